//! Which entries of a block are still to be assembled.

use faer::Mat;

use crate::mesh::distinct::distinct;

/// Blocks that are assembled at once at the most; more are joined, as each has work of its own.
const MOST_BLOCKS: usize = 8;

/// Entries that are not known, by the numbers of their rows and columns.
pub(crate) struct Missing {
    pub rows: Vec<usize>,
    pub columns: Vec<usize>,
}

/// The columns of a block that are NaN in the same rows, for each set of such rows.
///
/// * `open`: columns that are NaN somewhere
pub(crate) fn missing(block: &Mat<f64>, open: Vec<usize>) -> Vec<Missing> {
    let mut missing: Vec<Missing> = Vec::new();
    for column in open {
        let entries = block.col_as_slice(column);
        let count = entries.iter().filter(|entry| entry.is_nan()).count();
        let is_alike = |known: &&mut Missing| {
            known.rows.len() == count && known.rows.iter().all(|&row| entries[row].is_nan())
        };
        match missing.iter_mut().find(is_alike) {
            Some(known) => known.columns.push(column),
            None => {
                let rows = (0..entries.len()).filter(|&row| entries[row].is_nan()).collect();
                missing.push(Missing { rows, columns: vec![column] });
            }
        }
    }
    if missing.len() > MOST_BLOCKS {
        let rows = distinct(missing.iter().flat_map(|one| &one.rows).copied());
        missing = vec![Missing { rows, columns: missing.into_iter().flat_map(|one| one.columns).collect() }];
    }
    missing
}
