//! Integrals of hats over one triangle against quadrature at 60 digits.

use std::f64::consts::TAU;

use quasirigid::response::{gaussian_hat_integrals, hat_integrals};

use crate::common::reference_integrals;

use super::gauss_rule;

#[test]
fn hat_integrals_match_60_digit_quadrature() {
    for (row, case) in reference_integrals().iter().enumerate() {
        let got = hat_integrals(&case.point, &case.triangle);
        for (k, (got, exact)) in got.iter().zip(case.inverse).enumerate() {
            let error = (got / exact - 1.0).abs();
            assert!(error < 5e-13, "row {row}, corner {k}: {error:e}");
        }
    }
}

#[test]
fn order_of_the_corners_permutes_the_integrals() {
    for case in reference_integrals() {
        let (x, [a, b, c]) = (case.point, case.triangle);
        let first = hat_integrals(&x, &[a, b, c]);
        let turned = hat_integrals(&x, &[b, c, a]);
        let flipped = hat_integrals(&x, &[b, a, c]);
        for (one, other) in
            [(first[0], turned[2]), (first[1], turned[0]), (first[0], flipped[1]), (first[2], flipped[2])]
        {
            assert!((one / other - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn gaussian_hat_integrals_match_60_digit_quadrature() {
    for (row, case) in reference_integrals().iter().enumerate() {
        let (width, expected) = (case.width, case.gaussian);
        let got = gaussian_hat_integrals(&case.point, &case.triangle, width);
        let [a, b, c] = case.triangle;
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        let height = 2.0 * area / longest;
        for k in 0..3 {
            // relative to the integral of the hat alone, as the Gaussian is at most 1
            let error = (got[k] - expected[k]).abs() / (area / 3.0);
            let bound = 4e-15 * (width / height).powi(2).max(1.0) * (longest / height).max(1.0);
            assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
        }
    }
}

#[test]
fn owens_t_is_accurate_to_1e_14_in_the_range_used() {
    // T(h, a) = 1/2π ∫_0^a exp(-h²(1+x²)/2)/(1+x²) dx by Gauss quadrature over short pieces
    let rule = gauss_rule(20);
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
