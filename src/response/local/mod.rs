//! Response matrices of kernels that fade, stored in blocks at almost linear cost.
//!
//! `R_ij = ∫ k(|x_i - y|) p_j(y) dA` (m/N) with a kernel k that has faded beyond its reach, so that a product keeps
//! `|R' f - R f| <= threshold |R| |f|`, R' the stored matrix.
//!
//! A hierarchical matrix (Hackbusch 1999, Computing 62, 89-108): a tree of `clusters` of nodes, a `plan` of blocks of
//! pairs of clusters, and in each, by `assemble`:
//!
//! - close to each other: all entries, exact;
//! - apart: a few products of vectors, by `cross` approximation of `far` entries, their loads as a few `points`;
//! - `across` the distance at which a kernel is cut off: a `step`, products of vectors for the columns within, and the
//!   entries of the loads that are cut (`cut_load`, triangle by triangle in `cut_face`, the kernel in `cut_kernel`).
//!
//! The `matrix` is read by its `product` and its `spectrum`.

mod across;
mod assemble;
mod clusters;
mod cross;
mod cut_face;
mod cut_kernel;
mod cut_load;
mod far;
mod matrix;
mod norm;
mod options;
mod plan;
mod points;
mod product;
mod smooth;
mod spectrum;
mod step;

pub use assemble::assemble_local;
pub use matrix::LocalMatrix;
pub use options::LocalOptions;
pub use spectrum::LocalDefiniteness;
