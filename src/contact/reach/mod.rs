//! Presses to a force or an overlap: the depth is searched on the given mesh, the mesh refined there, the depth searched
//! again on the refined one.

pub(crate) mod goal;
pub(crate) mod on_mesh;
pub(crate) mod on_refined;
pub(crate) mod search;
pub(crate) mod target;
