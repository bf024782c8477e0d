//! Columns of a matrix filled on several threads.

use faer::Mat;
use rayon::prelude::*;

use crate::linalg::threads::bounded_pool;
use crate::response::error::ResponseError;
use crate::response::matrix::options::AssemblyOptions;

/// Columns between two looks at `interrupt`, per thread.
const BATCH_COLUMNS: usize = 64;

/// Fills each column of `matrix` by `fill(scratch, j, column)`.
///
/// Columns are disjoint and each is computed by one thread from the same inputs, so the result does not
/// depend on the number of threads. `interrupt` is asked on the calling thread between batches.
pub(crate) fn fill_columns<S>(
    matrix: &mut Mat<f64>,
    options: &AssemblyOptions,
    scratch: impl Fn() -> S + Sync + Send,
    fill: impl Fn(&mut S, usize, &mut [f64]) + Sync + Send,
) -> Result<(), ResponseError> {
    let nodes = matrix.ncols();
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
    let mut columns: Vec<(usize, &mut [f64])> = matrix
        .col_iter_mut()
        .map(|c| c.try_as_col_major_mut().expect("columns of a Mat are contiguous").as_slice_mut())
        .enumerate()
        .collect();
    let mut alone = scratch();
    for (turn, chunk) in columns.chunks_mut(batch).enumerate() {
        if options.interrupt.is_some_and(|stop| stop()) {
            return Err(ResponseError::Interrupted { columns: turn * batch, nodes });
        }
        if threads == 1 {
            chunk.iter_mut().for_each(|(j, column)| fill(&mut alone, *j, column));
        } else {
            let mut work = || {
                let columns = chunk.par_iter_mut().with_min_len(4);
                columns.for_each_init(&scratch, |s, (j, column)| fill(s, *j, column));
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
    bounded_pool(threads)
        .map(Some)
        .map_err(|error| ResponseError::Threads { threads, reason: error.to_string() })
}
