//! What every method reads.

use crate::lcp::problem::LcpError;
use crate::linalg::factor::Interrupt;

/// Whether M is looked at for positive definiteness, which makes a solution the only one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum DefinitenessCheck {
    /// Only where that costs no more than the solve did.
    #[default]
    Cheap,
    /// Always.
    Always,
    /// Never.
    Never,
}

impl DefinitenessCheck {
    /// Every choice.
    pub const ALL: [Self; 3] = [Self::Cheap, Self::Always, Self::Never];

    /// The name by which it is asked for.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Cheap => "cheap",
            Self::Always => "always",
            Self::Never => "never",
        }
    }
}

/// What every method reads; each has parameters of its own in [`LcpMethod`](crate::lcp::LcpMethod).
#[derive(Clone)]
pub struct LcpOptions<'a> {
    /// Pivot budget of each run, a crash and the path after it being two; `None` means `50 n`, at least 1000.
    pub max_pivots: Option<usize>,
    /// Largest natural residual of an answer that is called solved (dimensionless, > 0).
    pub tolerance: f64,
    /// Guess of the unknowns with `z > 0`, in any order; `None` starts from none.
    pub initial_active: Option<Vec<usize>>,
    /// Whether to give up where the block exchanges that a method begins with lead to no answer: for a caller who then
    /// changes the problem.
    pub exchanges_only: bool,
    /// Asked again and again by the calling thread while the solve runs; `true`, which must then stay so, ends
    /// it as interrupted.
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
    /// Whether the certificate looks for positive definiteness.
    pub definiteness: DefinitenessCheck,
}

impl Default for LcpOptions<'_> {
    fn default() -> Self {
        Self {
            max_pivots: None,
            tolerance: 1e-10,
            initial_active: None,
            exchanges_only: false,
            interrupt: None,
            definiteness: DefinitenessCheck::Cheap,
        }
    }
}

impl std::fmt::Debug for LcpOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LcpOptions")
            .field("max_pivots", &self.max_pivots)
            .field("tolerance", &self.tolerance)
            .field("initial_active", &self.initial_active)
            .field("exchanges_only", &self.exchanges_only)
            .field("interrupt", &self.interrupt.is_some())
            .field("definiteness", &self.definiteness)
            .finish()
    }
}

impl<'a> LcpOptions<'a> {
    /// Checks every option against a problem of `size` unknowns.
    pub(super) fn validate(&self, size: usize) -> Result<(), LcpError> {
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            let expected = "a finite value above 0";
            return Err(LcpError::OptionOutOfRange { name: "tolerance", value: self.tolerance, expected });
        }
        let mut seen = vec![false; size];
        for (position, &index) in self.initial_active.iter().flatten().enumerate() {
            if index >= size || std::mem::replace(&mut seen[index], true) {
                return Err(LcpError::InitialActive { position, index, size });
            }
        }
        Ok(())
    }

    pub(super) fn pivot_budget(&self, size: usize) -> usize {
        self.max_pivots.unwrap_or_else(|| size.saturating_mul(50).max(1000))
    }

    /// The interrupt; one that never says stop where there is none.
    pub(super) fn interrupt(&self) -> Interrupt<'a> {
        self.interrupt.unwrap_or(&|| false)
    }
}
