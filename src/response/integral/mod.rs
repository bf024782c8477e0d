//! Integrals over one flat triangle.
//!
//! `∫ φ_k(y) k(|x - y|) dA` with φ_k the hat of corner k: exact for 1/r (Wilton et al. 1984) and for a Gaussian
//! (Owen's T function), also within a cutoff; by quadrature along the edges for other radial kernels.

pub(crate) mod cutoff;
pub(crate) mod edge_quadrature;
pub(crate) mod frame;
pub(crate) mod gauss;
pub(crate) mod gaussian;
pub(crate) mod hat;
pub(crate) mod hat_simd;
mod piece;
pub(crate) mod rule_lists;
pub(crate) mod symmetric_rule;
