//! What is left of a problem once the unknowns that can stay at zero are gone.

use faer::MatRef;

use crate::lcp::problem::LcpProblem;
use crate::linalg::dense::Dense;
use crate::linalg::factor::Interrupt;

/// The problem on some of its rows, q divided by a power of two near `max(-q)`.
pub(super) struct ReducedProblem<'a> {
    m: MatRef<'a, f64>,
    /// Rows kept, ascending.
    kept: Vec<usize>,
    pub(super) q: Vec<f64>,
    /// z and w of the reduced problem are those of the whole divided by this.
    pub(super) unit: f64,
    pub(super) interrupted: Interrupt<'a>,
}

impl<'a> ReducedProblem<'a> {
    /// The problem on `rows` (ascending); on all where copying most of M to spare the rest would not pay.
    pub(super) fn on(problem: &LcpProblem<'a>, rows: Vec<usize>, interrupted: Interrupt<'a>) -> Self {
        let unit = power_of_two(problem.deficit());
        let n = problem.size();
        let kept = if 4 * rows.len() > 3 * n { (0..n).collect() } else { rows };
        let q = kept.iter().map(|&i| problem.q[i] / unit).collect();
        Self { m: problem.m, kept, q, unit, interrupted }
    }

    pub(super) fn size(&self) -> usize {
        self.q.len()
    }

    /// Row of the whole problem that stands at `place` here.
    pub(super) fn index(&self, place: usize) -> usize {
        self.kept[place]
    }

    /// M, if all rows are kept.
    pub(super) fn whole(&self) -> Option<MatRef<'a, f64>> {
        (self.m.nrows() == self.size()).then_some(self.m)
    }

    /// A copy of columns of the whole problem's M, on the rows kept; left unfinished when interrupted.
    pub(super) fn gather(&self, columns: &[usize]) -> Dense {
        Dense::gather(self.m, &self.kept, columns, self.interrupted)
    }

    /// Entries of a vector of the whole problem on the rows kept.
    pub(super) fn restrict(&self, whole: &[f64]) -> Vec<f64> {
        self.kept.iter().map(|&i| whole[i]).collect()
    }

    /// Places in the reduced problem of unknowns of the whole one; those left out are dropped.
    pub(super) fn restrict_set(&self, whole: &[usize]) -> Vec<usize> {
        let mut set: Vec<usize> = whole.iter().filter_map(|i| self.kept.binary_search(i).ok()).collect();
        set.sort_unstable();
        set
    }

    /// A reduced vector times `unit` in the whole problem's places, the others zero.
    pub(super) fn expand(&self, reduced: &[f64], unit: f64) -> Vec<f64> {
        let mut whole = vec![0.0; self.m.nrows()];
        self.kept.iter().zip(reduced).for_each(|(&i, &value)| whole[i] = unit * value);
        whole
    }
}

/// Rows that may have to leave zero.
///
/// A row with `q_i >= 0` and no negative entry (`row_min`) has `w_i >= 0` whatever `z >= 0` is, so `z_i = 0` solves
/// it: the answer on the other rows, filled with zeros, is an answer to the whole.
pub(super) fn rows_that_matter(q: &[f64], row_min: &[f64]) -> Vec<usize> {
    (0..q.len()).filter(|&i| q[i] < 0.0 || row_min[i] < 0.0).collect()
}

/// The power of two at or below a positive value; dividing by it rounds nothing.
pub(super) fn power_of_two(value: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(value.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use faer::Mat;

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
        let row_min = &problem.rows(&|| false).expect("finite entries").low;
        let reduced = ReducedProblem::on(&problem, rows_that_matter(&[1.0, -1.0, 0.0], row_min), &|| false);
        assert_eq!(reduced.q, [-1.0]);
        assert_eq!(reduced.expand(&[0.5], 2.0), [0.0, 1.0, 0.0]);
        assert_eq!(reduced.restrict_set(&[2, 1]), [0]);
    }
}
