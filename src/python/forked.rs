//! Threads after a fork: a child has those of its parent no more, and what waits for them waits for ever.

use std::process;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// The process that loaded the module, to which rayon's own pool belongs.
static LOADED_BY: OnceLock<u32> = OnceLock::new();

/// The pool of a process that was forked later, and that process. The first process never locks it, so that no fork of
/// it copies a lock that is held.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// Notes which process this is; called as the module is loaded.
pub(super) fn note_process() {
    LOADED_BY.get_or_init(process::id);
}

/// The pool of this process where it was forked since the module was loaded; `None` where rayon's own will do.
pub(super) fn own_pool() -> Option<Arc<ThreadPool>> {
    let this = process::id();
    if LOADED_BY.get().is_none_or(|loaded_by| *loaded_by == this) {
        return None;
    }
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((made_by, pool)) = &*kept
        && *made_by == this
    {
        return Some(pool.clone());
    }
    // Its threads are its parent's; to drop it would wait for them.
    std::mem::forget(kept.take());
    let built = ThreadPoolBuilder::new().build().or_else(|_| ThreadPoolBuilder::new().num_threads(1).build());
    let pool = Arc::new(built.expect("a process can start one thread"));
    *kept = Some((this, pool.clone()));
    Some(pool)
}

/// Runs `work` with the interpreter released, on threads that this process has.
pub(super) fn released<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| match own_pool() {
        None => work(),
        Some(pool) => pool.install(work),
    })
}
