//! Vector loops, compiled for what the processor offers and chosen at run time.

use rayon::prelude::*;

use crate::linalg::vectorized::vectorized;

/// Multiplications from which a product is worth sharing among threads.
pub(crate) const SHARED_WORK: usize = 1 << 18;
/// Entries of a matrix between two asks of the interrupt: some milliseconds of memory traffic.
pub(crate) const CHUNK_ENTRIES: usize = 1 << 22;

/// Rows that one task of a shared product takes.
pub(crate) fn row_block(rows: usize) -> usize {
    rows.div_ceil(8).max(256)
}

/// `y += Σ c_k x_k` over the terms `(x_k, c_k)`, each x as long as `y`.
pub(crate) fn add_terms<'a>(y: &mut [f64], count: usize, term: impl Fn(usize) -> (&'a [f64], f64)) {
    vectorized(
        #[inline(always)]
        || add_terms_inline(y, count, &term),
    );
}

/// [`add_terms`] within a dispatch.
#[inline(always)]
pub(crate) fn add_terms_inline<'a>(y: &mut [f64], count: usize, term: impl Fn(usize) -> (&'a [f64], f64)) {
    let n = y.len();
    let whole = count - count % 8;
    for first in (0..whole).step_by(8) {
        // Written out, as `array::from_fn` is not compiled into the kernel.
        let at = |k: usize| {
            let (x, c) = term(first + k);
            (&x[..n], c)
        };
        let [(x0, c0), (x1, c1), (x2, c2), (x3, c3)] = [at(0), at(1), at(2), at(3)];
        let [(x4, c4), (x5, c5), (x6, c6), (x7, c7)] = [at(4), at(5), at(6), at(7)];
        for i in 0..n {
            let even = (c0 * x0[i] + c2 * x2[i]) + (c4 * x4[i] + c6 * x6[i]);
            let odd = (c1 * x1[i] + c3 * x3[i]) + (c5 * x5[i] + c7 * x7[i]);
            y[i] += even + odd;
        }
    }
    for k in whole..count {
        let (x, c) = term(k);
        axpy(y, c, x);
    }
}

/// `y += c x`.
#[inline(always)]
pub(crate) fn axpy(y: &mut [f64], c: f64, x: &[f64]) {
    let n = y.len();
    let x = &x[..n];
    for i in 0..n {
        y[i] += c * x[i];
    }
}

/// `y + tail += c x` with the rounding errors gathered in `tail` (Ogita, Rump, Oishi 2005).
pub(crate) fn add_column_compensated(y: &mut [f64], tail: &mut [f64], x: &[f64], c: f64) {
    vectorized(
        #[inline(always)]
        || {
            let n = y.len();
            let (tail, x) = (&mut tail[..n], &x[..n]);
            for i in 0..n {
                let product = c * x[i];
                let error = c.mul_add(x[i], -product);
                let sum = y[i] + product;
                let back = sum - y[i];
                tail[i] += ((y[i] - (sum - back)) + (product - back)) + error;
                y[i] = sum;
            }
        },
    );
}

/// `y += c x` and `magnitudes += |c x|`.
pub(crate) fn add_column_measured(y: &mut [f64], magnitudes: &mut [f64], x: &[f64], c: f64) {
    vectorized(
        #[inline(always)]
        || {
            let n = y.len();
            let (magnitudes, x) = (&mut magnitudes[..n], &x[..n]);
            for i in 0..n {
                let product = c * x[i];
                y[i] += product;
                magnitudes[i] += product.abs();
            }
        },
    );
}

/// The shortest step along `rates` that takes one of `values` to zero; rates above `-smallest` take none there.
pub(crate) fn first_to_zero(values: &[f64], rates: &[f64], smallest: f64) -> f64 {
    const LANES: usize = 8;
    let step = |value: f64, rate: f64| {
        if rate < -smallest { value.max(0.0) / -rate } else { f64::INFINITY }
    };
    vectorized(
        #[inline(always)]
        || {
            let mut lanes = [f64::INFINITY; LANES];
            let (values, rates) = (values.chunks_exact(LANES), rates.chunks_exact(LANES));
            for (&value, &rate) in values.remainder().iter().zip(rates.remainder()) {
                lanes[0] = lanes[0].min(step(value, rate));
            }
            for (values, rates) in values.zip(rates) {
                for k in 0..LANES {
                    let reached = step(values[k], rates[k]);
                    lanes[k] = if reached < lanes[k] { reached } else { lanes[k] };
                }
            }
            lanes.into_iter().fold(f64::INFINITY, f64::min)
        },
    )
}

/// Inner product, summed in 16 lanes.
#[inline(always)]
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len().min(y.len());
    let (x, y) = (&x[..n], &y[..n]);
    let mut lanes = [0.0; 16];
    let (xs, ys) = (x.chunks_exact(16), y.chunks_exact(16));
    let tail: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in xs.zip(ys) {
        for k in 0..16 {
            lanes[k] += a[k] * b[k];
        }
    }
    let mut half = [0.0; 8];
    for k in 0..8 {
        half[k] = lanes[k] + lanes[k + 8];
    }
    let quarter = [half[0] + half[4], half[1] + half[5], half[2] + half[6], half[3] + half[7]];
    (quarter[0] + quarter[2]) + (quarter[1] + quarter[3]) + tail
}

/// What a pass over some rows of a matrix learns about each.
#[derive(Debug, Clone)]
pub(crate) struct Extremes {
    /// Smallest entry.
    pub(crate) low: Vec<f64>,
    /// Largest magnitude; not a number where an entry is infinite or not a number.
    pub(crate) high: Vec<f64>,
}

impl Extremes {
    pub(crate) fn new(rows: usize) -> Self {
        Self { low: vec![f64::INFINITY; rows], high: vec![0.0; rows] }
    }

    /// Takes in columns, each with one entry for every row; a thread takes so many blocks of rows at least.
    pub(crate) fn fold(&mut self, columns: &[&[f64]], blocks_each: usize) {
        const COLUMNS: usize = 8;
        const ROWS: usize = 512;
        let blocks = self.low.par_chunks_mut(ROWS).zip(self.high.par_chunks_mut(ROWS)).enumerate();
        blocks.with_min_len(blocks_each).for_each(|(k, (low, high))| {
            vectorized(
                #[inline(always)]
                || {
                    let mut chunks = columns.chunks_exact(COLUMNS);
                    for chunk in &mut chunks {
                        let chunk: [&[f64]; COLUMNS] = std::array::from_fn(|j| &chunk[j][k * ROWS..]);
                        fold_block(chunk, low, high);
                    }
                    for column in chunks.remainder() {
                        fold_block([&column[k * ROWS..]], low, high);
                    }
                },
            );
        });
    }
}

#[inline(always)]
fn fold_block<const K: usize>(columns: [&[f64]; K], low: &mut [f64], high: &mut [f64]) {
    let n = low.len();
    let columns: [&[f64]; K] = std::array::from_fn(|k| &columns[k][..n]);
    let high = &mut high[..n];
    for i in 0..n {
        let (mut least, mut most) = (low[i], high[i]);
        for column in columns {
            let value = column[i];
            least = if value < least { value } else { least };
            // What is not finite times zero is not a number, and nothing is larger than that.
            most = value * 0.0 + if value.abs() > most { value.abs() } else { most };
        }
        (low[i], high[i]) = (least, most);
    }
}

/// Smallest entry and largest magnitude of one row, as [`Extremes`] has them.
pub(crate) fn extremes(row: &[f64]) -> (f64, f64) {
    const LANES: usize = 16;
    let mut lanes = ([f64::INFINITY; LANES], [0.0; LANES]);
    let mut last = ([f64::INFINITY], [0.0]);
    vectorized(
        #[inline(always)]
        || {
            let chunks = row.chunks_exact(LANES);
            for value in chunks.remainder().chunks_exact(1) {
                fold_block([value], &mut last.0, &mut last.1);
            }
            for chunk in chunks {
                fold_block([chunk], &mut lanes.0, &mut lanes.1);
            }
        },
    );
    let largest = lanes.1.into_iter().fold(last.1[0], |a, b| if b > a || b.is_nan() { b } else { a });
    (lanes.0.into_iter().fold(last.0[0], f64::min), largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inner_product_of_integers_is_exact_at_every_length() {
        for n in 0..50 {
            let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
            assert_eq!(dot(&x, &x), (0..n).map(|i| (i * i) as f64).sum::<f64>());
        }
    }

    #[test]
    fn the_first_to_reach_zero_is_found_at_every_length() {
        for n in 0..30 {
            for first in 0..n {
                let values: Vec<f64> =
                    (0..n).map(|i| if i == first { 1.0 } else { 3.0 + i as f64 }).collect();
                let rates = vec![-0.5; n];
                assert_eq!(first_to_zero(&values, &rates, 1e-11), 2.0);
            }
            assert_eq!(first_to_zero(&vec![1.0; n], &vec![-1e-12; n], 1e-11), f64::INFINITY);
        }
        assert_eq!(first_to_zero(&[-1.0, 5.0], &[-1.0, 1.0], 1e-11), 0.0);
    }

    #[test]
    fn extremes_see_signs_and_values_that_are_not_finite() {
        assert_eq!(extremes(&[1.0, -3.0, 2.0]), (-3.0, 3.0));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut row = vec![1.0; 40];
            for at in [0, 17, 39] {
                row[at] = bad;
                assert!(extremes(&row).1.is_nan());
                row[at] = 1.0;
            }
        }
    }
}
