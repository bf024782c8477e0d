//! How many threads work is given.

use std::thread::available_parallelism;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Threads for each processor beyond which more only cost time and memory.
const MOST_PER_PROCESSOR: usize = 4;

/// The worker threads could not be started.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("could not start {threads} threads: {reason}")]
pub struct ThreadsError {
    /// Threads asked for.
    pub threads: usize,
    /// What the system said.
    pub reason: String,
}

/// A pool of as many threads as asked for, but at most four for each processor; results do not depend on their number.
pub(crate) fn bounded_pool(threads: usize) -> Result<ThreadPool, ThreadsError> {
    if threads == 0 {
        return Err(ThreadsError { threads, reason: "at least 1 is needed".into() });
    }
    let processors = available_parallelism().map_or(1, usize::from);
    let most = MOST_PER_PROCESSOR * processors;
    let pool = ThreadPoolBuilder::new().num_threads(threads.min(most)).build();
    pool.map_err(|error| ThreadsError { threads, reason: error.to_string() })
}

/// Does `work` on as many threads as asked for; `None` for those at hand.
pub(crate) fn with_threads<R: Send>(
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> Result<R, ThreadsError> {
    match threads {
        None => Ok(work()),
        Some(threads) => Ok(bounded_pool(threads)?.install(work)),
    }
}
