//! Whether a local matrix is positive definite, by products alone.

use super::super::definiteness::{Definiteness, Extremes, lanczos};
use super::matrix::LocalMatrix;
use faer::Mat;

/// Lanczos steps.
const STEPS: usize = 100;

/// What [`LocalMatrix::definiteness`] finds of the symmetric part (R + R')/2.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct LocalDefiniteness {
    /// Whether the stored and the exact matrix are both positive definite: the smallest eigenvalue found is above
    /// `margin`.
    pub positive_definite: bool,
    /// Whether the smallest eigenvalue is farther from 0 than `margin`, so that the sign is not left to what the
    /// threshold took away.
    pub decided: bool,
    /// Smallest eigenvalue of the stored matrix (m/N), as far as Lanczos steps see: never below the true one.
    pub smallest: f64,
    /// Largest eigenvalue of the stored matrix (m/N).
    pub largest: f64,
    /// largest / smallest; infinite unless both are positive.
    pub condition: f64,
    /// What the smallest eigenvalue may be off by (m/N): threshold times largest, for the entries that are not stored
    /// exactly, and the residual of the steps.
    pub margin: f64,
}

impl LocalMatrix {
    /// Definiteness of the symmetric part (R + R')/2: 100 Lanczos steps, each with R and R'.
    ///
    /// An eigenvalue that they find below zero is there. That none is below is an estimate: the start has parts in all
    /// directions, but the smallest eigenvalue is approached from above. No node counts as positive definite, with
    /// eigenvalues nan.
    pub fn definiteness(&self) -> LocalDefiniteness {
        if self.order() == 0 {
            let (smallest, largest, margin) = (f64::NAN, f64::NAN, 0.0);
            return LocalDefiniteness {
                positive_definite: true,
                decided: true,
                smallest,
                largest,
                condition: 1.0,
                margin,
            };
        }
        let symmetric = |v: &Mat<f64>| {
            let v: Vec<f64> = v.col(0).iter().copied().collect();
            let (ahead, back) = (self.apply(&v), self.apply_transposed(&v));
            Mat::from_fn(v.len(), 1, |i, _| 0.5 * (ahead[i] + back[i]))
        };
        let Extremes { low, high, low_residual } = lanczos(self.order(), STEPS, symmetric);
        let margin = self.threshold() * high + low_residual;
        LocalDefiniteness {
            positive_definite: low > margin,
            decided: low.abs() > margin,
            smallest: low,
            largest: high,
            condition: if low > 0.0 { high / low } else { f64::INFINITY },
            margin,
        }
    }
}

impl LocalDefiniteness {
    /// What to know and which constant to change where the matrix is not positive definite or that is left open;
    /// `None` if it is.
    ///
    /// * `matrix`: the matrix that it was found for
    pub fn advice(&self, matrix: &LocalMatrix) -> Option<String> {
        if self.positive_definite {
            return None;
        }
        if !self.decided {
            return Some(format!(
                "whether the response matrix is positive definite is open at threshold {:.0e}: its smallest eigenvalue \
                 is {:.1e} of the largest, known to {:.1e}; assemble with a smaller threshold, or take fewer nodes",
                matrix.threshold(),
                self.smallest / self.largest,
                self.margin / self.largest
            ));
        }
        let Self { smallest, largest, condition, .. } = *self;
        let found = Definiteness { positive_definite: false, smallest, largest, condition, estimated: true };
        found.advice(matrix.skin())
    }
}
