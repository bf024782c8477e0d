//! LU factors with partial pivoting in block columns.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::linalg::matmul;
use faer::linalg::triangular_solve as substitution;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};

use crate::linalg::dense::Dense;
use crate::linalg::factor::{
    GROUP_WORK, Interrupt, NoFactor, RIGHT_SIDES, Real, STRIP_COLUMNS, in_strips, panel_width,
};
use crate::linalg::kernels::axpy;
use crate::linalg::vectorized::vectorized;

/// Multiplications in whose time a row of a column changes its place.
const MOVE_COST: usize = 64;

/// `P A = L U`, stored over A.
pub(crate) struct Lu<T = f64> {
    a: Dense<T>,
    /// Row i of P A is this row of A.
    order: Vec<usize>,
}

/// How the work is cut up; threads change no bit of the factor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Blocking {
    /// Columns factored before the rest is updated.
    pub(crate) panel: usize,
    /// Columns of the rest that one task updates.
    pub(crate) strip: usize,
    /// Threads within a panel.
    pub(crate) par: Par,
}

impl Lu {
    /// In narrow panels and strips, for small matrices and soon interrupted.
    pub(crate) fn new(a: Dense, interrupted: Interrupt) -> Result<Self, NoFactor> {
        let blocking = Blocking { panel: panel_width(a.rows()), strip: STRIP_COLUMNS, par: Par::Seq };
        Self::with_blocking(a, blocking, &mut |_| interrupted())
    }

    /// The sign of the determinant.
    pub(crate) fn has_positive_determinant(&self) -> bool {
        let mut positive = (0..self.order.len()).filter(|&i| self.a.at(i, i) < 0.0).count().is_multiple_of(2);
        // Each cycle of even length is an odd permutation.
        let mut seen = vec![false; self.order.len()];
        for start in 0..self.order.len() {
            let (mut at, mut length) = (start, 0_usize);
            while !std::mem::replace(&mut seen[at], true) {
                at = self.order[at];
                length += 1;
            }
            positive ^= length > 0 && length.is_multiple_of(2);
        }
        positive
    }

    /// L and U in one matrix, and `L⁻¹ P`.
    pub(crate) fn split(self, interrupted: Interrupt) -> Result<(Dense, Dense), NoFactor> {
        let n = self.a.rows();
        let mut inverse = Dense::zeros(n, n);
        self.order.iter().enumerate().for_each(|(i, &from)| inverse.column_mut(from)[i] = 1.0);
        let strip = (GROUP_WORK / (4 * n * n).max(1)).clamp(8, STRIP_COLUMNS);
        in_strips(inverse.as_mut(), strip, n * n, &mut || interrupted(), |_, strip| {
            substitution::solve_unit_lower_triangular_in_place(self.a.as_ref(), strip, Par::Seq);
        });
        if interrupted() {
            return Err(NoFactor::Interrupted);
        }
        Ok((self.a, inverse))
    }

    /// `A x = b`.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.order.iter().map(|&i| b[i]).collect();
        vectorized(
            #[inline(always)]
            || {
                for j in 0..x.len() {
                    let value = -x[j];
                    axpy(&mut x[j + 1..], value, &self.a.column(j)[j + 1..]);
                }
                for j in (0..x.len()).rev() {
                    let column = self.a.column(j);
                    x[j] /= column[j];
                    let value = -x[j];
                    axpy(&mut x[..j], value, &column[..j]);
                }
            },
        );
        x
    }

    /// `A X = B` in place; left unfinished when interrupted.
    pub(crate) fn solve_in_place(&self, right: MatMut<'_, f64>, interrupted: Interrupt) {
        let moves: Vec<(usize, usize)> = self.order.iter().copied().enumerate().collect();
        let n = self.order.len();
        in_strips(right, RIGHT_SIDES, n * n, &mut || interrupted(), |_, mut strip| {
            move_rows(strip.rb_mut(), &moves);
            substitution::solve_unit_lower_triangular_in_place(self.a.as_ref(), strip.rb_mut(), Par::Seq);
            substitution::solve_upper_triangular_in_place(self.a.as_ref(), strip, Par::Seq);
        });
    }
}

impl<T: Real> Lu<T> {
    /// As cut up; `stop` is told the share of the work that is done, 0 to 1, and ends it by returning true.
    pub(crate) fn with_blocking(
        mut a: Dense<T>,
        Blocking { panel: width, strip, par }: Blocking,
        stop: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, NoFactor> {
        let n = a.rows();
        let mut order: Vec<usize> = (0..n).collect();
        for start in (0..n).step_by(width) {
            let done = 1.0 - ((n - start) as f64 / n as f64).powi(3);
            if stop(done) {
                return Err(NoFactor::Interrupted);
            }
            let mut stop = || stop(done);
            let (end, height) = ((start + width).min(n), n - start);
            let from = factor_panel(a.as_mut().submatrix_mut(start, start, height, end - start), par);
            if !(start..end).all(|i| a.at(i, i).into() != 0.0 && a.at(i, i).into().is_finite()) {
                return Err(NoFactor::Singular);
            }
            let before = order[start..].to_vec();
            order[start..].iter_mut().zip(&from).for_each(|(row, &from)| *row = before[from]);
            // At most two rows for each column of the panel have moved.
            let moves: Vec<(usize, usize)> =
                from.into_iter().enumerate().filter(|(to, from)| to != from).collect();
            let (left, mut right) = a.as_mut().subrows_mut(start, height).split_at_col_mut(end);
            let (before, panel) = left.split_at_col_mut(start);
            for columns in [before, right.rb_mut()] {
                in_strips(columns, STRIP_COLUMNS, MOVE_COST * moves.len(), &mut stop, |_, strip| {
                    move_rows(strip, &moves)
                });
            }
            let (triangle, below) = panel.rb().split_at_row(end - start);
            in_strips(right, strip, (end - start) * height, &mut stop, |_, strip| {
                let (mut top, rest) = strip.split_at_row_mut(end - start);
                substitution::solve_unit_lower_triangular_in_place(triangle, top.rb_mut(), Par::Seq);
                matmul::matmul(rest, Accum::Add, below, top.rb(), T::from(-1.0), Par::Seq);
            });
        }
        if stop(1.0) {
            return Err(NoFactor::Interrupted);
        }
        Ok(Self { a, order })
    }

    /// Smallest over largest pivot in size.
    pub(crate) fn pivot_ratio(&self) -> f64 {
        let pivots = || (0..self.a.rows()).map(|i| self.a.at(i, i).into().abs());
        pivots().fold(f64::INFINITY, f64::min) / pivots().fold(0.0, f64::max)
    }

    /// The last `count` unknowns of `A X = B` in place, in less time than all; left unfinished when interrupted.
    pub(crate) fn solve_last(&self, mut right: MatMut<'_, T>, count: usize, interrupted: Interrupt) {
        let moves: Vec<(usize, usize)> = self.order.iter().copied().enumerate().collect();
        move_rows(right.rb_mut(), &moves);
        substitution::solve_unit_lower_triangular_in_place(self.a.as_ref(), right.rb_mut(), Par::Seq);
        if interrupted() {
            return;
        }
        let first = self.order.len() - count;
        let last = self.a.as_ref().submatrix(first, first, count, count);
        substitution::solve_upper_triangular_in_place(last, right.subrows_mut(first, count), Par::Seq);
    }
}

/// LU of a block column; returns which row has come to each place.
fn factor_panel<T: Real>(panel: MatMut<'_, T>, par: Par) -> Vec<usize> {
    let (height, width) = (panel.nrows(), panel.ncols());
    let [mut from, mut to] = [vec![0; height], vec![0; height]];
    let scratch = factor::lu_in_place_scratch::<usize, T>(height, width, par, Default::default());
    let mut memory = MemBuffer::new(scratch);
    factor::lu_in_place(panel, &mut from, &mut to, par, MemStack::new(&mut memory), Default::default());
    from
}

/// Puts row `from` at `to` for each of `moves`.
fn move_rows<T: Real>(columns: MatMut<'_, T>, moves: &[(usize, usize)]) {
    let mut held = vec![T::from(0.0); moves.len()];
    for column in columns.col_iter_mut() {
        let column = column.try_as_col_major_mut().expect("an owned matrix has contiguous columns");
        let column = column.as_slice_mut();
        held.iter_mut().zip(moves).for_each(|(held, &(_, from))| *held = column[from]);
        held.iter().zip(moves).for_each(|(&held, &(to, _))| column[to] = held);
    }
}
