//! Whether a symmetric part is positive definite, beyond what rounding could feign.

use faer::MatRef;

use crate::lcp::certificate::Definiteness;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::dense::Dense;
use crate::linalg::factor::NoFactor;

/// Share of its diagonal by which a symmetric matrix of order `n` is lowered, so that a Cholesky factor of what is
/// left proves it positive definite; raised by as much, it has one unless it has a negative eigenvalue.
///
/// Rounding in the factor moves the matrix, scaled to a unit diagonal, by `n (n + 1) ε / 2` at most, to first order
/// in ε (Demmel 1989, "On floating point errors in Cholesky"; Rump 2006, BIT 46, 433-452); halving and adding the
/// two sides moves it by less than `2 n ε`. The bound here is twice as large.
pub(crate) fn cholesky_rounding(n: usize) -> f64 {
    let n = n as f64;
    n * (n + 8.0) * f64::EPSILON
}

/// What a Cholesky factor proves of the symmetric part of `m` on the rows and columns `kept`; unknown where
/// that is singular to rounding, and when interrupted.
pub(super) fn definiteness(
    m: MatRef<'_, f64>,
    kept: &[usize],
    interrupted: &dyn Fn() -> bool,
) -> Definiteness {
    if kept.iter().any(|&i| m[(i, i)] <= 0.0) {
        return Definiteness::NotPositiveDefinite;
    }
    let share = cholesky_rounding(kept.len());
    let factor = |diagonal: f64| {
        let symmetric = Dense::build(kept.len(), kept.len(), interrupted, |j, first, entries| {
            for (entry, &i) in entries.iter_mut().zip(&kept[first..]) {
                let factor = if i == kept[j] { diagonal } else { 1.0 };
                *entry = factor * (0.5 * m[(i, kept[j])] + 0.5 * m[(kept[j], i)]);
            }
        });
        Cholesky::new(symmetric, interrupted)
    };
    match factor(1.0 - share) {
        Ok(_) => return Definiteness::PositiveDefinite,
        Err(NoFactor::Interrupted) => return Definiteness::Unknown,
        Err(NoFactor::Singular) => {}
    }
    match factor(1.0 + share) {
        Err(NoFactor::Singular) => Definiteness::NotPositiveDefinite,
        _ => Definiteness::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    fn of(m: &Mat<f64>) -> Definiteness {
        let all: Vec<usize> = (0..m.nrows()).collect();
        definiteness(m.as_ref(), &all, &|| false)
    }

    /// `B B'` of small integers: exact, and singular as B has fewer columns than rows.
    fn singular(n: usize, rank: usize, seed: u64) -> Mat<f64> {
        let mut state = seed;
        let b = Mat::from_fn(n, rank, |_, _| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 % 19.0 - 9.0
        });
        &b * b.transpose()
    }

    #[test]
    fn exactly_singular_matrices_are_never_called_definite_nor_indefinite() {
        for seed in 0..400 {
            let n = 2 + seed as usize % 40;
            let m = singular(n, n - 1, seed);
            if (0..n).all(|i| m[(i, i)] > 0.0) {
                assert_eq!(of(&m), Definiteness::Unknown, "seed {seed}");
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
                    assert_eq!(of(&m), expected, "{n}, {scale:e}");
                }
            }
        }
    }

    #[test]
    fn a_diagonal_that_is_not_positive_tells_at_once() {
        assert_eq!(of(&Mat::zeros(2, 2)), Definiteness::NotPositiveDefinite);
        assert_eq!(of(&Mat::zeros(0, 0)), Definiteness::PositiveDefinite);
        let interrupted = definiteness(Mat::<f64>::identity(3, 3).as_ref(), &[0, 1, 2], &|| true);
        assert_eq!(interrupted, Definiteness::Unknown);
    }
}
