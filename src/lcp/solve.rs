//! One entry for every method: look at what must be looked at, run, check against the problem as given.

use crate::lcp::lemke::run::LemkeOptions;
use crate::lcp::options::{DefinitenessCheck, LcpOptions};
use crate::lcp::problem::{Halt, LcpError, LcpProblem};
use crate::lcp::session::{Answer, Session};
use crate::lcp::solution::{LcpMethodName, LcpSolution, LcpStatus};

/// Rows up to which all of M is read first: that costs next to nothing and leaves the fewest unknowns.
const FEW_ROWS: usize = 64;

/// How a problem is solved.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LcpMethod {
    /// Lemke's complementary pivoting; any M.
    Lemke(LemkeOptions),
    /// Block principal pivoting; M with positive principal minors (a P-matrix). Lemke's method follows where exchanges find
    /// no answer; its [`crash`](LemkeOptions::crash) is not read.
    BlockPivoting(LemkeOptions),
    /// Projected conjugate gradients; M symmetric (within 1e-10 of its largest entry) and positive definite.
    ProjectedCg,
    /// Whatever suits the problem, with options as of block pivoting; [`LcpSolution::attempts`] says what ran.
    Auto(LemkeOptions),
}

impl Default for LcpMethod {
    fn default() -> Self {
        LcpMethodName::Auto.into()
    }
}

/// The method of that name with its default options.
impl From<LcpMethodName> for LcpMethod {
    fn from(name: LcpMethodName) -> Self {
        Self::named(name, LemkeOptions::default())
    }
}

impl LcpMethod {
    /// The method of that name with the options, if it reads any.
    pub(crate) fn named(name: LcpMethodName, options: LemkeOptions) -> Self {
        match name {
            LcpMethodName::Lemke => Self::Lemke(options),
            LcpMethodName::BlockPivoting => Self::BlockPivoting(options),
            LcpMethodName::ProjectedCg => Self::ProjectedCg,
            LcpMethodName::Auto => Self::Auto(options),
        }
    }

    /// The method without its options.
    pub fn name(&self) -> LcpMethodName {
        match self {
            Self::Lemke(_) => LcpMethodName::Lemke,
            Self::BlockPivoting(_) => LcpMethodName::BlockPivoting,
            Self::ProjectedCg => LcpMethodName::ProjectedCg,
            Self::Auto(_) => LcpMethodName::Auto,
        }
    }

    /// The name by which the method is asked for.
    pub fn as_str(&self) -> &'static str {
        self.name().as_str()
    }

    fn validate(&self, size: usize) -> Result<(), LcpError> {
        match self {
            Self::Lemke(lemke) | Self::BlockPivoting(lemke) | Self::Auto(lemke) => lemke.validate(size),
            Self::ProjectedCg => Ok(()),
        }
    }
}

/// Solves `w = M z + q`, `w >= 0`, `z >= 0`, `w·z = 0`.
///
/// An answer is called [`LcpStatus::Solved`] only if its natural residual, measured with the M and q given, is
/// at most [`LcpOptions::tolerance`].
///
/// [`LcpMethod::Lemke`] begins from a crash basis where [`LemkeOptions::crash`] allows.
///
/// [`LcpMethod::Auto`] begins with block pivoting, which for a handful of unknowns of unknown kind would gain
/// nothing and is left out; Lemke's method follows, from nothing. Unless that has proved that there is no
/// solution, block pivoting is tried again to its end, and conjugate gradients where M is symmetric and not known
/// to be indefinite.
///
/// # Errors
/// An option that is out of range or does not fit the problem, [`LcpError::NonFiniteMatrix`] where an entry that
/// is read is not finite, and [`LcpError::NotSymmetric`] from [`LcpMethod::ProjectedCg`]; no ending is an error.
pub fn solve(
    problem: &LcpProblem,
    method: &LcpMethod,
    options: &LcpOptions,
) -> Result<LcpSolution, LcpError> {
    method.validate(problem.size())?;
    options.validate(problem.size())?;
    let mut session = Session { problem, options, attempts: Vec::new(), candidates: 0 };
    match run(&mut session, method) {
        Ok(solution) => Ok(solution),
        Err(Halt::Rejected(error)) => Err(error),
        Err(Halt::Interrupted) => {
            Ok(session.with_attempts(session.at_zero(method.name(), LcpStatus::Interrupted)))
        }
    }
}

fn run(session: &mut Session, method: &LcpMethod) -> Result<LcpSolution, Halt> {
    let (problem, interrupt) = (session.problem, session.options.interrupt());
    if problem.size() <= FEW_ROWS {
        problem.rows(interrupt)?;
    }
    if problem.deficit() == 0.0 {
        let mut solution = session.at_zero(method.name(), LcpStatus::Solved);
        if session.options.definiteness == DefinitenessCheck::Always && !problem.is_known() {
            solution.certificate.definiteness = session.definiteness(0.0)?;
        }
        return Ok(solution);
    }
    // Where a diagonal is not positive, its row's largest magnitude stands in for it.
    if !problem.has_positive_diagonal() {
        problem.rows(interrupt)?;
    }
    let Answer { mut solution, work } = match method {
        LcpMethod::Lemke(options) => session.lemke(options)?,
        LcpMethod::BlockPivoting(options) => session.block_pivoting_or_lemke(options)?,
        LcpMethod::ProjectedCg => session.projected_cg()?,
        LcpMethod::Auto(options) => session.auto(options)?,
    };
    if solution.status == LcpStatus::Interrupted {
        return Ok(solution);
    }
    if solution.status != LcpStatus::Solved {
        problem.rows(interrupt)?;
    }
    if !problem.is_known() {
        solution.certificate.definiteness = session.definiteness(work)?;
    }
    Ok(solution)
}
