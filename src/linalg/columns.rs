//! Columns of a dense matrix, on several threads.

use faer::Mat;
use rayon::prelude::*;

/// Entries of a matrix that are worth a task of their own.
const ENTRIES_PER_TASK: usize = 1 << 15;

/// The columns of a matrix, as many to a task as are worth one.
pub(crate) fn par_columns(matrix: &mut Mat<f64>) -> impl IndexedParallelIterator<Item = &mut [f64]> {
    let at_once = (ENTRIES_PER_TASK / matrix.nrows().max(1)).max(1);
    matrix.par_col_chunks_mut(1).with_min_len(at_once).map(|column| {
        let column = column.col_mut(0).try_as_col_major_mut();
        column.expect("columns of a Mat are contiguous").as_slice_mut()
    })
}
