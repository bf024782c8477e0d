//! Factor `T K = U` of a square matrix that gains and loses single rows and columns.
//!
//! `U` is upper triangular and `T`, kept explicitly, is the product of the row operations that made it so.
//! Each change costs O(k²): a new row is eliminated against `U` with row interchanges, a lost column leaves a
//! Hessenberg form that adjacent interchanges mend (Bartels, Golub 1969, Communications of the ACM 12,
//! 266-268), and a lost row goes out through the combination of rows that has just become zero.

use rayon::prelude::*;

use crate::linalg::dense::Dense;
use crate::linalg::factor::{Interrupt, NoFactor};
use crate::linalg::kernels::{CHUNK_ENTRIES, SHARED_WORK, axpy, dot, row_block};
use crate::linalg::lu::Lu;
use crate::linalg::vectorized::vectorized;

/// A new row's entry must exceed the pivot by this factor before the two rows change places; above 1 so that
/// `T` stays triangular, and half as dear, where no interchange is needed.
const INTERCHANGE_RATIO: f64 = 4.0;
/// Rows turned from columns together, so that what is written stays in cache.
const STRIP_ROWS: usize = 16;

/// The factor; between two halves of a change it has one row or column more.
#[derive(Debug, Default)]
pub(super) struct Basis {
    rows: usize,
    columns: usize,
    /// Length of a stored row of `t` and `u`.
    stride: usize,
    /// Row i is `t[i * stride..][..rows]`, zero from `extent[i]` on.
    t: Vec<f64>,
    extent: Vec<usize>,
    /// Row i is `u[i * stride..][..columns]`, zero before i; what stands there is not read.
    u: Vec<f64>,
}

impl Basis {
    /// Makes room for `size` rows and columns and the one more that a change needs.
    fn reserve(&mut self, size: usize) {
        if size < self.stride {
            return;
        }
        let stride = (size + 1).max(self.stride + self.stride / 2).next_multiple_of(8);
        for matrix in [&mut self.t, &mut self.u] {
            let mut grown = vec![0.0; stride * stride];
            for i in 0..self.rows {
                let width = self.rows.max(self.columns);
                grown[i * stride..][..width].copy_from_slice(&matrix[i * self.stride..][..width]);
            }
            *matrix = grown;
        }
        self.stride = stride;
    }

    /// Factors afresh the matrix whose columns `fill` writes; partial pivoting. Where it is singular the old factor
    /// stays; after an interrupt there is none.
    pub(super) fn factor(
        &mut self,
        size: usize,
        mut fill: impl FnMut(usize, &mut [f64]),
        interrupted: Interrupt,
    ) -> Result<(), NoFactor> {
        let columns_at_once = (CHUNK_ENTRIES / size.max(1)).max(1);
        let mut k = Dense::zeros(size, size);
        for j in 0..size {
            if j > 0 && j % columns_at_once == 0 && interrupted() {
                return Err(NoFactor::Interrupted);
            }
            fill(j, k.column_mut(j));
        }
        let (lu, t) = Lu::new(k, interrupted)?.split(interrupted)?;
        (self.rows, self.columns) = (0, 0);
        self.reserve(size);
        let stride = self.stride;
        let rows_at_once = (columns_at_once / STRIP_ROWS).max(1) * STRIP_ROWS;
        for (to, from) in [(&mut self.t, &t), (&mut self.u, &lu)] {
            for (k, part) in to[..size * stride].chunks_mut(rows_at_once * stride).enumerate() {
                if k > 0 && interrupted() {
                    return Err(NoFactor::Interrupted);
                }
                let strip = |(strip, rows): (usize, &mut [f64])| {
                    rows.chunks_exact_mut(stride).for_each(|row| row[size..].fill(0.0));
                    for j in 0..size {
                        let column = &from.column(j)[k * rows_at_once + strip * STRIP_ROWS..];
                        rows.chunks_exact_mut(stride).zip(column).for_each(|(row, &entry)| row[j] = entry);
                    }
                };
                let strips = part.par_chunks_mut(STRIP_ROWS * stride).enumerate();
                strips.with_min_len(if size * size < SHARED_WORK { size } else { 1 }).for_each(strip);
            }
        }
        self.extent = vec![size; size];
        (self.rows, self.columns) = (size, size);
        Ok(())
    }

    /// `y = T a`.
    pub(super) fn transform(&self, a: &[f64], y: &mut Vec<f64>) {
        y.clear();
        y.resize(self.rows, 0.0);
        let rows_each =
            if self.rows * self.rows < SHARED_WORK { self.rows.max(1) } else { row_block(self.rows) };
        let block = |(k, y): (usize, &mut [f64])| {
            vectorized(
                #[inline(always)]
                || {
                    for (i, y) in (k * rows_each..).zip(y.iter_mut()) {
                        let extent = self.extent[i];
                        *y = dot(&self.t[i * self.stride..][..extent], &a[..extent]);
                    }
                },
            );
        };
        y.par_chunks_mut(rows_each).enumerate().for_each(block);
    }

    /// Solves `U x = y` in place.
    pub(super) fn back_substitute(&self, y: &mut [f64]) {
        debug_assert!(self.rows == self.columns && y.len() == self.rows);
        vectorized(
            #[inline(always)]
            || {
                for i in (0..self.rows).rev() {
                    let row = &self.u[i * self.stride..][..self.columns];
                    let sum = dot(&row[i + 1..], &y[i + 1..]);
                    y[i] = (y[i] - sum) / row[i];
                }
            },
        );
    }

    /// `K x = a` in place.
    pub(super) fn solve(&self, a: &mut Vec<f64>) {
        let mut y = Vec::with_capacity(a.len());
        self.transform(a, &mut y);
        self.back_substitute(&mut y);
        std::mem::swap(a, &mut y);
    }

    /// Appends the column whose transform is `y = T a`.
    pub(super) fn append_column(&mut self, y: &[f64]) {
        debug_assert_eq!(y.len(), self.rows);
        self.reserve(self.rows.max(self.columns + 1));
        for (row, &value) in self.u.chunks_exact_mut(self.stride).zip(y) {
            row[self.columns] = value;
        }
        self.columns += 1;
    }

    /// Appends a row, `b` over the columns; `b` is used up.
    pub(super) fn append_row(&mut self, b: &mut [f64]) {
        debug_assert_eq!(b.len(), self.columns);
        self.reserve((self.rows + 1).max(self.columns));
        let (stride, last) = (self.stride, self.rows);
        let (t_rows, t_last) = self.t.split_at_mut(last * stride);
        let t_last = &mut t_last[..stride];
        t_last.fill(0.0);
        t_last[last] = 1.0;
        // The unit entry stands aside (the column is new, so no other row has one there) to keep extents short.
        let mut unit = last;
        let mut extent = 0;
        let extents = &mut self.extent;
        vectorized(
            #[inline(always)]
            || {
                for j in 0..last.min(b.len()) {
                    let u_row = &mut self.u[j * stride..][..b.len()];
                    if b[j] == 0.0 {
                        continue;
                    }
                    let t_row = &mut t_rows[j * stride..][..stride];
                    if b[j].abs() > INTERCHANGE_RATIO * u_row[j].abs() {
                        u_row[j..].swap_with_slice(&mut b[j..]);
                        t_row[..=last].swap_with_slice(&mut t_last[..=last]);
                        let full = if unit == last { last + 1 } else { extent };
                        extent = extents[j];
                        extents[j] = full;
                        unit = usize::MAX;
                    }
                    let factor = b[j] / u_row[j];
                    if factor != 0.0 {
                        axpy(&mut b[j + 1..], -factor, &u_row[j + 1..]);
                        extent = extent.max(extents[j]);
                        axpy(&mut t_last[..extent], -factor, &t_row[..extent]);
                    }
                }
            },
        );
        if unit == last {
            extent = last + 1;
        }
        self.u[last * stride..][..b.len()].copy_from_slice(b);
        extents.push(extent);
        self.rows += 1;
    }

    /// Takes column `c` out; the later ones move up.
    pub(super) fn delete_column(&mut self, c: usize) {
        let (stride, columns) = (self.stride, self.columns);
        for (i, row) in self.u.chunks_exact_mut(stride).take(self.rows).enumerate() {
            row.copy_within(i.max(c + 1)..columns.max(i), i.max(c + 1) - 1);
        }
        self.columns -= 1;
        let columns = self.columns;
        vectorized(
            #[inline(always)]
            || {
                for j in c..columns.min(self.rows.saturating_sub(1)) {
                    let (upper, lower) = self.u[j * stride..].split_at_mut(stride);
                    let (upper, lower) = (&mut upper[..columns], &mut lower[..columns]);
                    let (t_upper, t_lower) = self.t[j * stride..].split_at_mut(stride);
                    let (t_upper, t_lower) = (&mut t_upper[..self.rows], &mut t_lower[..self.rows]);
                    if lower[j].abs() > upper[j].abs() {
                        upper[j..].swap_with_slice(&mut lower[j..]);
                        t_upper.swap_with_slice(t_lower);
                        self.extent.swap(j, j + 1);
                    }
                    if lower[j] != 0.0 {
                        let factor = lower[j] / upper[j];
                        axpy(&mut lower[j + 1..], -factor, &upper[j + 1..]);
                        let extent = self.extent[j].max(self.extent[j + 1]);
                        axpy(&mut t_lower[..extent], -factor, &t_upper[..extent]);
                        self.extent[j + 1] = extent;
                    }
                }
            },
        );
    }

    /// Takes row `r` out after a column has gone; the last row of K takes its place.
    ///
    /// With one row too many, the last row t of T has `t K = 0`, so adding multiples of it changes T alone:
    /// they clear column r of T. Returns the largest multiple, a measure of what that costs in accuracy.
    pub(super) fn delete_row(&mut self, r: usize) -> f64 {
        debug_assert_eq!(self.rows, self.columns + 1);
        let (stride, last) = (self.stride, self.rows - 1);
        let (t_rows, t_last) = self.t.split_at_mut(last * stride);
        let t_last = &t_last[..stride];
        let last_extent = self.extent[last];
        let pivot = t_last[r];
        let mut growth = 0.0_f64;
        vectorized(
            #[inline(always)]
            || {
                for (row, extent) in t_rows.chunks_exact_mut(stride).zip(&mut self.extent) {
                    if row[r] != 0.0 {
                        let factor = row[r] / pivot;
                        growth = if factor.abs() > growth { factor.abs() } else { growth };
                        axpy(&mut row[..last_extent], -factor, &t_last[..last_extent]);
                        *extent = (*extent).max(last_extent);
                    }
                    row[r] = row[last];
                    row[last] = 0.0;
                    *extent = (*extent).max(r + 1).min(last);
                }
            },
        );
        self.rows -= 1;
        self.extent.truncate(self.rows);
        growth
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Random;

    fn assert_solves(basis: &Basis, k: &[Vec<f64>], random: &mut Random) {
        let x: Vec<f64> = k.iter().map(|_| random.signed()).collect();
        let mut a: Vec<f64> = k.iter().map(|row| row.iter().zip(&x).map(|(k, x)| k * x).sum()).collect();
        let right = a.clone();
        basis.solve(&mut a);
        for (row, right) in k.iter().zip(right) {
            let product: f64 = row.iter().zip(&a).map(|(k, x)| k * x).sum();
            assert!((product - right).abs() < 1e-9, "{product} is not {right} at size {}", k.len());
        }
    }

    #[test]
    fn a_long_walk_of_changes_keeps_solving() {
        let mut random = Random(7);
        let mut k: Vec<Vec<f64>> = vec![vec![1.5]];
        let mut basis = Basis::default();
        basis.factor(1, |_, column| column[0] = 1.5, &|| false).unwrap();
        for step in 0..400 {
            let size = k.len();
            let choice = (random.next() * 4.0) as usize;
            let at = (random.next() * size as f64) as usize;
            let column: Vec<f64> = (0..size).map(|_| random.signed()).collect();
            let mut y = Vec::new();
            let grow = size < 4 || (choice == 0 && size < 24);
            if grow || choice == 1 {
                basis.transform(&column, &mut y);
                basis.append_column(&y);
                k.iter_mut().zip(&column).for_each(|(row, &c)| row.push(c));
            }
            if !grow && choice != 2 {
                basis.delete_column(at);
                k.iter_mut().for_each(|row| _ = row.remove(at));
            }
            if grow || choice == 2 {
                let mut row: Vec<f64> = (0..k[0].len()).map(|_| random.signed()).collect();
                k.push(row.clone());
                basis.append_row(&mut row);
            }
            if !grow && choice != 1 {
                basis.delete_row(at);
                k.swap_remove(at);
            }
            assert_solves(&basis, &k, &mut random);
            if step % 50 == 49 {
                let copy = k.clone();
                let fill = |j: usize, column: &mut [f64]| {
                    column.iter_mut().zip(&copy).for_each(|(entry, row)| *entry = row[j]);
                };
                basis.factor(k.len(), fill, &|| false).unwrap();
                assert_solves(&basis, &k, &mut random);
            }
        }
    }
}
