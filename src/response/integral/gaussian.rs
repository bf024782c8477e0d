//! Exact integrals of a Gaussian against a linear density over a flat triangle.

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use nalgebra::Vector3;

use crate::response::integral::cutoff::{PlanarKernel, hats_within};
use crate::response::integral::frame::TriangleFrame;

/// `exp(-r²/2c²)` as a function of the in-plane distance s and the height z, r² = s² + z².
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gaussian {
    /// c (m), > 0.
    pub(crate) width: f64,
}

/// Gaussian measure of the right triangle with legs h (from the center) and q: `V(h, q)`, odd in q.
fn right_triangle(h: f64, q: f64) -> f64 {
    f64::atan2(q, h) / TAU - owens_t::owens_t(h, q / h)
}

impl PlanarKernel for Gaussian {
    fn edge(&self, d: f64, s0: f64, s1: f64, z: f64) -> (f64, f64) {
        let c = self.width;
        let fade = (-0.5 * (z / c).powi(2)).exp();
        let h = d.abs() / c;
        // The measure of a right triangle is 0 where one leg is; q/h must stay finite.
        let measure = if h < 1e-150 { 0.0 } else { right_triangle(h, s1 / c) - right_triangle(h, s0 / c) };
        let erfs = libm::erf(s1 / c * FRAC_1_SQRT_2) - libm::erf(s0 / c * FRAC_1_SQRT_2);
        let boundary = -c.powi(3) * (0.5 * PI).sqrt() * (-0.5 * (d * d + z * z) / (c * c)).exp() * erfs;
        (d.signum() * TAU * c * c * fade * measure, boundary)
    }

    fn disc(&self, radius: f64, z: f64) -> (f64, f64) {
        let c = self.width;
        let zeroth = -c * c * (-0.5 * (z / c).powi(2)).exp() * (-0.5 * (radius / c).powi(2)).exp_m1();
        (zeroth, -c * c * (-0.5 * (radius * radius + z * z) / (c * c)).exp())
    }
}

/// Integrals over a triangle of its three hat functions against a Gaussian.
///
/// `I_k = ∫ hat_k(y) exp(-|x - y|²/2c²) dA`, exact through Owen's T function.
///
/// * `point`: x (m), anywhere
/// * `triangle`: corners (m), not degenerate
/// * `width`: c (m), > 0
///
/// Returns the integral for each corner's hat (m²); relative to the area the error is about 1e-14 (c / height)².
pub fn gaussian_hat_integrals(point: &Vector3<f64>, triangle: &[Vector3<f64>; 3], width: f64) -> [f64; 3] {
    hats_within(&TriangleFrame::new(*triangle), point, &Gaussian { width }, f64::INFINITY)
}
