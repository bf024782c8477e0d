//! Columns of M that a method has touched, ready for blocks and products.

use faer::{ContiguousFwd, MatRef};

use crate::lcp::product::{add_row_products, add_terms};
use crate::lcp::reduced::ReducedProblem;
use crate::linalg::dense::Dense;

/// A matrix whose columns lie in one piece each.
type ByColumns<'a> = MatRef<'a, f64, usize, usize, ContiguousFwd>;

/// What stands for a copy where a column has not been touched.
const NO_COPY: usize = usize::MAX;

/// Columns of M on the rows kept, copied side by side, each once; or M itself where all rows are kept. Copies,
/// blocks and products are left unfinished when interrupted.
pub(super) struct TouchedColumns<'a> {
    pub(super) reduced: &'a ReducedProblem<'a>,
    in_place: Option<AsStored<'a>>,
    copies: Vec<Dense>,
    /// Copy that holds each column, and its number there.
    place: Vec<(usize, usize)>,
}

/// M where it lies.
#[derive(Clone, Copy)]
enum AsStored<'a> {
    Columns(ByColumns<'a>),
    /// M stored by rows, turned.
    Rows(ByColumns<'a>),
}

impl<'a> TouchedColumns<'a> {
    /// In place where that can be.
    pub(super) fn new(reduced: &'a ReducedProblem<'a>) -> Self {
        let m = reduced.whole();
        let by_rows = || m?.transpose().try_as_col_major().map(AsStored::Rows);
        let in_place = m.and_then(|m| m.try_as_col_major()).map(AsStored::Columns).or_else(by_rows);
        Self { in_place, ..Self::copied(reduced) }
    }

    /// Of an M that is symmetric, so that its rows are its columns; all are touched.
    pub(super) fn symmetric(reduced: &'a ReducedProblem<'a>) -> Self {
        let mut all = Self::new(reduced);
        if let Some(AsStored::Rows(m)) = all.in_place {
            all.in_place = Some(AsStored::Columns(m));
        }
        all.touch(&(0..reduced.size()).collect::<Vec<_>>());
        all
    }

    /// Copies in any case.
    pub(super) fn copied(reduced: &'a ReducedProblem<'a>) -> Self {
        Self { reduced, in_place: None, copies: Vec::new(), place: vec![(NO_COPY, 0); reduced.size()] }
    }

    /// Copies those of `set` that are not there; returns whether there are such.
    pub(super) fn touch(&mut self, set: &[usize]) -> bool {
        let mut new = Vec::new();
        for &j in set {
            if self.in_place.is_none() && self.place[j].0 == NO_COPY {
                self.place[j] = (self.copies.len(), new.len());
                new.push(self.reduced.index(j));
            }
        }
        if !new.is_empty() {
            self.copies.push(self.reduced.gather(&new));
        }
        !new.is_empty()
    }

    /// A column that was touched, of a symmetric M or of copies.
    pub(super) fn column(&self, j: usize) -> &[f64] {
        let (copy, k) = self.place[j];
        match self.in_place {
            Some(AsStored::Columns(m)) => m.col(j).as_slice(),
            Some(AsStored::Rows(_)) => unreachable!("only blocks and products are made of rows"),
            None => self.copies[copy].column(k),
        }
    }

    /// The copy of a column that was touched.
    pub(super) fn copy_mut(&mut self, j: usize) -> &mut [f64] {
        let (copy, k) = self.place[j];
        self.copies[copy].column_mut(k)
    }

    /// The block of M on `set`, all touched, or its transpose where `symmetric`.
    pub(super) fn principal(&self, set: &[usize], symmetric: bool) -> Dense {
        if let Some(AsStored::Rows(m)) = self.in_place {
            let m = if symmetric { m.as_dyn_stride() } else { m.as_dyn_stride().transpose() };
            return Dense::gather(m, set, set, self.reduced.interrupted);
        }
        self.block(set, set)
    }

    /// The block of M on `rows` and `columns`, these touched.
    pub(super) fn block(&self, rows: &[usize], columns: &[usize]) -> Dense {
        let interrupted = self.reduced.interrupted;
        if let Some(AsStored::Rows(m)) = self.in_place {
            return Dense::gather(m.as_dyn_stride().transpose(), rows, columns, interrupted);
        }
        Dense::build(rows.len(), columns.len(), interrupted, |j, first, entries| {
            let column = self.column(columns[j]);
            entries.iter_mut().zip(&rows[first..]).for_each(|(entry, &i)| *entry = column[i]);
        })
    }

    /// `w += M z` for a z that is zero outside `set`, all touched.
    pub(super) fn add_product(&self, set: &[usize], z: &[f64], w: &mut [f64]) {
        let interrupted = self.reduced.interrupted;
        match self.in_place {
            Some(AsStored::Rows(m)) => add_row_products(w, |i| m.col(i).as_slice(), z, interrupted),
            _ => add_terms(w, set.len(), |k| (self.column(set[k]), z[set[k]]), interrupted),
        }
    }
}
