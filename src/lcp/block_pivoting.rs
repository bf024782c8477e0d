//! Block principal pivoting (Kostreva 1978; Júdice, Pires 1994, Computers & Operations Research 21, 587-596).
//!
//! A guess F of the active set gives `z_F = -M_FF⁻¹ q_F` and `w = q + M z`; every unknown whose sign is wrong
//! changes sides. While that keeps lowering their number, a handful of factors solve thousands of unknowns;
//! when it does not, one unknown at a time changes (Murty's least-index rule), which ends for P-matrices, if
//! not always soon.

use super::certificate::nan_max;
use super::dense::{Factor, NoFactor};
use super::options::LcpOptions;
use super::outcome::Outcome;
use super::problem::add_product;
use super::reduced::{Reduced, gather};
use super::solution::LcpStatus;

/// Block exchanges without progress before single ones take over (Júdice and Pires advise at most ten).
const PATIENCE: usize = 10;
/// Values closer to zero than this count as zero, relative to the largest.
const ZERO: f64 = 64.0 * f64::EPSILON;
/// Error of a block's equations, relative to its largest value, above which its factor is no use.
const ACCURACY: f64 = 1e-6;

/// How long single exchanges may go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fallback {
    /// Until they end, within the pivot budget.
    Finite,
    /// Not at all; something else is waiting.
    None,
}

/// Solves from the guess `active` (ascending); `definite` tries Cholesky while it lasts, for a symmetric M.
pub(super) fn solve(
    reduced: &Reduced,
    active: &[usize],
    mut definite: bool,
    fallback: Fallback,
    options: &LcpOptions,
) -> Outcome {
    let (m, n) = (reduced.m(), reduced.size());
    let budget = options.pivot_budget(n);
    let interrupted = || options.is_interrupted();
    let scale: Vec<f64> = (0..n).map(|i| if m[(i, i)] > 0.0 { m[(i, i)] } else { 1.0 }).collect();
    let mut is_active = vec![false; n];
    active.iter().for_each(|&i| is_active[i] = true);
    let mut outcome = Outcome::zero(LcpStatus::Breakdown, n);
    let (mut fewest, mut patience) = (usize::MAX, PATIENCE);
    let mut singles = if options.max_pivots.is_some() { usize::MAX } else { single_budget(n) };
    loop {
        let set: Vec<usize> = (0..n).filter(|&i| is_active[i]).collect();
        let k = set.len() as f64;
        outcome.work += k * k * k * if definite { 1.0 / 3.0 } else { 2.0 / 3.0 } + 4.0 * k * n as f64;
        let block = gather(m, &set, &set, &interrupted);
        let factor =
            if definite { Factor::cholesky(block, &interrupted) } else { Factor::lu(block, &interrupted) };
        let factor = match factor {
            Err(NoFactor::Singular) if definite => {
                definite = false;
                continue;
            }
            Ok(factor) => factor,
            Err(NoFactor::Interrupted) => return Outcome { status: LcpStatus::Interrupted, ..outcome },
            Err(NoFactor::Singular) => return outcome,
        };
        let (z, w, error) = block_values(reduced, &set, &factor, &interrupted);
        outcome.z = z;
        let z = &outcome.z;
        let size = (0..n).fold(1.0, |size: f64, i| nan_max(size, scale[i] * z[i].abs()));
        if !size.is_finite() || error > ACCURACY * size {
            outcome.z.iter_mut().for_each(|z| *z = if z.is_finite() { z.max(0.0) } else { 0.0 });
            return outcome;
        }
        let zero = ZERO * size;
        let wrong: Vec<usize> =
            (0..n).filter(|&i| if is_active[i] { scale[i] * z[i] < -zero } else { w[i] < -zero }).collect();
        if wrong.is_empty() {
            outcome.z.iter_mut().for_each(|z| *z = z.max(0.0));
            return Outcome { status: LcpStatus::Solved, ..outcome };
        }
        let mut exchanged = &wrong[..];
        if wrong.len() < fewest {
            (fewest, patience) = (wrong.len(), PATIENCE);
        } else if patience > 0 {
            patience -= 1;
        } else if fallback == Fallback::Finite {
            exchanged = &wrong[..1];
        } else {
            return outcome;
        }
        singles -= usize::from(exchanged.len() < wrong.len());
        if outcome.pivots >= budget || singles == 0 {
            outcome.z.iter_mut().for_each(|z| *z = z.max(0.0));
            return Outcome { status: LcpStatus::PivotLimit, ..outcome };
        }
        exchanged.iter().for_each(|&i| is_active[i] = !is_active[i]);
        outcome.pivots += exchanged.len();
    }
}

/// Single exchanges, each with a factor of its own, that are bearable.
fn single_budget(n: usize) -> usize {
    n + 20_000 / n.max(1)
}

/// z and w of the complementary basis of `set`, refined once, and how far w is from zero on it.
fn block_values(
    reduced: &Reduced,
    set: &[usize],
    factor: &Factor,
    interrupted: &dyn Fn() -> bool,
) -> (Vec<f64>, Vec<f64>, f64) {
    let mut z = vec![0.0; reduced.size()];
    let mut w = reduced.q.clone();
    for _ in 0..2 {
        let right: Vec<f64> = set.iter().map(|&i| w[i]).collect();
        for (&i, error) in set.iter().zip(factor.solve(&right)) {
            z[i] -= error;
        }
        w.copy_from_slice(&reduced.q);
        add_product(reduced.m(), &z, &mut w);
        if interrupted() {
            break;
        }
    }
    let error = set.iter().fold(0.0, |worst: f64, &i| nan_max(worst, w[i].abs()));
    (z, w, error)
}

/// Where a press without a guess begins: a smooth obstacle touches where it would overlap by half of the most
/// (a parabolic gap touches there exactly, Johnson 1985, §4.2); for other problems it is as good as any set.
pub(super) fn first_guess(q: &[f64]) -> Vec<usize> {
    let lowest = q.iter().copied().fold(0.0, f64::min);
    (0..q.len()).filter(|&i| q[i] < 0.5 * lowest).collect()
}
