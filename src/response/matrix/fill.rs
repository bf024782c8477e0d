//! Columns of a matrix filled on several threads.

use faer::Mat;
use rayon::prelude::*;

use crate::linalg::threads::bounded_pool;
use crate::response::error::ResponseError;
use crate::response::matrix::options::AssemblyOptions;

/// Columns between two looks at `interrupt`, per thread.
const BATCH_COLUMNS: usize = 64;

/// Fewest items that are worth a task of their own.
const ITEMS_PER_TASK: usize = 8;

/// Entries cleared between two looks at `interrupt`: 64 MB.
const CLEARED_AT_ONCE: usize = 1 << 23;

/// A matrix (rows × columns) with each column filled by `fill(scratch, j, column)`, where it is zero: see [`fill_items`].
pub(crate) fn filled_columns<S>(
    [rows, columns]: [usize; 2],
    options: &AssemblyOptions,
    scratch: impl Fn() -> S + Sync + Send,
    fill: impl Fn(&mut S, usize, &mut [f64]) + Sync + Send,
) -> Result<Mat<f64>, ResponseError> {
    // It takes the system a second to find 2 GB.
    let at_once = (CLEARED_AT_ONCE / rows.max(1)).max(1);
    let mut matrix = Mat::with_capacity(rows, columns);
    loop {
        matrix.resize_with(rows, columns.min(matrix.ncols() + at_once), |_, _| 0.0);
        if matrix.ncols() == columns {
            break;
        }
        if options.interrupt.is_some_and(|stop| stop()) {
            return Err(ResponseError::Interrupted { columns: 0, nodes: columns });
        }
    }
    let mut entries: Vec<&mut [f64]> = matrix
        .col_iter_mut()
        .map(|c| c.try_as_col_major_mut().expect("columns of a Mat are contiguous").as_slice_mut())
        .collect();
    fill_items(&mut entries, options, scratch, |scratch, j, column| fill(scratch, j, column))?;
    Ok(matrix)
}

/// Fills each of some items by `fill(scratch, index, item)`.
///
/// Each is computed by one thread from the same inputs, so the result does not depend on the number of threads.
/// `interrupt` is asked on the calling thread between batches.
pub(crate) fn fill_items<T: Send, S>(
    items: &mut [T],
    options: &AssemblyOptions,
    scratch: impl Fn() -> S + Sync + Send,
    fill: impl Fn(&mut S, usize, &mut T) + Sync + Send,
) -> Result<(), ResponseError> {
    let nodes = items.len();
    if nodes == 0 {
        return Ok(());
    }
    let pool = pool(options)?;
    let threads = match (&pool, options.num_threads) {
        (Some(pool), _) => pool.current_num_threads(),
        (None, Some(one)) => one,
        (None, None) => rayon::current_num_threads(),
    };
    let batch = if options.interrupt.is_some() { BATCH_COLUMNS * threads } else { nodes };
    let mut alone = scratch();
    for (turn, chunk) in items.chunks_mut(batch).enumerate() {
        if options.interrupt.is_some_and(|stop| stop()) {
            return Err(ResponseError::Interrupted { columns: turn * batch, nodes });
        }
        let first = turn * batch;
        if threads == 1 {
            chunk.iter_mut().enumerate().for_each(|(k, item)| fill(&mut alone, first + k, item));
        } else {
            let mut work = || {
                let items = chunk.par_iter_mut().enumerate().with_min_len(ITEMS_PER_TASK);
                items.for_each_init(&scratch, |s, (k, item)| fill(s, first + k, item));
            };
            match &pool {
                Some(pool) => pool.install(work),
                None => work(),
            }
        }
    }
    Ok(())
}

/// The local pool that the options ask for; `None` for the global one, or for a single thread.
fn pool(options: &AssemblyOptions) -> Result<Option<rayon::ThreadPool>, ResponseError> {
    let Some(threads) = options.num_threads.filter(|&threads| threads > 1) else { return Ok(None) };
    Ok(Some(bounded_pool(threads)?))
}
