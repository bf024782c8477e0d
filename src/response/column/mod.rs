//! One column of a response matrix: displacement of all points per newton at one node.
//!
//! The node's force is spread over the triangles around it ([`load`]); far points are served by a series, near ones by
//! exact integrals or quadrature.

pub(crate) mod border;
pub(crate) mod gaussian;
pub(crate) mod half_space;
pub(crate) mod kernel;
pub(crate) mod layer;
pub(crate) mod load;
