//! What each method does with a problem, and what follows where it fails.

use crate::lcp::block_pivoting::{self, EXCHANGE_PATIENCE, Fallback, ZERO_TOLERANCE, first_guess};
use crate::lcp::lemke::path::draw;
use crate::lcp::lemke::run::{self, LemkeOptions};
use crate::lcp::problem::{Halt, LcpError};
use crate::lcp::projected_cg;
use crate::lcp::ray::{LcpRay, RayConclusion};
use crate::lcp::reduced::{ReducedProblem, power_of_two, rows_that_matter};
use crate::lcp::session::{Answer, Session};
use crate::lcp::solution::{LcpMethodName, LcpSolution, LcpStatus, StartingBasis};
use crate::lcp::symmetry::asymmetry;
use crate::lcp::touched_columns::TouchedColumns;

/// Rays further than this from their own equations are rounding.
const RAY_TOLERANCE: f64 = 1e-7;
/// After a breakdown Lemke's method starts again with pivots this much larger.
const PIVOT_TOL_STEP: f64 = 100.0;
/// So often Lemke's method starts again.
const RESTARTS: u64 = 3;
/// Largest asymmetry that conjugate gradients bear.
const CG_ASYMMETRY: f64 = 1e-10;
/// Share of the tolerance at which conjugate gradients stop, since forces are less exact than gaps.
const CG_MARGIN: f64 = 0.1;
/// Block exchanges without progress where a crash basis is looked for, which must cost little when not found.
const CRASH_PATIENCE: usize = 2;
/// Unknowns up to which block pivoting gains nothing before Lemke's method where M is not known to be a P-matrix.
const PIVOTED_UNKNOWNS: usize = 16;
/// So often rows that an answer leaves open are added before all of M is looked at for those that may matter.
const ROW_GROWTHS: usize = 4;

impl Session<'_> {
    pub(super) fn auto(&mut self, options: &LemkeOptions) -> Result<Answer, Halt> {
        let guessed = self.options.initial_active.is_some();
        if guessed || self.problem.known_p_matrix || self.rows_to_begin_with().len() > PIVOTED_UNKNOWNS {
            let answer = self.exchange(LcpMethodName::BlockPivoting, Fallback::None, EXCHANGE_PATIENCE)?;
            if answer.is_conclusive() || self.options.exchanges_only {
                return Ok(answer);
            }
        }
        let reduced = self.reduce()?;
        let lemke = self.lemke_on(&reduced, options);
        let conclusion = lemke.solution.ray.as_ref().map(|ray| ray.conclusion);
        if lemke.is_conclusive() || conclusion == Some(RayConclusion::Infeasible) {
            return Ok(lemke);
        }
        // A ray: conjugate gradients have no minimum to go to, and single exchanges hardly an end.
        let has_ray = lemke.solution.status == LcpStatus::Ray;
        let is_finite = !has_ray || reduced.size() <= PIVOTED_UNKNOWNS;
        let fallback = if is_finite { Fallback::Finite } else { Fallback::None };
        let mut others = vec![self.exchange(LcpMethodName::BlockPivoting, fallback, EXCHANGE_PATIENCE)?];
        if !has_ray && !others[0].is_conclusive() {
            match self.projected_cg() {
                Err(Halt::Interrupted) => return Err(Halt::Interrupted),
                Err(Halt::Rejected(_)) => {}
                Ok(answer) => others.push(answer),
            }
        }
        let work = lemke.work + others.iter().map(|answer| answer.work).sum::<f64>();
        let best = others.into_iter().find(Answer::is_conclusive).unwrap_or(lemke);
        Ok(Answer { solution: self.with_attempts(best.solution), work })
    }

    /// Lemke's method, from a crash basis where that may be tried and leads to an answer; the guess, if there is one, leads
    /// to the crash basis.
    ///
    /// Where the crash basis has no wrong sign, z0 is zero on it and the path has no length. The path from a guess asks for
    /// no P-matrix, and so neither do the exchanges from it.
    pub(super) fn lemke(&mut self, options: &LemkeOptions) -> Result<Answer, Halt> {
        let may_crash = options.crash && options.covering.is_none();
        let mut work = 0.0;
        if may_crash
            && self.problem.has_positive_diagonal()
            && self.rows_to_begin_with().len() > PIVOTED_UNKNOWNS
        {
            let is_guessed = self.options.initial_active.is_some();
            let fallback = if is_guessed { Fallback::None } else { Fallback::Crash };
            let answer = self.exchange(LcpMethodName::Lemke, fallback, CRASH_PATIENCE)?;
            if answer.is_conclusive() || self.options.exchanges_only {
                return Ok(answer);
            }
            work = answer.work;
        }
        let reduced = self.reduce()?;
        let answer = self.lemke_on(&reduced, options);
        Ok(Answer { work: answer.work + work, ..answer })
    }

    /// Lemke's path: from the guess if there is one and it leads to an answer, else from nothing.
    ///
    /// Where rounding broke it, again with larger pivots; where it went on without end, as it can on examples
    /// made for that, or left along a ray that proves nothing, again with another covering vector, unless the
    /// caller chose budget or vector.
    fn lemke_on(&mut self, reduced: &ReducedProblem, options: &LemkeOptions) -> Answer {
        let (problem, shared) = (self.problem, self.options);
        let budget = shared.pivot_budget(reduced.size());
        let mut work = 0.0;
        if let Some(guess) = &shared.initial_active {
            let guess = reduced.restrict_set(guess);
            if let Some(outcome) = run::solve_warm(reduced, &guess, options.pivot_tol, budget) {
                work += outcome.work;
                let solution = self.certify(LcpMethodName::Lemke, &outcome, reduced);
                let answer = Answer { solution: self.record(solution, StartingBasis::Guess), work };
                if answer.is_conclusive() {
                    return answer;
                }
            }
        }
        let mut covering = options.covering.clone().unwrap_or_else(|| vec![1.0; problem.size()]);
        let is_free = options.covering.is_none() && shared.max_pivots.is_none();
        let (mut pivot_tol, mut restart) = (options.pivot_tol, 0_u64);
        loop {
            restart += 1;
            let unit = power_of_two(covering.iter().copied().fold(0.0, f64::max));
            let d = reduced.restrict(&covering).iter().map(|d| d / unit).collect();
            let mut outcome = run::solve_cold(reduced, d, pivot_tol, budget);
            work += outcome.work;
            let ray = outcome.ray.take().map(|(z, z0)| {
                let z = reduced.expand(&z, 1.0);
                LcpRay::verify(problem, z, z0 / unit, &covering, shared.interrupt())
            });
            if ray.as_ref().is_some_and(|ray| ray.residual > RAY_TOLERANCE) {
                outcome.status = LcpStatus::Breakdown;
            }
            let solution = self.certify(LcpMethodName::Lemke, &outcome, reduced);
            let mut solution = self.record(solution, StartingBasis::Cold);
            solution.ray = ray.filter(|_| solution.status == LcpStatus::Ray);
            let conclusion = solution.ray.as_ref().map(|ray| ray.conclusion);
            let may_restart = restart <= RESTARTS
                && match solution.status {
                    LcpStatus::Breakdown => true,
                    LcpStatus::PivotLimit => is_free,
                    LcpStatus::Ray => is_free && conclusion == Some(RayConclusion::Inconclusive),
                    LcpStatus::Solved | LcpStatus::Interrupted => false,
                };
            if !may_restart {
                return Answer { solution, work };
            }
            if solution.status == LcpStatus::Breakdown {
                pivot_tol *= PIVOT_TOL_STEP;
            }
            if options.covering.is_none() {
                covering.iter_mut().enumerate().for_each(|(i, d)| *d = draw(i, restart));
            }
        }
    }

    /// Block pivoting to its end; where single exchanges take too long, Lemke's method unless the caller set a
    /// budget.
    pub(super) fn block_pivoting_or_lemke(&mut self, options: &LemkeOptions) -> Result<Answer, Halt> {
        let fallback = if self.options.exchanges_only { Fallback::None } else { Fallback::Finite };
        let answer = self.exchange(LcpMethodName::BlockPivoting, fallback, EXCHANGE_PATIENCE)?;
        if answer.solution.status != LcpStatus::PivotLimit || self.options.max_pivots.is_some() {
            return Ok(answer);
        }
        let reduced = self.reduce()?;
        let path = self.lemke_on(&reduced, options);
        Ok(Answer { work: answer.work + path.work, ..path })
    }

    /// Block exchanges in the name of `method`.
    ///
    /// They begin on the rows with q < 0 and take in those that an answer leaves open, so that where no other can
    /// touch no other column of M is read, and none is known to be free of them.
    fn exchange(
        &mut self,
        method: LcpMethodName,
        fallback: Fallback,
        patience: usize,
    ) -> Result<Answer, Halt> {
        let (problem, options) = (self.problem, self.options);
        let n = problem.size();
        let mut is_kept = vec![false; n];
        self.rows_to_begin_with().into_iter().for_each(|i| is_kept[i] = true);
        let (start, mut active) = match &options.initial_active {
            Some(guess) => (StartingBasis::Guess, guess.clone()),
            None if fallback == Fallback::Crash => (StartingBasis::Crash, first_guess(problem.q)),
            None => (StartingBasis::Cold, first_guess(problem.q)),
        };
        active.iter().for_each(|&i| is_kept[i] = true);
        // Unknowns that the caller put into the basis are no pivots of ours.
        let mut pivots = if start == StartingBasis::Guess { 0 } else { active.len() };
        if pivots > options.pivot_budget(n) {
            (active, pivots) = (Vec::new(), 0);
        }
        let (mut work, mut growth) = (0.0, 0);
        loop {
            let is_all = problem.known_rows().is_some();
            let reduced = self.reduce_to((0..n).filter(|&i| is_kept[i]).collect());
            let guess = reduced.restrict_set(&active);
            let outcome =
                block_pivoting::solve(problem, &reduced, &guess, pivots, (fallback, patience), options);
            pivots = outcome.pivots;
            work += outcome.work;
            let solution = self.certify(method, &outcome, &reduced);
            // What an interrupt left unfinished opens no rows.
            let is_answer = outcome.status == LcpStatus::Solved && solution.status != LcpStatus::Interrupted;
            let may_grow = is_answer && !is_all && reduced.size() < n;
            let open = if may_grow { self.open_rows(&solution, &is_kept) } else { Vec::new() };
            if open.is_empty() {
                return Ok(Answer { solution: self.record(solution, start), work });
            }
            active = solution.active();
            open.into_iter().for_each(|i| is_kept[i] = true);
            growth += 1;
            if growth == ROW_GROWTHS {
                let rows = problem.rows(options.interrupt())?;
                rows_that_matter(problem.q, &rows.low).into_iter().for_each(|i| is_kept[i] = true);
            }
        }
    }

    /// Rows left out that the answer presses below zero.
    fn open_rows(&self, solution: &LcpSolution, is_kept: &[bool]) -> Vec<usize> {
        let size = self.largest_force(&solution.z);
        (0..is_kept.len()).filter(|&i| !is_kept[i] && solution.w[i] < -ZERO_TOLERANCE * size).collect()
    }

    pub(super) fn projected_cg(&mut self) -> Result<Answer, Halt> {
        let reduced = self.reduce()?;
        let columns = TouchedColumns::symmetric(&reduced);
        let (row, column, difference) = asymmetry(&columns, CG_ASYMMETRY);
        if (reduced.interrupted)() {
            return Err(Halt::Interrupted);
        }
        if difference > CG_ASYMMETRY {
            let (row, column) = (reduced.index(row), reduced.index(column));
            return Err(LcpError::NotSymmetric { row, column, difference }.into());
        }
        let guess = self.options.initial_active.as_ref().map(|guess| reduced.restrict_set(guess));
        let start = if guess.is_some() { StartingBasis::Guess } else { StartingBasis::Cold };
        let active = guess.unwrap_or_else(|| first_guess(&reduced.q));
        let tolerance = CG_MARGIN * self.options.tolerance;
        let budget = self.options.pivot_budget(reduced.size());
        let outcome = projected_cg::solve(&columns, &active, tolerance, budget);
        let solution = self.certify(LcpMethodName::ProjectedCg, &outcome, &reduced);
        Ok(Answer { solution: self.record(solution, start), work: outcome.work })
    }
}
