//! What is left of a problem once the unknowns that can stay at zero are gone.

use faer::{Mat, MatRef};

use super::problem::{Columns, LcpProblem};

/// The problem on the rows that matter, q divided by a power of two near `max(-q)`.
///
/// A row with `q_i >= 0` and no negative entry has `w_i >= 0` whatever `z >= 0` is, so `z_i = 0` solves it: the
/// answer on the other rows, filled with zeros, is an answer to the whole.
pub(super) struct Reduced<'a> {
    /// Rows kept; `None` when all are.
    kept: Option<Vec<usize>>,
    m: Storage<'a>,
    pub(super) q: Vec<f64>,
    /// z and w of the reduced problem are those of the whole divided by this.
    pub(super) unit: f64,
}

enum Storage<'a> {
    Borrowed(Columns<'a>),
    Owned(Mat<f64>),
}

impl<'a> Reduced<'a> {
    pub(super) fn new(problem: &LcpProblem<'a>) -> Self {
        let n = problem.size();
        let (m, q) = (problem.m, problem.q);
        let unit = power_of_two(problem.deficit());
        let keep: Vec<usize> = (0..n).filter(|&i| q[i] < 0.0 || problem.row_min[i] < 0.0).collect();
        // Copying most of M to spare the rest of it would not pay.
        if let Some(columns) = m.try_as_col_major()
            && (keep.len() == n || 4 * keep.len() > 3 * n)
        {
            let q = q.iter().map(|q| q / unit).collect();
            return Self { kept: None, m: Storage::Borrowed(columns), q, unit };
        }
        let m = gather(m, &keep, &keep);
        let q = keep.iter().map(|&i| q[i] / unit).collect();
        Self { kept: (keep.len() < n).then_some(keep), m: Storage::Owned(m), q, unit }
    }

    pub(super) fn size(&self) -> usize {
        self.q.len()
    }

    /// M on the rows kept.
    pub(super) fn columns(&self) -> Columns<'_> {
        match &self.m {
            Storage::Borrowed(columns) => *columns,
            Storage::Owned(m) => {
                m.as_ref().try_as_col_major().expect("an owned matrix has contiguous columns")
            }
        }
    }

    /// Entries of a vector of the whole problem on the rows kept.
    pub(super) fn restrict(&self, whole: &[f64]) -> Vec<f64> {
        match &self.kept {
            None => whole.to_vec(),
            Some(kept) => kept.iter().map(|&i| whole[i]).collect(),
        }
    }

    /// Places in the reduced problem of unknowns of the whole one; those left out are dropped.
    pub(super) fn restrict_set(&self, whole: &[usize]) -> Vec<usize> {
        let mut set: Vec<usize> = match &self.kept {
            None => whole.to_vec(),
            Some(kept) => whole.iter().filter_map(|i| kept.binary_search(i).ok()).collect(),
        };
        set.sort_unstable();
        set
    }

    /// A reduced vector in the whole problem's places, the others zero.
    pub(super) fn expand(&self, reduced: &[f64], size: usize) -> Vec<f64> {
        match &self.kept {
            None => reduced.to_vec(),
            Some(kept) => {
                let mut whole = vec![0.0; size];
                kept.iter().zip(reduced).for_each(|(&i, &value)| whole[i] = value);
                whole
            }
        }
    }
}

/// The block of `m` on `rows` and `columns`.
pub(super) fn gather(m: MatRef<'_, f64>, rows: &[usize], columns: &[usize]) -> Mat<f64> {
    Mat::from_fn(rows.len(), columns.len(), |i, j| m[(rows[i], columns[j])])
}

/// The power of two at or below a positive value; dividing by it rounds nothing.
pub(super) fn power_of_two(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(value.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_bracket_the_value() {
        for value in [1.0, 1.5, 1e-9, 3e300, f64::MIN_POSITIVE, f64::MAX] {
            let power = power_of_two(value);
            assert!(power <= value && value < 2.0 * power || power == 2_f64.powi(1023));
            assert_eq!(1.0 / (1.0 / power), power);
        }
        assert_eq!(power_of_two(5e-324), f64::MIN_POSITIVE);
    }

    #[test]
    fn rows_that_cannot_touch_are_left_out() {
        let m = Mat::from_fn(3, 3, |i, j| if i == j { 2.0 } else { 1.0 });
        let problem = LcpProblem::new(m.as_ref(), &[1.0, -1.0, 0.0]).unwrap();
        let reduced = Reduced::new(&problem);
        assert_eq!(reduced.q, [-1.0]);
        assert_eq!(reduced.expand(&[0.5], 3), [0.0, 0.5, 0.0]);
        assert_eq!(reduced.restrict_set(&[2, 1]), [0]);
    }
}
