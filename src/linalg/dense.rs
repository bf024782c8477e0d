//! A matrix of our own by columns, and copies of parts of another into one.

use faer::prelude::ReborrowMut;
use faer::{MatMut, MatRef};
use rayon::prelude::*;

use crate::linalg::factor::Interrupt;
use crate::linalg::kernels::SHARED_WORK;

/// Rows and columns of a tile that two of fit into the nearest cache.
pub(crate) const TILE: usize = 32;

/// Entries by columns; a new one is zero, and its memory is touched only as it is filled, which for a large one
/// can then be interrupted.
#[derive(Debug, Clone)]
pub(crate) struct Dense<T = f64> {
    entries: Vec<T>,
    rows: usize,
    columns: usize,
}

impl<T: Copy> Dense<T> {
    /// Entries by columns as they lie.
    pub(crate) fn from_columns(entries: Vec<T>, rows: usize, columns: usize) -> Self {
        assert_eq!(entries.len(), rows * columns, "one entry for every row and column");
        Self { entries, rows, columns }
    }

    /// Swaps rows and columns of a square matrix in place.
    pub(crate) fn transpose(&mut self)
    where
        T: Send,
    {
        assert_eq!(self.rows, self.columns, "a square matrix");
        transpose(self.as_mut());
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn column(&self, j: usize) -> &[T] {
        &self.entries[j * self.rows..][..self.rows]
    }

    pub(crate) fn column_mut(&mut self, j: usize) -> &mut [T] {
        &mut self.entries[j * self.rows..][..self.rows]
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> T {
        self.column(j)[i]
    }

    pub(crate) fn as_ref(&self) -> MatRef<'_, T> {
        MatRef::from_column_major_slice(&self.entries, self.rows, self.columns)
    }

    pub(crate) fn as_mut(&mut self) -> MatMut<'_, T> {
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, self.columns)
    }
}

impl Dense {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        Self { entries: vec![0.0; rows * columns], rows, columns }
    }

    #[cfg(test)]
    pub(crate) fn of(m: &faer::Mat<f64>) -> Self {
        let entries = (0..m.ncols()).flat_map(|j| m.col_as_slice(j)).copied().collect();
        Self::from_columns(entries, m.nrows(), m.ncols())
    }

    /// The block of `m` on `rows` and `columns`; left unfinished when `interrupted`.
    pub(crate) fn gather(m: MatRef<f64>, rows: &[usize], columns: &[usize], interrupted: Interrupt) -> Self {
        let source = m.try_as_col_major();
        Self::build(rows.len(), columns.len(), interrupted, |j, first, entries| {
            let rows = &rows[first..first + entries.len()];
            match source {
                Some(source) => {
                    let column = source.col(columns[j]).as_slice();
                    entries.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = column[i]);
                }
                None => entries.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = m[(i, columns[j])]),
            }
        })
    }

    /// A matrix made in tiles, so that reading across the storage order does not starve; `fill` is given a column,
    /// the first row of a run in it and that run. Left unfinished when `interrupted`.
    pub(crate) fn build(
        rows: usize,
        columns: usize,
        interrupted: Interrupt,
        fill: impl Fn(usize, usize, &mut [f64]) + Sync,
    ) -> Self {
        let mut block = Self::zeros(rows, columns);
        let group = (SHARED_WORK / rows.max(1)).next_multiple_of(8 * TILE);
        for start in (0..columns).step_by(group) {
            let width = group.min(columns - start);
            let part = block.as_mut().subcols_mut(start, width);
            let strips = part.par_col_chunks_mut(TILE).enumerate();
            let strips = strips.with_min_len(if rows * width < SHARED_WORK / 2 { width } else { 1 });
            strips.for_each(|(k, mut strip)| {
                for row in (0..rows).step_by(TILE) {
                    for j in 0..strip.ncols() {
                        let column = strip.rb_mut().col_mut(j).try_as_col_major_mut();
                        let column = column.expect("an owned matrix has contiguous columns").as_slice_mut();
                        fill(start + k * TILE + j, row, &mut column[row..(row + TILE).min(rows)]);
                    }
                }
            });
            if columns > group && interrupted() {
                break;
            }
        }
        block
    }
}

/// Swaps rows and columns of a square matrix, its quarters side by side.
fn transpose<T: Copy + Send>(mut matrix: MatMut<'_, T>) {
    let n = matrix.nrows();
    if n > TILE {
        let (upper_left, upper_right, lower_left, lower_right) = matrix.split_at_mut(n / 2, n / 2);
        let on_diagonal = || rayon::join(|| transpose(upper_left), || transpose(lower_right));
        rayon::join(on_diagonal, || swap_transposed(upper_right, lower_left));
        return;
    }
    for (i, j) in (0..n).flat_map(|j| (0..j).map(move |i| (i, j))) {
        (matrix[(i, j)], matrix[(j, i)]) = (matrix[(j, i)], matrix[(i, j)]);
    }
}

/// Puts each of two matrices in the place of the other, rows as columns.
fn swap_transposed<T: Copy + Send>(mut one: MatMut<'_, T>, mut other: MatMut<'_, T>) {
    let (rows, columns) = (one.nrows(), one.ncols());
    if rows.max(columns) > TILE && rows >= columns {
        let (upper, lower) = one.split_at_row_mut(rows / 2);
        let (left, right) = other.split_at_col_mut(rows / 2);
        rayon::join(|| swap_transposed(upper, left), || swap_transposed(lower, right));
    } else if columns > TILE {
        swap_transposed(other, one);
    } else {
        for (i, j) in (0..columns).flat_map(|j| (0..rows).map(move |i| (i, j))) {
            std::mem::swap(&mut one[(i, j)], &mut other[(j, i)]);
        }
    }
}
