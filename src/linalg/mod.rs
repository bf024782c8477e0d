//! Dense linear algebra that faer has not: vector loops chosen at run time, factors in panels that can be interrupted,
//! factors of blocks kept for others like them, definiteness beyond rounding.

pub(crate) mod block_factor;
pub(crate) mod cholesky;
pub(crate) mod columns;
pub(crate) mod definiteness;
pub(crate) mod dense;
pub(crate) mod factor;
pub(crate) mod kernels;
pub(crate) mod lanczos;
pub(crate) mod lu;
pub(crate) mod memory;
pub(crate) mod threads;
pub(crate) mod vectorized;
