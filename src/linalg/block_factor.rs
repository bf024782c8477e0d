//! The factor of a principal block of a matrix M, kept for sets that differ from its own by a few unknowns: also from matrix
//! to matrix, where they are blocks of one.

use std::sync::{Mutex, MutexGuard};

use faer::linalg::matmul;
use faer::{Accum, MatMut, Par};

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
pub(crate) struct BlockFactor {
    /// Names of the unknowns whose block was factored, ascending.
    set: Vec<usize>,
    factor: Factor,
    border: Option<Bordering>,
}

/// Factors kept from matrix to matrix, of sets that share no unknown.
#[derive(Default)]
pub struct KeptFactors(Mutex<Vec<BlockFactor>>);

impl std::fmt::Debug for KeptFactors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("KeptFactors").finish_non_exhaustive()
    }
}

impl KeptFactors {
    /// The one of a set that shares unknowns with some others (names, ascending).
    pub(crate) fn take(&self, names: &[usize]) -> Option<BlockFactor> {
        let mut kept = self.lock();
        let shares = |known: &BlockFactor| known.set.iter().any(|name| names.binary_search(name).is_ok());
        let at = kept.iter().position(shares)?;
        Some(kept.swap_remove(at))
    }

    pub(crate) fn put(&self, factor: BlockFactor) {
        self.lock().push(BlockFactor { border: None, ..factor });
    }

    fn lock(&self) -> MutexGuard<'_, Vec<BlockFactor>> {
        self.0.lock().expect("no thread panics while it holds the lock")
    }
}

pub(crate) enum Factor {
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

    /// Lets the factor stand for the block of `set` (places in M) where that costs far less than a new one; says whether it
    /// does. `work` counts multiplications.
    ///
    /// * `names`: of the unknowns in `set`, ascending
    /// * `block`: of M on some of `set`, rows and columns
    pub fn change_to(
        &mut self,
        set: &[usize],
        names: &[usize],
        block: impl Fn(&[usize], &[usize]) -> Dense,
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
        let of_kept = block(&joining, &kept_unknowns);
        let mut rows = Dense::zeros(added.len(), size);
        for (j, &place) in kept.iter().enumerate() {
            rows.column_mut(place).copy_from_slice(of_kept.column(j));
        }
        let corner = block(&joining, &joining);
        let joined = block(&kept_unknowns, &joining);
        let mut solved = Dense::zeros(size, changed);
        for j in 0..added.len() {
            let column = solved.column_mut(j);
            kept.iter().zip(joined.column(j)).for_each(|(&place, &entry)| column[place] = entry);
        }
        removed.iter().enumerate().for_each(|(k, &place)| solved.column_mut(added.len() + k)[place] = 1.0);
        self.factor.solve_in_place(solved.as_mut(), interrupted);
        *work += 2.0 * (size * size * changed) as f64;
        let schur = schur_complement(&corner, &rows, &solved, &removed);
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

/// Of the border: `corner - rows · solved` for what was added, the held unknowns of `solved` for what was `removed`.
fn schur_complement(corner: &Dense, rows: &Dense, solved: &Dense, removed: &[usize]) -> Dense {
    let (added, changed) = (corner.rows(), corner.rows() + removed.len());
    let mut schur = Dense::zeros(changed, changed);
    (0..added).for_each(|j| schur.column_mut(j)[..added].copy_from_slice(corner.column(j)));
    let upper = schur.as_mut().subrows_mut(0, added);
    matmul::matmul(upper, Accum::Add, rows.as_ref(), solved.as_ref(), -1.0, Par::Seq);
    for j in 0..changed {
        let held = removed.iter().map(|&place| -solved.column(j)[place]);
        schur.column_mut(j)[added..].iter_mut().zip(held).for_each(|(entry, held)| *entry = held);
    }
    schur
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;
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
            let block =
                |rows: &[usize], columns: &[usize]| Dense::gather(m.as_ref(), rows, columns, &|| false);
            let set: Vec<usize> = (0..400).collect();
            let own = block(&set, &set);
            let factor = if is_symmetric {
                Factor::Cholesky(Cholesky::new(own, &|| false).expect("definite"))
            } else {
                Factor::Lu(Lu::new(own, &|| false).expect("regular"))
            };
            let mut factor = BlockFactor::new(&set, factor);
            let wanted = |i: &usize| i % 17 != 3 && *i < 400 || (440..455).contains(i);
            let near: Vec<usize> = (0..n).filter(wanted).collect();
            assert!(factor.change_to(&near, &near, block, &mut 0.0, &|| false).expect("not interrupted"));
            assert!(factor.is_bordered());
            assert_eq!(factor.has_positive_determinant(), sign > 0.0);
            let b: Vec<f64> = near.iter().map(|&i| (i % 5) as f64 - 2.0).collect();
            let found = factor.solve(&b);
            for (&i, &b) in near.iter().zip(&b) {
                let product: f64 = near.iter().zip(&found).map(|(&j, x)| m[(i, j)] * x).sum();
                assert!((product - b).abs() < 1e-11, "row {i}: {product} is not {b}");
            }
            let far: Vec<usize> = (0..300).collect();
            assert!(!factor.change_to(&far, &far, block, &mut 0.0, &|| false).expect("not interrupted"));
        }
    }
}
