//! The ray on which Lemke's method may end, and what it proves.

use crate::lcp::certificate::nan_max;
use crate::lcp::problem::LcpProblem;
use crate::lcp::product::{product_and_magnitudes, product_compensated};
use crate::linalg::factor::Interrupt;

/// What a ray proves about the problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RayConclusion {
    /// `M' z <= 0` and `q·z < 0`: no `z >= 0` has `M z + q >= 0`, so there is no solution.
    Infeasible,
    /// The same but for entries of `M' z` that are above zero by rounding: a solution would have to be huge.
    InfeasibleToRounding,
    /// `z·Mz < 0`, beyond rounding, with `z >= 0`: M is not copositive and Lemke's method cannot tell.
    NotCopositive,
    /// Neither could be shown.
    Inconclusive,
}

/// Direction of the unbounded path: `w = M z + d z0` with w, z, z0 >= 0 and `w·z = 0`, d the covering vector.
///
/// Its length means nothing; it is scaled so that the largest of `M_ii z_i`, w and z0 is of the order of 1, where
/// the covering vector is.
#[derive(Debug, Clone, PartialEq)]
pub struct LcpRay {
    /// Direction of z (n).
    pub z: Vec<f64>,
    /// Direction of w (n).
    pub w: Vec<f64>,
    /// Direction of the covering variable.
    pub z0: f64,
    /// Largest violation of the ray's equations and signs, relative to its own size.
    pub residual: f64,
    /// `z·Mz` relative to `Σ |z_i M_ij z_j|`.
    pub curvature: f64,
    /// What it proves.
    pub conclusion: RayConclusion,
}

/// Share of a sum's magnitudes that is taken for rounding.
const ROUNDING_SHARE: f64 = 1e-12;

impl LcpRay {
    /// Checks a ray of the whole problem against M and q as given.
    pub(super) fn verify(
        problem: &LcpProblem,
        z: Vec<f64>,
        z0: f64,
        covering: &[f64],
        interrupted: Interrupt,
    ) -> Self {
        let n = z.len();
        let (product, magnitudes) = product_and_magnitudes(problem.m, &z, interrupted);
        let w: Vec<f64> = product.iter().zip(covering).map(|(p, d)| p + d * z0).collect();
        let size = (0..n).fold(0.0, |size: f64, i| size.max(magnitudes[i] + covering[i] * z0));
        let mut residual = 0.0_f64;
        let (mut curvature, mut weight) = (0.0, 0.0);
        for i in 0..n {
            let force = problem.force_beside(i, z[i], w[i]);
            residual = nan_max(nan_max(residual, force.min(w[i]).abs()), -w[i]);
            curvature += z[i] * product[i];
            weight += z[i].abs() * magnitudes[i];
        }
        let relative = |value: f64, scale: f64| if scale > 0.0 { value / scale } else { 0.0 };
        let (residual, curvature) = (relative(residual, size), relative(curvature, weight));
        let conclusion = infeasibility(problem, &z, interrupted).unwrap_or({
            if curvature < -ROUNDING_SHARE {
                RayConclusion::NotCopositive
            } else {
                RayConclusion::Inconclusive
            }
        });
        Self { z, w, z0, residual, curvature, conclusion }
    }
}

/// Farkas: `z >= 0`, `M' z <= 0`, `q·z < 0`; with twice the digits, or else to rounding.
fn infeasibility(problem: &LcpProblem, z: &[f64], interrupted: Interrupt) -> Option<RayConclusion> {
    let (product, magnitude) =
        problem.q.iter().zip(z).fold((0.0, 0.0), |(p, m), (q, z)| (p + q * z, m + (q * z).abs()));
    if product >= -ROUNDING_SHARE * magnitude || product.is_nan() {
        return None;
    }
    let transposed = problem.m.transpose();
    let columns = product_compensated(transposed, z, interrupted);
    // A column that is only rounding above zero can still be lifted by a huge z_j.
    if columns.iter().all(|&sum| sum <= 0.0) {
        return Some(RayConclusion::Infeasible);
    }
    let (_, magnitudes) = product_and_magnitudes(transposed, z, interrupted);
    let is_rounding = |(&sum, magnitude): (&f64, f64)| sum <= 16.0 * f64::EPSILON * magnitude;
    columns.iter().zip(magnitudes).all(is_rounding).then_some(RayConclusion::InfeasibleToRounding)
}
