//! What the caller may ask of the solution of a body.

use crate::linalg::threads::with_threads;
use crate::response::body::error::BodyError;
use crate::response::body::progress::BodyProgress;

/// Parameters of [`Body::prepare`](crate::response::body::Body::prepare).
#[derive(Clone, Copy)]
pub struct BodyOptions<'a> {
    /// Relative error of the integral over one face, 1e-9 to 1e-2.
    pub tolerance: f64,
    /// Threads (>= 1); `None` takes all that rayon has.
    pub num_threads: Option<usize>,
    /// Peak memory allowed (bytes); `None`: what the system has free, where it says so (Linux).
    pub memory_limit: Option<usize>,
    /// Whether to keep the pressure on the bone too.
    pub bone_pressure: bool,
    /// Asked now and then, from any thread; true ends the work with [`BodyError::Interrupted`].
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
    /// Told how far the work is, from any thread.
    pub progress: Option<&'a (dyn Fn(BodyProgress) + Sync)>,
}

impl Default for BodyOptions<'_> {
    fn default() -> Self {
        BodyOptions {
            tolerance: 1e-6,
            num_threads: None,
            memory_limit: None,
            bone_pressure: false,
            interrupt: None,
            progress: None,
        }
    }
}

impl BodyOptions<'_> {
    /// Works on as many threads as asked for, with options that ask for those at hand.
    pub(crate) fn with_threads<R: Send, E: From<BodyError> + Send>(
        &self,
        work: impl FnOnce(&BodyOptions) -> Result<R, E> + Send,
    ) -> Result<R, E> {
        let at_hand = BodyOptions { num_threads: None, ..*self };
        with_threads(self.num_threads, || work(&at_hand)).map_err(BodyError::from)?
    }
}
