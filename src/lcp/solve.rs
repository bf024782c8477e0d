//! One entry for every method: leave out what cannot matter, run, check against the problem as given.

use super::certificate::Certificate;
use super::lemke::{self, Outcome};
use super::options::{LcpMethod, LcpOptions};
use super::problem::{LcpError, LcpProblem};
use super::ray::LcpRay;
use super::reduced::{Reduced, power_of_two};
use super::solution::{LcpAttempt, LcpSolution, LcpStatus};

/// Rays further than this from their own equations are rounding.
const RAY_TOLERANCE: f64 = 1e-7;

/// Solves `w = M z + q`, `w >= 0`, `z >= 0`, `w·z = 0`.
///
/// An answer is called [`LcpStatus::Solved`] only if its natural residual, measured with the M and q given, is
/// at most [`LcpOptions::tolerance`].
///
/// # Errors
/// An option that is out of range or does not fit the problem; no ending is an error.
pub fn solve(problem: &LcpProblem, method: LcpMethod, options: &LcpOptions) -> Result<LcpSolution, LcpError> {
    options.validate(problem.size())?;
    if problem.deficit() == 0.0 {
        let outcome = Outcome { status: LcpStatus::Solved, z: Vec::new(), pivots: 0, ray: None };
        return Ok(Run::new(problem, options).conclude(method, outcome, vec![0.0; problem.size()]));
    }
    let mut run = Run::new(problem, options);
    let reduced = Reduced::new(problem);
    run.candidates = reduced.size();
    match method {
        LcpMethod::Lemke | LcpMethod::Auto => Ok(run.lemke(&reduced)),
    }
}

/// A solve under way.
struct Run<'a> {
    problem: &'a LcpProblem<'a>,
    options: &'a LcpOptions<'a>,
    attempts: Vec<LcpAttempt>,
    candidates: usize,
}

impl<'a> Run<'a> {
    fn new(problem: &'a LcpProblem<'a>, options: &'a LcpOptions<'a>) -> Self {
        Self { problem, options, attempts: Vec::new(), candidates: 0 }
    }

    /// Lemke's method: from the guess if there is one and it leads to an answer, else from nothing.
    fn lemke(&mut self, reduced: &Reduced) -> LcpSolution {
        let method = LcpMethod::Lemke;
        if let Some(guess) = &self.options.initial_active {
            let guess = reduced.restrict_set(guess);
            let warm = lemke::solve_warm(reduced.columns(), &reduced.q, &guess, self.options);
            let z = warm.as_ref().map(|outcome| self.expand(reduced, outcome)).unwrap_or_default();
            if let Some(outcome) = warm {
                let solution = self.attempt(method, outcome, z, true);
                if matches!(solution.status, LcpStatus::Solved | LcpStatus::Interrupted) {
                    return solution;
                }
            }
        }
        let ones = || vec![1.0; self.problem.size()];
        let covering = self.options.covering.clone().unwrap_or_else(ones);
        let unit = power_of_two(covering.iter().copied().fold(0.0, f64::max));
        let d = reduced.restrict(&covering).iter().map(|d| d / unit).collect();
        let mut outcome = lemke::solve_cold(reduced.columns(), &reduced.q, d, self.options);
        let ray = outcome.ray.take().map(|(z, z0)| {
            let z = reduced.expand(&z, self.problem.size());
            LcpRay::verify(self.problem, z, z0 / unit, &covering)
        });
        if ray.as_ref().is_some_and(|ray| ray.residual > RAY_TOLERANCE) {
            outcome.status = LcpStatus::Breakdown;
        }
        let z = self.expand(reduced, &outcome);
        let mut solution = self.attempt(method, outcome, z, false);
        if solution.status == LcpStatus::Ray {
            solution.ray = ray;
        }
        solution
    }

    fn expand(&self, reduced: &Reduced, outcome: &Outcome) -> Vec<f64> {
        let mut z = reduced.expand(&outcome.z, self.problem.size());
        z.iter_mut().for_each(|z| *z *= reduced.unit);
        z
    }

    fn attempt(&mut self, method: LcpMethod, outcome: Outcome, z: Vec<f64>, warm: bool) -> LcpSolution {
        let pivots = outcome.pivots;
        let mut solution = self.conclude(method, outcome, z);
        self.attempts.push(LcpAttempt { method, status: solution.status, pivots, warm });
        solution.attempts.clone_from(&self.attempts);
        solution.pivots = self.attempts.iter().map(|attempt| attempt.pivots).sum();
        solution
    }

    /// Measures an outcome; what does not pass is no solution.
    fn conclude(&self, method: LcpMethod, outcome: Outcome, z: Vec<f64>) -> LcpSolution {
        let w = self.problem.residual(&z);
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
        }
    }
}
