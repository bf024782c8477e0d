//! One entry for every method: look at what must be looked at, run, check against the problem as given.

use crate::lcp::certificate::Certificate;
use crate::lcp::options::{DefinitenessCheck, LcpMethod, LcpOptions};
use crate::lcp::outcome::Outcome;
use crate::lcp::problem::{LcpError, LcpProblem};
use crate::lcp::reduced::{Reduced, rows_that_matter};
use crate::lcp::solution::{LcpAttempt, LcpSolution, LcpStatus};
use crate::linalg::definiteness::{Definiteness, definiteness};

/// Rows up to which all of M is read first: that costs next to nothing and leaves the fewest unknowns.
const FEW_ROWS: usize = 64;

/// Solves `w = M z + q`, `w >= 0`, `z >= 0`, `w·z = 0`.
///
/// An answer is called [`LcpStatus::Solved`] only if its natural residual, measured with the M and q given, is
/// at most [`LcpOptions::tolerance`].
///
/// [`LcpMethod::Lemke`] begins from a crash basis where [`LcpOptions::crash`] allows.
///
/// [`LcpMethod::Auto`] begins with block pivoting, which for a handful of unknowns of unknown kind would gain
/// nothing and is left out; Lemke's method follows, from nothing. Unless that has proved that there is no
/// solution, block pivoting is tried again to its end, and conjugate gradients where M is symmetric and not known
/// to be indefinite.
///
/// # Errors
/// An option that is out of range or does not fit the problem, [`LcpError::NonFiniteMatrix`] where an entry that
/// is read is not finite, and [`LcpError::NotSymmetric`] from [`LcpMethod::ProjectedCg`]; no ending is an error.
pub fn solve(problem: &LcpProblem, method: LcpMethod, options: &LcpOptions) -> Result<LcpSolution, LcpError> {
    options.validate(problem.size())?;
    let n = problem.size();
    let mut run = Run { problem, options, attempts: Vec::new(), candidates: 0, has_positive_diagonal: false };
    if n <= FEW_ROWS && problem.rows(&|| options.is_interrupted())?.is_none() {
        return Ok(run.stopped(method));
    }
    if problem.deficit() == 0.0 {
        let zero = Outcome::zero(LcpStatus::Solved, 0);
        let mut solution = run.conclude(method, &zero, vec![0.0; n]);
        if options.definiteness == DefinitenessCheck::Always && !problem.is_known() {
            solution.certificate.definiteness = run.definiteness(0.0)?;
        }
        return Ok(solution);
    }
    run.has_positive_diagonal = problem.diagonal().iter().all(|&entry| entry > 0.0 && entry.is_finite());
    // Where a diagonal is not positive, its row's largest magnitude stands in for it.
    if !run.has_positive_diagonal && problem.rows(&|| options.is_interrupted())?.is_none() {
        return Ok(run.stopped(method));
    }
    let (mut solution, work) = match method {
        LcpMethod::Lemke => run.lemke()?,
        LcpMethod::BlockPivoting => run.block_pivoting_or_lemke()?,
        LcpMethod::ProjectedCg => run.projected_cg()?,
        LcpMethod::Auto => run.auto()?,
    };
    if solution.status == LcpStatus::Interrupted {
        return Ok(solution);
    }
    if solution.status != LcpStatus::Solved && problem.rows(&|| options.is_interrupted())?.is_none() {
        return Ok(run.stopped(method));
    }
    if !problem.is_known() {
        solution.certificate.definiteness = run.definiteness(work)?;
    }
    Ok(solution)
}

/// A solve under way.
pub(super) struct Run<'a> {
    pub(super) problem: &'a LcpProblem<'a>,
    pub(super) options: &'a LcpOptions<'a>,
    pub(super) attempts: Vec<LcpAttempt>,
    pub(super) candidates: usize,
    pub(super) has_positive_diagonal: bool,
}

impl<'a> Run<'a> {
    /// Rows that may have to leave zero; as long as not all of M has been looked at, those with q < 0.
    pub(super) fn rows_to_begin_with(&self) -> Vec<usize> {
        let q = self.problem.q;
        match self.problem.known_rows() {
            Some(rows) => rows_that_matter(q, &rows.low),
            None => (0..q.len()).filter(|&i| q[i] < 0.0).collect(),
        }
    }

    /// The problem on the rows that may have to leave zero, all of M having been looked at; `None` when
    /// interrupted.
    pub(super) fn reduce(&mut self) -> Result<Option<Reduced<'a>>, LcpError> {
        let Some(rows) = self.problem.rows(&|| self.options.is_interrupted())? else {
            return Ok(None);
        };
        let reduced = Reduced::on(self.problem, rows_that_matter(self.problem.q, &rows.low));
        self.candidates = reduced.size();
        Ok(Some(reduced))
    }

    /// What stands when the interrupt came before a method ran.
    pub(super) fn stopped(&self, method: LcpMethod) -> LcpSolution {
        let n = self.problem.size();
        let mut solution = self.conclude(method, &Outcome::zero(LcpStatus::Interrupted, n), vec![0.0; n]);
        self.tell_attempts(&mut solution);
        solution
    }

    /// Measures an outcome and notes it; what does not pass is no solution.
    pub(super) fn attempt(
        &mut self,
        method: LcpMethod,
        outcome: &Outcome,
        reduced: &Reduced,
        start: Start,
    ) -> LcpSolution {
        let solution = self.measure(method, outcome, reduced);
        self.note(solution, start)
    }

    pub(super) fn measure(&self, method: LcpMethod, outcome: &Outcome, reduced: &Reduced) -> LcpSolution {
        let mut z = reduced.expand(&outcome.z, self.problem.size());
        z.iter_mut().for_each(|z| *z *= reduced.unit);
        self.conclude(method, outcome, z)
    }

    pub(super) fn note(&mut self, mut solution: LcpSolution, start: Start) -> LcpSolution {
        self.attempts.push(LcpAttempt {
            method: solution.method,
            status: solution.status,
            pivots: solution.pivots,
            warm: start == Start::Guess,
            crash: start == Start::Crash,
        });
        self.tell_attempts(&mut solution);
        solution
    }

    /// Every run so far, and the pivots of all.
    pub(super) fn tell_attempts(&self, solution: &mut LcpSolution) {
        solution.attempts.clone_from(&self.attempts);
        solution.pivots = self.attempts.iter().map(|attempt| attempt.pivots).sum();
    }

    fn conclude(&self, method: LcpMethod, outcome: &Outcome, z: Vec<f64>) -> LcpSolution {
        let w = self.problem.residual(&z, self.options.tolerance, &|| self.options.is_interrupted());
        let certificate = Certificate::measure(self.problem, &z, &w);
        let passed = certificate.natural_residual <= self.options.tolerance;
        let status = match outcome.status {
            // What was measured may be unfinished.
            _ if self.options.is_interrupted() => LcpStatus::Interrupted,
            LcpStatus::Solved if !passed => LcpStatus::Breakdown,
            status => status,
        };
        LcpSolution {
            status,
            z,
            w,
            pivots: outcome.pivots,
            natural_residual: certificate.natural_residual,
            complementarity: certificate.complementarity,
            method,
            certificate,
            ray: None,
            attempts: Vec::new(),
            candidates: self.candidates,
        }
    }

    /// Cholesky of the symmetric part on the rows kept, where that may be made after `work` operations.
    fn definiteness(&self, work: f64) -> Result<Definiteness, LcpError> {
        let n = self.candidates as f64;
        let look =
            if self.problem.known_rows().is_some() { 0.0 } else { (self.problem.size() as f64).powi(2) };
        let wanted = match self.options.definiteness {
            DefinitenessCheck::Always => true,
            DefinitenessCheck::Never => false,
            DefinitenessCheck::Cheap => look + n * n * n / 3.0 <= work,
        };
        let interrupted = || self.options.is_interrupted();
        if !wanted {
            return Ok(Definiteness::Unknown);
        }
        let rows = match self.problem.rows(&interrupted) {
            // What is not asked for is no reason to refuse an answer.
            Err(_) if self.options.definiteness == DefinitenessCheck::Cheap => None,
            rows => rows?,
        };
        let Some(rows) = rows else {
            return Ok(Definiteness::Unknown);
        };
        let (m, q) = (self.problem.m, self.problem.q);
        let kept = rows_that_matter(q, &rows.low);
        // A row left out stays at zero in every solution only if something there is above zero.
        let mut is_kept = vec![false; q.len()];
        kept.iter().for_each(|&i| is_kept[i] = true);
        if (0..q.len()).any(|i| !is_kept[i] && q[i] == 0.0 && m[(i, i)] == 0.0) {
            return Ok(Definiteness::Unknown);
        }
        Ok(definiteness(m, &kept, &interrupted))
    }
}

/// Where a run began.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// From nothing, or from a guess of the method's own.
    Cold,
    /// From the caller's guess.
    Guess,
    /// From a crash basis.
    Crash,
}
