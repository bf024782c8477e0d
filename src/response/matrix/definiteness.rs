//! Whether a response matrix is positive definite, and how well it is conditioned.

use faer::{Mat, MatRef, Side};

use crate::lcp::definite::cholesky_rounding;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::{Kernel, KernelSkin};

/// Up to this order all eigenvalues are computed; beyond it the extreme ones are estimated.
const SMALL: usize = 192;
/// Lanczos steps beyond that.
const STEPS: usize = 80;

/// What [`definiteness`] finds.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Definiteness {
    /// Whether the symmetric part is positive definite beyond rounding. Then R is a P-matrix: the contact problem
    /// has one solution for any gap, and Lemke's method finds it. False also where R is singular to rounding.
    pub positive_definite: bool,
    /// Smallest eigenvalue of the symmetric part (m/N).
    pub smallest: f64,
    /// Largest eigenvalue of the symmetric part (m/N).
    pub largest: f64,
    /// largest / smallest; infinite unless positive definite.
    pub condition: f64,
    /// Whether the eigenvalues are Lanczos estimates (large matrices): the true smallest may be a little
    /// smaller, the true largest a little larger.
    pub estimated: bool,
}

/// Definiteness and condition number of the symmetric part (R + R')/2 of a response matrix.
///
/// Definite is what a Cholesky factor proves (n³/3 operations): of R with its diagonal lowered by the share
/// `n (n + 8) ε`, more than rounding in the factor amounts to. Eigenvalues are exact up to order 192 and beyond it
/// estimated by 80 Lanczos steps with the matrix and with the inverse of that factor (to some 1e-3 or better).
///
/// * `matrix`: R (k × k, m/N), finite
///
/// An empty matrix counts as positive definite, with eigenvalues nan.
///
/// # Panics
/// If the matrix is not square.
pub fn definiteness(matrix: MatRef<'_, f64>) -> Definiteness {
    let n = matrix.nrows();
    assert_eq!(n, matrix.ncols(), "a response matrix is square");
    if n == 0 {
        let (smallest, largest, condition) = (f64::NAN, f64::NAN, 1.0);
        return Definiteness { positive_definite: true, smallest, largest, condition, estimated: false };
    }
    let symmetric = Mat::from_fn(n, n, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]));
    let mut lowered = symmetric.clone();
    (0..n).for_each(|i| lowered[(i, i)] *= 1.0 - cholesky_rounding(n));
    let factor = lowered.llt(Side::Lower).ok();
    drop(lowered);
    let (smallest, largest, estimated) = if n <= SMALL {
        match symmetric.self_adjoint_eigenvalues(Side::Lower) {
            Ok(values) => (values[0], values[n - 1], false),
            Err(_) => (f64::NAN, f64::NAN, true),
        }
    } else {
        let Extremes { low, high } = lanczos(n, STEPS, |v| &symmetric * v);
        match &factor {
            Some(factor) => {
                use faer::linalg::solvers::Solve;
                (1.0 / lanczos(n, STEPS, |v| factor.solve(v)).high, high, true)
            }
            None => (low.min(0.0), high, true),
        }
    };
    let positive_definite = factor.is_some();
    let condition = if positive_definite && smallest > 0.0 { largest / smallest } else { f64::INFINITY };
    Definiteness { positive_definite, smallest, largest, condition, estimated }
}

/// Extreme Ritz values of a symmetric operator.
#[derive(Debug, Clone, Copy)]
struct Extremes {
    low: f64,
    high: f64,
}

/// Lanczos steps with full orthogonalisation, from a fixed start with parts in all directions.
fn lanczos(n: usize, steps: usize, apply: impl Fn(&Mat<f64>) -> Mat<f64>) -> Extremes {
    let steps = steps.min(n);
    let mut state = 1u64;
    let mut v = Mat::from_fn(n, 1, |_, _| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    });
    v /= faer::Scale(v.norm_l2());
    let mut basis: Vec<Mat<f64>> = Vec::with_capacity(steps);
    let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
    for _ in 0..steps {
        let mut w = apply(&v);
        basis.push(v);
        let scale = w.norm_l2();
        diagonal.push((basis[basis.len() - 1].transpose() * &w)[(0, 0)]);
        for _ in 0..2 {
            for b in &basis {
                let part = (b.transpose() * &w)[(0, 0)];
                w -= faer::Scale(part) * b;
            }
        }
        let norm = w.norm_l2();
        beside.push(norm);
        if norm <= 1e-12 * scale {
            break;
        }
        v = w / faer::Scale(norm);
    }
    let m = diagonal.len();
    let small = Mat::from_fn(m, m, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    });
    match small.self_adjoint_eigenvalues(Side::Lower) {
        Ok(values) => Extremes { low: values[0], high: values[m - 1] },
        Err(_) => Extremes { low: f64::NAN, high: f64::NAN },
    }
}

impl Definiteness {
    /// Why the matrix is not positive definite and which constant to change; `None` if it is.
    pub fn advice(&self, skin: &KernelSkin) -> Option<String> {
        if self.positive_definite {
            return None;
        }
        let found = format!(
            "the response matrix is not positive definite beyond rounding (smallest eigenvalue {:.1e} of the largest), so the \
             contact problem may have no solution or several",
            self.smallest / self.largest
        );
        let remedy = match skin.kernel() {
            _ if skin.basis() == PressureBasis::OneRing => {
                "pressure = one_ring is singular on regular meshes: take pressure = linear".to_string()
            }
            Kernel::GaussianCorrected { height, width, .. } => format!(
                "the Gaussian of height {height:.3e} m/N and width {width:.3e} m takes off more than K/r gives: \
                 without a cutoff a height up to {:.3e} m/N is well posed at this width, balanced and cut off at \
                 L a width from about L/2; or take a layer or half-space",
                skin.kernel_constant() * 0.5f64.exp() / width
            ),
            Kernel::Layer { thickness } => {
                let form = match skin.discretization() {
                    Discretization::Collocation => "on badly shaped flat triangles gap = weighted is; ",
                    Discretization::Galerkin => "",
                };
                format!(
                    "the kernel of a layer of thickness {:.3e} m is that of a flat layer: {form}where the surface \
                     bends within some 20 thicknesses, take fewer nodes, lower poisson_ratio a little, or take a \
                     body response",
                    thickness.largest()
                )
            }
            _ => "triangles near the contact are badly shaped: improve the mesh there, or take the weighted form"
                .to_string(),
        };
        Some(format!("{found}; {remedy}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skin(basis: PressureBasis) -> KernelSkin {
        KernelSkin::new(60e3, 0.5, Kernel::HalfSpace).expect("valid constants").with_basis(basis)
    }

    #[test]
    fn a_two_by_two_has_its_hand_made_eigenvalues() {
        // symmetric part [2 1; 1 2]: 1 and 3
        let m = Mat::from_fn(2, 2, |i, j| [[2.0, 0.5], [1.5, 2.0]][i][j]);
        let d = definiteness(m.as_ref());
        assert!(d.positive_definite && !d.estimated);
        assert!((d.smallest - 1.0).abs() < 1e-14 && (d.largest - 3.0).abs() < 1e-14);
        assert!((d.condition - 3.0).abs() < 1e-13);
        assert_eq!(d.advice(&skin(PressureBasis::Linear)), None);
    }

    #[test]
    fn an_indefinite_matrix_is_told_with_advice() {
        let m = Mat::from_fn(2, 2, |i, j| [[1.0, 2.0], [2.0, 1.0]][i][j]);
        let d = definiteness(m.as_ref());
        assert!(!d.positive_definite && d.condition == f64::INFINITY);
        assert!((d.smallest + 1.0).abs() < 1e-14);
        assert!(d.advice(&skin(PressureBasis::Linear)).expect("advice").contains("weighted"));
        assert!(d.advice(&skin(PressureBasis::OneRing)).expect("advice").contains("one_ring"));
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
            let d = definiteness(m.as_ref());
            let exact = |k: f64| 2.0 - 2.0 * (k * std::f64::consts::PI / (n as f64 + 1.0)).cos() + shift;
            assert!(d.estimated);
            assert_eq!(d.positive_definite, shift > 0.0);
            assert!((d.largest / exact(n as f64) - 1.0).abs() < 1e-2);
            let error = (d.smallest - exact(1.0)).abs();
            // the inverse makes the smallest one sharp; without it Lanczos comes from above
            assert!(error < if shift > 0.0 { 1e-6 } else { 1e-2 }, "{error:e}");
        }
    }

    #[test]
    fn a_singular_matrix_is_not_called_definite() {
        // B B' of integers with determinant 0, whose last pivot is rounding above zero.
        let rows = [[106.0, 90.0, -76.0], [90.0, 106.0, -92.0], [-76.0, -92.0, 80.0]];
        for scale in [1.0, 1e-9, 0.3] {
            let d = definiteness(Mat::from_fn(3, 3, |i, j| rows[i][j] * scale).as_ref());
            assert!(!d.positive_definite && d.condition == f64::INFINITY, "{d:?}");
        }
        // Every node twice, beyond the order whose eigenvalues are all computed.
        let n = 300;
        let m = Mat::from_fn(n, n, |i, j| 0.7_f64.powi((i / 2).abs_diff(j / 2) as i32));
        assert!(!definiteness(m.as_ref()).positive_definite);
    }

    #[test]
    fn no_nodes_are_positive_definite() {
        assert!(definiteness(Mat::<f64>::zeros(0, 0).as_ref()).positive_definite);
    }
}
