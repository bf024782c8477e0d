//! What is left of a problem once the unknowns that can stay at zero are gone.

use faer::prelude::ReborrowMut;
use faer::{MatMut, MatRef};
use rayon::prelude::*;

use crate::lcp::problem::LcpProblem;
use crate::lcp::product::{add_product, add_product_on};
use crate::linalg::dense::Dense;
use crate::linalg::kernels::SHARED;

/// The problem on some of its rows, q divided by a power of two near `max(-q)`.
pub(super) struct Reduced<'a> {
    /// Rows kept, ascending; `None` when all are.
    kept: Option<Vec<usize>>,
    source: MatRef<'a, f64>,
    /// M on the rows kept, once in one piece.
    block: Option<Block>,
    pub(super) q: Vec<f64>,
    /// z and w of the reduced problem are those of the whole divided by this.
    pub(super) unit: f64,
}

/// A copy of a part of M, in the storage order of M.
struct Block {
    entries: Dense,
    is_turned: bool,
}

impl<'a> Reduced<'a> {
    /// The problem on `rows` (ascending); the whole in place where copying most of M to spare the rest would not
    /// pay.
    pub(super) fn on(problem: &LcpProblem<'a>, rows: Vec<usize>) -> Self {
        let unit = power_of_two(problem.deficit());
        let n = problem.size();
        let kept = (4 * rows.len() <= 3 * n).then_some(rows);
        let q = match &kept {
            None => problem.q.iter().map(|q| q / unit).collect(),
            Some(kept) => kept.iter().map(|&i| problem.q[i] / unit).collect(),
        };
        Self { kept, source: problem.m, block: None, q, unit }
    }

    /// Row of the whole problem that stands at `place` here.
    pub(super) fn index(&self, place: usize) -> usize {
        self.kept.as_ref().map_or(place, |kept| kept[place])
    }

    pub(super) fn size(&self) -> usize {
        self.q.len()
    }

    /// Copies M on the rows kept into one piece, if they are not all; left unfinished when `interrupted`.
    pub(super) fn gather(&mut self, interrupted: &dyn Fn() -> bool) {
        if let (Some(kept), None) = (&self.kept, &self.block) {
            let is_turned = is_by_rows(self.source);
            let source = if is_turned { self.source.transpose() } else { self.source };
            self.block = Some(Block { entries: gather(source, kept, kept, interrupted), is_turned });
        }
    }

    /// M on the rows kept, which must have been gathered.
    pub(super) fn m(&self) -> MatRef<'_, f64> {
        match (&self.kept, &self.block) {
            (None, _) => self.source,
            (Some(_), Some(block)) if block.is_turned => block.entries.as_ref().transpose(),
            (Some(_), Some(block)) => block.entries.as_ref(),
            (Some(_), None) => panic!("invariant: rows kept are gathered before M is used in one piece"),
        }
    }

    /// `w += M z` on the rows kept, from wherever M is at hand.
    pub(super) fn add_product(&self, z: &[f64], w: &mut [f64], interrupted: &dyn Fn() -> bool) {
        match (&self.kept, &self.block) {
            (Some(kept), None) => add_product_on(self.source, kept, z, w, interrupted),
            _ => add_product(self.m(), z, w, interrupted),
        }
    }

    /// The block of M on the places `set`, or, where `stored`, its transpose if that is how M is stored.
    pub(super) fn principal(&self, set: &[usize], stored: bool, interrupted: &dyn Fn() -> bool) -> Dense {
        let m = if stored && is_by_rows(self.source) { self.source.transpose() } else { self.source };
        match &self.kept {
            None => gather(m, set, set, interrupted),
            Some(kept) => {
                let rows: Vec<usize> = set.iter().map(|&place| kept[place]).collect();
                gather(m, &rows, &rows, interrupted)
            }
        }
    }

    /// Column `j` of M on the rows kept, from wherever it is at hand.
    pub(super) fn read_column(&self, j: usize, column: &mut [f64]) {
        let (m, kept) = match (&self.kept, &self.block) {
            (Some(kept), None) => (self.source, Some(kept)),
            _ => (self.m(), None),
        };
        let row_at = |place: usize| kept.map_or(place, |kept| kept[place]);
        let j = row_at(j);
        let entries = column.iter_mut().enumerate();
        if let Some(columns) = m.try_as_col_major() {
            let source = columns.col(j).as_slice();
            entries.for_each(|(place, entry)| *entry = source[row_at(place)]);
        } else if let Some(rows) = m.transpose().try_as_col_major() {
            entries.for_each(|(place, entry)| *entry = rows.col(row_at(place)).as_slice()[j]);
        } else {
            entries.for_each(|(place, entry)| *entry = m[(row_at(place), j)]);
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

/// Rows that may have to leave zero.
///
/// A row with `q_i >= 0` and no negative entry (`row_min`) has `w_i >= 0` whatever `z >= 0` is, so `z_i = 0` solves
/// it: the answer on the other rows, filled with zeros, is an answer to the whole.
pub(super) fn rows_that_matter(q: &[f64], row_min: &[f64]) -> Vec<usize> {
    (0..q.len()).filter(|&i| q[i] < 0.0 || row_min[i] < 0.0).collect()
}

/// Whether M is stored by rows and not by columns.
pub(super) fn is_by_rows(m: MatRef<'_, f64>) -> bool {
    m.try_as_col_major().is_none() && m.transpose().try_as_col_major().is_some()
}

/// The block of `m` on `rows` and `columns`; left unfinished when `interrupted`.
pub(super) fn gather(
    m: MatRef<'_, f64>,
    rows: &[usize],
    columns: &[usize],
    interrupted: &dyn Fn() -> bool,
) -> Dense {
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
) -> Dense {
    const TILE: usize = 32;
    let mut block = Dense::zeros(rows, columns);
    if rows * columns <= TILE * TILE * TILE {
        for j in 0..columns {
            fill(j, 0, block.column_mut(j));
        }
        return block;
    }
    let group = (SHARED / rows.max(1)).next_multiple_of(8 * TILE);
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
        let row_min = &problem.rows(&|| false).unwrap().unwrap().low;
        let reduced = Reduced::on(&problem, rows_that_matter(&[1.0, -1.0, 0.0], row_min));
        assert_eq!(reduced.q, [-1.0]);
        assert_eq!(reduced.expand(&[0.5], 3), [0.0, 0.5, 0.0]);
        assert_eq!(reduced.restrict_set(&[2, 1]), [0]);
    }
}
