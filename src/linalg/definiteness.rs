//! Whether the symmetric part of a matrix is positive definite, and how well it is conditioned.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::linalg::cholesky::Cholesky;
use crate::linalg::dense::Dense;
use crate::linalg::factor::{Interrupt, NoFactor};
use crate::linalg::lanczos::{extremes, krylov_space, ritz_values};

/// Up to this order all eigenvalues are computed; beyond it the extreme ones are estimated.
const EXACT_ORDER: usize = 192;
/// Lanczos steps beyond that.
const LANCZOS_STEPS: usize = 80;
/// Of these so many are multiplied by the matrix between two asks of the interrupt.
const STRIP_STEPS: usize = 8;

/// What is known of the symmetric part `(A + A')/2` of a square matrix.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Definiteness {
    /// Positive definite, beyond rounding. A is then a P-matrix: a complementarity problem with it has one solution.
    PositiveDefinite,
    /// It has a negative eigenvalue, beyond rounding, or a diagonal entry that is not positive.
    NotPositiveDefinite,
    /// Singular to rounding, so that neither can be told; or not examined.
    Unknown,
}

impl Definiteness {
    /// The name used in reports.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::PositiveDefinite => "positive_definite",
            Self::NotPositiveDefinite => "not_positive_definite",
            Self::Unknown => "unknown",
        }
    }
}

/// Extreme eigenvalues of the symmetric part of a matrix, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Spectrum {
    /// What a Cholesky factor proves.
    pub definiteness: Definiteness,
    /// Smallest eigenvalue.
    pub smallest: f64,
    /// Largest eigenvalue.
    pub largest: f64,
    /// largest / smallest; infinite unless positive definite.
    pub condition: f64,
    /// Whether the eigenvalues are Lanczos estimates (large matrices): the true smallest may be a little
    /// smaller, the true largest a little larger.
    pub estimated: bool,
}

impl Spectrum {
    /// Whether the matrix is positive definite beyond rounding; false also where it is singular to rounding.
    pub fn is_positive_definite(&self) -> bool {
        self.definiteness == Definiteness::PositiveDefinite
    }
}

/// Definiteness and condition number of the symmetric part of a matrix.
///
/// Definite is what a Cholesky factor proves (n³/3 operations): of the matrix with its diagonal lowered by the share
/// `n (n + 8) ε`, more than rounding in the factor amounts to. Eigenvalues are exact up to order 192 and beyond it
/// estimated from 80 Lanczos steps with the matrix, the smallest from the matrix on as many with the inverse of that
/// factor (to some 1e-3 or better).
///
/// * `matrix`: (k × k), finite
///
/// An empty matrix counts as positive definite, with eigenvalues nan.
///
/// # Panics
/// If the matrix is not square.
pub fn spectrum(matrix: MatRef<f64>) -> Spectrum {
    spectrum_until(matrix, &|| false)
}

/// The same, with nothing known once it is interrupted.
pub(crate) fn spectrum_until(matrix: MatRef<f64>, interrupted: Interrupt) -> Spectrum {
    let n = matrix.nrows();
    assert_eq!(n, matrix.ncols(), "a matrix with a spectrum is square");
    let all: Vec<usize> = (0..n).collect();
    let (definiteness, factor) = examine(matrix, &all, interrupted);
    let symmetric = symmetric_part(matrix, &all, 1.0, interrupted);
    let (smallest, largest) = if n == 0 || interrupted() {
        (f64::NAN, f64::NAN)
    } else if n <= EXACT_ORDER {
        extremes(symmetric.as_ref())
    } else {
        let times_matrix = |v: &Mat<f64>| times(symmetric.as_ref(), v.as_ref());
        let (low, high) = ritz_values(n, LANCZOS_STEPS, interrupted, times_matrix);
        let smallest = factor.map(|factor| smallest_eigenvalue(symmetric.as_ref(), &factor, interrupted));
        (smallest.unwrap_or(low.min(0.0)), high)
    };
    let condition = match definiteness {
        Definiteness::PositiveDefinite if n == 0 => 1.0,
        Definiteness::PositiveDefinite if smallest > 0.0 => largest / smallest,
        _ => f64::INFINITY,
    };
    Spectrum { definiteness, smallest, largest, condition, estimated: n > EXACT_ORDER }
}

/// Smallest eigenvalue of a positive definite matrix, a little too large; NaN once it is interrupted.
///
/// Rayleigh and Ritz: the least of the matrix itself on the directions that the inverse of its factor stretches most. The
/// factor's own eigenvalues are lower by as much as its diagonal, which may be more than the smallest is.
fn smallest_eigenvalue(matrix: MatRef<f64>, factor: &Cholesky, interrupted: Interrupt) -> f64 {
    let n = matrix.nrows();
    let inverse = |v: &Mat<f64>| {
        let x = factor.solve(v.col_as_slice(0));
        Mat::from_fn(n, 1, |i, _| x[i])
    };
    let Some((basis, _)) = krylov_space(n, LANCZOS_STEPS, interrupted, inverse) else { return f64::NAN };
    let steps = basis.ncols();
    let mut projected = Mat::zeros(steps, steps);
    for first in (0..steps).step_by(STRIP_STEPS) {
        if interrupted() {
            return f64::NAN;
        }
        let width = STRIP_STEPS.min(steps - first);
        let strip = times(matrix, basis.subcols(first, width));
        projected.subcols_mut(first, width).copy_from(times(basis.transpose(), strip.as_ref()));
    }
    extremes(projected.as_ref()).0
}

/// A product whose sums hang on no number of threads.
fn times(matrix: MatRef<f64>, v: MatRef<f64>) -> Mat<f64> {
    let mut product = Mat::zeros(matrix.nrows(), v.ncols());
    matmul(product.as_mut(), Accum::Replace, matrix, v, 1.0, Par::Seq);
    product
}

/// What a Cholesky factor proves of the symmetric part of `m` on the rows and columns `kept`, unknown where that is
/// singular to rounding and when interrupted; and that factor, its diagonal lowered, where it is positive definite.
pub(crate) fn examine(
    m: MatRef<f64>,
    kept: &[usize],
    interrupted: Interrupt,
) -> (Definiteness, Option<Cholesky>) {
    if kept.iter().any(|&i| m[(i, i)] <= 0.0) {
        return (Definiteness::NotPositiveDefinite, None);
    }
    let share = cholesky_rounding(kept.len());
    let factor = |diagonal: f64| Cholesky::new(symmetric_part(m, kept, diagonal, interrupted), interrupted);
    match factor(1.0 - share) {
        Ok(factor) => return (Definiteness::PositiveDefinite, Some(factor)),
        Err(NoFactor::Interrupted) => return (Definiteness::Unknown, None),
        Err(NoFactor::Singular) => {}
    }
    match factor(1.0 + share) {
        Err(NoFactor::Singular) => (Definiteness::NotPositiveDefinite, None),
        _ => (Definiteness::Unknown, None),
    }
}

/// `(M + M')/2` on the rows and columns `kept`, its diagonal times a factor.
fn symmetric_part(m: MatRef<f64>, kept: &[usize], diagonal: f64, interrupted: Interrupt) -> Dense {
    Dense::build(kept.len(), kept.len(), interrupted, |j, first, entries| {
        for (entry, &i) in entries.iter_mut().zip(&kept[first..]) {
            let factor = if i == kept[j] { diagonal } else { 1.0 };
            *entry = factor * (0.5 * m[(i, kept[j])] + 0.5 * m[(kept[j], i)]);
        }
    })
}

/// Share of its diagonal by which a symmetric matrix of order `n` is lowered, so that a Cholesky factor of what is
/// left proves it positive definite; raised by as much, it has one unless it has a negative eigenvalue.
///
/// Rounding in the factor moves the matrix, scaled to a unit diagonal, by `n (n + 1) ε / 2` at most, to first order
/// in ε (Demmel 1989, "On floating point errors in Cholesky"; Rump 2006, BIT 46, 433-452); halving and adding the
/// two sides moves it by less than `2 n ε`. The bound here is twice as large.
fn cholesky_rounding(n: usize) -> f64 {
    let n = n as f64;
    n * (n + 8.0) * f64::EPSILON
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interrupt_leaves_it_unknown() {
        let (found, factor) = examine(Mat::<f64>::identity(3, 3).as_ref(), &[0, 1, 2], &|| true);
        assert!(found == Definiteness::Unknown && factor.is_none());
    }
}
