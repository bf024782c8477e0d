//! Dense LU in block columns, so that it can report and be interrupted.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::perm::Perm;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};
use rayon::iter::ParallelIterator;

/// Columns factored between two looks at the interrupt; wide enough for full-speed products.
const BLOCK: usize = 512;

/// `P A = L U`, stored over `A`.
pub(crate) struct Factors<'a> {
    lu: MatMut<'a, f64>,
    rows: Perm<usize>,
    par: Par,
}

/// Factors `matrix` in place by right-looking blocks with partial pivoting.
///
/// `advance` hears the fraction of the work done after each block and stops (`None`) by returning false.
pub(crate) fn factor_in_place<'a>(
    mut matrix: MatMut<'a, f64>,
    par: Par,
    advance: &mut dyn FnMut(f64) -> bool,
) -> Option<Factors<'a>> {
    let n = matrix.nrows();
    let mut rows: Vec<usize> = (0..n).collect();
    let mut start = 0;
    while start < n {
        let width = BLOCK.min(n - start);
        let height = n - start;
        let (left, below) = matrix.rb_mut().subrows_mut(start, height).split_at_col_mut(start);
        let (mut panel, mut right) = below.split_at_col_mut(width);

        let (mut forward, mut inverse) = (vec![0; height], vec![0; height]);
        let mut memory =
            MemBuffer::new(factor::lu_in_place_scratch::<usize, f64>(height, width, par, Default::default()));
        let (_, swaps) = factor::lu_in_place(
            panel.rb_mut(),
            &mut forward,
            &mut inverse,
            par,
            MemStack::new(&mut memory),
            Default::default(),
        );
        let moves: Vec<(usize, usize)> =
            swaps.arrays().0.iter().copied().enumerate().filter(|(to, from)| to != from).collect();
        move_rows(left, &moves);
        move_rows(right.rb_mut(), &moves);
        let before = rows[start..].to_vec();
        moves.iter().for_each(|&(to, from)| rows[start + to] = before[from]);

        let (top, bottom) = panel.rb().split_at_row(width);
        let (mut across, rest) = right.split_at_row_mut(width);
        solve_unit_lower_triangular_in_place(top, across.rb_mut(), par);
        matmul(rest, Accum::Add, bottom, across.rb(), -1.0, par);

        start += width;
        let left_over = (n - start) as f64 / n as f64;
        if !advance(1.0 - left_over.powi(3)) {
            return None;
        }
    }
    let mut inverse = vec![0; n];
    for (row, &from) in rows.iter().enumerate() {
        inverse[from] = row;
    }
    Some(Factors { lu: matrix, rows: Perm::new_checked(rows.into(), inverse.into(), n), par })
}

/// Puts row `from` at `to` for each of `moves`, column by column with no copy of the matrix.
fn move_rows(matrix: MatMut<f64>, moves: &[(usize, usize)]) {
    if matrix.ncols() == 0 {
        return;
    }
    matrix.par_col_chunks_mut(32).for_each_init(Vec::new, |held: &mut Vec<f64>, columns| {
        for mut column in columns.col_iter_mut() {
            held.clear();
            held.extend(moves.iter().map(|&(_, from)| column[from]));
            moves.iter().zip(&*held).for_each(|(&(to, _), &value)| column[to] = value);
        }
    });
}

impl Factors<'_> {
    /// Smallest over largest pivot in size: 0 for a singular matrix.
    pub fn pivot_ratio(&self) -> f64 {
        let pivots = || (0..self.lu.nrows()).map(|i| self.lu[(i, i)].abs());
        let (low, high) = (pivots().fold(f64::INFINITY, f64::min), pivots().fold(0.0, f64::max));
        if low.is_finite() && high > 0.0 { low / high } else { 0.0 }
    }

    /// Solves `A' X = B` in place.
    pub fn solve_transposed(&self, mut right: MatMut<f64>) {
        let scratch =
            solve::solve_transpose_in_place_scratch::<usize, f64>(self.lu.nrows(), right.ncols(), self.par);
        let mut memory = MemBuffer::new(scratch);
        solve::solve_transpose_in_place(
            self.lu.rb(),
            self.lu.rb(),
            self.rows.as_ref(),
            right.rb_mut(),
            self.par,
            MemStack::new(&mut memory),
        );
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    fn some_matrix(n: usize) -> Mat<f64> {
        Mat::from_fn(n, n, |i, j| {
            ((i * 7919 + j * 104729) % 1009) as f64 / 1009.0 - 0.5 + f64::from(i + 1 == j)
        })
    }

    #[test]
    fn block_edges_do_not_matter() {
        for n in [1, 2, 3, 511, 512, 513, 1100] {
            let matrix = some_matrix(n);
            let right = Mat::from_fn(n, 2, |i, j| (i + 3 * j) as f64 / n as f64 - 0.4);
            let mut lu = matrix.clone();
            let factors = factor_in_place(lu.as_mut(), Par::Seq, &mut |_| true).expect("not interrupted");
            let mut x = right.clone();
            factors.solve_transposed(x.as_mut());
            let residual = matrix.transpose() * &x - &right;
            assert!(residual.norm_max() < 1e-9 * x.norm_max().max(1.0), "n = {n}: {:e}", residual.norm_max());
            assert!(factors.pivot_ratio() > 0.0);
        }
    }

    #[test]
    fn an_interrupt_ends_it_and_the_work_done_rises_to_one() {
        let mut seen = Vec::new();
        let mut lu = some_matrix(1100);
        factor_in_place(lu.as_mut(), Par::Seq, &mut |done| {
            seen.push(done);
            true
        });
        assert!(seen.windows(2).all(|pair| pair[0] < pair[1]) && seen.last() == Some(&1.0));
        assert!(factor_in_place(some_matrix(600).as_mut(), Par::Seq, &mut |_| false).is_none());
    }
}
