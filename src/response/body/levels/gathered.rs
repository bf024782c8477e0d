//! Blocks of a large compliance between the few vertices that a contact asks of, close together in memory.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use faer::Mat;
use nalgebra::Matrix3;

use crate::mesh::distinct::distinct;
use crate::response::error::ResponseError;

/// Blocks of more rows or columns than so many times those asked for are let go, and of more rows than so many times the
/// columns not kept.
pub(super) const MOST_TIMES_ASKED: usize = 2;
/// No place.
const NO_PLACE: usize = usize::MAX;

/// Blocks between the vertices that were asked for; clones share them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Gathered(Arc<Mutex<Option<Arc<Blocks>>>>);

/// Blocks between some vertices.
#[derive(Debug)]
pub(crate) struct Blocks {
    pub rows: Places,
    pub columns: Places,
    /// Displacement at each row per newton at each column (3 m × 3 k, m/N).
    pub entries: Mat<f64>,
}

/// Some vertices and where they stand.
#[derive(Debug)]
pub(crate) struct Places {
    /// Ascending.
    pub vertices: Vec<usize>,
    /// Place of each vertex of the mesh among them.
    places: Vec<usize>,
}

impl Blocks {
    /// By the places of its row and column (m/N).
    pub fn block(&self, row: usize, column: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|a, b| self.entries[(3 * row + a, 3 * column + b)])
    }
}

impl Places {
    fn new(vertices: Vec<usize>) -> Self {
        let mut places = vec![NO_PLACE; vertices.last().map_or(0, |last| last + 1)];
        vertices.iter().enumerate().for_each(|(place, &vertex)| places[vertex] = place);
        Self { vertices, places }
    }

    /// Place of one of the vertices.
    pub fn of(&self, vertex: usize) -> usize {
        self.places[vertex]
    }

    fn hold(&self, vertices: &[usize]) -> bool {
        vertices.iter().all(|&vertex| self.places.get(vertex).is_some_and(|&place| place != NO_PLACE))
    }

    /// These and others, or the others alone where these are far more.
    fn with(&self, others: &[usize]) -> Self {
        let all = distinct([&self.vertices, others].concat());
        Self::new(if all.len() > MOST_TIMES_ASKED * others.len() { others.to_vec() } else { all })
    }
}

impl Gathered {
    /// Blocks between `rows` and `columns` at least, both ascending.
    ///
    /// * `gather`: the blocks between given rows and columns
    pub fn between(
        &self,
        rows: &[usize],
        columns: &[usize],
        gather: impl Fn(&[usize], &[usize]) -> Result<Mat<f64>, ResponseError>,
    ) -> Result<Arc<Blocks>, ResponseError> {
        // No lock is held while blocks are gathered, which may take other work of the same threads in between.
        let known = self.lock().clone();
        let [known_rows, known_columns] = match known {
            Some(known) if known.rows.hold(rows) && known.columns.hold(columns) => return Ok(known),
            Some(known) => [known.rows.with(rows), known.columns.with(columns)],
            None => [rows, columns].map(|vertices| Places::new(vertices.to_vec())),
        };
        let entries = gather(&known_rows.vertices, &known_columns.vertices)?;
        let blocks = Arc::new(Blocks { rows: known_rows, columns: known_columns, entries });
        *self.lock() = Some(Arc::clone(&blocks));
        Ok(blocks)
    }

    fn lock(&self) -> MutexGuard<'_, Option<Arc<Blocks>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(rows: &[usize], columns: &[usize]) -> Result<Mat<f64>, ResponseError> {
        let entry = |row: usize, column: usize| (100 * rows[row / 3] + columns[column / 3]) as f64;
        Ok(Mat::from_fn(3 * rows.len(), 3 * columns.len(), entry))
    }

    #[test]
    fn blocks_are_gathered_once_and_let_go_where_far_fewer_are_asked_for() {
        let gathered = Gathered::default();
        let first = gathered.between(&[2, 5, 7], &[5, 7], numbered).expect("blocks");
        let same = gathered.between(&[5], &[7], |_, _| unreachable!("they are known")).expect("blocks");
        assert!(Arc::ptr_eq(&first, &same));
        let more = gathered.between(&[3, 5], &[5, 9], numbered).expect("blocks");
        assert_eq!((&more.rows.vertices, &more.columns.vertices), (&vec![2, 3, 5, 7], &vec![5, 7, 9]));
        assert_eq!(more.block(more.rows.of(3), more.columns.of(9))[(0, 0)], 309.0);
        let fewer = gathered.between(&[8], &[5], numbered).expect("blocks");
        assert_eq!((&fewer.rows.vertices, &fewer.columns.vertices), (&vec![8], &vec![5]));
    }
}
