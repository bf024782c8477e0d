//! A body on two levels: a near kernel on the skin's own mesh and the body's smooth remainder from a coarse one.
//!
//! The body's compliance B is singular near a force, as a half-space's is, and that part is known in closed form on any
//! mesh. What is left of it is smooth, so that a coarse mesh carries it:
//!
//! ```text
//! C = N + P (B_coarse - N_coarse) P'
//! ```
//!
//! with N the [`near`] kernel on the mesh at hand, and P the values at its vertices that are linear on the faces of the
//! coarse mesh, between whose vertices the [`remainder`] in brackets stands. With the skin itself for the coarse mesh P is
//! 1 and C is B.

pub(crate) mod coarseness;
mod gathered;
pub(crate) mod near;
mod near_blocks;
pub(crate) mod on_mesh;
pub(crate) mod one_level;
mod remainder;
pub(crate) mod sizing;
mod thickness;
pub(crate) mod two_levels;
mod wanted_edges;
