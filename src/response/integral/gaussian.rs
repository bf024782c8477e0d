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

/// Gaussian measure of the right triangle with legs h (from the centre) and q: `V(h, q)`, odd in q.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::integral::reference_values::reference_integrals;

    #[test]
    fn gaussian_hat_integrals_match_60_digit_quadrature() {
        let mut worst: f64 = 0.0;
        for (row, case) in reference_integrals().iter().enumerate() {
            let (width, expected) = (case.width, case.gaussian);
            let got = gaussian_hat_integrals(&case.point, &case.triangle, width);
            let frame = TriangleFrame::new(case.triangle);
            let area = frame.area;
            let height = frame.heights.into_iter().fold(f64::INFINITY, f64::min);
            let longest = 2.0 * area / height;
            for k in 0..3 {
                // relative to the integral of the hat alone, as the Gaussian is at most 1
                let error = (got[k] - expected[k]).abs() / (area / 3.0);
                worst = worst.max(error);
                let bound = 4e-15 * (width / height).powi(2).max(1.0) * (longest / height).max(1.0);
                assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
            }
        }
        println!("worst error {worst:e} of the area");
    }

    #[test]
    fn owens_t_is_accurate_to_1e_14_in_the_range_used() {
        // T(h, a) = 1/2π ∫_0^a exp(-h²(1+x²)/2)/(1+x²) dx by Gauss quadrature over short pieces
        let rule = crate::response::integral::gauss::gauss(20, 0.0);
        for i in 0..60 {
            let h = 0.1 * i as f64;
            for a in [1e-3, 0.1, 0.5, 0.9, 1.0, 1.1, 2.0, 7.0, 40.0] {
                let pieces = 400;
                let mut sum = 0.0;
                for p in 0..pieces {
                    for &(t, w) in &rule {
                        let x: f64 = a * (p as f64 + t) / pieces as f64;
                        sum += w * (-0.5 * h * h * (1.0 + x * x)).exp() / (1.0 + x * x);
                    }
                }
                let expected = sum * a / pieces as f64 / TAU;
                assert!((owens_t::owens_t(h, a) - expected).abs() < 1e-14, "T({h}, {a})");
            }
        }
    }
}
