//! The factor of a principal block of M, kept for sets that differ from its own by a few unknowns: also from problem to
//! problem, where their matrices are blocks of one.

use std::sync::{Mutex, MutexGuard};

use faer::linalg::matmul;
use faer::{Accum, MatMut, Par};

use crate::lcp::touched_columns::TouchedColumns;
use crate::linalg::cholesky::Cholesky;
use crate::linalg::dense::Dense;
use crate::linalg::factor::{Interrupt, NoFactor};
use crate::linalg::kernels::add_terms;
use crate::linalg::lu::Lu;

/// Unknowns below which a block is factored anew: its factor costs next to nothing.
const FEW_UNKNOWNS: usize = 256;
/// Share of a set that may change for a border to its factor: with k unknowns 2/8 k³ products in place of 2/3 k³.
const MOST_CHANGED: f64 = 0.125;

/// Factor of the principal block of a set.
pub(super) struct BlockFactor {
    /// Names of the unknowns whose block was factored, ascending.
    set: Vec<usize>,
    factor: Factor,
    border: Option<Bordering>,
}

/// Factors kept from problem to problem, of sets that share no unknown.
#[derive(Default)]
pub struct KeptFactors(Mutex<Vec<BlockFactor>>);

impl std::fmt::Debug for KeptFactors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("KeptFactors").finish_non_exhaustive()
    }
}

impl KeptFactors {
    /// The one of a set that shares unknowns with some others (names, ascending).
    pub(super) fn take(&self, names: &[usize]) -> Option<BlockFactor> {
        let mut kept = self.lock();
        let shares = |known: &BlockFactor| known.set.iter().any(|name| names.binary_search(name).is_ok());
        let at = kept.iter().position(shares)?;
        Some(kept.swap_remove(at))
    }

    pub(super) fn put(&self, factor: BlockFactor) {
        self.lock().push(BlockFactor { border: None, ..factor });
    }

    fn lock(&self) -> MutexGuard<'_, Vec<BlockFactor>> {
        self.0.lock().expect("no thread panics while it holds the lock")
    }
}

pub(super) enum Factor {
    /// Stands for the lower triangle alone.
    Cholesky(Cholesky),
    Lu(Lu),
}

/// What turns the block `K` of a set F into that of another set, F without some unknowns R and with others A:
///
/// ```text
/// [K  B] [z_F]   [b_F]        B = [M_FA  E_R],  C = [M_AF; E_R'],  D = [M_AA  0; 0  0],
/// [C  D] [ y ] = [b_A; 0]     S = D - C K⁻¹ B
/// ```
///
/// where `E_R` are unit columns and `y` is `z_A` and what holds `z_R` at zero. The entries of M between R and A are then
/// multiplied by zero, or in equations that `y` fulfils, and stand as zeros.
struct Bordering {
    /// Names of the other set, ascending.
    set: Vec<usize>,
    /// Places in F of what left it, and in the other set of what joined.
    removed: Vec<usize>,
    added: Vec<usize>,
    /// `M_AF`.
    rows: Dense,
    /// `K⁻¹ B`.
    solved: Dense,
    schur: Lu,
}

impl Factor {
    fn solve(&self, b: &[f64]) -> Vec<f64> {
        match self {
            Self::Cholesky(factor) => factor.solve(b),
            Self::Lu(factor) => factor.solve(b),
        }
    }

    fn solve_in_place(&self, right: MatMut<'_, f64>, interrupted: Interrupt) {
        match self {
            Self::Cholesky(factor) => factor.solve_in_place(right, interrupted),
            Self::Lu(factor) => factor.solve_in_place(right, interrupted),
        }
    }
}

impl BlockFactor {
    pub fn new(set: &[usize], factor: Factor) -> Self {
        Self { set: set.to_vec(), factor, border: None }
    }

    /// Whether it stands for its block by a border, with rounding of two factors.
    pub fn is_bordered(&self) -> bool {
        self.border.is_some()
    }

    /// Whether it stands for the lower triangle alone.
    pub fn is_symmetric(&self) -> bool {
        matches!(self.factor, Factor::Cholesky(_))
    }

    /// Whether the determinant is positive, as that of every principal block of a P-matrix.
    pub fn has_positive_determinant(&self) -> bool {
        let whole = match &self.factor {
            Factor::Cholesky(_) => true,
            Factor::Lu(factor) => factor.has_positive_determinant(),
        };
        let border = self.border.as_ref().is_none_or(|border| {
            // Each pair of a unit row and column turns the sign.
            border.schur.has_positive_determinant() == border.removed.len().is_multiple_of(2)
        });
        whole == border
    }

    /// Lets the factor stand for the block of `set` (places of the columns, all touched) where that costs far less than a
    /// new one; says whether it does. `work` counts multiplications.
    ///
    /// * `names`: of the unknowns in `set`, ascending
    pub fn change_to(
        &mut self,
        set: &[usize],
        names: &[usize],
        columns: &TouchedColumns,
        work: &mut f64,
        interrupted: Interrupt,
    ) -> Result<bool, NoFactor> {
        // Of what stays: its place in F and its unknown.
        let (mut kept, mut kept_unknowns, mut removed) = (Vec::new(), Vec::new(), Vec::new());
        for (place, name) in self.set.iter().enumerate() {
            match names.binary_search(name) {
                Ok(at) => {
                    kept.push(place);
                    kept_unknowns.push(set[at]);
                }
                Err(_) => removed.push(place),
            }
        }
        let is_new = |&place: &usize| self.set.binary_search(&names[place]).is_err();
        let added: Vec<usize> = (0..set.len()).filter(is_new).collect();
        let joining: Vec<usize> = added.iter().map(|&place| set[place]).collect();
        let (size, changed) = (self.set.len(), removed.len() + added.len());
        if size < FEW_UNKNOWNS || changed as f64 > MOST_CHANGED * size as f64 {
            return Ok(false);
        }
        let of_kept = columns.block(&joining, &kept_unknowns);
        let mut rows = Dense::zeros(added.len(), size);
        for (j, &place) in kept.iter().enumerate() {
            rows.column_mut(place).copy_from_slice(of_kept.column(j));
        }
        let corner = columns.block(&joining, &joining);
        let joined = columns.block(&kept_unknowns, &joining);
        let mut solved = Dense::zeros(size, changed);
        for j in 0..added.len() {
            let column = solved.column_mut(j);
            kept.iter().zip(joined.column(j)).for_each(|(&place, &entry)| column[place] = entry);
        }
        removed.iter().enumerate().for_each(|(k, &place)| solved.column_mut(added.len() + k)[place] = 1.0);
        self.factor.solve_in_place(solved.as_mut(), interrupted);
        *work += 2.0 * (size * size * changed) as f64;
        let mut schur = Dense::zeros(changed, changed);
        (0..added.len()).for_each(|j| schur.column_mut(j)[..added.len()].copy_from_slice(corner.column(j)));
        let upper = schur.as_mut().subrows_mut(0, added.len());
        matmul::matmul(upper, Accum::Add, rows.as_ref(), solved.as_ref(), -1.0, Par::Seq);
        for j in 0..changed {
            let held = removed.iter().map(|&place| -solved.column(j)[place]);
            schur.column_mut(j)[added.len()..].iter_mut().zip(held).for_each(|(entry, held)| *entry = held);
        }
        if interrupted() {
            return Err(NoFactor::Interrupted);
        }
        match Lu::new(schur, interrupted) {
            Err(NoFactor::Interrupted) => Err(NoFactor::Interrupted),
            Err(NoFactor::Singular) => Ok(false),
            Ok(schur) => {
                self.border = Some(Bordering { set: names.to_vec(), removed, added, rows, solved, schur });
                Ok(true)
            }
        }
    }

    /// `M_SS x = b` for the set S that it stands for.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let Some(border) = &self.border else { return self.factor.solve(b) };
        let at = |name: &usize| border.set.binary_search(name).map_or(0.0, |place| b[place]);
        let mut own = self.factor.solve(&self.set.iter().map(at).collect::<Vec<_>>());
        let mut rest: Vec<f64> = border.added.iter().map(|&place| b[place]).collect();
        add_terms(&mut rest, own.len(), |k| (border.rows.column(k), -own[k]));
        rest.extend(border.removed.iter().map(|&place| -own[place]));
        let rest = border.schur.solve(&rest);
        add_terms(&mut own, rest.len(), |k| (border.solved.column(k), -rest[k]));
        let mut x = vec![0.0; b.len()];
        border.added.iter().zip(&rest).for_each(|(&place, &value)| x[place] = value);
        for (name, value) in self.set.iter().zip(own) {
            if let Ok(place) = border.set.binary_search(name) {
                x[place] = value;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;
    use crate::lcp::problem::LcpProblem;
    use crate::lcp::reduced::ReducedProblem;
    use crate::lcp::{LcpMethod, LcpOptions, LcpStatus, solve};
    use crate::sample::Random;

    /// A matrix with a dominant diagonal, symmetric where asked for.
    fn dominant(n: usize, is_symmetric: bool) -> Mat<f64> {
        let mut random = Random(7);
        let any = Mat::from_fn(n, n, |_, _| random.signed());
        let own = if is_symmetric { &any + any.transpose() } else { any };
        own + Mat::<f64>::identity(n, n) * (2 * n) as f64
    }

    #[test]
    fn a_border_solves_as_a_factor_of_its_own_and_knows_the_sign_of_the_determinant() {
        let n = 500;
        // Negative on a row that joins later: the determinant of every set with it is negative.
        for (is_symmetric, sign) in [(true, 1.0), (false, 1.0), (false, -1.0)] {
            let mut m = dominant(n, is_symmetric);
            m[(450, 450)] *= sign;
            let q = vec![-1.0; n];
            let problem = LcpProblem::new(m.as_ref(), &q).expect("a valid problem");
            let reduced = ReducedProblem::on(&problem, (0..n).collect(), &|| false);
            let mut columns = TouchedColumns::new(&reduced);
            columns.touch(&(0..n).collect::<Vec<_>>());
            let set: Vec<usize> = (0..400).collect();
            let block = columns.principal(&set, false);
            let factor = match is_symmetric {
                true => Factor::Cholesky(Cholesky::new(block, &|| false).expect("definite")),
                false => Factor::Lu(Lu::new(block, &|| false).expect("regular")),
            };
            let mut factor = BlockFactor::new(&set, factor);
            let wanted = |i: &usize| i % 17 != 3 && *i < 400 || (440..455).contains(i);
            let near: Vec<usize> = (0..n).filter(wanted).collect();
            assert!(factor.change_to(&near, &near, &columns, &mut 0.0, &|| false).expect("not interrupted"));
            assert!(factor.is_bordered());
            assert_eq!(factor.has_positive_determinant(), sign > 0.0);
            let b: Vec<f64> = near.iter().map(|&i| (i % 5) as f64 - 2.0).collect();
            let found = factor.solve(&b);
            for (&i, &b) in near.iter().zip(&b) {
                let product: f64 = near.iter().zip(&found).map(|(&j, x)| m[(i, j)] * x).sum();
                assert!((product - b).abs() < 1e-11, "row {i}: {product} is not {b}");
            }
            let far: Vec<usize> = (0..300).collect();
            assert!(!factor.change_to(&far, &far, &columns, &mut 0.0, &|| false).expect("not interrupted"));
        }
    }

    #[test]
    fn a_factor_from_another_problem_helps_where_it_holds_and_harms_nowhere() {
        let n = 500;
        let whole = dominant(n, false);
        let other = &whole + Mat::from_fn(n, n, |i, j| if i == j { 1e-6 * n as f64 } else { 0.0 });
        let kept = KeptFactors::default();
        let mut random = Random(3);
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
