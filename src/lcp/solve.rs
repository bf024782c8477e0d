//! One entry for every method: leave out what cannot matter, run, check against the problem as given.

use super::block_pivoting::{self, Fallback, first_guess};
use super::certificate::{Certificate, Definiteness};
use super::dense::{Factor, NoFactor};
use super::lemke;
use super::options::{DefinitenessCheck, LcpMethod, LcpOptions};
use super::outcome::Outcome;
use super::problem::{LcpError, LcpProblem};
use super::projected_cg;
use super::ray::{LcpRay, RayConclusion};
use super::reduced::{Reduced, build, power_of_two};
use super::solution::{LcpAttempt, LcpSolution, LcpStatus};

/// Rays further than this from their own equations are rounding.
const RAY_TOLERANCE: f64 = 1e-7;
/// After a breakdown Lemke's method starts again with pivots this much larger.
const PIVOT_TOL_STEP: f64 = 100.0;
/// So often Lemke's method starts again.
const TRIES: usize = 3;
/// Largest asymmetry that conjugate gradients bear, and that Cholesky does.
const SYMMETRIC: f64 = 1e-10;
const SYMMETRIC_FACTOR: f64 = 1e-13;
/// Share of the tolerance at which conjugate gradients stop, since forces are less exact than gaps.
const CG_MARGIN: f64 = 0.1;
/// Unknowns up to which `auto` begins with Lemke's method where M is not known to be a P-matrix.
const FEW: usize = 16;
/// Unknowns from which looking for symmetry pays for itself in block pivoting.
const MANY: usize = 256;

/// Solves `w = M z + q`, `w >= 0`, `z >= 0`, `w·z = 0`.
///
/// An answer is called [`LcpStatus::Solved`] only if its natural residual, measured with the M and q given, is
/// at most [`LcpOptions::tolerance`].
///
/// [`LcpMethod::Auto`] begins with block pivoting, which for a handful of unknowns of unknown kind would gain
/// nothing and is left out; Lemke's method follows. Unless that has proved that there is no solution, block
/// pivoting is tried again to its end, and conjugate gradients where M is symmetric and not known to be
/// indefinite.
///
/// # Errors
/// An option that is out of range or does not fit the problem, and [`LcpError::NotSymmetric`] from
/// [`LcpMethod::ProjectedCg`]; no ending is an error.
pub fn solve(problem: &LcpProblem, method: LcpMethod, options: &LcpOptions) -> Result<LcpSolution, LcpError> {
    options.validate(problem.size(), method)?;
    let mut run = Run { problem, options, attempts: Vec::new(), candidates: 0 };
    if options.total.is_some() && problem.size() > 0 {
        return run.load_control();
    }
    if problem.deficit() == 0.0 {
        let zero = Outcome::zero(LcpStatus::Solved, 0);
        return Ok(run.conclude(method, &zero, vec![0.0; problem.size()]));
    }
    let reduced = Reduced::new(problem, &|| options.is_interrupted());
    run.candidates = reduced.size();
    let (mut solution, work) = match method {
        LcpMethod::Lemke => run.lemke(reduced),
        LcpMethod::BlockPivoting => run.block_pivoting_or_lemke(reduced),
        LcpMethod::ProjectedCg => run.projected_cg(&reduced)?,
        LcpMethod::Auto => run.auto(reduced),
    };
    if !problem.known_p_matrix && solution.status != LcpStatus::Interrupted {
        solution.certificate.definiteness = run.definiteness(work);
    }
    Ok(solution)
}

/// A solve under way.
struct Run<'a> {
    problem: &'a LcpProblem<'a>,
    options: &'a LcpOptions<'a>,
    attempts: Vec<LcpAttempt>,
    candidates: usize,
}

/// A solution, or how a method failed, and the multiplications it took.
type Answer = (LcpSolution, f64);

impl Run<'_> {
    fn auto(&mut self, reduced: Reduced) -> Answer {
        let ends = |answer: &Answer| matches!(answer.0.status, LcpStatus::Solved | LcpStatus::Interrupted);
        let guessed = self.options.initial_active.is_some();
        if reduced.size() > FEW || self.problem.known_p_matrix || guessed {
            let answer = self.block_pivoting(&reduced, Fallback::None);
            if ends(&answer) {
                return answer;
            }
        }
        let reduced = reduced.into_columns(&|| self.options.is_interrupted());
        let lemke = self.lemke_on(&reduced);
        let proved = |ray: &LcpRay| ray.conclusion == RayConclusion::Infeasible;
        if ends(&lemke) || lemke.0.ray.as_ref().is_some_and(proved) {
            return lemke;
        }
        // Not copositive: conjugate gradients have no minimum to go to, and single exchanges no end.
        let copositive = lemke.0.status != LcpStatus::Ray;
        let fallback = if copositive || reduced.size() <= FEW { Fallback::Finite } else { Fallback::None };
        let mut others = vec![self.block_pivoting(&reduced, fallback)];
        if copositive
            && !ends(&others[0])
            && let Ok(answer) = self.projected_cg(&reduced)
        {
            others.push(answer);
        }
        let work = lemke.1 + others.iter().map(|answer| answer.1).sum::<f64>();
        let mut solution = others.into_iter().find(ends).map_or(lemke.0, |answer| answer.0);
        solution.attempts.clone_from(&self.attempts);
        solution.pivots = self.attempts.iter().map(|attempt| attempt.pivots).sum();
        (solution, work)
    }

    fn lemke(&mut self, reduced: Reduced) -> Answer {
        self.lemke_on(&reduced.into_columns(&|| self.options.is_interrupted()))
    }

    /// Lemke's method: from the guess if there is one and it leads to an answer, else from nothing.
    ///
    /// Where rounding broke it, again with larger pivots; where it went on without end, as it can on examples
    /// made for that, or left along a ray that proves nothing, again with another covering vector, unless the
    /// caller chose budget or vector.
    fn lemke_on(&mut self, reduced: &Reduced) -> Answer {
        let method = LcpMethod::Lemke;
        let m = reduced.m().try_as_col_major().expect("the caller made the columns contiguous");
        let mut work = 0.0;
        if let Some(guess) = &self.options.initial_active {
            let guess = reduced.restrict_set(guess);
            if let Some(outcome) = lemke::solve_warm(m, &reduced.q, &guess, self.options) {
                work += outcome.work;
                let solution = self.attempt(method, &outcome, reduced, true);
                if matches!(solution.status, LcpStatus::Solved | LcpStatus::Interrupted) {
                    return (solution, work);
                }
            }
        }
        let mut covering = self.options.covering.clone().unwrap_or_else(|| vec![1.0; self.problem.size()]);
        let is_free = self.options.covering.is_none() && self.options.max_pivots.is_none();
        let mut pivot_tol = self.options.pivot_tol;
        let mut tries = 0;
        loop {
            let unit = power_of_two(covering.iter().copied().fold(0.0, f64::max));
            let d = reduced.restrict(&covering).iter().map(|d| d / unit).collect();
            let mut outcome = lemke::solve_cold(m, &reduced.q, d, pivot_tol, self.options);
            work += outcome.work;
            let ray = outcome.ray.take().map(|(z, z0)| {
                let z = reduced.expand(&z, self.problem.size());
                LcpRay::verify(self.problem, z, z0 / unit, &covering)
            });
            if ray.as_ref().is_some_and(|ray| ray.residual > RAY_TOLERANCE) {
                outcome.status = LcpStatus::Breakdown;
            }
            let mut solution = self.attempt(method, &outcome, reduced, false);
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
            if self.options.covering.is_none() {
                covering.iter_mut().enumerate().for_each(|(i, d)| *d = lemke::draw(i, tries as u64));
            }
        }
    }

    /// Block pivoting to its end; where single exchanges take too long, Lemke's method unless the caller set a
    /// budget.
    fn block_pivoting_or_lemke(&mut self, reduced: Reduced) -> Answer {
        let answer = self.block_pivoting(&reduced, Fallback::Finite);
        if answer.0.status != LcpStatus::PivotLimit || self.options.max_pivots.is_some() {
            return answer;
        }
        let (solution, work) = self.lemke(reduced);
        (solution, answer.1 + work)
    }

    fn block_pivoting(&mut self, reduced: &Reduced, fallback: Fallback) -> Answer {
        let guess = self.options.initial_active.as_ref().map(|guess| reduced.restrict_set(guess));
        let start = guess.clone().unwrap_or_else(|| first_guess(&reduced.q));
        let symmetric =
            reduced.size() >= MANY && self.asymmetry(reduced, SYMMETRIC_FACTOR).2 <= SYMMETRIC_FACTOR;
        let outcome = block_pivoting::solve(reduced, &start, symmetric, fallback, self.options);
        let solution = self.attempt(LcpMethod::BlockPivoting, &outcome, reduced, guess.is_some());
        (solution, outcome.work)
    }

    fn projected_cg(&mut self, reduced: &Reduced) -> Result<Answer, LcpError> {
        self.check_symmetry(reduced)?;
        let guess = self.options.initial_active.as_ref().map(|guess| reduced.restrict_set(guess));
        let start = guess.clone().unwrap_or_else(|| first_guess(&reduced.q));
        let run = projected_cg::solve(
            contiguous(reduced),
            &reduced.q,
            &start,
            None,
            CG_MARGIN * self.options.tolerance,
            self.options,
        );
        let solution = self.attempt(LcpMethod::ProjectedCg, &run.outcome, reduced, guess.is_some());
        Ok((solution, run.outcome.work))
    }

    /// Conjugate gradients with `Σ z` given.
    fn load_control(&mut self) -> Result<LcpSolution, LcpError> {
        let reduced = Reduced::whole(self.problem, power_of_two(largest(self.problem.q)));
        self.candidates = reduced.size();
        self.check_symmetry(&reduced)?;
        let guess = self.options.initial_active.clone();
        let start = guess.clone().unwrap_or_else(|| {
            let lowest = reduced.q.iter().copied().fold(f64::INFINITY, f64::min);
            let highest = reduced.q.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (0..reduced.size()).filter(|&i| reduced.q[i] <= 0.5 * (lowest + highest)).collect()
        });
        let total = self.options.total.map(|total| total / reduced.unit);
        let tolerance = CG_MARGIN * self.options.tolerance;
        let run =
            projected_cg::solve(contiguous(&reduced), &reduced.q, &start, total, tolerance, self.options);
        let shift = run.shift * reduced.unit;
        let shifted: Vec<f64> = self.problem.q.iter().map(|q| q + shift).collect();
        let problem = LcpProblem { q: &shifted, ..self.problem.clone() };
        let mut inner = Run {
            problem: &problem,
            options: self.options,
            attempts: Vec::new(),
            candidates: self.candidates,
        };
        let mut solution = inner.attempt(LcpMethod::ProjectedCg, &run.outcome, &reduced, guess.is_some());
        solution.shift = shift;
        Ok(solution)
    }

    fn asymmetry(&self, reduced: &Reduced, limit: f64) -> (usize, usize, f64) {
        projected_cg::asymmetry(reduced.m(), limit, &|| self.options.is_interrupted())
    }

    fn check_symmetry(&self, reduced: &Reduced) -> Result<(), LcpError> {
        let (row, column, difference) = self.asymmetry(reduced, SYMMETRIC);
        if difference <= SYMMETRIC {
            return Ok(());
        }
        let (row, column) = (reduced.index(row), reduced.index(column));
        Err(LcpError::NotSymmetric { row, column, difference })
    }

    /// Measures an outcome and notes it; what does not pass is no solution.
    fn attempt(
        &mut self,
        method: LcpMethod,
        outcome: &Outcome,
        reduced: &Reduced,
        warm: bool,
    ) -> LcpSolution {
        let mut z = reduced.expand(&outcome.z, self.problem.size());
        z.iter_mut().for_each(|z| *z *= reduced.unit);
        let mut solution = self.conclude(method, outcome, z);
        self.attempts.push(LcpAttempt { method, status: solution.status, pivots: outcome.pivots, warm });
        solution.attempts.clone_from(&self.attempts);
        solution.pivots = self.attempts.iter().map(|attempt| attempt.pivots).sum();
        solution
    }

    fn conclude(&self, method: LcpMethod, outcome: &Outcome, z: Vec<f64>) -> LcpSolution {
        let w = self.problem.residual(&z, self.options.tolerance);
        let certificate = Certificate::measure(self.problem, &z, &w);
        let passed = certificate.natural_residual <= self.options.tolerance;
        let status = match outcome.status {
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
            shift: 0.0,
        }
    }

    /// Cholesky of the symmetric part on the rows kept, where it may be made after `work` multiplications.
    fn definiteness(&self, work: f64) -> Definiteness {
        let n = self.candidates as f64;
        let wanted = match self.options.definiteness {
            DefinitenessCheck::Always => true,
            DefinitenessCheck::Never => false,
            DefinitenessCheck::Cheap => n * n * n / 6.0 <= work,
        };
        if !wanted {
            return Definiteness::Unknown;
        }
        let kept = Reduced::kept(self.problem);
        // A row left out stays at zero in every solution only if something there is above zero.
        let (m, q) = (self.problem.m, self.problem.q);
        let mut is_kept = vec![false; q.len()];
        kept.iter().for_each(|&i| is_kept[i] = true);
        if (0..q.len()).any(|i| !is_kept[i] && q[i] == 0.0 && m[(i, i)] == 0.0) {
            return Definiteness::Unknown;
        }
        let interrupted = || self.options.is_interrupted();
        let symmetric = build(kept.len(), kept.len(), &interrupted, |j, first, entries| {
            for (entry, &i) in entries.iter_mut().zip(&kept[first..]) {
                *entry = 0.5 * m[(i, kept[j])] + 0.5 * m[(kept[j], i)];
            }
        });
        match Factor::cholesky(symmetric, &interrupted) {
            Ok(_) => Definiteness::PositiveDefinite,
            Err(NoFactor::Singular) => Definiteness::NotPositiveDefinite,
            Err(NoFactor::Interrupted) => Definiteness::Unknown,
        }
    }
}

/// A symmetric matrix as stored, turned if that makes its columns contiguous.
fn contiguous<'a>(reduced: &'a Reduced) -> faer::MatRef<'a, f64> {
    let m = reduced.m();
    if m.try_as_col_major().is_none() && m.transpose().try_as_col_major().is_some() {
        m.transpose()
    } else {
        m
    }
}

fn largest(q: &[f64]) -> f64 {
    let largest = q.iter().fold(0.0, |a: f64, q| a.max(q.abs()));
    if largest > 0.0 { largest } else { 1.0 }
}
