//! Extreme eigenvalues of a symmetric operator.

use faer::{Mat, MatRef, Side};

use crate::linalg::factor::Interrupt;

/// Smallest and largest Ritz value after `steps` Lanczos steps, of the [`krylov_space`]; NaN if their equation has no
/// solution, or once it is interrupted.
pub(crate) fn ritz_values(
    n: usize,
    steps: usize,
    interrupted: Interrupt,
    apply: impl Fn(&Mat<f64>) -> Mat<f64>,
) -> (f64, f64) {
    let space = krylov_space(n, steps, interrupted, apply);
    space.map_or((f64::NAN, f64::NAN), |(_, projected)| extremes(projected.as_ref()))
}

/// Smallest and largest eigenvalue of a symmetric matrix, of which the lower triangle is read; NaN if not found.
pub(crate) fn extremes(matrix: MatRef<f64>) -> (f64, f64) {
    let values = matrix.self_adjoint_eigenvalues(Side::Lower);
    values.map_or((f64::NAN, f64::NAN), |values| (values[0], values[values.len() - 1]))
}

/// Orthonormal columns (n × at most `steps`) by Lanczos' method with full orthogonalisation, from a fixed start with
/// parts in all directions, and the operator on them; `None` once it is interrupted.
///
/// * `n`: order of the operator, > 0
/// * `apply`: the operator on a vector (n × 1)
pub(crate) fn krylov_space(
    n: usize,
    steps: usize,
    interrupted: Interrupt,
    apply: impl Fn(&Mat<f64>) -> Mat<f64>,
) -> Option<(Mat<f64>, Mat<f64>)> {
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
        if interrupted() {
            return None;
        }
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
    let projected = Mat::from_fn(m, m, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    });
    Some((Mat::from_fn(n, m, |i, j| basis[j][(i, 0)]), projected))
}
