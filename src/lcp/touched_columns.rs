//! Columns of M that a method has touched, ready for blocks and products.

use faer::{ContiguousFwd, MatRef};

use crate::lcp::product::add_terms;
use crate::lcp::reduced::ReducedProblem;
use crate::linalg::dense::Dense;

/// What stands for a copy where a column has not been touched.
const NOWHERE: usize = usize::MAX;

/// Columns of M on the rows kept, copied side by side, each once; or M itself where all rows are kept. Copies,
/// blocks and products are left unfinished when interrupted.
pub(super) struct TouchedColumns<'a> {
    pub(super) reduced: &'a ReducedProblem<'a>,
    /// M where it lies, its columns in one piece each.
    in_place: Option<MatRef<'a, f64, usize, usize, ContiguousFwd>>,
    copies: Vec<Dense>,
    /// Copy that holds each column, and its number there.
    place: Vec<(usize, usize)>,
}

impl<'a> TouchedColumns<'a> {
    /// In place where that can be.
    pub(super) fn new(reduced: &'a ReducedProblem<'a>) -> Self {
        let in_place = reduced.whole().and_then(|m| m.try_as_col_major());
        Self { in_place, ..Self::copied(reduced) }
    }

    /// Of an M that is symmetric, so that its rows are its columns; all are touched.
    pub(super) fn symmetric(reduced: &'a ReducedProblem<'a>) -> Self {
        let mut all = Self::new(reduced);
        let by_rows = || reduced.whole()?.transpose().try_as_col_major();
        all.in_place = all.in_place.or_else(by_rows);
        all.touch(&(0..reduced.size()).collect::<Vec<_>>());
        all
    }

    /// Copies in any case.
    pub(super) fn copied(reduced: &'a ReducedProblem<'a>) -> Self {
        Self { reduced, in_place: None, copies: Vec::new(), place: vec![(NOWHERE, 0); reduced.size()] }
    }

    /// Copies those of `set` that are not there; returns whether there are such.
    pub(super) fn touch(&mut self, set: &[usize]) -> bool {
        let mut new = Vec::new();
        for &j in set {
            if self.in_place.is_none() && self.place[j].0 == NOWHERE {
                self.place[j] = (self.copies.len(), new.len());
                new.push(self.reduced.index(j));
            }
        }
        if !new.is_empty() {
            self.copies.push(self.reduced.gather(&new));
        }
        !new.is_empty()
    }

    /// A column that was touched.
    pub(super) fn column(&self, j: usize) -> &[f64] {
        let (copy, k) = self.place[j];
        match self.in_place {
            Some(m) => m.col(j).as_slice(),
            None => self.copies[copy].column(k),
        }
    }

    /// The copy of a column that was touched.
    pub(super) fn copy_mut(&mut self, j: usize) -> &mut [f64] {
        let (copy, k) = self.place[j];
        self.copies[copy].column_mut(k)
    }

    /// The block of M on `set`, all touched.
    pub(super) fn principal(&self, set: &[usize]) -> Dense {
        Dense::build(set.len(), set.len(), self.reduced.interrupted, |j, first, entries| {
            let column = self.column(set[j]);
            entries.iter_mut().zip(&set[first..]).for_each(|(entry, &i)| *entry = column[i]);
        })
    }

    /// `w += M z` for a z that is zero outside `set`, all touched.
    pub(super) fn add_product(&self, set: &[usize], z: &[f64], w: &mut [f64]) {
        add_terms(w, set.len(), |k| (self.column(set[k]), z[set[k]]), self.reduced.interrupted);
    }
}
