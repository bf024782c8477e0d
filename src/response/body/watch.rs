//! Reports how far the solution of a body is, and asks whether it is to go on.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use crate::response::body::cost::BodyCost;
use crate::response::body::error::BodyError;
use crate::response::body::options::BodyOptions;
use crate::response::body::progress::BodyProgress;

/// Rows between two reports of the assembly.
const ROWS_PER_REPORT: usize = 64;

/// Reports progress and polls the interrupt.
pub(crate) struct Watch<'a> {
    options: &'a BodyOptions<'a>,
    cost: BodyCost,
    start: Instant,
    stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    pub fn new(options: &'a BodyOptions<'a>, cost: BodyCost) -> Self {
        Self { options, cost, start: Instant::now(), stopped: AtomicBool::new(false) }
    }

    /// Reports and returns whether to go on.
    pub fn advance(&self, stage: &'static str, done: f64) -> bool {
        if let Some(progress) = self.options.progress {
            progress(BodyProgress { stage, done, cost: self.cost });
        }
        if self.is_interrupted() {
            self.stopped.store(true, Ordering::Relaxed);
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    pub fn is_interrupted(&self) -> bool {
        self.options.interrupt.is_some_and(|interrupt| interrupt())
    }

    /// Counts the rows of a stage that are done, from any thread; returns whether to go on.
    pub fn by_rows(&self, stage: &'static str, row_count: usize) -> impl Fn() -> bool + Sync {
        let rows_done = AtomicUsize::new(0);
        move || {
            let done = 1 + rows_done.fetch_add(1, Ordering::Relaxed);
            if !done.is_multiple_of(ROWS_PER_REPORT) && done != row_count {
                return !self.stopped.load(Ordering::Relaxed);
            }
            self.advance(stage, done as f64 / row_count as f64)
        }
    }

    pub fn interrupted(&self, stage: &'static str) -> BodyError {
        BodyError::Interrupted { stage, seconds: self.start.elapsed().as_secs_f64() }
    }
}
