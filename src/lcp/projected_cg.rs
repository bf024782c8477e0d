//! Projected conjugate gradients (Polonsky, Keer 1999, Wear 231, 206-219) for symmetric M.
//!
//! They need only products with M. The diagonal is taken out first (Jacobi), which changes no sign; after
//! each step what became negative is cut off, and unknowns at zero with w < 0 are let in.

use crate::lcp::certificate::nan_max;
use crate::lcp::outcome::Outcome;
use crate::lcp::problem::deficit;
use crate::lcp::solution::LcpStatus;
use crate::lcp::touched_columns::TouchedColumns;

/// Steps after which w is formed anew from z.
const REFRESH_STEPS: usize = 50;
/// Iterations without a smaller residual before the run is given up.
const STALLED_STEPS: usize = 500;

/// Solves on `m`, all its columns touched, from the guess `active`.
pub(super) fn solve(m: &TouchedColumns, active: &[usize], tolerance: f64, budget: usize) -> Outcome {
    let (q, n) = (&m.reduced.q, m.reduced.size());
    let diagonal: Vec<f64> = (0..n).map(|i| m.column(i)[i]).collect();
    let mut outcome = Outcome::zero(LcpStatus::Breakdown, n);
    if diagonal.iter().any(|&m| m <= 0.0) {
        return outcome;
    }
    let deficit = deficit(q);
    let mut iterate = Iterate::new(m, diagonal, active);
    let (mut best, mut best_at) = (f64::INFINITY, 0);
    loop {
        let residual = iterate.natural_residual();
        if residual < best * deficit {
            (best, best_at) = (residual / deficit, outcome.pivots);
            outcome.z.copy_from_slice(&iterate.z);
        }
        let is_small = residual <= tolerance * deficit;
        if is_small && !iterate.is_fresh {
            // Updates of w gather rounding; the last word has M itself.
            iterate.refresh();
            continue;
        }
        let ending = if is_small {
            Some(LcpStatus::Solved)
        } else if (m.reduced.interrupted)() {
            Some(LcpStatus::Interrupted)
        } else if outcome.pivots >= budget {
            Some(LcpStatus::PivotLimit)
        } else if !residual.is_finite() || outcome.pivots > best_at + STALLED_STEPS {
            Some(LcpStatus::Breakdown)
        } else {
            outcome.pivots += 1;
            iterate.step(&mut outcome.work).err()
        };
        if let Some(status) = ending {
            return Outcome { status, ..outcome };
        }
        if outcome.pivots.is_multiple_of(REFRESH_STEPS) {
            iterate.refresh();
        }
    }
}

/// Where the iteration stands.
struct Iterate<'a> {
    m: &'a TouchedColumns<'a>,
    diagonal: Vec<f64>,
    z: Vec<f64>,
    w: Vec<f64>,
    /// Whether w was formed from z, not updated.
    is_fresh: bool,
    direction: Vec<f64>,
    /// Square of the last gradient, to which the next direction is conjugate; zero where it starts anew.
    last_square: f64,
}

impl<'a> Iterate<'a> {
    /// A load on the guess alone, of the size that suits it best.
    fn new(m: &'a TouchedColumns<'a>, diagonal: Vec<f64>, active: &[usize]) -> Self {
        let q = &m.reduced.q;
        let mut z = vec![0.0; q.len()];
        active.iter().for_each(|&i| z[i] = (-q[i]).max(0.0) / diagonal[i]);
        let (w, direction) = (q.clone(), vec![0.0; q.len()]);
        let mut start = Self { m, diagonal, z, w, is_fresh: true, direction, last_square: 0.0 };
        let mut curved = vec![0.0; q.len()];
        start.add_product(&start.z, &mut curved);
        let slope: f64 = q.iter().zip(&start.z).map(|(q, z)| -q * z).sum();
        let curvature: f64 = curved.iter().zip(&start.z).map(|(c, z)| c * z).sum();
        let factor = if curvature > 0.0 && slope > 0.0 { slope / curvature } else { 1.0 };
        start.z.iter_mut().for_each(|z| *z *= factor);
        start.refresh();
        start
    }

    /// `max |min(M_ii z_i, w_i)|`.
    fn natural_residual(&self) -> f64 {
        let rows = self.diagonal.iter().zip(&self.z).zip(&self.w);
        rows.fold(0.0, |worst: f64, ((diagonal, z), w)| nan_max(worst, (diagonal * z).min(*w).abs()))
    }

    fn refresh(&mut self) {
        let mut w = self.m.reduced.q.clone();
        self.add_product(&self.z, &mut w);
        (self.w, self.is_fresh) = (w, true);
    }

    /// Goes to the minimum along the next direction, cuts off what became negative and lets in unknowns with w < 0.
    fn step(&mut self, work: &mut f64) -> Result<(), LcpStatus> {
        let n = self.z.len();
        let square: f64 =
            (0..n).filter(|&i| self.z[i] > 0.0).map(|i| self.w[i].powi(2) / self.diagonal[i]).sum();
        let keep = if self.last_square > 0.0 { square / self.last_square } else { 0.0 };
        for i in 0..n {
            let along =
                if self.z[i] > 0.0 { self.w[i] / self.diagonal[i] + keep * self.direction[i] } else { 0.0 };
            self.direction[i] = along;
        }
        self.last_square = square;
        let mut curved = vec![0.0; n];
        self.add_product(&self.direction, &mut curved);
        *work += (n * self.direction.iter().filter(|&&d| d != 0.0).count()) as f64;
        let slope: f64 = (0..n).map(|i| self.w[i] * self.direction[i]).sum();
        let curvature: f64 = (0..n).map(|i| curved[i] * self.direction[i]).sum();
        if curvature <= 0.0 && slope != 0.0 {
            return Err(LcpStatus::Breakdown);
        }
        let step = if curvature > 0.0 { slope / curvature } else { 1.0 };
        // What z is off the straight step, at the few unknowns that were cut off or let in.
        let mut correction = vec![0.0; n];
        for (i, correction) in correction.iter_mut().enumerate() {
            let z = &mut self.z[i];
            if *z > 0.0 {
                let straight = *z - step * self.direction[i];
                *z = straight.max(0.0);
                *correction = *z - straight;
            } else if self.w[i] < 0.0 {
                *z = -step.abs().min(1.0) * self.w[i] / self.diagonal[i];
                *correction = *z;
                self.last_square = 0.0;
            }
        }
        let mut w = std::mem::take(&mut self.w);
        w.iter_mut().zip(&curved).for_each(|(w, curved)| *w -= step * curved);
        self.add_product(&correction, &mut w);
        (self.w, self.is_fresh) = (w, false);
        Ok(())
    }

    /// `w += M z`.
    fn add_product(&self, z: &[f64], w: &mut [f64]) {
        let active: Vec<usize> = (0..z.len()).filter(|&j| z[j] != 0.0).collect();
        self.m.add_product(&active, z, w);
    }
}
