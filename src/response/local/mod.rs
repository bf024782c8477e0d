//! Response matrices of kernels that fade, stored in blocks at almost linear cost.
//!
//! A hierarchical matrix (Hackbusch 1999, Computing 62, 89-108): a tree of clusters of nodes, blocks of pairs of clusters,
//! and products of a few vectors where the clusters are apart.

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
