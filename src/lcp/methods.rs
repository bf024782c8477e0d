//! What each method does with a problem, and what follows where it fails.

use crate::lcp::block_pivoting::{Fallback, ZERO, first_guess};
use crate::lcp::options::LcpMethod;
use crate::lcp::problem::LcpError;
use crate::lcp::ray::{LcpRay, RayConclusion};
use crate::lcp::reduced::{Reduced, power_of_two, rows_that_matter};
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::lcp::solve::{Run, Start};
use crate::lcp::symmetry::asymmetry;
use crate::lcp::touched_columns::TouchedColumns;
use crate::lcp::{block_pivoting, lemke, projected_cg};

/// Rays further than this from their own equations are rounding.
const RAY_TOLERANCE: f64 = 1e-7;
/// After a breakdown Lemke's method starts again with pivots this much larger.
const PIVOT_TOL_STEP: f64 = 100.0;
/// So often Lemke's method starts again.
const TRIES: usize = 3;
/// Largest asymmetry that conjugate gradients bear.
const SYMMETRIC: f64 = 1e-10;
/// Share of the tolerance at which conjugate gradients stop, since forces are less exact than gaps.
const CG_MARGIN: f64 = 0.1;
/// Unknowns up to which block pivoting gains nothing before Lemke's method where M is not known to be a P-matrix.
const FEW: usize = 16;
/// So often rows that an answer leaves open are added before all of M is looked at for those that may matter.
const GROWTHS: usize = 4;

/// A solution, or how a method failed, and the operations it took.
type Answer = (LcpSolution, f64);

fn ends(answer: &Answer) -> bool {
    matches!(answer.0.status, LcpStatus::Solved | LcpStatus::Interrupted)
}

impl Run<'_> {
    pub(super) fn auto(&mut self) -> Result<Answer, LcpError> {
        let guessed = self.options.initial_active.is_some();
        if guessed || self.problem.known_p_matrix || self.rows_to_begin_with().len() > FEW {
            let answer = self.exchange(LcpMethod::BlockPivoting, Fallback::None)?;
            if ends(&answer) {
                return Ok(answer);
            }
        }
        let Some(reduced) = self.reduce()? else {
            return Ok((self.stopped(LcpMethod::Auto), 0.0));
        };
        let lemke = self.lemke_on(&reduced);
        let proved = |ray: &LcpRay| ray.conclusion == RayConclusion::Infeasible;
        if ends(&lemke) || lemke.0.ray.as_ref().is_some_and(proved) {
            return Ok(lemke);
        }
        // A ray: conjugate gradients have no minimum to go to, and single exchanges hardly an end.
        let has_ray = lemke.0.status == LcpStatus::Ray;
        let fallback = if !has_ray || reduced.size() <= FEW { Fallback::Finite } else { Fallback::None };
        let mut others = vec![self.exchange(LcpMethod::BlockPivoting, fallback)?];
        if !has_ray
            && !ends(&others[0])
            && let Ok(answer) = self.projected_cg()
        {
            others.push(answer);
        }
        let work = lemke.1 + others.iter().map(|answer| answer.1).sum::<f64>();
        let mut solution = others.into_iter().find(ends).map_or(lemke.0, |answer| answer.0);
        self.tell_attempts(&mut solution);
        Ok((solution, work))
    }

    /// Lemke's method, from a crash basis where that may be tried and leads to an answer.
    ///
    /// Where the crash basis has no wrong sign, z0 is zero on it and the path has no length.
    pub(super) fn lemke(&mut self) -> Result<Answer, LcpError> {
        let options = self.options;
        let may_crash = options.crash && options.initial_active.is_none() && options.covering.is_none();
        let mut work = 0.0;
        if may_crash && self.has_positive_diagonal && self.rows_to_begin_with().len() > FEW {
            let answer = self.exchange(LcpMethod::Lemke, Fallback::Crash)?;
            if ends(&answer) {
                return Ok(answer);
            }
            work = answer.1;
        }
        let Some(reduced) = self.reduce()? else {
            return Ok((self.stopped(LcpMethod::Lemke), work));
        };
        let answer = self.lemke_on(&reduced);
        Ok((answer.0, answer.1 + work))
    }

    /// Lemke's path: from the guess if there is one and it leads to an answer, else from nothing.
    ///
    /// Where rounding broke it, again with larger pivots; where it went on without end, as it can on examples
    /// made for that, or left along a ray that proves nothing, again with another covering vector, unless the
    /// caller chose budget or vector.
    fn lemke_on(&mut self, reduced: &Reduced) -> Answer {
        let options = self.options;
        let method = LcpMethod::Lemke;
        let mut work = 0.0;
        if let Some(guess) = &options.initial_active {
            let guess = reduced.restrict_set(guess);
            if let Some(outcome) = lemke::solve_warm(reduced, &guess, options) {
                work += outcome.work;
                let solution = self.attempt(method, &outcome, reduced, Start::Guess);
                if matches!(solution.status, LcpStatus::Solved | LcpStatus::Interrupted) {
                    return (solution, work);
                }
            }
        }
        let mut covering = options.covering.clone().unwrap_or_else(|| vec![1.0; self.problem.size()]);
        let is_free = options.covering.is_none() && options.max_pivots.is_none();
        let mut pivot_tol = options.pivot_tol;
        let mut tries = 0;
        loop {
            let unit = power_of_two(covering.iter().copied().fold(0.0, f64::max));
            let d = reduced.restrict(&covering).iter().map(|d| d / unit).collect();
            let mut outcome = lemke::solve_cold(reduced, d, pivot_tol, options);
            work += outcome.work;
            let ray = outcome.ray.take().map(|(z, z0)| {
                let z = reduced.expand(&z, self.problem.size());
                LcpRay::verify(self.problem, z, z0 / unit, &covering, &|| options.is_interrupted())
            });
            if ray.as_ref().is_some_and(|ray| ray.residual > RAY_TOLERANCE) {
                outcome.status = LcpStatus::Breakdown;
            }
            let mut solution = self.attempt(method, &outcome, reduced, Start::Cold);
            if solution.status == LcpStatus::Ray {
                solution.ray = ray;
            }
            tries += 1;
            let proved =
                solution.ray.as_ref().is_none_or(|ray| ray.conclusion != RayConclusion::Inconclusive);
            match solution.status {
                LcpStatus::Breakdown if tries <= TRIES => pivot_tol *= PIVOT_TOL_STEP,
                LcpStatus::PivotLimit if tries <= TRIES && is_free => {}
                LcpStatus::Ray if tries <= TRIES && is_free && !proved => {}
                _ => return (solution, work),
            }
            if options.covering.is_none() {
                covering.iter_mut().enumerate().for_each(|(i, d)| *d = lemke::draw(i, tries as u64));
            }
        }
    }

    /// Block pivoting to its end; where single exchanges take too long, Lemke's method unless the caller set a
    /// budget.
    pub(super) fn block_pivoting_or_lemke(&mut self) -> Result<Answer, LcpError> {
        let answer = self.exchange(LcpMethod::BlockPivoting, Fallback::Finite)?;
        if answer.0.status != LcpStatus::PivotLimit || self.options.max_pivots.is_some() {
            return Ok(answer);
        }
        let Some(reduced) = self.reduce()? else {
            return Ok((self.stopped(LcpMethod::BlockPivoting), answer.1));
        };
        let (solution, work) = self.lemke_on(&reduced);
        Ok((solution, answer.1 + work))
    }

    /// Block exchanges in the name of `method`.
    ///
    /// They begin on the rows with q < 0 and take in those that an answer leaves open, so that where no other can
    /// touch no other column of M is read, and none is known to be free of them.
    fn exchange(&mut self, method: LcpMethod, fallback: Fallback) -> Result<Answer, LcpError> {
        let (problem, options) = (self.problem, self.options);
        let interrupted = || options.is_interrupted();
        let n = problem.size();
        let mut is_kept = vec![false; n];
        self.rows_to_begin_with().into_iter().for_each(|i| is_kept[i] = true);
        let (start, mut active) = match &options.initial_active {
            Some(guess) => (Start::Guess, guess.clone()),
            None if fallback == Fallback::Crash => (Start::Crash, first_guess(problem.q)),
            None => (Start::Cold, first_guess(problem.q)),
        };
        active.iter().for_each(|&i| is_kept[i] = true);
        // Unknowns that the caller put into the basis are no pivots of ours.
        let mut pivots = if start == Start::Guess { 0 } else { active.len() };
        if pivots > options.pivot_budget(n) {
            (active, pivots) = (Vec::new(), 0);
        }
        let mut work = 0.0;
        let mut growth = 0;
        loop {
            let rows: Vec<usize> = (0..n).filter(|&i| is_kept[i]).collect();
            let is_all = problem.known_rows().is_some();
            let reduced = Reduced::on(problem, rows);
            self.candidates = reduced.size();
            let scale: Vec<f64> =
                (0..reduced.size()).map(|place| problem.diagonal_scale(reduced.index(place))).collect();
            let guess = reduced.restrict_set(&active);
            let outcome = block_pivoting::solve(&reduced, &scale, &guess, pivots, fallback, options);
            pivots = outcome.pivots;
            work += outcome.work;
            let solution = self.measure(method, &outcome, &reduced);
            let open = match outcome.status {
                // What an interrupt left unfinished opens no rows.
                LcpStatus::Solved if solution.status == LcpStatus::Interrupted => Vec::new(),
                LcpStatus::Solved if !is_all && reduced.size() < n => open_rows(self, &solution, &is_kept),
                _ => Vec::new(),
            };
            if open.is_empty() {
                return Ok((self.note(solution, start), work));
            }
            active = solution.active();
            open.into_iter().for_each(|i| is_kept[i] = true);
            growth += 1;
            if growth == GROWTHS {
                let Some(rows) = problem.rows(&interrupted)? else {
                    return Ok((self.stopped(method), work));
                };
                rows_that_matter(problem.q, &rows.low).into_iter().for_each(|i| is_kept[i] = true);
            }
        }
    }

    pub(super) fn projected_cg(&mut self) -> Result<Answer, LcpError> {
        let Some(reduced) = self.reduce()? else {
            return Ok((self.stopped(LcpMethod::ProjectedCg), 0.0));
        };
        let interrupted = || self.options.is_interrupted();
        let columns = TouchedColumns::symmetric(&reduced, &interrupted);
        let (row, column, difference) = asymmetry(&columns, reduced.size(), SYMMETRIC, &interrupted);
        if difference > SYMMETRIC {
            let (row, column) = (reduced.index(row), reduced.index(column));
            return Err(LcpError::NotSymmetric { row, column, difference });
        }
        let guess = self.options.initial_active.as_ref().map(|guess| reduced.restrict_set(guess));
        let start = if guess.is_some() { Start::Guess } else { Start::Cold };
        let active = guess.unwrap_or_else(|| first_guess(&reduced.q));
        let tolerance = CG_MARGIN * self.options.tolerance;
        let outcome = projected_cg::solve(&columns, &reduced.q, &active, tolerance, self.options);
        let solution = self.attempt(LcpMethod::ProjectedCg, &outcome, &reduced, start);
        Ok((solution, outcome.work))
    }
}

/// Rows left out that the answer presses below zero.
fn open_rows(run: &Run, solution: &LcpSolution, is_kept: &[bool]) -> Vec<usize> {
    let scaled = |(i, &z): (usize, &f64)| if z > 0.0 { run.problem.diagonal_scale(i) * z } else { 0.0 };
    let size = solution.z.iter().enumerate().map(scaled).fold(run.problem.deficit(), f64::max);
    (0..is_kept.len()).filter(|&i| !is_kept[i] && solution.w[i] < -ZERO * size).collect()
}
