//! Cholesky's factor in panels.

use faer::linalg::matmul::{self, triangular};
use faer::linalg::triangular_solve as substitution;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};

use crate::linalg::dense::Dense;
use crate::linalg::factor::{Interrupt, NoFactor, RIGHT_SIDES, STRIP_COLUMNS, in_strips, panel_width};
use crate::linalg::kernels::{add_terms_inline, axpy, dot};
use crate::linalg::vectorized::vectorized;

/// `c A = L L'` of a symmetric positive definite matrix.
pub(crate) struct Cholesky {
    l: Dense,
    /// c, 1 or 1/2: the largest entry of c A has an even exponent, so that A and 2 A have the same digits under the roots.
    scale: f64,
}

impl Cholesky {
    /// Reads the lower triangle of `a`.
    pub(crate) fn new(mut a: Dense, interrupted: Interrupt) -> Result<Self, NoFactor> {
        let n = a.rows();
        let largest = (0..n).map(|i| a.at(i, i)).fold(0.0, f64::max);
        let is_odd = largest > 0.0 && largest.is_finite() && libm::ilogb(largest).rem_euclid(2) == 1;
        let scale = if is_odd { 0.5 } else { 1.0 };
        if is_odd {
            (0..n).for_each(|j| a.column_mut(j)[j..].iter_mut().for_each(|entry| *entry *= scale));
        }
        for start in (0..n).step_by(panel_width(n)) {
            if interrupted() {
                return Err(NoFactor::Interrupted);
            }
            let end = (start + panel_width(n)).min(n);
            let width = end - start;
            let (mut left, right) = a.as_mut().split_at_col_mut(end);
            let (mut triangle, mut below) =
                left.rb_mut().submatrix_mut(start, start, n - start, width).split_at_row_mut(width);
            factor_triangle(triangle.rb_mut())?;
            // L21 = A21 L11'^-1, that is L11 L21' = A21'.
            substitution::solve_lower_triangular_in_place(
                triangle.rb(),
                below.rb_mut().transpose_mut(),
                Par::Seq,
            );
            let below = below.rb();
            let rest = right.submatrix_mut(end, 0, n - end, n - end);
            in_strips(rest, STRIP_COLUMNS, width * (n - end), &mut || interrupted(), |first, strip| {
                let columns = strip.ncols();
                let (_, strip) = strip.split_at_row_mut(first);
                let (top, mut rest) = strip.split_at_row_mut(columns);
                let own = below.subrows(first, columns);
                triangular::matmul(
                    top,
                    triangular::BlockStructure::TriangularLower,
                    Accum::Add,
                    own,
                    triangular::BlockStructure::Rectangular,
                    own.transpose(),
                    triangular::BlockStructure::Rectangular,
                    -1.0,
                    Par::Seq,
                );
                let under = below.subrows(first + columns, rest.nrows());
                matmul::matmul(rest.rb_mut(), Accum::Add, under, own.transpose(), -1.0, Par::Seq);
            });
        }
        Ok(Self { l: a, scale })
    }

    /// `A X = B` in place; left unfinished when interrupted.
    pub(crate) fn solve_in_place(&self, right: MatMut<'_, f64>, interrupted: Interrupt) {
        let (l, n) = (self.l.as_ref(), self.l.rows());
        in_strips(right, RIGHT_SIDES, n * n, &mut || interrupted(), |_, mut strip| {
            strip.rb_mut().col_iter_mut().for_each(|mut column| column *= faer::Scale(self.scale));
            substitution::solve_lower_triangular_in_place(l, strip.rb_mut(), Par::Seq);
            substitution::solve_upper_triangular_in_place(l.transpose(), strip, Par::Seq);
        });
    }

    /// `A x = b`.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = b.iter().map(|entry| self.scale * entry).collect();
        vectorized(
            #[inline(always)]
            || {
                for j in 0..x.len() {
                    let column = self.l.column(j);
                    x[j] /= column[j];
                    let value = -x[j];
                    axpy(&mut x[j + 1..], value, &column[j + 1..]);
                }
                for j in (0..x.len()).rev() {
                    let column = self.l.column(j);
                    let sum = dot(&column[j + 1..], &x[j + 1..]);
                    x[j] = (x[j] - sum) / column[j];
                }
            },
        );
        x
    }
}

/// Cholesky of a panel's triangle, column by column; faer's has a start-up cost that small blocks would feel.
fn factor_triangle(mut triangle: MatMut<'_, f64>) -> Result<(), NoFactor> {
    let n = triangle.nrows();
    let mut l = vec![0.0; n * n];
    for (j, column) in l.chunks_exact_mut(n.max(1)).enumerate() {
        let source = triangle.rb().col(j).try_as_col_major().expect("an owned matrix has contiguous columns");
        column[j..].copy_from_slice(&source.as_slice()[j..]);
    }
    let is_definite = vectorized(
        #[inline(always)]
        || {
            for j in 0..n {
                let (left, rest) = l.split_at_mut(j * n);
                let column = &mut rest[j..n];
                add_terms_inline(column, j, |p| {
                    let earlier = &left[p * n + j..][..n - j];
                    (earlier, -earlier[0])
                });
                let pivot = column[0];
                if !(pivot > 0.0 && pivot.is_finite()) {
                    return false;
                }
                let root = pivot.sqrt();
                column.iter_mut().for_each(|entry| *entry /= root);
            }
            true
        },
    );
    if !is_definite {
        return Err(NoFactor::Singular);
    }
    for (j, column) in l.chunks_exact(n.max(1)).enumerate() {
        let target = triangle.rb_mut().col_mut(j).try_as_col_major_mut();
        let target = target.expect("an owned matrix has contiguous columns").as_slice_mut();
        target[j..].copy_from_slice(&column[j..]);
    }
    Ok(())
}
