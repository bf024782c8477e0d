//! One look at all of `M`, row by row or in whatever order it is stored.

use faer::MatRef;
use rayon::prelude::*;

use crate::linalg::kernels::{self, CHUNK, Extremes, SHARED};

/// Columns that one step of the look takes.
const COLUMN_BLOCK: usize = 32;

/// Smallest entry, largest magnitude and flaw of every row; `None` when interrupted.
pub(crate) fn row_extremes(m: MatRef<'_, f64>, interrupted: &dyn Fn() -> bool) -> Option<Extremes> {
    let n = m.nrows();
    let mut found = Extremes::new(n);
    let parallel = n * n >= 4 * SHARED;
    let lines_at_once = (CHUNK / n.max(1)).next_multiple_of(COLUMN_BLOCK);
    for first in (0..n).step_by(lines_at_once) {
        if first > 0 && interrupted() {
            return None;
        }
        let lines = first..(first + lines_at_once).min(n);
        if let Some(rows) = m.transpose().try_as_col_major() {
            let row = |((i, low), (high, flaw)): ((usize, &mut f64), (&mut f64, &mut f64))| {
                (*low, *high, *flaw) = kernels::extremes(rows.col(first + i).as_slice());
            };
            let (low, high) = (&mut found.low[lines.clone()], &mut found.high[lines.clone()]);
            let flaw = &mut found.flaw[lines];
            if parallel {
                let others = high.par_iter_mut().zip(flaw);
                low.par_iter_mut().enumerate().zip(others).with_min_len(64).for_each(row);
            } else {
                low.iter_mut().enumerate().zip(high.iter_mut().zip(flaw)).for_each(row);
            }
        } else if let Some(columns) = m.try_as_col_major() {
            let fold = |mut found: Extremes, k: usize| {
                let block =
                    lines.start + k * COLUMN_BLOCK..(lines.start + (k + 1) * COLUMN_BLOCK).min(lines.end);
                found.fold(&block.map(|j| columns.col(j).as_slice()).collect::<Vec<_>>());
                found
            };
            let blocks = lines.len().div_ceil(COLUMN_BLOCK);
            if parallel {
                let folds = (0..blocks).into_par_iter().with_min_len(blocks.div_ceil(16));
                let folds = folds.fold(|| Extremes::new(n), fold);
                found = folds.reduce(|| Extremes::new(n), |a, b| a.merge(&b)).merge(&found);
            } else {
                found = (0..blocks).fold(found, fold);
            }
        } else {
            let mut row = vec![0.0; n];
            for i in lines {
                row.iter_mut().enumerate().for_each(|(j, entry)| *entry = m[(i, j)]);
                (found.low[i], found.high[i], found.flaw[i]) = kernels::extremes(&row);
            }
        }
    }
    Some(found)
}

/// Row and column of the first entry by rows that is not finite, and how many there are in the rows that are not
/// without `flaw`; counting ends when interrupted.
pub(crate) fn first_non_finite(
    m: MatRef<'_, f64>,
    flaw: &[f64],
    interrupted: &dyn Fn() -> bool,
) -> Option<(usize, usize, usize)> {
    let n = m.ncols();
    let mut first = None;
    let mut count = 0;
    let flawed = (0..n).filter(|&i| flaw[i] != 0.0);
    for (seen, i) in flawed.enumerate() {
        for j in (0..n).filter(|&j| !m[(i, j)].is_finite()) {
            first.get_or_insert((i, j));
            count += 1;
        }
        if seen % (CHUNK / 8 / n.max(1)).max(1) == 0 && interrupted() {
            break;
        }
    }
    first.map(|(row, column)| (row, column, count))
}
