//! Block principal pivoting (Kostreva 1978; Júdice, Pires 1994, Computers & Operations Research 21, 587-596).
//!
//! A guess F of the active set gives `z_F = -M_FF⁻¹ q_F` and `w = q + M z`; every unknown whose sign is wrong
//! changes sides. While that keeps lowering their number, a handful of factors solve thousands of unknowns;
//! when it does not, one unknown at a time changes (Murty's least-index rule), which ends for P-matrices, if
//! not always soon.

use crate::lcp::certificate::nan_max;
use crate::lcp::options::LcpOptions;
use crate::lcp::outcome::Outcome;
use crate::lcp::reduced::Reduced;
use crate::lcp::solution::LcpStatus;
use crate::lcp::touched_columns::TouchedColumns;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::dense::Dense;
use crate::linalg::factor::NoFactor;
use crate::linalg::lu::Lu;

/// Block exchanges without progress that are borne (Júdice and Pires advise at most ten).
const PATIENCE: usize = 10;
/// The same where a crash basis is looked for, which must cost little when it is not found.
const CRASH_PATIENCE: usize = 2;
/// Values closer to zero than this count as zero, relative to the largest; larger errors are refined.
pub(super) const ZERO: f64 = 64.0 * f64::EPSILON;
/// Errors of a block's equations, relative to its largest value, above which the factor is no use.
const ACCURACY: f64 = 1e-6;
/// Share of the largest entry by which the outer rows and columns of a symmetric block may differ.
const SYMMETRIC: f64 = 1e-13;

/// What to do where block exchanges do not get on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fallback {
    /// Exchange single unknowns until they end, within the pivot budget.
    Finite,
    /// Give up; something else is waiting.
    None,
    /// Give up soon, and as soon as a block shows that M is no P-matrix.
    Crash,
}

/// Solves from the guess `active` (ascending), to which `spent` pivots have led; `scale_i z_i` counts in units of w.
pub(super) fn solve(
    reduced: &Reduced,
    scale: &[f64],
    active: &[usize],
    spent: usize,
    fallback: Fallback,
    options: &LcpOptions,
) -> Outcome {
    let n = reduced.size();
    let budget = options.pivot_budget(n);
    let deficit = reduced.q.iter().fold(0.0, |deficit: f64, q| deficit.max(-q));
    let mut is_active = vec![false; n];
    active.iter().for_each(|&i| is_active[i] = true);
    let mut outcome = Outcome { pivots: spent, ..Outcome::zero(LcpStatus::Breakdown, n) };
    let full_patience = if fallback == Fallback::Crash { CRASH_PATIENCE } else { PATIENCE };
    let (mut fewest, mut patience) = (usize::MAX, full_patience);
    let mut singles = if options.max_pivots.is_some() { usize::MAX } else { single_budget(n) };
    let mut blocks = Blocks { reduced, columns: TouchedColumns::new(reduced), options, kind: Kind::Open };
    loop {
        let set: Vec<usize> = (0..n).filter(|&i| is_active[i]).collect();
        let factor = match blocks.factor(&set, &mut outcome.work) {
            Ok(factor) => factor,
            Err(NoFactor::Interrupted) => return Outcome { status: LcpStatus::Interrupted, ..outcome },
            Err(NoFactor::Singular) => return outcome,
        };
        if fallback == Fallback::Crash
            && !(factor.has_positive_determinant() && blocks.kind != Kind::Indefinite)
        {
            return outcome;
        }
        let (w, size, error) = blocks.values(&set, &factor, scale, deficit, &mut outcome);
        if options.is_interrupted() {
            return Outcome { status: LcpStatus::Interrupted, ..clipped(outcome) };
        }
        if matches!(factor, BlockFactor::Cholesky(_)) && error > ZERO * size {
            // The lower triangle does not stand for the block: it is not symmetric after all.
            blocks.kind = Kind::Nonsymmetric;
            continue;
        }
        if !size.is_finite() || error > ACCURACY * size {
            return clipped(outcome);
        }
        let zero = ZERO * size;
        let z = &outcome.z;
        let wrong: Vec<usize> =
            (0..n).filter(|&i| if is_active[i] { scale[i] * z[i] < -zero } else { w[i] < -zero }).collect();
        if wrong.is_empty() {
            return Outcome { status: LcpStatus::Solved, ..clipped(outcome) };
        }
        let mut exchanged = &wrong[..];
        if wrong.len() < fewest {
            (fewest, patience) = (wrong.len(), full_patience);
        } else if patience > 0 {
            patience -= 1;
        } else if fallback == Fallback::Finite {
            exchanged = &wrong[..1];
        } else {
            return clipped(outcome);
        }
        singles -= usize::from(exchanged.len() < wrong.len());
        if outcome.pivots + exchanged.len() > budget || singles == 0 {
            return Outcome { status: LcpStatus::PivotLimit, ..clipped(outcome) };
        }
        exchanged.iter().for_each(|&i| is_active[i] = !is_active[i]);
        outcome.pivots += exchanged.len();
    }
}

/// Single exchanges, each with a factor of its own, that are bearable.
fn single_budget(n: usize) -> usize {
    n + 20_000 / n.max(1)
}

fn clipped(mut outcome: Outcome) -> Outcome {
    outcome.z.iter_mut().for_each(|z| *z = if z.is_finite() { z.max(0.0) } else { 0.0 });
    outcome
}

/// Factor of a principal block.
enum BlockFactor {
    /// Stands for the lower triangle alone.
    Cholesky(Cholesky),
    Lu(Lu),
}

impl BlockFactor {
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        match self {
            Self::Cholesky(factor) => factor.solve(b),
            Self::Lu(factor) => factor.solve(b),
        }
    }

    /// As is so for every principal block of a P-matrix.
    fn has_positive_determinant(&self) -> bool {
        match self {
            Self::Cholesky(_) => true,
            Self::Lu(factor) => factor.has_positive_determinant(),
        }
    }
}

/// Factors of principal blocks, and what they give.
struct Blocks<'a> {
    reduced: &'a Reduced<'a>,
    columns: TouchedColumns<'a>,
    options: &'a LcpOptions<'a>,
    kind: Kind,
}

/// What the blocks so far have shown of M.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Nothing against M being symmetric and positive definite.
    Open,
    /// M is symmetric, but not definite, hence no P-matrix.
    Indefinite,
    /// M is not symmetric.
    Nonsymmetric,
}

impl Blocks<'_> {
    /// The block of `set`: by Cholesky where it looks symmetric and may be definite, else by LU.
    ///
    /// Only its outer rows and columns are compared; that the rest is symmetric shows in the residual.
    fn factor(&mut self, set: &[usize], work: &mut f64) -> Result<BlockFactor, NoFactor> {
        let interrupted = || self.options.is_interrupted();
        let k = set.len() as f64;
        self.columns.touch(set, &interrupted);
        if self.kind == Kind::Open {
            let block = self.columns.principal(set, true, &interrupted);
            if looks_symmetric(&block) {
                *work += k * k * k / 3.0;
                match Cholesky::new(block, &interrupted) {
                    Ok(factor) => return Ok(BlockFactor::Cholesky(factor)),
                    Err(NoFactor::Interrupted) => return Err(NoFactor::Interrupted),
                    Err(NoFactor::Singular) => self.kind = Kind::Indefinite,
                }
            } else {
                self.kind = Kind::Nonsymmetric;
            }
        }
        *work += 2.0 / 3.0 * k * k * k;
        Lu::new(self.columns.principal(set, false, &interrupted), &interrupted).map(BlockFactor::Lu)
    }

    /// z, in `outcome`, and w of the complementary basis of `set`; the largest of their values in units of w, and
    /// how far w is from zero on the set.
    fn values(
        &self,
        set: &[usize],
        factor: &BlockFactor,
        scale: &[f64],
        deficit: f64,
        outcome: &mut Outcome,
    ) -> (Vec<f64>, f64, f64) {
        let interrupted = || self.options.is_interrupted();
        let z = &mut outcome.z;
        z.fill(0.0);
        let mut w = self.reduced.q.clone();
        let (mut size, mut error) = (deficit, f64::INFINITY);
        for _ in 0..2 {
            let right: Vec<f64> = set.iter().map(|&i| w[i]).collect();
            for (&i, error) in set.iter().zip(factor.solve(&right)) {
                z[i] -= error;
            }
            w.copy_from_slice(&self.reduced.q);
            self.columns.add_product(set, z, &mut w, &interrupted);
            outcome.work += 2.0 * set.len() as f64 * (w.len() + set.len()) as f64;
            size = set.iter().fold(deficit, |size, &i| nan_max(size, scale[i] * z[i].abs()));
            error = set.iter().fold(0.0, |worst: f64, &i| nan_max(worst, w[i].abs()));
            if error <= ZERO * size || interrupted() {
                break;
            }
        }
        (w, size, error)
    }
}

/// Whether the first and the last row and column of a block are the same but for rounding.
fn looks_symmetric(block: &Dense) -> bool {
    let k = block.rows();
    let Some(last) = k.checked_sub(1) else {
        return true;
    };
    [0, last].iter().all(|&j| {
        let column = block.column(j);
        let limit = SYMMETRIC * column.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
        column.iter().enumerate().all(|(i, &entry)| (entry - block.at(j, i)).abs() <= limit)
    })
}

/// Where a press without a guess begins: a smooth obstacle touches where it would overlap by half of the most
/// (a parabolic gap touches there exactly, Johnson 1985, §4.2); for other problems it is as good as any set.
pub(super) fn first_guess(q: &[f64]) -> Vec<usize> {
    let lowest = q.iter().copied().fold(0.0, f64::min);
    (0..q.len()).filter(|&i| q[i] < 0.5 * lowest).collect()
}
