//! Long work outside the interpreter that Ctrl-C still ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Mutex, TryLockError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::prelude::*;

use crate::linalg::factor::Interrupt;
use crate::python::forked::own_pool;

/// How often signals are looked at.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Held by work within rayon's own pool, of which there is one at a time: a thread that waits for a task takes up what else
/// the pool is given, and other work may ask for what is locked below it.
static SEAT: Mutex<()> = Mutex::new(());

/// Runs `work` with the interpreter released: within rayon's pool, where no task need change threads to be shared, or on a
/// thread of its own where it asks for a number of threads.
pub(super) fn detached_with<T: Send>(
    py: Python<'_>,
    num_threads: Option<usize>,
    work: impl FnOnce(Interrupt) -> T + Send,
) -> PyResult<T> {
    if num_threads.is_some() || own_pool().is_some() {
        return detached_on_thread(py, work);
    }
    let seat = SEAT.try_lock();
    let is_taken = matches!(seat, Err(TryLockError::WouldBlock)) || rayon::current_thread_index().is_some();
    if is_taken || rayon::current_num_threads() == 1 { detached(py, work) } else { in_pool(py, work) }
}

/// Runs `work` with the interpreter released. `work` gets a function that answers whether to stop; a pending
/// signal (KeyboardInterrupt) makes it answer yes, and is raised once `work` has returned.
pub(super) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce(Interrupt) -> T + Send) -> PyResult<T> {
    if own_pool().is_some() {
        return detached_on_thread(py, work);
    }
    let signal: Mutex<Option<PyErr>> = Mutex::new(None);
    let last_look = Mutex::new(Instant::now());
    let result = py.detach(|| {
        work(&|| {
            let mut last_look = last_look.lock().expect("no panic while the lock is held");
            if last_look.elapsed() >= POLL_INTERVAL {
                *last_look = Instant::now();
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    *signal.lock().expect("no panic while the lock is held") = Some(error);
                }
            }
            signal.lock().expect("no panic while the lock is held").is_some()
        })
    });
    match signal.into_inner().expect("no panic while the lock is held") {
        Some(error) => Err(error),
        None => Ok(result),
    }
}

/// As [`detached`], for work that moves to other threads, where signals cannot be seen: the calling thread waits
/// and looks.
pub(super) fn detached_on_thread<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(Interrupt) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let (result, signal) = py.detach(|| {
        thread::scope(|scope| {
            let (running, ended) = mpsc::channel();
            let worker = scope.spawn(|| {
                let _running = running;
                let work = || work(&|| stop.load(Ordering::Relaxed));
                match own_pool() {
                    None => work(),
                    Some(pool) => pool.install(work),
                }
            });
            let signal = look_until(&ended, &stop);
            (worker.join(), signal)
        })
    });
    match (result, signal) {
        (_, Some(error)) => Err(error),
        (Ok(result), None) => Ok(result),
        (Err(panic), None) => std::panic::resume_unwind(panic),
    }
}

/// As [`detached_on_thread`], on one of rayon's own.
fn in_pool<T: Send>(py: Python<'_>, work: impl FnOnce(Interrupt) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    let mut result = None;
    let signal = py.detach(|| {
        let (running, ended) = mpsc::channel();
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| {
                let _running = running;
                result = Some(work(&|| stop.load(Ordering::Relaxed)));
            });
            look_until(&ended, &stop)
        })
    });
    match signal {
        Some(error) => Err(error),
        None => Ok(result.expect("the scope waits for the work")),
    }
}

/// Looks for signals until the other end of `ended` is dropped, as work that returns or panics does; after the first,
/// which is returned, `stop` is set.
fn look_until(ended: &Receiver<()>, stop: &AtomicBool) -> Option<PyErr> {
    let mut signal = None;
    while ended.recv_timeout(POLL_INTERVAL) == Err(RecvTimeoutError::Timeout) {
        if signal.is_none()
            && let Err(error) = Python::attach(|py| py.check_signals())
        {
            signal = Some(error);
            stop.store(true, Ordering::Relaxed);
        }
    }
    signal
}
