//! How many threads work is given.

use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Threads for each processor beyond which more only cost time and memory.
const MOST_PER_PROCESSOR: usize = 4;

/// Entries of a matrix that are worth a task of their own.
const ENTRIES_PER_TASK: usize = 1 << 15;

/// Fewest columns of so many rows that are worth a task of their own.
pub(crate) fn columns_per_task(rows: usize) -> usize {
    (ENTRIES_PER_TASK / rows.max(1)).max(1)
}

/// A pool of as many threads as asked for, but at most four for each processor; results do not depend on their number.
pub(crate) fn bounded_pool(num_threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    let processors = available_parallelism().map_or(1, usize::from);
    let threads = num_threads.min(MOST_PER_PROCESSOR * processors);
    ThreadPoolBuilder::new().num_threads(threads).build()
}
