//! Presses one after the other, each from the mesh and the forces that the one before leaves.
//!
//! A mesh that met the target for one contact serves the next ones too: it is cut where the rim of the contact comes to
//! larger triangles, and given up where the contact has become another in size. Then, and on a sharp edge that it was not
//! refined for, the next press begins from the given one.
//!
//! [`presses`] goes on from press to press; [`mesh`] says what a mesh costs a contact that it was not refined for.

pub(crate) mod mesh;
pub(crate) mod presses;
