//! The path from start to ending.

use crate::lcp::certificate::nan_max;
use crate::lcp::lemke::path::Path;
use crate::lcp::lemke::pivot::{Entering, Leaving};
use crate::lcp::outcome::Outcome;
use crate::lcp::problem::{LcpError, check_vector};
use crate::lcp::reduced::ReducedProblem;
use crate::lcp::solution::LcpStatus;

/// Pivots after which values are recomputed from q.
const REFRESH_PIVOTS: usize = 64;
/// Relative error of a direction above which it is refined, and above which the basis is factored anew.
const REFINE_ERROR: f64 = 1e-12;
const REFACTOR_ERROR: f64 = 1e-8;
/// Perturbations drawn before the run is given up as a breakdown.
const PERTURBATION_DRAWS: u64 = 8;

/// Parameters of Lemke's method.
#[derive(Debug, Clone, PartialEq)]
pub struct LemkeOptions {
    /// Rates of change below `pivot_tol` times the largest never pivot (dimensionless, in (0, 1e-3]).
    pub pivot_tol: f64,
    /// Covering vector (n, > 0); `None` means all ones.
    pub covering: Option<Vec<f64>>,
    /// Whether it may begin from a crash basis (Dirkse, Ferris): block exchanges guess the active set as long as
    /// nothing shows that M is no P-matrix, or from the caller's guess, whatever M is; where they stall, the path begins
    /// from the guess or from nothing. Only without a covering vector of the caller's, and for more than 16 unknowns
    /// that may touch.
    pub crash: bool,
}

impl Default for LemkeOptions {
    fn default() -> Self {
        Self { pivot_tol: 1e-11, covering: None, crash: true }
    }
}

impl LemkeOptions {
    /// Checks every option against a problem of `size` unknowns.
    pub(crate) fn validate(&self, size: usize) -> Result<(), LcpError> {
        if !(self.pivot_tol > 0.0 && self.pivot_tol <= 1e-3) {
            let expected = "a value in (0, 1e-3]";
            return Err(LcpError::OptionOutOfRange { name: "pivot_tol", value: self.pivot_tol, expected });
        }
        let Some(covering) = &self.covering else { return Ok(()) };
        check_vector("covering", covering, size)?;
        match covering.iter().position(|&value| value <= 0.0) {
            None => Ok(()),
            Some(index) => Err(LcpError::CoveringNotPositive { index, value: covering[index] }),
        }
    }
}

/// Solves `w = M z + q` from z = 0 with covering vector `d`.
pub(in crate::lcp) fn solve_cold(
    source: &ReducedProblem,
    d: Vec<f64>,
    pivot_tol: f64,
    budget: usize,
) -> Outcome {
    let mut path = Path::new(source, d, pivot_tol);
    let entering = path.start_cold();
    path.run(entering, budget)
}

/// Solves from the basis of a guessed active set; `None` where that basis is singular.
pub(in crate::lcp) fn solve_warm(
    source: &ReducedProblem,
    active: &[usize],
    pivot_tol: f64,
    budget: usize,
) -> Option<Outcome> {
    let mut path = Path::new(source, vec![0.0; source.size()], pivot_tol);
    match path.start_warm(active)? {
        None => Some(path.finish(LcpStatus::Solved)),
        Some(entering) => Some(path.run(entering, budget)),
    }
}

impl Path<'_> {
    fn run(&mut self, mut entering: Entering, budget: usize) -> Outcome {
        loop {
            if (self.interrupted)() {
                return self.finish(LcpStatus::Interrupted);
            }
            if self.pivots >= budget {
                return self.finish(LcpStatus::PivotLimit);
            }
            if self.stale {
                self.renew();
            } else if self.pivots.is_multiple_of(REFRESH_PIVOTS) {
                self.refresh();
            }
            if !self.visited.insert(self.active_hash ^ entering.hash()) {
                if self.draws >= PERTURBATION_DRAWS {
                    return self.finish(LcpStatus::Breakdown);
                }
                if self.renew() {
                    self.perturb();
                }
            }
            let k = self.columns.len() as f64;
            self.work += k * (self.n as f64 + 2.0 * k);
            let mut leaving = self.try_direction(entering);
            if leaving.is_none() && self.renew() {
                leaving = self.try_direction(entering);
            }
            if let Err(reason) = self.factored {
                return self.finish(reason.into());
            }
            let Some(leaving) = leaving else {
                if !self.dx.iter().chain(&self.dw).all(|rate| rate.is_finite()) {
                    return self.finish(LcpStatus::Breakdown);
                }
                let ray = self.ray(entering);
                return Outcome { ray: Some(ray), ..self.finish(LcpStatus::Ray) };
            };
            self.pivots += 1;
            match self.pivot(entering, leaving) {
                Some(next) => entering = next,
                None => return self.finish(LcpStatus::Solved),
            }
        }
    }

    /// Rates of change along `entering` and the variable that blocks it first.
    fn try_direction(&mut self, entering: Entering) -> Option<Leaving> {
        self.factored.ok()?;
        let mut error = self.direction(entering);
        if error > REFINE_ERROR {
            error = self.refine_direction(entering);
        }
        if error > REFACTOR_ERROR {
            if !self.renew() {
                return None;
            }
            self.direction(entering);
            self.refine_direction(entering);
        }
        for &i in &self.rows {
            self.dw[i] = 0.0;
        }
        self.ratio_test()
    }

    fn ray(&self, entering: Entering) -> (Vec<f64>, f64) {
        let size = self.dx.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
        let clean = |rate: f64| if rate > self.pivot_tol * size { rate / size } else { 0.0 };
        let mut z = vec![0.0; self.n];
        let mut z0 = 0.0;
        for (&c, &rate) in self.columns.iter().zip(&self.dx) {
            if c == self.n { z0 = clean(rate) } else { z[c] = self.entered.scale(c) * clean(rate) }
        }
        if let Entering::Z(r) = entering {
            z[r] = self.entered.scale(r) / size;
        }
        (z, z0)
    }

    /// z in the reduced problem's units: for an answer solved from the final basis and refined, else as it stands.
    fn finish(&mut self, status: LcpStatus) -> Outcome {
        if status == LcpStatus::Solved {
            let (mut x, mut error) = self.clipped();
            if error >= 1e-13 {
                self.refactor();
                let again = self.factored.is_ok().then(|| self.clipped());
                (x, error) = again.filter(|again| again.1 < error).unwrap_or((x, error));
            }
            if error.is_finite() {
                self.x = x;
            }
        }
        let mut z = vec![0.0; self.n];
        for (&c, &x) in self.columns.iter().zip(&self.x) {
            if c != self.n {
                z[c] = self.entered.scale(c) * x.max(0.0);
            }
        }
        Outcome { status, z, pivots: self.pivots, ray: None, work: self.work }
    }

    /// Values solved from q without those below zero, and how far they are from an answer.
    fn clipped(&self) -> (Vec<f64>, f64) {
        let (mut x, mut w) = self.values(self.q);
        x.iter_mut().for_each(|x| *x = x.max(0.0));
        w.copy_from_slice(self.q);
        self.combine(&x, &mut w);
        let error = w.iter().fold(0.0, |error: f64, &w| nan_max(error, -w));
        let basic = self.columns.iter().zip(&x);
        let error = basic.fold(error, |error, (&c, &x)| nan_max(error, w[c].min(x).abs()));
        (x, error)
    }
}
