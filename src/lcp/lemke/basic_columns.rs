//! Columns of M that have entered the basis.

use crate::lcp::reduced::{ReducedProblem, power_of_two};
use crate::lcp::touched_columns::TouchedColumns;

/// Columns scaled to magnitude one by powers of two, so that every tolerance of the path is dimensionless.
pub(super) struct BasicColumns<'a> {
    columns: TouchedColumns<'a>,
    scale: Vec<f64>,
}

impl<'a> BasicColumns<'a> {
    pub(super) fn new(reduced: &'a ReducedProblem<'a>) -> Self {
        Self { columns: TouchedColumns::copied(reduced), scale: vec![1.0; reduced.size()] }
    }

    /// Copies column `j` unless that has been done.
    pub(super) fn fetch(&mut self, j: usize) {
        if !self.columns.touch(&[j]) {
            return;
        }
        let column = self.columns.copy_mut(j);
        let largest = column.iter().fold(0.0, |a: f64, m| a.max(m.abs()));
        if largest > 0.0 {
            self.scale[j] = 1.0 / power_of_two(largest);
            column.iter_mut().for_each(|entry| *entry *= self.scale[j]);
        }
    }

    /// A column that was fetched.
    pub(super) fn column(&self, j: usize) -> &[f64] {
        self.columns.column(j)
    }

    /// What column `j` was multiplied by.
    pub(super) fn scale(&self, j: usize) -> f64 {
        self.scale[j]
    }
}
