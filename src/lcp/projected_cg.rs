//! Projected conjugate gradients (Polonsky, Keer 1999, Wear 231, 206-219) for symmetric M.
//!
//! They need only products with M. The diagonal is taken out first (Jacobi), which changes no sign; after
//! each step what became negative is cut off, and unknowns at zero with w < 0 are let in.

use crate::lcp::certificate::nan_max;
use crate::lcp::options::LcpOptions;
use crate::lcp::outcome::Outcome;
use crate::lcp::solution::LcpStatus;
use crate::lcp::touched_columns::TouchedColumns;

/// Iterations without a smaller residual before the run is given up.
const STALLED: usize = 500;

/// Solves on `m`, all its columns touched, from the guess `active`.
pub(super) fn solve(
    m: &TouchedColumns,
    q: &[f64],
    active: &[usize],
    tolerance: f64,
    options: &LcpOptions,
) -> Outcome {
    let n = q.len();
    let diagonal: Vec<f64> = (0..n).map(|i| m.column(i)[i]).collect();
    let mut outcome = Outcome::zero(LcpStatus::Breakdown, n);
    if diagonal.iter().any(|&m| m <= 0.0) {
        return outcome;
    }
    let budget = options.pivot_budget(n);
    let interrupted = || options.is_interrupted();
    let mut z = start(m, q, &diagonal, active, &interrupted);
    let mut direction = vec![0.0; n];
    let mut curved = vec![0.0; n];
    let (mut conjugate, mut last) = (false, 1.0);
    let (mut best, mut best_at) = (f64::INFINITY, 0);
    let mut w = gap(m, q, &z, &interrupted);
    let mut is_fresh = true;
    loop {
        // Natural residual, by which the best iterate so far is kept.
        let unit = q.iter().fold(0.0, |unit: f64, &q| unit.max(-q));
        let residual = (0..n).fold(0.0, |worst: f64, i| nan_max(worst, (diagonal[i] * z[i]).min(w[i]).abs()));
        if residual < best * unit {
            (best, best_at) = (residual / unit, outcome.pivots);
            outcome.z.copy_from_slice(&z);
        }
        if residual <= tolerance * unit && !is_fresh {
            // Updates of w gather rounding; the last word has M itself.
            w = gap(m, q, &z, &interrupted);
            is_fresh = true;
            continue;
        }
        outcome.status = if residual <= tolerance * unit {
            LcpStatus::Solved
        } else if options.is_interrupted() {
            LcpStatus::Interrupted
        } else if outcome.pivots >= budget {
            LcpStatus::PivotLimit
        } else if !residual.is_finite() || outcome.pivots > best_at + STALLED {
            LcpStatus::Breakdown
        } else {
            LcpStatus::Solved
        };
        if outcome.status != LcpStatus::Solved || residual <= tolerance * unit {
            return outcome;
        }
        outcome.pivots += 1;
        let square: f64 = (0..n).filter(|&i| z[i] > 0.0).map(|i| w[i].powi(2) / diagonal[i]).sum();
        let keep = if conjugate && last > 0.0 { square / last } else { 0.0 };
        last = square;
        for i in 0..n {
            direction[i] = if z[i] > 0.0 { w[i] / diagonal[i] + keep * direction[i] } else { 0.0 };
        }
        curved.fill(0.0);
        add_product(m, &direction, &mut curved, &interrupted);
        outcome.work += (n * direction.iter().filter(|&&d| d != 0.0).count()) as f64;
        let slope: f64 = (0..n).map(|i| w[i] * direction[i]).sum();
        let curvature: f64 = (0..n).map(|i| curved[i] * direction[i]).sum();
        if curvature <= 0.0 && slope != 0.0 {
            outcome.status = LcpStatus::Breakdown;
            return outcome;
        }
        let step = if curvature > 0.0 { slope / curvature } else { 1.0 };
        conjugate = true;
        // What z is off the straight step, at the few unknowns that were cut off or let in.
        let mut correction = vec![0.0; n];
        for i in 0..n {
            if z[i] > 0.0 {
                let straight = z[i] - step * direction[i];
                z[i] = straight.max(0.0);
                correction[i] = z[i] - straight;
            } else if w[i] < 0.0 {
                z[i] = -step.abs().min(1.0) * w[i] / diagonal[i];
                correction[i] = z[i];
                conjugate = false;
            }
        }
        w.iter_mut().zip(&curved).for_each(|(w, curved)| *w -= step * curved);
        add_product(m, &correction, &mut w, &interrupted);
        is_fresh = outcome.pivots.is_multiple_of(50);
        if is_fresh {
            w = gap(m, q, &z, &interrupted);
        }
    }
}

/// A load on the guess alone, of the size that suits it best.
fn start(
    m: &TouchedColumns,
    q: &[f64],
    diagonal: &[f64],
    active: &[usize],
    interrupted: &dyn Fn() -> bool,
) -> Vec<f64> {
    let mut z = vec![0.0; q.len()];
    active.iter().for_each(|&i| z[i] = (-q[i]).max(0.0) / diagonal[i]);
    let mut curved = vec![0.0; q.len()];
    add_product(m, &z, &mut curved, interrupted);
    let slope: f64 = q.iter().zip(&z).map(|(q, z)| -q * z).sum();
    let curvature: f64 = curved.iter().zip(&z).map(|(c, z)| c * z).sum();
    let factor = if curvature > 0.0 && slope > 0.0 { slope / curvature } else { 1.0 };
    z.iter_mut().for_each(|z| *z *= factor);
    z
}

fn gap(m: &TouchedColumns, q: &[f64], z: &[f64], interrupted: &dyn Fn() -> bool) -> Vec<f64> {
    let mut w = q.to_vec();
    add_product(m, z, &mut w, interrupted);
    w
}

/// `w += M z`.
fn add_product(m: &TouchedColumns, z: &[f64], w: &mut [f64], interrupted: &dyn Fn() -> bool) {
    let active: Vec<usize> = (0..z.len()).filter(|&j| z[j] != 0.0).collect();
    m.add_product(&active, z, w, interrupted);
}
