//! Factors of a dense block, made in panels so that a large one can be interrupted and shared among threads.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor as lu;
use faer::linalg::matmul::{self, triangular};
use faer::linalg::triangular_solve as substitution;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};
use rayon::prelude::*;

use crate::linalg::dense::Dense;
use crate::linalg::kernels::{CHUNK, add_terms_inline, axpy, dot};

/// Columns of a panel; between panels the interrupt is asked, so those of a tall matrix are narrow.
fn panel(n: usize) -> usize {
    if n > 2048 { 64 } else { 128 }
}
/// Columns of the rest that one task updates. It depends on no number of threads, so neither do the results.
const STRIP: usize = 256;
/// Columns whose rows change places between two asks of the interrupt.
const INTERCHANGED: usize = 512;
/// Multiplications between two asks of the interrupt: some tens of milliseconds on one core.
const WORK: usize = 1 << 28;

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NoFactor {
    /// A pivot was zero, not a number, or not positive.
    Singular,
    /// The interrupt said stop.
    Interrupted,
}

/// `P A = L U`, or `A = L L'` where A is symmetric positive definite.
pub(crate) struct Factor {
    a: Dense,
    /// Row i of P A is this row of A; `None` for Cholesky.
    order: Option<Vec<usize>>,
}

impl Factor {
    /// LU with partial pivoting.
    pub(crate) fn lu(mut a: Dense, interrupted: &dyn Fn() -> bool) -> Result<Self, NoFactor> {
        let n = a.rows();
        let mut order: Vec<usize> = (0..n).collect();
        for start in (0..n).step_by(panel(n)) {
            if interrupted() {
                return Err(NoFactor::Interrupted);
            }
            let end = (start + panel(n)).min(n);
            let height = n - start;
            let (mut forward, mut backward) = (vec![0_usize; height], vec![0_usize; height]);
            let scratch =
                lu::lu_in_place_scratch::<usize, f64>(height, end - start, Par::Seq, Default::default());
            let panel = a.as_mut().submatrix_mut(start, start, height, end - start);
            let mut buffer = MemBuffer::new(scratch);
            let stack = MemStack::new(&mut buffer);
            lu::lu_in_place(panel, &mut forward, &mut backward, Par::Seq, stack, Default::default());
            if !(start..end).all(|i| a.at(i, i) != 0.0 && a.at(i, i).is_finite()) {
                return Err(NoFactor::Singular);
            }
            let permuted: Vec<usize> = forward.iter().map(|&from| order[start + from]).collect();
            order[start..].copy_from_slice(&permuted);
            // At most two rows for each column of the panel have moved.
            let moved: Vec<(usize, usize)> = forward
                .iter()
                .enumerate()
                .filter(|&(to, &from)| to != from)
                .map(|(to, &from)| (to, from))
                .collect();
            let mut values = vec![0.0; moved.len()];
            for j in (0..start).chain(end..n) {
                if j % INTERCHANGED == 0 && interrupted() {
                    return Err(NoFactor::Interrupted);
                }
                let entries = &mut a.column_mut(j)[start..];
                values.iter_mut().zip(&moved).for_each(|(value, &(_, from))| *value = entries[from]);
                values.iter().zip(&moved).for_each(|(&value, &(to, _))| entries[to] = value);
            }
            let (left, right) = a.as_mut().split_at_col_mut(end);
            let left = left.rb();
            let (triangle, below) = (
                left.submatrix(start, start, end - start, end - start),
                left.submatrix(end, start, n - end, end - start),
            );
            in_strips(
                right.submatrix_mut(start, 0, height, n - end),
                end - start,
                interrupted,
                |_, strip| {
                    let (mut top, mut rest) = strip.split_at_row_mut(end - start);
                    substitution::solve_unit_lower_triangular_in_place(triangle, top.rb_mut(), Par::Seq);
                    matmul::matmul(rest.rb_mut(), Accum::Add, below, top.rb(), -1.0, Par::Seq);
                },
            );
        }
        Ok(Self { a, order: Some(order) })
    }

    /// Cholesky; the lower triangle of `a` is read.
    pub(crate) fn cholesky(mut a: Dense, interrupted: &dyn Fn() -> bool) -> Result<Self, NoFactor> {
        let n = a.rows();
        for start in (0..n).step_by(panel(n)) {
            if interrupted() {
                return Err(NoFactor::Interrupted);
            }
            let end = (start + panel(n)).min(n);
            let width = end - start;
            let (mut left, right) = a.as_mut().split_at_col_mut(end);
            let (triangle, mut below) =
                left.rb_mut().submatrix_mut(start, start, n - start, width).split_at_row_mut(width);
            let mut triangle = triangle;
            triangle_cholesky(triangle.rb_mut())?;
            // L21 = A21 L11'^-1, that is L11 L21' = A21'.
            substitution::solve_lower_triangular_in_place(
                triangle.rb(),
                below.rb_mut().transpose_mut(),
                Par::Seq,
            );
            let below = below.rb();
            in_strips(right.submatrix_mut(end, 0, n - end, n - end), width, interrupted, |first, strip| {
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
        Ok(Self { a, order: None })
    }

    /// L and U in one matrix, and `L⁻¹ P`.
    pub(crate) fn split(self, interrupted: &dyn Fn() -> bool) -> Result<(Dense, Dense), NoFactor> {
        let n = self.a.rows();
        let mut inverse = Dense::zeros(n, n);
        let order = self.order.expect("an LU factor has an order of rows");
        order.iter().enumerate().for_each(|(i, &from)| inverse.column_mut(from)[i] = 1.0);
        let strip = (WORK / (4 * n * n).max(1)).clamp(8, STRIP);
        for_groups(inverse.as_mut(), 4 * strip, interrupted, |_, part| {
            let solve = |strip| {
                substitution::solve_unit_lower_triangular_in_place(self.a.as_ref(), strip, Par::Seq);
            };
            if part.ncols() <= strip { solve(part) } else { part.par_col_chunks_mut(strip).for_each(solve) }
        });
        if interrupted() {
            return Err(NoFactor::Interrupted);
        }
        Ok((self.a, inverse))
    }

    /// Whether the factor stands for the lower triangle alone.
    pub(crate) fn is_cholesky(&self) -> bool {
        self.order.is_none()
    }

    /// The sign of the determinant, which is positive for every principal block of a P-matrix.
    pub(crate) fn has_positive_determinant(&self) -> bool {
        let Some(order) = &self.order else {
            return true;
        };
        let mut positive = (0..order.len()).filter(|&i| self.a.at(i, i) < 0.0).count().is_multiple_of(2);
        // Each cycle of even length is an odd permutation.
        let mut seen = vec![false; order.len()];
        for start in 0..order.len() {
            let (mut at, mut length) = (start, 0_usize);
            while !std::mem::replace(&mut seen[at], true) {
                at = order[at];
                length += 1;
            }
            positive ^= length > 0 && length.is_multiple_of(2);
        }
        positive
    }

    /// `A x = b`; unfinished when interrupted.
    pub(crate) fn solve(&self, b: &[f64], interrupted: &dyn Fn() -> bool) -> Vec<f64> {
        let n = b.len();
        let mut x: Vec<f64> = match &self.order {
            Some(order) => order.iter().map(|&i| b[i]).collect(),
            None => b.to_vec(),
        };
        let columns_at_once = (CHUNK / n.max(1)).max(1);
        for first in (0..n).step_by(columns_at_once) {
            if first > 0 && interrupted() {
                return x;
            }
            let columns = first..(first + columns_at_once).min(n);
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    for j in columns {
                        let column = self.a.column(j);
                        if self.order.is_none() {
                            x[j] /= column[j];
                        }
                        let value = -x[j];
                        axpy(&mut x[j + 1..], value, &column[j + 1..]);
                    }
                },
            );
        }
        for end in (1..=n).rev().step_by(columns_at_once) {
            if end < n && interrupted() {
                return x;
            }
            let columns = end.saturating_sub(columns_at_once)..end;
            pulp::Arch::new().dispatch(
                #[inline(always)]
                || {
                    for j in columns.rev() {
                        let column = self.a.column(j);
                        if self.order.is_some() {
                            x[j] /= column[j];
                            let value = -x[j];
                            axpy(&mut x[..j], value, &column[..j]);
                        } else {
                            let sum = dot(&column[j + 1..], &x[j + 1..]);
                            x[j] = (x[j] - sum) / column[j];
                        }
                    }
                },
            );
        }
        x
    }
}

/// Cholesky of a panel's triangle, column by column; faer's has a start-up cost that small blocks would feel.
fn triangle_cholesky(mut triangle: MatMut<'_, f64>) -> Result<(), NoFactor> {
    let n = triangle.nrows();
    let mut l = vec![0.0; n * n];
    for (j, column) in l.chunks_exact_mut(n.max(1)).enumerate() {
        let source = triangle.rb().col(j).try_as_col_major().expect("an owned matrix has contiguous columns");
        column[j..].copy_from_slice(&source.as_slice()[j..]);
    }
    let is_definite = pulp::Arch::new().dispatch(
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

/// Runs `update` on strips of columns, with the number of the first; several at a time where there are many, and
/// `interrupted` asked in between. Each column takes `depth` multiplications a row.
fn in_strips(
    rest: MatMut<'_, f64>,
    depth: usize,
    interrupted: &dyn Fn() -> bool,
    update: impl Fn(usize, MatMut<'_, f64>) + Sync,
) {
    let group = STRIP * (WORK / (STRIP * depth * rest.nrows()).max(1)).max(4);
    for_groups(rest, group, interrupted, |first, part| match part.ncols() {
        0..=STRIP => update(first, part),
        _ => {
            part.par_col_chunks_mut(STRIP).enumerate().for_each(|(k, strip)| update(first + k * STRIP, strip))
        }
    });
}

/// Runs `update` on groups of columns one after the other, asking in between.
fn for_groups(
    mut rest: MatMut<'_, f64>,
    group: usize,
    interrupted: &dyn Fn() -> bool,
    update: impl Fn(usize, MatMut<'_, f64>),
) {
    for first in (0..rest.ncols()).step_by(group) {
        if first > 0 && interrupted() {
            return;
        }
        let width = group.min(rest.ncols() - first);
        update(first, rest.rb_mut().subcols_mut(first, width));
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    fn dense(a: &Mat<f64>) -> Dense {
        let mut copy = Dense::zeros(a.nrows(), a.ncols());
        (0..a.ncols()).for_each(|j| copy.column_mut(j).copy_from_slice(a.col_as_slice(j)));
        copy
    }

    fn matrix(n: usize) -> Mat<f64> {
        let mut seed = 3_u64;
        Mat::from_fn(n, n, |_, _| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        })
    }

    fn assert_solves(a: &Mat<f64>, factor: &Factor) {
        let n = a.nrows();
        let x: Vec<f64> = (0..n).map(|i| (i % 7) as f64 - 3.0).collect();
        let b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| a[(i, j)] * x[j]).sum()).collect();
        for (found, expected) in factor.solve(&b, &|| false).iter().zip(&x) {
            assert!((found - expected).abs() < 1e-8, "{found} is not {expected} at n = {n}");
        }
    }

    #[test]
    fn both_factors_solve_at_every_size_around_a_panel() {
        for n in [0, 1, 2, 3, 127, 128, 129, 300, 700] {
            let a = matrix(n);
            assert_solves(&a, &Factor::lu(dense(&a), &|| false).ok().unwrap());
            let definite = &a * a.transpose() + Mat::<f64>::identity(n, n) * n as f64;
            assert_solves(&definite, &Factor::cholesky(dense(&definite), &|| false).ok().unwrap());
        }
    }

    #[test]
    fn singular_indefinite_and_interrupted_give_no_factor() {
        let zero = Mat::<f64>::zeros(3, 3);
        assert_eq!(Factor::lu(dense(&zero), &|| false).err(), Some(NoFactor::Singular));
        assert_eq!(Factor::cholesky(dense(&zero), &|| false).err(), Some(NoFactor::Singular));
        let indefinite = Mat::<f64>::identity(200, 200) * -1.0;
        assert_eq!(Factor::cholesky(dense(&indefinite), &|| false).err(), Some(NoFactor::Singular));
        assert_eq!(Factor::lu(dense(&zero), &|| true).err(), Some(NoFactor::Interrupted));
    }
}
