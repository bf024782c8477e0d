//! How good an answer is, measured against M and q as given.

use crate::lcp::problem::LcpProblem;
use crate::linalg::definiteness::Definiteness;

/// Measures of an answer, all dimensionless and unchanged when M or q is scaled.
///
/// `delta = max(-q)` is the length they are divided by; where it is zero, z = 0 is exact and they are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Certificate {
    /// `max |min(M_ii z_i, w_i)| / delta`; where `M_ii z_i` is the smaller, `max |M_ji| z_i` over j stands for it, and
    /// the largest entry of a row for a diagonal that is not positive.
    pub natural_residual: f64,
    /// `Σ |z_i w_i| / (delta max(delta / mean diagonal, Σ z))`.
    pub complementarity: f64,
    /// `max(-w_i, 0) / delta`.
    pub infeasibility: f64,
    /// What is known of M on the rows that can leave zero.
    pub definiteness: Definiteness,
    /// Whether the caller stated that every principal minor of M is positive.
    pub known_p_matrix: bool,
}

impl Certificate {
    /// Measures `z` with `w = M z + q` as recomputed from the problem.
    pub(super) fn measure(problem: &LcpProblem, z: &[f64], w: &[f64]) -> Self {
        let exact = Self {
            natural_residual: 0.0,
            complementarity: 0.0,
            infeasibility: 0.0,
            definiteness: problem.known_definiteness,
            known_p_matrix: problem.known_p_matrix,
        };
        let delta = problem.deficit();
        if delta == 0.0 {
            return exact;
        }
        let (mut natural, mut products, mut infeasibility, mut total) = (0.0, 0.0, 0.0, 0.0);
        for (i, (&z, &w)) in z.iter().zip(w).enumerate() {
            natural = nan_max(natural, problem.force_beside(i, z, w).min(w).abs() / delta);
            infeasibility = nan_max(infeasibility, (-w).max(0.0) / delta);
            if z < 0.0 || !w.is_finite() {
                natural = nan_max(natural, f64::INFINITY);
            }
            products += (z * (w / delta)).abs();
            total += z;
        }
        let n = z.len();
        let mean = (0..n).map(|i| problem.diagonal_scale(i) / n as f64).sum::<f64>();
        let load = if mean > 0.0 { (delta / mean).max(total) } else { total };
        let complementarity = if products == 0.0 { 0.0 } else { products / load };
        Self { natural_residual: natural, complementarity, infeasibility, ..exact }
    }

    /// Whether the solution is known to be the only one.
    pub fn is_unique(&self) -> bool {
        self.known_p_matrix || self.definiteness == Definiteness::PositiveDefinite
    }
}

/// The larger of two, where NaN counts as infinite.
pub(super) fn nan_max(a: f64, b: f64) -> f64 {
    if b.is_nan() { f64::INFINITY } else { a.max(b) }
}
