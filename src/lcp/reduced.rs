//! What is left of a problem once the unknowns that can stay at zero are gone.

use faer::prelude::ReborrowMut;
use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use super::problem::{LcpProblem, SHARED};

/// The problem on the rows that matter, q divided by a power of two near `max(-q)`.
///
/// A row with `q_i >= 0` and no negative entry has `w_i >= 0` whatever `z >= 0` is, so `z_i = 0` solves it: the
/// answer on the other rows, filled with zeros, is an answer to the whole.
pub(super) struct Reduced<'a> {
    /// Rows kept; `None` when all are.
    kept: Option<Vec<usize>>,
    storage: Storage<'a>,
    pub(super) q: Vec<f64>,
    /// z and w of the reduced problem are those of the whole divided by this.
    pub(super) unit: f64,
}

enum Storage<'a> {
    Borrowed(MatRef<'a, f64>),
    Owned(Mat<f64>),
}

impl<'a> Reduced<'a> {
    pub(super) fn new(problem: &LcpProblem<'a>, interrupted: &dyn Fn() -> bool) -> Self {
        let n = problem.size();
        let (m, q) = (problem.m, problem.q);
        let unit = power_of_two(problem.deficit());
        let keep = Self::kept(problem);
        // Copying most of M to spare the rest of it would not pay.
        if keep.len() == n || 4 * keep.len() > 3 * n {
            return Self::whole(problem, unit);
        }
        let q = keep.iter().map(|&i| q[i] / unit).collect();
        let m = gather(m, &keep, &keep, interrupted);
        Self { kept: Some(keep), storage: Storage::Owned(m), q, unit }
    }

    /// Rows that may have to leave zero.
    pub(super) fn kept(problem: &LcpProblem) -> Vec<usize> {
        (0..problem.size()).filter(|&i| problem.q[i] < 0.0 || problem.row_min[i] < 0.0).collect()
    }

    /// Row of the whole problem that stands at `place` here.
    pub(super) fn index(&self, place: usize) -> usize {
        self.kept.as_ref().map_or(place, |kept| kept[place])
    }

    /// All rows, in place.
    pub(super) fn whole(problem: &LcpProblem<'a>, unit: f64) -> Self {
        let q = problem.q.iter().map(|q| q / unit).collect();
        Self { kept: None, storage: Storage::Borrowed(problem.m), q, unit }
    }

    pub(super) fn size(&self) -> usize {
        self.q.len()
    }

    /// M on the rows kept.
    pub(super) fn m(&self) -> MatRef<'_, f64> {
        match &self.storage {
            Storage::Borrowed(m) => *m,
            Storage::Owned(m) => m.as_ref(),
        }
    }

    /// The same with contiguous columns, copied if it has none.
    pub(super) fn into_columns(self, interrupted: &dyn Fn() -> bool) -> Self {
        if self.m().try_as_col_major().is_some() {
            return self;
        }
        let all: Vec<usize> = (0..self.size()).collect();
        let storage = Storage::Owned(gather(self.m(), &all, &all, interrupted));
        Self { storage, ..self }
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

/// The block of `m` on `rows` and `columns`; left unfinished when `interrupted`.
pub(super) fn gather(
    m: MatRef<'_, f64>,
    rows: &[usize],
    columns: &[usize],
    interrupted: &dyn Fn() -> bool,
) -> Mat<f64> {
    let source = m.try_as_col_major();
    build(rows.len(), columns.len(), interrupted, |j, first, entries| {
        let rows = &rows[first..first + entries.len()];
        match source {
            Some(source) => {
                let column = source.col(columns[j]).as_slice();
                entries.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = column[i]);
            }
            None => entries.iter_mut().zip(rows).for_each(|(entry, &i)| *entry = m[(i, columns[j])]),
        }
    })
}

/// A matrix made in tiles, so that reading across the storage order does not starve; `fill` is given a column,
/// the first row of a run in it and that run. Left unfinished when `interrupted`.
pub(super) fn build(
    rows: usize,
    columns: usize,
    interrupted: &dyn Fn() -> bool,
    fill: impl Fn(usize, usize, &mut [f64]) + Sync,
) -> Mat<f64> {
    const TILE: usize = 32;
    let group = (SHARED / rows.max(1)).next_multiple_of(8 * TILE);
    let mut block = Mat::zeros(rows, columns);
    let tiles = |first: usize, mut strip: MatMut<'_, f64>| {
        for row in (0..rows).step_by(TILE) {
            for j in 0..strip.ncols() {
                let column = strip.rb_mut().col_mut(j).try_as_col_major_mut();
                let column = column.expect("an owned matrix has contiguous columns").as_slice_mut();
                fill(first + j, row, &mut column[row..(row + TILE).min(rows)]);
            }
        }
    };
    for start in (0..columns).step_by(group) {
        let width = group.min(columns - start);
        let mut part = block.as_mut().subcols_mut(start, width);
        if rows * width < SHARED / 2 {
            for first in (0..width).step_by(TILE) {
                tiles(start + first, part.rb_mut().subcols_mut(first, TILE.min(width - first)));
            }
        } else {
            let strips = part.par_col_chunks_mut(TILE).enumerate();
            strips.for_each(|(k, strip)| tiles(start + k * TILE, strip));
        }
        if columns > group && interrupted() {
            break;
        }
    }
    block
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
        let reduced = Reduced::new(&problem, &|| false);
        assert_eq!(reduced.q, [-1.0]);
        assert_eq!(reduced.expand(&[0.5], 3), [0.0, 0.5, 0.0]);
        assert_eq!(reduced.restrict_set(&[2, 1]), [0]);
    }
}
