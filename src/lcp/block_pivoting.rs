//! Block principal pivoting (Kostreva 1978; Júdice, Pires 1994, Computers & Operations Research 21, 587-596).
//!
//! A guess F of the active set gives `z_F = -M_FF⁻¹ q_F` and `w = q + M z`; every unknown whose sign is wrong
//! changes sides. While that keeps lowering their number, a handful of factors solve thousands of unknowns;
//! when it does not, one unknown at a time changes (Murty's least-index rule), which ends for P-matrices, if
//! not always soon.

use crate::lcp::certificate::nan_max;
use crate::lcp::options::LcpOptions;
use crate::lcp::outcome::Outcome;
use crate::lcp::problem::{LcpProblem, deficit};
use crate::lcp::reduced::ReducedProblem;
use crate::lcp::solution::LcpStatus;
use crate::lcp::touched_columns::TouchedColumns;
use crate::linalg::block_factor::{BlockFactor, Factor};
use crate::linalg::cholesky::Cholesky;
use crate::linalg::dense::Dense;
use crate::linalg::factor::NoFactor;
use crate::linalg::lu::Lu;

/// Values closer to zero than this count as zero, relative to the largest; larger errors are refined.
pub(super) const ZERO_TOLERANCE: f64 = 64.0 * f64::EPSILON;
/// Errors of a block's equations, relative to its largest value, above which the factor is no use.
const LARGEST_ERROR: f64 = 1e-6;
/// Share of the largest entry by which the outer rows and columns of a symmetric block may differ.
const BLOCK_ASYMMETRY: f64 = 1e-13;

/// Exchanges without progress, blocks or singles, that any problem may take: each has a factor of its own, in whose time
/// Lemke's path makes many pivots.
const FEW_IN_VAIN: usize = 64;

/// Block exchanges without progress that are borne: Júdice and Pires advise at most ten.
pub(super) const EXCHANGE_PATIENCE: usize = 10;

/// What to do where block exchanges do not get on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fallback {
    /// Exchange single unknowns until they end, within the pivot budget.
    Finite,
    /// Give up; something else is waiting.
    None,
    /// Give up, also as soon as a block shows that M is no P-matrix.
    Crash,
}

/// Solves from the guess `active` (ascending), to which `spent` pivots have led.
///
/// After `patience` block exchanges without progress the fallback holds.
pub(super) fn solve(
    problem: &LcpProblem,
    reduced: &ReducedProblem,
    active: &[usize],
    spent: usize,
    (fallback, patience): (Fallback, usize),
    options: &LcpOptions,
) -> Outcome {
    let n = reduced.size();
    let mut outcome = Outcome { pivots: spent, ..Outcome::zero(LcpStatus::Solved, n) };
    let mut is_active = vec![false; n];
    active.iter().for_each(|&i| is_active[i] = true);
    let (mut fewest, mut patience_left) = (usize::MAX, patience);
    let bearable = FEW_IN_VAIN + 20_000 / n.max(1);
    let mut vain_left = if options.max_pivots.is_some() { usize::MAX } else { bearable };
    let mut blocks = Bases::new(problem, reduced);
    outcome.status = loop {
        let set: Vec<usize> = (0..n).filter(|&i| is_active[i]).collect();
        let wrong = match blocks.wrong_signs(&set, fallback == Fallback::Crash, &mut outcome) {
            Err(status) => break status,
            Ok(wrong) if wrong.is_empty() => break LcpStatus::Solved,
            Ok(wrong) => wrong,
        };
        let mut exchanged = &wrong[..];
        if wrong.len() < fewest {
            (fewest, patience_left) = (wrong.len(), patience);
        } else {
            vain_left -= 1;
            if patience_left > 0 {
                patience_left -= 1;
            } else if fallback == Fallback::Finite {
                exchanged = &wrong[..1];
            } else {
                break LcpStatus::Breakdown;
            }
        }
        if outcome.pivots + exchanged.len() > options.pivot_budget(n) || vain_left == 0 {
            break LcpStatus::PivotLimit;
        }
        exchanged.iter().for_each(|&i| is_active[i] = !is_active[i]);
        outcome.pivots += exchanged.len();
    };
    if let (Some(factors), Some(factor)) = (problem.kept_factors, blocks.factor) {
        factors.put(factor);
    }
    outcome.z.iter_mut().for_each(|z| *z = if z.is_finite() { z.max(0.0) } else { 0.0 });
    outcome
}

/// Bases of a problem, and what they give.
struct Bases<'a> {
    reduced: &'a ReducedProblem<'a>,
    columns: TouchedColumns<'a>,
    /// Of the unknowns, ascending, by which factors know them.
    names: Vec<usize>,
    /// `scale_i z_i` counts in units of w.
    scale: Vec<f64>,
    kind: Kind,
    /// Of the last set that needed one of its own.
    factor: Option<BlockFactor>,
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

impl<'a> Bases<'a> {
    fn new(problem: &LcpProblem, reduced: &'a ReducedProblem<'a>) -> Self {
        let scale = (0..reduced.size()).map(|place| problem.diagonal_scale(reduced.index(place))).collect();
        let names: Vec<usize> = (0..reduced.size()).map(|place| problem.name(reduced.index(place))).collect();
        let factor = problem.kept_factors.and_then(|kept| kept.take(&names));
        Self { reduced, columns: TouchedColumns::new(reduced), names, scale, kind: Kind::Open, factor }
    }

    /// Unknowns whose z or w has the wrong sign in the complementary basis of `set`, whose z goes to `outcome`; or
    /// why there is no such basis, which may be that a crash looks for a P-matrix and M is none.
    fn wrong_signs(
        &mut self,
        set: &[usize],
        is_crash: bool,
        outcome: &mut Outcome,
    ) -> Result<Vec<usize>, LcpStatus> {
        let factor = self.factor(set, &mut outcome.work)?;
        // Every principal block of a P-matrix has a positive determinant.
        if is_crash && (self.kind == Kind::Indefinite || !factor.has_positive_determinant()) {
            return Err(LcpStatus::Breakdown);
        }
        let (w, size, error) = self.values(set, &factor, outcome);
        if (self.reduced.interrupted)() {
            return Err(LcpStatus::Interrupted);
        }
        let is_exact = error <= ZERO_TOLERANCE * size && size.is_finite();
        if !is_exact && factor.is_bordered() {
            return self.wrong_signs(set, is_crash, outcome);
        }
        if error > ZERO_TOLERANCE * size && factor.is_symmetric() {
            // The lower triangle does not stand for the block: it is not symmetric after all.
            self.kind = Kind::Nonsymmetric;
            return self.wrong_signs(set, is_crash, outcome);
        }
        self.factor = Some(factor);
        if !size.is_finite() || error > LARGEST_ERROR * size {
            return Err(LcpStatus::Breakdown);
        }
        let mut basic = w;
        set.iter().for_each(|&i| basic[i] = self.scale[i] * outcome.z[i]);
        Ok((0..basic.len()).filter(|&i| basic[i] < -ZERO_TOLERANCE * size).collect())
    }

    /// The block of `set`: by the last factor where they differ little, by Cholesky where it looks symmetric and may be
    /// definite, else by LU.
    ///
    /// Only its outer rows and columns are compared; that the rest is symmetric shows in the residual.
    fn factor(&mut self, set: &[usize], work: &mut f64) -> Result<BlockFactor, NoFactor> {
        let k = set.len() as f64;
        self.columns.touch(set);
        let names: Vec<usize> = set.iter().map(|&place| self.names[place]).collect();
        let block = |rows: &[usize], columns: &[usize]| self.columns.block(rows, columns);
        if let Some(mut known) = self.factor.take()
            && known.change_to(set, &names, block, work, self.reduced.interrupted)?
        {
            return Ok(known);
        }
        if self.kind == Kind::Open {
            let block = self.columns.principal(set, true);
            if looks_symmetric(&block) {
                *work += k * k * k / 3.0;
                match Cholesky::new(block, self.reduced.interrupted) {
                    Ok(factor) => return Ok(BlockFactor::new(&names, Factor::Cholesky(factor))),
                    Err(NoFactor::Interrupted) => return Err(NoFactor::Interrupted),
                    Err(NoFactor::Singular) => self.kind = Kind::Indefinite,
                }
            } else {
                self.kind = Kind::Nonsymmetric;
            }
        }
        *work += 2.0 / 3.0 * k * k * k;
        let factor = Lu::new(self.columns.principal(set, false), self.reduced.interrupted)?;
        Ok(BlockFactor::new(&names, Factor::Lu(factor)))
    }

    /// z, in `outcome`, and w of the complementary basis of `set`; the largest of their values in units of w, and
    /// how far w is from zero on the set.
    fn values(&self, set: &[usize], factor: &BlockFactor, outcome: &mut Outcome) -> (Vec<f64>, f64, f64) {
        let deficit = deficit(&self.reduced.q);
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
            self.columns.add_product(set, z, &mut w);
            outcome.work += 2.0 * set.len() as f64 * (w.len() + set.len()) as f64;
            size = set.iter().fold(deficit, |size, &i| nan_max(size, self.scale[i] * z[i].abs()));
            error = set.iter().fold(0.0, |worst: f64, &i| nan_max(worst, w[i].abs()));
            if error <= ZERO_TOLERANCE * size || (self.reduced.interrupted)() {
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
        let limit = BLOCK_ASYMMETRY * column.iter().fold(0.0, |largest: f64, entry| largest.max(entry.abs()));
        column.iter().enumerate().all(|(i, &entry)| (entry - block.at(j, i)).abs() <= limit)
    })
}

/// Where a press without a guess begins: a smooth obstacle touches where it would overlap by half of the most
/// (a parabolic gap touches there exactly, Johnson 1985, §4.2); for other problems it is as good as any set.
pub(super) fn first_guess(q: &[f64]) -> Vec<usize> {
    let lowest = q.iter().copied().fold(0.0, f64::min);
    (0..q.len()).filter(|&i| q[i] < 0.5 * lowest).collect()
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;
    use crate::lcp::{LcpMethod, solve};
    use crate::linalg::block_factor::KeptFactors;
    use crate::sample::Random;

    #[test]
    fn a_factor_from_another_problem_helps_where_it_holds_and_harms_nowhere() {
        let n = 500;
        let mut random = Random(7);
        let whole = Mat::from_fn(n, n, |i, j| random.signed() + if i == j { (2 * n) as f64 } else { 0.0 });
        let other = &whole + Mat::from_fn(n, n, |i, j| if i == j { 1e-6 * n as f64 } else { 0.0 });
        let kept = KeptFactors::default();
        // The matrix changes under the factor in the third problem, and the unknowns in all.
        for (turn, m) in [&whole, &whole, &other, &other].into_iter().enumerate() {
            let names: Vec<usize> = (0..n).filter(|name| name % 50 != turn).collect();
            let m = Mat::from_fn(names.len(), names.len(), |i, j| m[(names[i], names[j])]);
            let q: Vec<f64> =
                names.iter().map(|&name| if name < 400 { -1.0 } else { 1.0 } + 0.1 * random.next()).collect();
            let problem = LcpProblem::new(m.as_ref(), &q).expect("a valid problem");
            let cold = solve(&problem, &LcpMethod::default(), &LcpOptions::default()).expect("valid options");
            let known = kept.take(&names);
            assert_eq!(known.is_some(), turn > 0);
            known.into_iter().for_each(|factor| kept.put(factor));
            let problem = problem.with_kept_factors(Some(&kept), &names);
            let warm = solve(&problem, &LcpMethod::default(), &LcpOptions::default()).expect("valid options");
            assert_eq!((warm.status, warm.active()), (LcpStatus::Solved, cold.active()));
            let largest = cold.z.iter().copied().fold(0.0, f64::max);
            for (warm, cold) in warm.z.iter().zip(&cold.z) {
                assert!((warm - cold).abs() <= 1e-12 * largest, "problem {turn}: {warm} is not {cold}");
            }
        }
    }
}
