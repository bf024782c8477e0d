//! Options of a local assembly.

use super::super::error::ResponseError;
use super::super::options::AssemblyOptions;

/// Parameters of [`assemble_local`](super::assemble_local).
#[derive(Clone, Copy)]
pub struct LocalOptions<'a> {
    /// Largest error of a product: `|R' f - R f| <= threshold |R| |f|` in Euclidean norms, R' the stored and R the
    /// exact matrix (dimensionless, 1e-10 ..= 0.1).
    pub threshold: f64,
    /// Largest relative error of an entry of nodes near each other, as in [`AssemblyOptions`], and of one that a cutoff
    /// cuts, relative to K over the cutoff; `None` means a tenth of the threshold for the former and half of it, which is
    /// the most in any case, for the latter.
    pub tolerance: Option<f64>,
    /// Threads (>= 1); `None` means rayon's global pool. The result is equal to the bit for any number.
    pub num_threads: Option<usize>,
    /// Largest size of the stored matrix (bytes); `None` means no limit.
    pub memory_limit: Option<usize>,
    /// Asked now and then on the calling thread; `true` ends the assembly with
    /// [`ResponseError::Interrupted`].
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl Default for LocalOptions<'_> {
    fn default() -> Self {
        Self { threshold: 1e-3, tolerance: None, num_threads: None, memory_limit: None, interrupt: None }
    }
}

impl std::fmt::Debug for LocalOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LocalOptions")
            .field("threshold", &self.threshold)
            .field("tolerance", &self.tolerance)
            .field("num_threads", &self.num_threads)
            .field("memory_limit", &self.memory_limit)
            .field("interrupt", &self.interrupt.is_some())
            .finish()
    }
}

impl<'a> LocalOptions<'a> {
    /// The options of the entries, checked with the rest later.
    pub(super) fn of_entries(&self) -> Result<AssemblyOptions<'a>, ResponseError> {
        if !(1e-10..=0.1).contains(&self.threshold) {
            let (name, value, expected) = ("threshold", self.threshold, "from 1e-10 to 0.1");
            return Err(ResponseError::Constant { name, value, expected });
        }
        Ok(AssemblyOptions {
            tolerance: self.tolerance.unwrap_or(0.1 * self.threshold),
            num_threads: self.num_threads,
            memory_limit: self.memory_limit,
            interrupt: self.interrupt,
        })
    }
}
