//! The problem as given, checked once, and what that check learned about the rows of `M`.

use faer::{ContiguousFwd, MatRef};
use rayon::prelude::*;

use super::kernels::{self, Extremes};

/// Why a problem or its options were rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LcpError {
    /// M is not square.
    #[error("M must be square, but it has {rows} rows and {columns} columns")]
    NotSquare {
        /// Rows of M.
        rows: usize,
        /// Columns of M.
        columns: usize,
    },
    /// A vector is not as long as the problem.
    #[error("{name} has {found} entries, but M has {expected} rows")]
    LengthMismatch {
        /// The vector at fault.
        name: &'static str,
        /// Its length.
        found: usize,
        /// Number of rows of M.
        expected: usize,
    },
    /// An entry of M is infinite or not a number.
    #[error("M[{row}, {column}] is {value}; {count} entries of M are not finite")]
    NonFiniteMatrix {
        /// Row of the first such entry.
        row: usize,
        /// Its column.
        column: usize,
        /// Its value.
        value: f64,
        /// Number of such entries.
        count: usize,
    },
    /// An entry of a vector is infinite or not a number.
    #[error("{name}[{index}] is {value}; {count} of its entries are not finite")]
    NonFiniteVector {
        /// The vector at fault.
        name: &'static str,
        /// The first such entry.
        index: usize,
        /// Its value.
        value: f64,
        /// Number of such entries.
        count: usize,
    },
    /// An entry of the covering vector is not above zero.
    #[error("covering[{index}] is {value}, expected a value above 0")]
    CoveringNotPositive {
        /// The first such entry.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The guessed active set names an unknown that does not exist, or one twice.
    #[error("initial_active[{position}] is {index}, expected distinct unknowns below {size}")]
    InitialActive {
        /// Place in the guess.
        position: usize,
        /// What stands there.
        index: usize,
        /// Number of unknowns.
        size: usize,
    },
    /// An option is out of its range.
    #[error("{name} is {value}, expected {expected}")]
    OptionOutOfRange {
        /// The option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would do.
        expected: &'static str,
    },
    /// Projected conjugate gradients were asked for, but M is not symmetric.
    #[error(
        "projected_cg needs a symmetric M, but M[{row}, {column}] and M[{column}, {row}] differ by {difference:e} \
         of the largest entry (limit 1e-10); use lemke or block_pivoting"
    )]
    NotSymmetric {
        /// Row of the worst pair.
        row: usize,
        /// Its column.
        column: usize,
        /// Their difference divided by the largest entry of M.
        difference: f64,
    },
}

/// `w = M z + q` with `w >= 0`, `z >= 0`, `w·z = 0`, shape and values checked.
///
/// M may be stored by columns (best), by rows or with any strides; it is not copied here.
#[derive(Debug, Clone)]
pub struct LcpProblem<'a> {
    pub(super) m: MatRef<'a, f64>,
    pub(super) q: &'a [f64],
    /// Smallest entry of each row.
    pub(super) row_min: Vec<f64>,
    /// Largest magnitude of each row.
    pub(super) row_scale: Vec<f64>,
    pub(super) known_p_matrix: bool,
}

impl<'a> LcpProblem<'a> {
    /// Checks `m` (n × n) and `q` (n); one pass over M.
    ///
    /// # Errors
    /// [`LcpError::NotSquare`], [`LcpError::LengthMismatch`], [`LcpError::NonFiniteMatrix`],
    /// [`LcpError::NonFiniteVector`].
    pub fn new(m: MatRef<'a, f64>, q: &'a [f64]) -> Result<Self, LcpError> {
        let n = m.nrows();
        if m.ncols() != n {
            return Err(LcpError::NotSquare { rows: n, columns: m.ncols() });
        }
        check_vector("q", q, n)?;
        let Extremes { low, high, flaw } = row_extremes(m);
        if flaw.iter().any(|&flaw| flaw != 0.0) {
            return Err(first_non_finite(m));
        }
        let (row_min, row_scale) = (low, high);
        Ok(Self { m, q, row_min, row_scale, known_p_matrix: false })
    }

    /// States that every principal minor of M is positive, so that the solution exists and is unique.
    ///
    /// The caller's word is taken: it is reported in the certificate and changes no answer.
    #[must_use]
    pub fn with_known_p_matrix(mut self) -> Self {
        self.known_p_matrix = true;
        self
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.q.len()
    }

    /// M as given.
    pub fn matrix(&self) -> MatRef<'a, f64> {
        self.m
    }

    /// q as given.
    pub fn vector(&self) -> &'a [f64] {
        self.q
    }

    /// `max(-q, 0)`, the length by which residuals are divided.
    pub fn deficit(&self) -> f64 {
        self.q.iter().fold(0.0, |deficit: f64, &q| deficit.max(-q))
    }

    /// Unit in which `z_i` counts in row i: the diagonal where positive, else the row's largest magnitude.
    pub(super) fn diagonal_scale(&self, row: usize) -> f64 {
        let diagonal = self.m[(row, row)];
        if diagonal > 0.0 { diagonal } else { self.row_scale[row] }
    }

    /// `M z + q`, with errors far below `tolerance · max(-q)`: where rounding could come near, with twice the digits.
    ///
    /// A huge z on singular columns would otherwise look like an answer once its terms cancel to zero.
    pub(super) fn residual(&self, z: &[f64], tolerance: f64) -> Vec<f64> {
        let mut w = self.q.to_vec();
        let largest = self.row_scale.iter().copied().fold(0.0, f64::max);
        let terms = z.iter().map(|z| z.abs()).sum::<f64>() * largest + self.deficit();
        if terms * f64::EPSILON <= 0.01 * tolerance * self.deficit() {
            add_product(self.m, z, &mut w);
            return w;
        }
        let mut tail = vec![0.0; w.len()];
        let mut column = tail.clone();
        for j in (0..z.len()).filter(|&j| z[j] != 0.0) {
            column.iter_mut().enumerate().for_each(|(i, entry)| *entry = self.m[(i, j)]);
            kernels::add_column_compensated(&mut w, &mut tail, &column, z[j]);
        }
        w.iter_mut().zip(tail).for_each(|(w, tail)| *w += tail);
        w
    }
}

/// `w += M z`, with the columns where z is not zero alone; equal to the bit for any number of threads.
pub(super) fn add_product(m: MatRef<'_, f64>, z: &[f64], w: &mut [f64]) {
    let active: Vec<usize> = (0..z.len()).filter(|&j| z[j] != 0.0).collect();
    let parallel = w.len() * active.len() > SHARED;
    let rows_each = row_block(w.len());
    if let Some(columns) = m.try_as_col_major() {
        let block = |(k, part): (usize, &mut [f64])| {
            let rows = k * rows_each..k * rows_each + part.len();
            let term = |&j: &usize| (&columns.col(j).as_slice()[rows.clone()], z[j]);
            kernels::add_columns(part, &active.iter().map(term).collect::<Vec<_>>());
        };
        if parallel {
            w.par_chunks_mut(rows_each).enumerate().for_each(block);
        } else {
            w.chunks_mut(rows_each).enumerate().for_each(block);
        }
        return;
    }
    let rows = m.transpose().try_as_col_major();
    let row = |(i, w): (usize, &mut f64)| {
        *w += match rows {
            // Reading past zeros in order beats picking the others out of most of a row.
            Some(rows) if 4 * active.len() > z.len() => kernels::inner_product(rows.col(i).as_slice(), z),
            _ => active.iter().map(|&j| m[(i, j)] * z[j]).sum::<f64>(),
        };
    };
    if parallel {
        w.par_iter_mut().enumerate().for_each(row);
    } else {
        w.iter_mut().enumerate().for_each(row);
    }
}

/// Columns that one step of the check takes.
const COLUMN_BLOCK: usize = 32;
/// Multiplications from which a product is worth sharing among threads.
pub(super) const SHARED: usize = 1 << 18;

/// Rows that one task of a shared product takes.
pub(super) fn row_block(rows: usize) -> usize {
    rows.div_ceil(8).max(256)
}

/// A matrix whose columns are contiguous.
pub(super) type Columns<'a> = MatRef<'a, f64, usize, usize, ContiguousFwd>;

/// Checks the length of a vector and that its entries are finite.
pub(super) fn check_vector(name: &'static str, vector: &[f64], expected: usize) -> Result<(), LcpError> {
    if vector.len() != expected {
        return Err(LcpError::LengthMismatch { name, found: vector.len(), expected });
    }
    match vector.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(LcpError::NonFiniteVector {
            name,
            index,
            value: vector[index],
            count: vector.iter().filter(|value| !value.is_finite()).count(),
        }),
    }
}

fn row_extremes(m: MatRef<'_, f64>) -> Extremes {
    let n = m.nrows();
    let mut found = Extremes::new(n);
    let parallel = n * n >= 4 * SHARED;
    if let Some(rows) = m.transpose().try_as_col_major() {
        let row = |((i, low), (high, flaw)): ((usize, &mut f64), (&mut f64, &mut f64))| {
            (*low, *high, *flaw) = kernels::extremes(rows.col(i).as_slice());
        };
        let Extremes { low, high, flaw } = &mut found;
        if parallel {
            let others = high.par_iter_mut().zip(flaw);
            low.par_iter_mut().enumerate().zip(others).with_min_len(64).for_each(row);
        } else {
            low.iter_mut().enumerate().zip(high.iter_mut().zip(flaw)).for_each(row);
        }
    } else if let Some(columns) = m.try_as_col_major() {
        let fold = |mut found: Extremes, k: usize| {
            let block = k * COLUMN_BLOCK..((k + 1) * COLUMN_BLOCK).min(n);
            found.fold(&block.map(|j| columns.col(j).as_slice()).collect::<Vec<_>>());
            found
        };
        let blocks = n.div_ceil(COLUMN_BLOCK);
        if !parallel {
            return (0..blocks).fold(found, fold);
        }
        let folds = (0..blocks).into_par_iter().with_min_len(blocks.div_ceil(16));
        let folds = folds.fold(|| Extremes::new(n), fold);
        return folds.reduce(|| Extremes::new(n), |found, other| found.merge(&other));
    } else {
        for i in 0..n {
            let row: Vec<f64> = (0..n).map(|j| m[(i, j)]).collect();
            (found.low[i], found.high[i], found.flaw[i]) = kernels::extremes(&row);
        }
    }
    found
}

fn first_non_finite(m: MatRef<'_, f64>) -> LcpError {
    let mut first = None;
    let mut count = 0;
    for i in 0..m.nrows() {
        for j in 0..m.ncols() {
            if !m[(i, j)].is_finite() {
                first.get_or_insert((i, j));
                count += 1;
            }
        }
    }
    let (row, column) = first.expect("an entry that is not finite was seen");
    LcpError::NonFiniteMatrix { row, column, value: m[(row, column)], count }
}
