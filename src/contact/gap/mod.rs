//! Initial gaps `g0` (m) along the obstacle's outward normal.
//!
//! [`initial`] measures them on demand, and keeps the planes `g0 = d - n . u` of vertices that were measured at a displacement u.
//! [`measured`] is signed distance at points; [`entry`], back along the press or the skin's inward normal where the closest side is
//! not the one that the skin came in through, [`look`] how far; [`edge`], from an edge of it between the vertices, as deep as it is
//! [`under`] a triangle, which is [`held`] by it there; [`averaged`], against the hats, for the Galerkin form. [`deepest`] is where
//! they are lowest. [`touch`] finds where an obstacle on its way first touches the skin, between vertices too, and [`inside`] what
//! of it stands in the deformed skin.

pub(crate) mod averaged;
pub(crate) mod deepest;
pub(crate) mod edge;
pub(crate) mod entry;
mod held;
pub(crate) mod initial;
pub(crate) mod inside;
mod look;
pub(crate) mod measured;
pub(crate) mod touch;
mod under;
