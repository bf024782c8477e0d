//! The problem as given, and what a look at all of `M` learns about its rows.

use std::sync::OnceLock;

use faer::MatRef;

use crate::lcp::row_extremes::row_extremes;
use crate::linalg::block_factor::KeptFactors;
use crate::linalg::definiteness::Definiteness;
use crate::linalg::factor::Interrupt;
use crate::linalg::kernels::Extremes;

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
    /// An entry of M that a solve reads is infinite or not a number.
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
         of the largest entry (limit 1e-10); use `method=\"lemke\"` or \
         `method=\"block_pivoting\"`; a half-space and a layer have a symmetric one with `discretization=\"galerkin\"`"
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

/// What ends a solve before there is an outcome.
#[derive(Debug)]
pub(super) enum Halt {
    Interrupted,
    Rejected(LcpError),
}

impl From<LcpError> for Halt {
    fn from(error: LcpError) -> Self {
        Self::Rejected(error)
    }
}

/// `w = M z + q` with `w >= 0`, `z >= 0`, `w·z = 0`, shape and q checked.
///
/// M may be stored by columns, by rows or with any strides; it is neither copied nor read here.
#[derive(Debug, Clone)]
pub struct LcpProblem<'a> {
    pub(super) m: MatRef<'a, f64>,
    pub(super) q: &'a [f64],
    pub(super) known_p_matrix: bool,
    pub(super) known_definiteness: Definiteness,
    /// Factors of other blocks of the matrix that M is a block of.
    pub(super) kept_factors: Option<&'a KeptFactors>,
    /// Of the unknowns in that matrix, ascending.
    names: Option<&'a [usize]>,
    diagonal: OnceLock<Vec<f64>>,
    /// What is known of the rows of M, once all of it has been looked at.
    extremes: OnceLock<Extremes>,
}

impl<'a> LcpProblem<'a> {
    /// Checks the shape of `m` (n × n) and all of `q` (n); no entry of M is read.
    ///
    /// # Errors
    /// [`LcpError::NotSquare`], [`LcpError::LengthMismatch`], [`LcpError::NonFiniteVector`].
    pub fn new(m: MatRef<'a, f64>, q: &'a [f64]) -> Result<Self, LcpError> {
        let n = m.nrows();
        if m.ncols() != n {
            return Err(LcpError::NotSquare { rows: n, columns: m.ncols() });
        }
        check_vector("q", q, n)?;
        Ok(Self {
            m,
            q,
            known_p_matrix: false,
            known_definiteness: Definiteness::Unknown,
            kept_factors: None,
            names: None,
            diagonal: OnceLock::new(),
            extremes: OnceLock::new(),
        })
    }

    /// States that every principal minor of M is positive, so that the solution exists and is unique.
    ///
    /// The caller's word is taken and reported in the certificate. [`LcpMethod::Auto`](crate::lcp::LcpMethod::Auto) then
    /// begins with block pivoting at any size; the one solution is the same, to rounding.
    #[must_use]
    pub fn with_known_p_matrix(mut self) -> Self {
        self.known_p_matrix = true;
        self
    }

    /// States what is known of M, so that no solve examines it.
    #[must_use]
    pub(crate) fn with_known_definiteness(mut self, definiteness: Definiteness) -> Self {
        self.known_definiteness = definiteness;
        self
    }

    /// States that M is a block of the matrix that some factors are of.
    ///
    /// * `names`: (n,) of the unknowns in that matrix, ascending
    #[must_use]
    pub(crate) fn with_kept_factors(mut self, kept: Option<&'a KeptFactors>, names: &'a [usize]) -> Self {
        (self.kept_factors, self.names) = (kept, Some(names));
        self
    }

    /// What factors know an unknown by.
    pub(super) fn name(&self, unknown: usize) -> usize {
        self.names.map_or(unknown, |names| names[unknown])
    }

    /// Whether the caller stated what would be examined.
    pub(super) fn is_known(&self) -> bool {
        self.known_p_matrix || self.known_definiteness != Definiteness::Unknown
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.q.len()
    }

    /// `max(-q, 0)`, the length by which residuals are divided.
    pub fn deficit(&self) -> f64 {
        deficit(self.q)
    }

    /// Smallest entry and largest magnitude of each row; the first call looks at every entry of M.
    ///
    /// # Errors
    /// [`LcpError::NonFiniteMatrix`], with the first such entry by rows.
    pub(super) fn rows(&self, interrupted: Interrupt) -> Result<&Extremes, Halt> {
        if let Some(extremes) = self.extremes.get() {
            return Ok(extremes);
        }
        let found = row_extremes(self.m, interrupted).ok_or(Halt::Interrupted)?;
        let n = self.size();
        let rows = (0..n).filter(|&i| found.high[i].is_nan());
        let mut entries =
            rows.flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&entry| !self.m[entry].is_finite());
        if let Some((row, column)) = entries.next() {
            let (value, count) = (self.m[(row, column)], 1 + entries.count());
            return Err(LcpError::NonFiniteMatrix { row, column, value, count }.into());
        }
        Ok(self.extremes.get_or_init(|| found))
    }

    /// The same, if all of M has been looked at already.
    pub(super) fn known_rows(&self) -> Option<&Extremes> {
        self.extremes.get()
    }

    /// Diagonal of M (n), read at the first call.
    pub(super) fn diagonal(&self) -> &[f64] {
        self.diagonal.get_or_init(|| (0..self.size()).map(|i| self.m[(i, i)]).collect())
    }

    pub(super) fn has_positive_diagonal(&self) -> bool {
        self.diagonal().iter().all(|&entry| entry > 0.0 && entry.is_finite())
    }

    /// Unit in which `z_i` counts in row i: the diagonal where positive, else the row's largest magnitude.
    pub(super) fn diagonal_scale(&self, row: usize) -> f64 {
        let diagonal = self.diagonal()[row];
        match self.extremes.get() {
            _ if diagonal > 0.0 => diagonal,
            Some(extremes) => extremes.high[row],
            None => (0..self.size()).fold(0.0, |largest: f64, j| largest.max(self.m[(row, j)].abs())),
        }
    }

    /// The most by which an unknown moves any w; 0 of one that is not above zero.
    pub(super) fn largest_effect(&self, column: usize, z: f64) -> f64 {
        if z > 0.0 {
            (0..self.size()).fold(0.0, |largest: f64, row| largest.max((self.m[(row, column)] * z).abs()))
        } else {
            0.0
        }
    }

    /// An unknown beside its own w: `M_ii z_i`, or where that is the smaller of both, the most by which it moves any w.
    ///
    /// A tiny diagonal would otherwise take a z for none that carries other rows.
    pub(super) fn force_beside(&self, i: usize, z: f64, w: f64) -> f64 {
        let own = if z > 0.0 { self.diagonal_scale(i) * z } else { 0.0 };
        if own < w { own.max(self.largest_effect(i, z)) } else { own }
    }
}

/// `max(-q, 0)`.
pub(super) fn deficit(q: &[f64]) -> f64 {
    q.iter().fold(0.0, |deficit: f64, &q| deficit.max(-q))
}

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
