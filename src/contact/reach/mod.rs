//! Presses to a force or an overlap: the depth is searched on the given mesh, the mesh refined there, the depth searched
//! again on the refined one.
//!
//! [`search`] finds where a rising function takes a value, [`target`] says which, [`on_mesh`] runs it with contacts on one mesh,
//! [`on_refined`] on the given mesh and the refined one, for a depth or for a balance; [`goal`] does so for a press.

pub(crate) mod goal;
pub(crate) mod on_mesh;
pub(crate) mod on_refined;
pub(crate) mod search;
pub(crate) mod target;
