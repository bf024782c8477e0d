//! Whether a matrix is symmetric.

use rayon::prelude::*;

use crate::lcp::touched_columns::TouchedColumns;
use crate::linalg::dense::TILE;

/// The worst pair of entries of a matrix, all its columns touched: row, column, difference over the largest entry.
///
/// Ends early once a pair is beyond `limit`, or when interrupted.
pub(super) fn asymmetry(columns: &TouchedColumns, limit: f64) -> (usize, usize, f64) {
    let n = columns.reduced.size();
    let strip = |&first_column: &usize| {
        let (mut worst, mut largest) = ((0, 0, 0.0), 0.0_f64);
        for first_row in (first_column..n).step_by(TILE) {
            for j in first_column..(first_column + TILE).min(n) {
                let column = columns.column(j);
                let rows = first_row.max(j)..(first_row + TILE).min(n);
                for (i, &a) in rows.clone().zip(&column[rows]) {
                    let b = columns.column(i)[j];
                    largest = largest.max(a.abs()).max(b.abs());
                    if (a - b).abs() > worst.2 {
                        worst = (j, i, (a - b).abs());
                    }
                }
            }
        }
        (worst, largest)
    };
    let join = |a: ((usize, usize, f64), f64), b: ((usize, usize, f64), f64)| {
        (if b.0.2 > a.0.2 { b.0 } else { a.0 }, a.1.max(b.1))
    };
    let nothing = ((0, 0, 0.0), 0.0);
    let strips: Vec<usize> = (0..n).step_by(TILE).collect();
    let mut found = nothing;
    for group in strips.chunks(16) {
        let each = group.par_iter().with_min_len(if n < 256 { 16 } else { 1 });
        found = join(found, each.map(strip).reduce(|| nothing, join));
        if found.0.2 > limit * found.1 || (columns.reduced.interrupted)() {
            break;
        }
    }
    let ((row, column, difference), largest) = found;
    (row, column, if largest > 0.0 { difference / largest } else { 0.0 })
}
