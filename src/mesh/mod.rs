//! Checks, neighbourhoods and repair of raw triangle meshes, shared by skin and product.
//!
//! A mesh is a list of vertices (m) and a list of faces, each three vertex indices counter-clockwise seen from
//! outside. [`check`] tests once what the later stages rely on and returns the [`Topology`], or a [`MeshError`] that
//! names the first element at fault, its value and how many there are; open meshes pass. [`check_nesting`] tests that
//! the closed components are turned as their nesting asks. [`repair`] mends what can be mended without guessing, as a
//! separate, explicit step.
//!
//! All tolerances are relative to the size of the mesh, so a mesh is judged alike in m and in mm.

pub(crate) mod adjacency;
pub(crate) mod borders;
pub(crate) mod check;
pub(crate) mod component;
pub(crate) mod csr;
pub(crate) mod distinct;
pub(crate) mod edge_map;
pub(crate) mod error;
pub(crate) mod fan;
pub(crate) mod grid;
pub(crate) mod nesting;
pub(crate) mod orient;
pub(crate) mod remesh;
pub(crate) mod repair;
pub(crate) mod topology;
pub(crate) mod weld;

pub use check::{DEGENERATE_HEIGHT, check};
pub use error::MeshError;
pub use nesting::{check_nesting, component_volumes};
pub use repair::{Repair, RepairOptions, RepairReport, repair};
pub use topology::Topology;
