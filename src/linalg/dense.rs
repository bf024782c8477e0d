//! A matrix of our own by columns.

use faer::{MatMut, MatRef};

/// Entries by columns; a new one is zero, and its memory is touched only as it is filled, which for a large one
/// can then be interrupted.
#[derive(Debug, Clone)]
pub(crate) struct Dense {
    entries: Vec<f64>,
    rows: usize,
    columns: usize,
}

impl Dense {
    pub(crate) fn zeros(rows: usize, columns: usize) -> Self {
        Self { entries: vec![0.0; rows * columns], rows, columns }
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.rows..][..self.rows]
    }

    pub(crate) fn column_mut(&mut self, j: usize) -> &mut [f64] {
        &mut self.entries[j * self.rows..][..self.rows]
    }

    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        self.column(j)[i]
    }

    pub(crate) fn as_ref(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.entries, self.rows, self.columns)
    }

    pub(crate) fn as_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, self.columns)
    }
}
