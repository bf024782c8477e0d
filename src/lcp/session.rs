//! A solve under way: the rows it looks at, and how what a method found is certified and recorded.

use crate::lcp::block_pivoting::ZERO_TOLERANCE;
use crate::lcp::certificate::Certificate;
use crate::lcp::options::{DefinitenessCheck, LcpOptions};
use crate::lcp::outcome::Outcome;
use crate::lcp::problem::{Halt, LcpProblem};
use crate::lcp::reduced::{ReducedProblem, rows_that_matter};
use crate::lcp::solution::{LcpAttempt, LcpMethodName, LcpSolution, LcpStatus, StartingBasis};
use crate::linalg::definiteness::{Definiteness, examine};

/// Share of the tolerance that unknowns may have which count as zero.
const ZERO_SHARE: f64 = 0.01;

/// A problem, the options of its solve and the runs so far.
pub(super) struct Session<'a> {
    pub(super) problem: &'a LcpProblem<'a>,
    pub(super) options: &'a LcpOptions<'a>,
    pub(super) attempts: Vec<LcpAttempt>,
    pub(super) candidates: usize,
}

/// A solution, or how a method failed, and the operations it took.
pub(super) struct Answer {
    pub(super) solution: LcpSolution,
    pub(super) work: f64,
}

impl Answer {
    /// Whether nothing else need be tried.
    pub(super) fn is_conclusive(&self) -> bool {
        matches!(self.solution.status, LcpStatus::Solved | LcpStatus::Interrupted)
    }
}

impl<'a> Session<'a> {
    /// Rows that may have to leave zero; as long as not all of M has been looked at, those with q < 0.
    pub(super) fn rows_to_begin_with(&self) -> Vec<usize> {
        let q = self.problem.q;
        match self.problem.known_rows() {
            Some(rows) => rows_that_matter(q, &rows.low),
            None => (0..q.len()).filter(|&i| q[i] < 0.0).collect(),
        }
    }

    /// The problem on the rows that may have to leave zero, all of M having been looked at.
    pub(super) fn reduce(&mut self) -> Result<ReducedProblem<'a>, Halt> {
        let rows = self.problem.rows(self.options.interrupt())?;
        Ok(self.reduce_to(rows_that_matter(self.problem.q, &rows.low)))
    }

    /// The problem on `rows` (ascending).
    pub(super) fn reduce_to(&mut self, rows: Vec<usize>) -> ReducedProblem<'a> {
        let reduced = ReducedProblem::on(self.problem, rows, self.options.interrupt());
        self.candidates = reduced.size();
        reduced
    }

    /// An ending at z = 0.
    pub(super) fn at_zero(&self, method: LcpMethodName, status: LcpStatus) -> LcpSolution {
        let nothing = ReducedProblem::on(self.problem, Vec::new(), self.options.interrupt());
        self.certify(method, &Outcome::zero(status, 0), &nothing)
    }

    /// Measures an outcome against the problem as given; what does not pass is no solution.
    pub(super) fn certify(
        &self,
        method: LcpMethodName,
        outcome: &Outcome,
        reduced: &ReducedProblem,
    ) -> LcpSolution {
        let interrupt = self.options.interrupt();
        let mut z = self.without_rounding(reduced.expand(&outcome.z, reduced.unit));
        let (mut w, mut is_known) = self.problem.slack(&z, self.options.tolerance, interrupt);
        if !z.iter().chain(&w).all(|value| value.is_finite()) {
            z.fill(0.0);
            w.copy_from_slice(self.problem.q);
            is_known = true;
        }
        let mut certificate = Certificate::measure(self.problem, &z, &w);
        if !is_known {
            certificate.natural_residual = f64::INFINITY;
        }
        let passed = certificate.natural_residual <= self.options.tolerance;
        let status = match outcome.status {
            // What was measured may be unfinished.
            _ if interrupt() => LcpStatus::Interrupted,
            LcpStatus::Solved if !passed => LcpStatus::Breakdown,
            // A run that aimed lower than it had to.
            LcpStatus::PivotLimit | LcpStatus::Breakdown if passed => LcpStatus::Solved,
            status => status,
        };
        LcpSolution {
            status,
            z,
            w,
            pivots: outcome.pivots,
            method,
            certificate,
            ray: None,
            attempts: Vec::new(),
            candidates: self.candidates,
        }
    }

    /// z >= 0 without what is zero to rounding, which would count as active.
    fn without_rounding(&self, mut z: Vec<f64>) -> Vec<f64> {
        // Far below what the certificate bears.
        let bearable = ZERO_SHARE * self.options.tolerance * self.problem.deficit();
        let zero = (ZERO_TOLERANCE * self.largest_force(&z)).min(bearable);
        for (i, z) in z.iter_mut().enumerate() {
            // All of a column is looked at for the few that the diagonal calls zero.
            if self.scaled(i, *z) <= zero && self.problem.largest_effect(i, *z) <= zero {
                *z = 0.0;
            }
        }
        z
    }

    /// An unknown in units of w; 0 of one below zero.
    fn scaled(&self, i: usize, z: f64) -> f64 {
        if z > 0.0 { self.problem.diagonal_scale(i) * z } else { 0.0 }
    }

    /// The largest of all z in units of w, or `max(-q)` if that is larger.
    pub(super) fn largest_force(&self, z: &[f64]) -> f64 {
        z.iter().enumerate().map(|(i, &z)| self.scaled(i, z)).fold(self.problem.deficit(), f64::max)
    }

    /// Notes a run that has ended.
    pub(super) fn record(&mut self, solution: LcpSolution, start: StartingBasis) -> LcpSolution {
        self.attempts.push(LcpAttempt {
            method: solution.method,
            status: solution.status,
            pivots: solution.pivots,
            start,
        });
        self.with_attempts(solution)
    }

    /// The solution with every run so far, and the pivots of all.
    pub(super) fn with_attempts(&self, solution: LcpSolution) -> LcpSolution {
        let pivots = self.attempts.iter().map(|attempt| attempt.pivots).sum();
        LcpSolution { attempts: self.attempts.clone(), pivots, ..solution }
    }

    /// Cholesky of the symmetric part on the rows kept, where that may be made after `work` operations.
    pub(super) fn definiteness(&self, work: f64) -> Result<Definiteness, Halt> {
        let LcpProblem { m, q, .. } = *self.problem;
        let n = self.candidates as f64;
        let look = if self.problem.known_rows().is_some() { 0.0 } else { (q.len() as f64).powi(2) };
        let check = self.options.definiteness;
        if check == DefinitenessCheck::Never
            || (check == DefinitenessCheck::Cheap && look + n * n * n / 3.0 > work)
        {
            return Ok(Definiteness::Unknown);
        }
        let rows = match self.problem.rows(self.options.interrupt()) {
            Ok(rows) => rows,
            // What is not asked for is no reason to refuse an answer.
            Err(Halt::Rejected(error)) if check == DefinitenessCheck::Always => return Err(error.into()),
            Err(_) => return Ok(Definiteness::Unknown),
        };
        let kept = rows_that_matter(q, &rows.low);
        // A row left out stays at zero in every solution only if something there is above zero.
        let is_kept = |i: usize| kept.binary_search(&i).is_ok();
        if (0..q.len()).any(|i| q[i] == 0.0 && m[(i, i)] == 0.0 && !is_kept(i)) {
            return Ok(Definiteness::Unknown);
        }
        Ok(examine(m, &kept, self.options.interrupt()).0)
    }
}
