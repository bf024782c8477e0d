//! Products with `M`, of the columns alone where the factor is not zero.
//!
//! Rows are handled in blocks that depend on no number of threads, so results are equal to the bit for any;
//! between chunks the interrupt is asked, and what it stops is left unfinished.

use faer::{ContiguousFwd, MatRef};
use rayon::prelude::*;

use crate::lcp::certificate::nan_max;
use crate::lcp::eights::Eights;
use crate::lcp::problem::LcpProblem;
use crate::linalg::kernels::{self, CHUNK, SHARED, row_block};

/// Rows that a pass takes at a time, so that what it adds to stays in the nearest cache.
const ROWS: usize = 1024;
/// Rows of a block of M that stays in the nearest cache whichever way it is stored.
const TILE: usize = 64;
/// Share of the tolerance that rounding may come near before a product is formed with twice the digits.
const MARGIN: f64 = 0.01;

/// `w += M z`.
pub(super) fn add_product(m: MatRef<'_, f64>, z: &[f64], w: &mut [f64], interrupted: &dyn Fn() -> bool) {
    let active = Active::new(z, None);
    match m.try_as_col_major() {
        Some(columns) => {
            in_row_blocks(w, active.len(), interrupted, |first, part| {
                let height = part.len();
                let term = |k: usize| {
                    (&columns.col(active.indices[k]).as_slice()[first..][..height], active.values[k])
                };
                kernels::add_terms(part, active.len(), term);
                0.0
            });
        }
        None => _ = add_rows(m, None, &active, w, interrupted),
    }
}

/// `w += M z` on the rows and columns `kept` of M alone.
pub(super) fn add_product_on(
    m: MatRef<'_, f64>,
    kept: &[usize],
    z: &[f64],
    w: &mut [f64],
    interrupted: &dyn Fn() -> bool,
) {
    let active = Active::new(z, Some(kept));
    let Some(columns) = m.try_as_col_major().filter(|columns| columns.nrows() >= 8) else {
        add_rows(m, Some(kept), &active, w, interrupted);
        return;
    };
    in_row_blocks(w, active.len(), interrupted, |first, part| {
        let rows = &kept[first..][..part.len()];
        let cover = Eights::cover(rows, part, columns.nrows());
        let sums = cover
            .combine_columns(active.len(), |k| (columns.col(active.indices[k]).as_slice(), active.values[k]));
        let mut run = 0;
        for (w, &row) in part.iter_mut().zip(rows) {
            // Where two runs overlap, either has the row.
            while row >= cover.starts[run] + 8 {
                run += 1;
            }
            *w += sums[run][row - cover.starts[run]];
        }
        0.0
    });
}

impl LcpProblem<'_> {
    /// `M z + q`, with errors far below `tolerance · max(-q)`: where rounding could come near, with twice the digits.
    ///
    /// A huge z on singular columns would otherwise look like an answer once its terms cancel to zero.
    pub(super) fn residual(&self, z: &[f64], tolerance: f64, interrupted: &dyn Fn() -> bool) -> Vec<f64> {
        let mut w = self.q.to_vec();
        let active = Active::new(z, None);
        if active.len() == 0 {
            return w;
        }
        let largest = match self.m.try_as_col_major() {
            Some(columns) => add_columns_measured(columns, &active, &mut w, interrupted),
            None => add_rows(self.m, None, &active, &mut w, interrupted),
        };
        if largest * f64::EPSILON > MARGIN * tolerance * self.deficit() {
            w.copy_from_slice(self.q);
            add_product_compensated(self.m, &active, &mut w, interrupted);
        }
        w
    }
}

/// `M z` with twice the digits.
pub(super) fn product_compensated(m: MatRef<'_, f64>, z: &[f64], interrupted: &dyn Fn() -> bool) -> Vec<f64> {
    let mut product = vec![0.0; m.nrows()];
    add_product_compensated(m, &Active::new(z, None), &mut product, interrupted);
    product
}

/// `|M| |z|`.
pub(super) fn magnitudes(m: MatRef<'_, f64>, z: &[f64], interrupted: &dyn Fn() -> bool) -> Vec<f64> {
    let active = Active::new(z, None);
    let mut sums = vec![0.0; m.nrows()];
    in_row_blocks(&mut sums, active.len(), interrupted, |first, part| {
        for (k, part) in part.chunks_mut(TILE).enumerate() {
            for (&j, &z) in active.indices.iter().zip(&active.values) {
                let rows = first + k * TILE..;
                part.iter_mut().zip(rows).for_each(|(sum, i)| *sum += (m[(i, j)] * z).abs());
            }
        }
        0.0
    });
    sums
}

/// `w += M z` down the columns; returns the largest `Σ_j |M_ij z_j|`, infinite where one is not a number.
fn add_columns_measured(
    columns: MatRef<'_, f64, usize, usize, ContiguousFwd>,
    active: &Active,
    w: &mut [f64],
    interrupted: &dyn Fn() -> bool,
) -> f64 {
    in_row_blocks(w, active.len(), interrupted, |first, part| {
        let mut largest = 0.0;
        for (k, part) in part.chunks_mut(ROWS).enumerate() {
            let mut magnitudes = [0.0; ROWS];
            let magnitudes = &mut magnitudes[..part.len()];
            for (&j, &z) in active.indices.iter().zip(&active.values) {
                let entries = &columns.col(j).as_slice()[first + k * ROWS..][..part.len()];
                kernels::add_column_measured(part, magnitudes, entries, z);
            }
            largest = magnitudes.iter().fold(largest, |largest, &value| nan_max(largest, value));
        }
        largest
    })
}

/// `w += M z` row by row, on the rows `kept` if given; returns what [`add_columns_measured`] does.
fn add_rows(
    m: MatRef<'_, f64>,
    kept: Option<&[usize]>,
    active: &Active,
    w: &mut [f64],
    interrupted: &dyn Fn() -> bool,
) -> f64 {
    let n = m.nrows();
    let row_at = |place: usize| kept.map_or(place, |kept| kept[place]);
    if let Some(rows) = m.transpose().try_as_col_major()
        && n >= 8
    {
        let cover = Eights::cover(&active.indices, &active.values, n);
        return in_row_blocks(w, 8 * cover.starts.len(), interrupted, |first, part| {
            nan_max(0.0, cover.add_rows(part, |i| rows.col(row_at(first + i)).as_slice()))
        });
    }
    in_row_blocks(w, active.len(), interrupted, |first, part| {
        let mut largest = 0.0;
        for (place, w) in (first..).zip(part) {
            let mut magnitude = 0.0;
            for (&j, &z) in active.indices.iter().zip(&active.values) {
                let product = m[(row_at(place), j)] * z;
                *w += product;
                magnitude += product.abs();
            }
            largest = nan_max(largest, magnitude);
        }
        largest
    })
}

/// `w += M z` with twice the digits.
fn add_product_compensated(
    m: MatRef<'_, f64>,
    active: &Active,
    w: &mut [f64],
    interrupted: &dyn Fn() -> bool,
) {
    // Each entry costs several times what a plain product takes.
    in_row_blocks(w, 8 * active.len(), interrupted, |first, part| {
        for (k, part) in part.chunks_mut(TILE).enumerate() {
            let (mut tail, mut entries) = ([0.0; TILE], [0.0; TILE]);
            let (tail, entries) = (&mut tail[..part.len()], &mut entries[..part.len()]);
            for (&j, &z) in active.indices.iter().zip(&active.values) {
                let rows = first + k * TILE..;
                entries.iter_mut().zip(rows).for_each(|(entry, i)| *entry = m[(i, j)]);
                kernels::add_column_compensated(part, tail, entries, z);
            }
            part.iter_mut().zip(tail).for_each(|(w, tail)| *w += *tail);
        }
        0.0
    });
}

/// Runs `block` on the first row and the entries of every block of `w`; returns the largest of what it gives.
fn in_row_blocks(
    w: &mut [f64],
    row_cost: usize,
    interrupted: &dyn Fn() -> bool,
    block: impl Fn(usize, &mut [f64]) -> f64 + Sync,
) -> f64 {
    let mut largest = 0.0;
    let rows_at_once = (CHUNK / row_cost.max(1)).max(64);
    for (k, group) in w.chunks_mut(rows_at_once).enumerate() {
        if k > 0 && interrupted() {
            break;
        }
        let first = k * rows_at_once;
        let each = if group.len() * row_cost < SHARED { group.len() } else { row_block(group.len()) };
        let found = if each == group.len() {
            block(first, group)
        } else {
            let blocks = group.par_chunks_mut(each).enumerate();
            blocks.map(|(k, part)| block(first + k * each, part)).reduce(|| 0.0, nan_max)
        };
        largest = nan_max(largest, found);
    }
    largest
}

/// Where a vector is not zero, in M's columns, and what stands there.
struct Active {
    indices: Vec<usize>,
    values: Vec<f64>,
}

impl Active {
    /// The entries of `z` belong to the columns `kept`, or to all.
    fn new(z: &[f64], kept: Option<&[usize]>) -> Self {
        let places = (0..z.len()).filter(|&place| z[place] != 0.0);
        let (indices, values) =
            places.map(|place| (kept.map_or(place, |kept| kept[place]), z[place])).unzip();
        Self { indices, values }
    }

    fn len(&self) -> usize {
        self.indices.len()
    }
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    #[test]
    fn products_agree_with_plain_loops_in_every_order_and_density() {
        for n in [1, 2, 17, 70, 600] {
            let m = Mat::from_fn(n, n, |i, j| ((i * 31 + j * 17) % 13) as f64 - 6.0);
            let turned = m.transpose().to_owned();
            let backwards = Mat::from_fn(n, n, |i, j| m[(n - 1 - i, n - 1 - j)]);
            for every in [1, 2, 7] {
                let z: Vec<f64> =
                    (0..n).map(|j| if j % every == 0 { (j % 5) as f64 - 2.0 } else { 0.0 }).collect();
                let expected: Vec<f64> =
                    (0..n).map(|i| 1.0 + (0..n).map(|j| m[(i, j)] * z[j]).sum::<f64>()).collect();
                let magnitude =
                    (0..n).map(|i| (0..n).map(|j| (m[(i, j)] * z[j]).abs()).sum::<f64>()).fold(0.0, f64::max);
                for view in [m.as_ref(), turned.transpose(), backwards.as_ref().reverse_rows_and_cols()] {
                    let mut w = vec![1.0; n];
                    add_product(view, &z, &mut w, &|| false);
                    assert_eq!(w, expected, "small integers add without rounding");
                    let active = Active::new(&z, None);
                    w.fill(1.0);
                    let largest = match view.try_as_col_major() {
                        Some(columns) => add_columns_measured(columns, &active, &mut w, &|| false),
                        None => add_rows(view, None, &active, &mut w, &|| false),
                    };
                    assert_eq!((largest, &w), (magnitude, &expected));
                    w.fill(1.0);
                    add_product_compensated(view, &active, &mut w, &|| false);
                    assert_eq!(w, expected);
                    assert_eq!(magnitudes(view, &z, &|| false).into_iter().fold(0.0, f64::max), magnitude);
                    // On every other row: z there, and w of the whole where the rest of z is zero.
                    let kept: Vec<usize> = (0..n).step_by(2).collect();
                    let some: Vec<f64> = kept.iter().map(|&j| z[j]).collect();
                    let mut part = vec![0.0; kept.len()];
                    add_product_on(view, &kept, &some, &mut part, &|| false);
                    for (&i, w) in kept.iter().zip(part) {
                        assert_eq!(w, kept.iter().map(|&j| m[(i, j)] * z[j]).sum::<f64>());
                    }
                }
            }
        }
    }
}
