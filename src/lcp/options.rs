//! What to run and how far.

use crate::lcp::problem::{LcpError, check_vector};

/// How a problem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum LcpMethod {
    /// Lemke's complementary pivoting; any M.
    Lemke,
    /// Block principal pivoting; M with positive principal minors (a P-matrix).
    BlockPivoting,
    /// Projected conjugate gradients; M symmetric (within 1e-10 of its largest entry) and positive definite.
    ProjectedCg,
    /// Whatever suits the problem; [`LcpSolution::attempts`](crate::lcp::LcpSolution::attempts) says what ran.
    #[default]
    Auto,
}

impl LcpMethod {
    /// Every method.
    pub const ALL: [Self; 4] = [Self::Lemke, Self::BlockPivoting, Self::ProjectedCg, Self::Auto];

    /// The name by which the method is asked for.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Lemke => "lemke",
            Self::BlockPivoting => "block_pivoting",
            Self::ProjectedCg => "projected_cg",
            Self::Auto => "auto",
        }
    }
}

impl std::fmt::Display for LcpMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

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

/// Parameters of [`solve`](crate::lcp::solve::solve()).
#[derive(Clone)]
pub struct LcpOptions<'a> {
    /// Pivot budget of each run, a crash and the path after it being two; `None` means `50 n`, at least 1000.
    pub max_pivots: Option<usize>,
    /// Rates of change below `pivot_tol` times the largest never pivot (dimensionless, in (0, 1e-3]).
    pub pivot_tol: f64,
    /// Largest natural residual of an answer that is called solved (dimensionless, > 0).
    pub tolerance: f64,
    /// Guess of the unknowns with `z > 0`, in any order; `None` starts from none.
    pub initial_active: Option<Vec<usize>>,
    /// Lemke's covering vector (n, > 0); `None` means all ones.
    pub covering: Option<Vec<f64>>,
    /// Asked again and again by the calling thread while the solve runs; `true`, which must then stay so, ends
    /// it as interrupted.
    pub interrupt: Option<&'a (dyn Fn() -> bool + Sync)>,
    /// Whether the certificate looks for positive definiteness.
    pub definiteness: DefinitenessCheck,
    /// Whether Lemke's method may begin from a crash basis (Dirkse, Ferris): block exchanges guess the active
    /// set as long as nothing shows that M is no P-matrix; where they stall, the path begins from nothing. Only
    /// without a guess or covering vector of the caller's, and for more than 16 unknowns that may touch.
    pub crash: bool,
}

impl Default for LcpOptions<'_> {
    fn default() -> Self {
        Self {
            max_pivots: None,
            pivot_tol: 1e-11,
            tolerance: 1e-10,
            initial_active: None,
            covering: None,
            interrupt: None,
            definiteness: DefinitenessCheck::Cheap,
            crash: true,
        }
    }
}

impl std::fmt::Debug for LcpOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LcpOptions")
            .field("max_pivots", &self.max_pivots)
            .field("pivot_tol", &self.pivot_tol)
            .field("tolerance", &self.tolerance)
            .field("initial_active", &self.initial_active)
            .field("covering", &self.covering)
            .field("interrupt", &self.interrupt.map(|_| "Fn() -> bool"))
            .field("definiteness", &self.definiteness)
            .field("crash", &self.crash)
            .finish()
    }
}

impl LcpOptions<'_> {
    /// Checks every option against a problem of `size` unknowns.
    pub(super) fn validate(&self, size: usize) -> Result<(), LcpError> {
        if !(self.pivot_tol > 0.0 && self.pivot_tol <= 1e-3) {
            let expected = "a value in (0, 1e-3]";
            return Err(LcpError::OptionOutOfRange { name: "pivot_tol", value: self.pivot_tol, expected });
        }
        if !(self.tolerance > 0.0 && self.tolerance.is_finite()) {
            let expected = "a finite value above 0";
            return Err(LcpError::OptionOutOfRange { name: "tolerance", value: self.tolerance, expected });
        }
        if let Some(covering) = &self.covering {
            check_vector("covering", covering, size)?;
            if let Some(index) = covering.iter().position(|&value| value <= 0.0) {
                return Err(LcpError::CoveringNotPositive { index, value: covering[index] });
            }
        }
        if let Some(active) = &self.initial_active {
            let mut seen = vec![false; size];
            for (position, &index) in active.iter().enumerate() {
                if index >= size || std::mem::replace(&mut seen[index], true) {
                    return Err(LcpError::InitialActive { position, index, size });
                }
            }
        }
        Ok(())
    }

    pub(super) fn pivot_budget(&self, size: usize) -> usize {
        self.max_pivots.unwrap_or_else(|| size.saturating_mul(50).max(1000))
    }

    pub(super) fn is_interrupted(&self) -> bool {
        self.interrupt.is_some_and(|interrupt| interrupt())
    }
}
