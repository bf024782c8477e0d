//! Checks, neighbourhoods and repair of raw triangle meshes, shared by skin and product.
//!
//! A mesh is a list of vertices (m) and a list of faces, each three vertex indices counter-clockwise seen from
//! outside. [`check`] looks once at everything that the later stages rely on and returns the [`Topology`], or
//! a [`MeshError`] that names the first element at fault, its value and how many there are. It accepts open
//! meshes. [`check_nesting`] looks at how the closed components of a mesh lie in one another and which way they
//! are turned. [`repair`] mends what can be mended without guessing, as a separate, explicit step.
//!
//! [`rigid_motion`] checks the rotation and translation by which either is moved.
//!
//! All tolerances are relative to the size of the mesh, so a mesh is judged alike in m and in mm.

mod adjacency;
mod borders;
mod check;
mod columns;
mod component;
mod csr;
mod distance;
mod error;
mod fan;
mod grid;
mod nesting;
mod orient;
mod repair;
mod rigid;
mod topology;
mod weld;
mod winding;

pub use check::{DEGENERATE_HEIGHT, check};
pub use error::MeshError;
pub use nesting::{check_nesting, component_volumes};
pub use repair::{Repair, RepairOptions, RepairReport, repair};
pub use rigid::{RigidMotionError, rigid_motion};
pub use topology::Topology;
pub use winding::{solid_angle, winding_number};

pub(crate) use winding::signed_volume;
