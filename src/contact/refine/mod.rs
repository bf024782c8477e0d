//! Finer meshes around the contact, until its figures are as good as wanted.
//!
//! [`given`] notes what the given mesh gave, and [`rounds`] solves again and again; [`meshes`] holds what it solved last,
//! [`wanting`] and [`mark`] say where the mesh must be finer, [`smooth_touch`] where the smooth skin is first touched,
//! [`estimate`] what is left to gain, by the [`mesh_errors`] of each discretization, [`tissue`] what the given mesh loses on
//! thin tissue, [`product`] what that of a product's matrix costs, [`round`] what each of them says of its mesh, and [`whole`]
//! puts the part that was solved back into the skin.

pub(crate) mod estimate;
pub(crate) mod given;
pub(crate) mod mark;
mod mesh_errors;
pub(crate) mod meshes;
pub(crate) mod product;
pub(crate) mod round;
pub(crate) mod rounds;
mod smooth_touch;
mod tissue;
mod wanting;
pub(crate) mod whole;
