//! Definiteness and extreme eigenvalues.

use faer::{Mat, mat};
use quasirigid::lcp::Definiteness;
use quasirigid::response::spectrum;

use crate::problems::Noise;

fn definiteness(m: &Mat<f64>) -> Definiteness {
    spectrum(m.as_ref()).definiteness
}

/// `B B'` of small integers: exact, and singular as B has fewer columns than rows.
fn singular(n: usize, rank: usize, seed: u64) -> Mat<f64> {
    let mut noise = Noise(seed);
    let b = Mat::from_fn(n, rank, |_, _| noise.integer(9));
    &b * b.transpose()
}

#[test]
fn exactly_singular_matrices_are_never_called_definite_nor_indefinite() {
    for seed in 0..400 {
        let n = 2 + seed as usize % 40;
        let m = singular(n, n - 1, seed);
        if (0..n).all(|i| m[(i, i)] > 0.0) {
            assert_eq!(definiteness(&m), Definiteness::Unknown, "seed {seed}");
        }
    }
}

#[test]
fn a_shift_beyond_rounding_either_way_is_told_at_every_scale() {
    for scale in [1.0, 3e-9, 7e12] {
        for (shift, expected) in
            [(1e-9, Definiteness::PositiveDefinite), (-1e-9, Definiteness::NotPositiveDefinite)]
        {
            for n in [3, 30, 300] {
                let m = singular(n, n - 1, 5);
                let mean = (0..n).map(|i| m[(i, i)]).sum::<f64>() / n as f64;
                let m = (m + Mat::<f64>::identity(n, n) * (shift * mean)) * scale;
                assert_eq!(definiteness(&m), expected, "{n}, {scale:e}");
            }
        }
    }
}

#[test]
fn a_diagonal_that_is_not_positive_tells_at_once() {
    assert_eq!(definiteness(&Mat::zeros(2, 2)), Definiteness::NotPositiveDefinite);
    assert!(spectrum(Mat::<f64>::zeros(0, 0).as_ref()).is_positive_definite());
}

#[test]
fn a_two_by_two_has_its_hand_made_eigenvalues() {
    // symmetric part [2 1; 1 2]: 1 and 3
    let m = Mat::from_fn(2, 2, |i, j| [[2.0, 0.5], [1.5, 2.0]][i][j]);
    let d = spectrum(m.as_ref());
    assert!(d.is_positive_definite() && !d.estimated);
    assert!((d.smallest - 1.0).abs() < 1e-14 && (d.largest - 3.0).abs() < 1e-14);
    assert!((d.condition - 3.0).abs() < 1e-13);
    let indefinite = spectrum(mat![[1.0, 2.0], [2.0, 1.0]].as_ref());
    assert_eq!(indefinite.definiteness, Definiteness::NotPositiveDefinite);
    assert!(indefinite.condition == f64::INFINITY && (indefinite.smallest + 1.0).abs() < 1e-14);
}

#[test]
fn estimates_of_large_matrices_match_their_known_spectrum() {
    // second differences: 2 - 2 cos(k π / (n + 1)); plus a shift
    let n = 400;
    for shift in [0.01, -0.5] {
        let m = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0 + shift,
            1 => -1.0,
            _ => 0.0,
        });
        let d = spectrum(m.as_ref());
        let exact = |k: f64| 2.0 - 2.0 * (k * std::f64::consts::PI / (n as f64 + 1.0)).cos() + shift;
        assert!(d.estimated);
        assert_eq!(d.is_positive_definite(), shift > 0.0);
        assert!((d.largest / exact(n as f64) - 1.0).abs() < 1e-2);
        let error = (d.smallest - exact(1.0)).abs();
        // the inverse makes the smallest one sharp; without it Lanczos comes from above
        assert!(error < if shift > 0.0 { 1e-6 } else { 1e-2 }, "{error:e}");
    }
}

#[test]
fn estimates_near_what_rounding_hides_are_those_of_the_matrix_as_given() {
    // Reflections turn a diagonal with known entries; their rounding is 1e-5 of the smallest.
    let n = 400;
    let lowest = |i: usize| 10f64.powf(-10.3 + 2.0 * i as f64).min(1.0);
    for decay in [0.0, 0.02] {
        let mut noise = Noise(3);
        let mut m = Mat::from_fn(n, n, |i, j| if i == j { lowest(i) } else { 0.0 });
        for _ in 0..2 {
            // A direction over all coordinates, or over some tens of them.
            let u = Mat::from_fn(n, 1, |i, _| (noise.integer(9) + 0.5) * (-decay * i as f64).exp());
            let u = &u / faer::Scale(u.norm_l2());
            let reflection = Mat::<f64>::identity(n, n) - &u * u.transpose() * faer::Scale(2.0);
            m = &reflection * m * &reflection;
        }
        let d = spectrum(m.as_ref());
        assert!(d.estimated && d.is_positive_definite());
        assert!((d.smallest / lowest(0) - 1.0).abs() < 1e-3, "{:e}", d.smallest);
        assert!((d.condition * lowest(0) - 1.0).abs() < 1e-3, "{:e}", d.condition);
    }
}

#[test]
fn a_singular_matrix_has_no_finite_condition() {
    // B B' of integers with determinant 0, whose last pivot is rounding above zero.
    let three = mat![[106.0, 90.0, -76.0], [90.0, 106.0, -92.0], [-76.0, -92.0, 80.0]];
    // Every node twice, beyond the order whose eigenvalues are all computed.
    let twice = Mat::from_fn(300, 300, |i, j| 0.7_f64.powi((i / 2).abs_diff(j / 2) as i32));
    for m in [&three, &(&three * 1e-9), &(&three * 0.3), &twice] {
        let d = spectrum(m.as_ref());
        assert!(!d.is_positive_definite() && d.condition == f64::INFINITY, "{d:?}");
    }
}
