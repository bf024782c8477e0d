//! One look at all of `M`, row by row or in whatever order it is stored.

use faer::MatRef;
use rayon::prelude::*;

use crate::linalg::factor::Interrupt;
use crate::linalg::kernels::{self, CHUNK, Extremes, SHARED};

/// Columns that one step of the look takes.
const COLUMN_BLOCK: usize = 32;

/// Extremes of every row; `None` when interrupted.
pub(super) fn row_extremes(m: MatRef<f64>, interrupted: Interrupt) -> Option<Extremes> {
    let n = m.nrows();
    let mut found = Extremes::new(n);
    let is_shared = n * n >= 4 * SHARED;
    let rows = m.transpose().try_as_col_major();
    let columns = if rows.is_some() { None } else { m.try_as_col_major() };
    let lines_at_once = (CHUNK / n.max(1)).next_multiple_of(COLUMN_BLOCK);
    for first in (0..n).step_by(lines_at_once) {
        if first > 0 && interrupted() {
            return None;
        }
        let lines = first..(first + lines_at_once).min(n);
        if let Some(columns) = columns {
            let fold = |mut found: Extremes, k: usize| {
                let block = first + k * COLUMN_BLOCK..(first + (k + 1) * COLUMN_BLOCK).min(lines.end);
                found.fold(&block.map(|j| columns.col(j).as_slice()).collect::<Vec<_>>());
                found
            };
            let blocks = lines.len().div_ceil(COLUMN_BLOCK);
            let folds = (0..blocks).into_par_iter();
            let folds = folds.with_min_len(if is_shared { blocks.div_ceil(16) } else { blocks });
            let folds = folds.fold(|| Extremes::new(n), fold);
            found = folds.reduce(|| Extremes::new(n), |a, b| a.merge(&b)).merge(&found);
        } else {
            let (low, high) = (&mut found.low[lines.clone()], &mut found.high[lines.clone()]);
            let parts = low.par_iter_mut().zip(high).zip(&mut found.non_finite[lines]).enumerate();
            let parts = parts.with_min_len(if is_shared { 64 } else { n });
            parts.for_each(|(i, ((low, high), non_finite))| {
                (*low, *high, *non_finite) = match rows {
                    Some(rows) => kernels::extremes(rows.col(first + i).as_slice()),
                    None => kernels::extremes(&(0..n).map(|j| m[(first + i, j)]).collect::<Vec<_>>()),
                };
            });
        }
    }
    Some(found)
}
