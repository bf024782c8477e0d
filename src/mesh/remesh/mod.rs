//! Other triangles for the same surface: fewer, finer or more even ones.

pub(crate) mod coarsen;
pub(crate) mod even_out;
pub(crate) mod green;
pub(crate) mod red_green;
pub(crate) mod smooth;
pub(crate) mod split_edges;
