//! One look at all of `M`, row by row or in whatever order it is stored.

use faer::MatRef;
use rayon::prelude::*;

use crate::linalg::factor::Interrupt;
use crate::linalg::kernels::{self, CHUNK_ENTRIES, Extremes, SHARED_WORK};

/// Extremes of every row; `None` when interrupted.
pub(super) fn row_extremes(m: MatRef<f64>, interrupted: Interrupt) -> Option<Extremes> {
    let n = m.nrows();
    let mut found = Extremes::new(n);
    let is_shared = n * n >= 4 * SHARED_WORK;
    let rows = m.transpose().try_as_col_major();
    let columns = if rows.is_some() { None } else { m.try_as_col_major() };
    let lines_at_once = (CHUNK_ENTRIES / n.max(1)).next_multiple_of(32);
    for first in (0..n).step_by(lines_at_once) {
        if first > 0 && interrupted() {
            return None;
        }
        let lines = first..(first + lines_at_once).min(n);
        if let Some(columns) = columns {
            let columns: Vec<&[f64]> = lines.map(|j| columns.col(j).as_slice()).collect();
            found.fold(&columns, if is_shared { 1 } else { n });
            continue;
        }
        let rows_found = found.low[lines.clone()].par_iter_mut().zip(&mut found.high[lines]).enumerate();
        rows_found.with_min_len(if is_shared { 64 } else { n }).for_each(|(i, (low, high))| {
            (*low, *high) = match rows {
                Some(rows) => kernels::extremes(rows.col(first + i).as_slice()),
                None => kernels::extremes(&(0..n).map(|j| m[(first + i, j)]).collect::<Vec<_>>()),
            };
        });
    }
    Some(found)
}
