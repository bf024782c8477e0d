//! The boundary-element equations of a body: Kelvin's kernels against hat functions, one collocation point after another.
//!
//! In units of the mesh's mean edge length and of `G`; see the parent module for the equations.

pub(crate) mod assemble;
pub(crate) mod blocks;
pub(crate) mod discretize;
pub(crate) mod element;
pub(crate) mod incompressible;
pub mod kelvin;
pub(crate) mod moments;
pub(crate) mod quadrature;
pub(crate) mod triangle;
