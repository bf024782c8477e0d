//! Products with `M`, of the columns alone where the factor is not zero.
//!
//! Rows are handled in blocks that depend on no number of threads, so results are equal to the bit for any;
//! between chunks the interrupt is asked, and what it stops is left unfinished.

use faer::MatRef;
use rayon::prelude::*;

use crate::lcp::certificate::nan_max;
use crate::lcp::problem::LcpProblem;
use crate::linalg::factor::Interrupt;
use crate::linalg::kernels::{self, CHUNK_ENTRIES, SHARED_WORK, row_block};
use crate::linalg::vectorized::vectorized;

/// Rows that a pass takes at a time, so that what it adds to stays in the nearest cache.
const ROWS_AT_ONCE: usize = 1024;
/// The same where pieces of columns are copied, so that what is read across the storage order stays there too.
const COPIED_ROWS: usize = 64;
/// Share of the tolerance that rounding may come near before a product is formed with twice the digits.
const ROUNDING_MARGIN: f64 = 0.01;

/// `y += Σ c_k x_k` over the terms `(x_k, c_k)`, each x as long as `y`.
pub(super) fn add_terms<'a>(
    y: &mut [f64],
    count: usize,
    term: impl Fn(usize) -> (&'a [f64], f64) + Sync,
    interrupted: Interrupt,
) {
    in_row_blocks(y, count, interrupted, |first, part| {
        let height = part.len();
        kernels::add_terms(part, count, |k| {
            let (x, c) = term(k);
            (&x[first..][..height], c)
        });
        0.0
    });
}

/// `y_i += row_i · x`.
pub(super) fn add_row_products<'a>(
    y: &mut [f64],
    row: impl Fn(usize) -> &'a [f64] + Sync,
    x: &[f64],
    interrupted: Interrupt,
) {
    in_row_blocks(y, x.len(), interrupted, |first, part| {
        vectorized(
            #[inline(always)]
            || part.iter_mut().enumerate().for_each(|(i, y)| *y += kernels::dot(row(first + i), x)),
        );
        0.0
    });
}

impl LcpProblem<'_> {
    /// `M z + q`, with errors far below `tolerance · max(-q)`: where rounding could come near, with twice the digits;
    /// and whether these are enough.
    ///
    /// A huge z on singular columns would otherwise look like an answer once its terms cancel to zero.
    pub(super) fn slack(&self, z: &[f64], tolerance: f64, interrupted: Interrupt) -> (Vec<f64>, bool) {
        let mut w = self.q.to_vec();
        let largest =
            add_product(self.m, z, &mut w, interrupted, kernels::add_column_measured, |_, magnitudes| {
                magnitudes.iter().copied().fold(0.0, nan_max)
            });
        let bearable = ROUNDING_MARGIN * tolerance * self.deficit();
        if largest * f64::EPSILON > bearable {
            w.copy_from_slice(self.q);
            add_product_compensated(self.m, z, &mut w, interrupted);
        }
        // q alone, at z = 0, has no rounding.
        (w, largest == 0.0 || largest * f64::EPSILON * f64::EPSILON <= bearable)
    }
}

/// `M z` with twice the digits.
pub(super) fn product_compensated(m: MatRef<f64>, z: &[f64], interrupted: Interrupt) -> Vec<f64> {
    let mut product = vec![0.0; m.nrows()];
    add_product_compensated(m, z, &mut product, interrupted);
    product
}

/// `M z` and `|M| |z|`.
pub(super) fn product_and_magnitudes(
    m: MatRef<f64>,
    z: &[f64],
    interrupted: Interrupt,
) -> (Vec<f64>, Vec<f64>) {
    let [mut product, mut magnitudes] = [vec![0.0; m.nrows()], vec![0.0; m.nrows()]];
    add_product(m, z, &mut product, interrupted, kernels::add_column_measured, |_, _| 0.0);
    add_product(m, z, &mut magnitudes, interrupted, kernels::add_column_measured, |part, magnitudes| {
        part.copy_from_slice(magnitudes);
        0.0
    });
    (product, magnitudes)
}

fn add_product_compensated(m: MatRef<f64>, z: &[f64], w: &mut [f64], interrupted: Interrupt) {
    add_product(m, z, w, interrupted, kernels::add_column_compensated, |part, tail| {
        part.iter_mut().zip(tail).for_each(|(w, tail)| *w += *tail);
        0.0
    });
}

/// `w += M z` by a kernel that adds a column times a factor to a part of w and keeps a second sum beside it;
/// `finish` is given both for each part. Returns the largest of what it returns.
fn add_product(
    m: MatRef<f64>,
    z: &[f64],
    w: &mut [f64],
    interrupted: Interrupt,
    kernel: fn(&mut [f64], &mut [f64], &[f64], f64),
    finish: impl Fn(&mut [f64], &[f64]) -> f64 + Sync,
) -> f64 {
    let active: Vec<usize> = (0..z.len()).filter(|&j| z[j] != 0.0).collect();
    let columns = m.try_as_col_major();
    let height = if columns.is_some() { ROWS_AT_ONCE } else { COPIED_ROWS };
    in_row_blocks(w, active.len(), interrupted, |first, part| {
        let (mut second, mut copy) = ([0.0; ROWS_AT_ONCE], [0.0; COPIED_ROWS]);
        let parts = part.chunks_mut(height).enumerate();
        let sums = parts.map(|(k, part)| {
            let (first, second) = (first + k * height, &mut second[..part.len()]);
            second.fill(0.0);
            for &j in &active {
                let entries = match columns {
                    Some(columns) => &columns.col(j).as_slice()[first..][..part.len()],
                    None => {
                        let copy = &mut copy[..part.len()];
                        copy.iter_mut().enumerate().for_each(|(i, entry)| *entry = m[(first + i, j)]);
                        copy
                    }
                };
                kernel(part, second, entries, z[j]);
            }
            finish(part, second)
        });
        sums.fold(0.0, nan_max)
    })
}

/// Runs `block` on the first row and the entries of every block of `w`; returns the largest of what it gives.
fn in_row_blocks(
    w: &mut [f64],
    row_cost: usize,
    interrupted: Interrupt,
    block: impl Fn(usize, &mut [f64]) -> f64 + Sync,
) -> f64 {
    let mut largest = 0.0;
    let rows_at_once = (CHUNK_ENTRIES / row_cost.max(1)).max(64);
    for (k, group) in w.chunks_mut(rows_at_once).enumerate() {
        if k > 0 && interrupted() {
            break;
        }
        let first = k * rows_at_once;
        let each = if group.len() * row_cost < SHARED_WORK { group.len() } else { row_block(group.len()) };
        let blocks = group.par_chunks_mut(each).enumerate();
        let found = blocks.map(|(k, part)| block(first + k * each, part)).reduce(|| 0.0, nan_max);
        largest = nan_max(largest, found);
    }
    largest
}

#[cfg(test)]
mod tests {
    use faer::Mat;

    use super::*;

    #[test]
    fn products_agree_with_plain_loops_in_every_order_and_density() {
        for n in [0, 1, 2, 7, 8, 9, 16, 17, 33, 70, 600] {
            let m = Mat::from_fn(n, n, |i, j| ((i * 31 + j * 17) % 13) as f64 - 6.0);
            let turned = m.transpose().to_owned();
            let backwards = Mat::from_fn(n, n, |i, j| m[(n - 1 - i, n - 1 - j)]);
            for every in [1, 2, 7] {
                let z: Vec<f64> =
                    (0..n).map(|j| if j % every == 0 { (j % 5) as f64 - 2.0 } else { 0.0 }).collect();
                let expected: Vec<f64> = (0..n).map(|i| (0..n).map(|j| m[(i, j)] * z[j]).sum()).collect();
                let sizes: Vec<f64> =
                    (0..n).map(|i| (0..n).map(|j| (m[(i, j)] * z[j]).abs()).sum()).collect();
                for view in [m.as_ref(), turned.transpose(), backwards.as_ref().reverse_rows_and_cols()] {
                    // Small integers add without rounding.
                    assert_eq!(
                        product_and_magnitudes(view, &z, &|| false),
                        (expected.clone(), sizes.clone())
                    );
                    assert_eq!(product_compensated(view, &z, &|| false), expected);
                    let q = vec![-1.0; n];
                    let (slack, is_known) = LcpProblem::new(view, &q).unwrap().slack(&z, 1e-10, &|| false);
                    assert!(is_known && slack.iter().zip(&expected).all(|(w, product)| *w == product - 1.0));
                }
                let mut sum = vec![1.0; n];
                add_terms(&mut sum, n, |j| (m.col_as_slice(j), z[j]), &|| false);
                assert!(sum.iter().zip(&expected).all(|(sum, product)| *sum == product + 1.0));
            }
        }
    }
}
