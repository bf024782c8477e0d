//! Vector loops, compiled for what the processor offers and chosen at run time.

/// `y += Σ c_j x_j` over the columns `(x_j, c_j)`, each as long as `y`.
pub(super) fn add_columns(y: &mut [f64], columns: &[(&[f64], f64)]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || add_columns_inline(y, columns),
    );
}

#[inline(always)]
fn add_columns_inline(y: &mut [f64], columns: &[(&[f64], f64)]) {
    let n = y.len();
    let mut chunks = columns.chunks_exact(8);
    for chunk in &mut chunks {
        let x: [&[f64]; 8] = std::array::from_fn(|k| &chunk[k].0[..n]);
        let c: [f64; 8] = std::array::from_fn(|k| chunk[k].1);
        for i in 0..n {
            let even = (c[0] * x[0][i] + c[2] * x[2][i]) + (c[4] * x[4][i] + c[6] * x[6][i]);
            let odd = (c[1] * x[1][i] + c[3] * x[3][i]) + (c[5] * x[5][i] + c[7] * x[7][i]);
            y[i] += even + odd;
        }
    }
    for &(x, c) in chunks.remainder() {
        axpy(y, c, x);
    }
}

/// `y += c x`.
#[inline(always)]
pub(super) fn axpy(y: &mut [f64], c: f64, x: &[f64]) {
    let n = y.len();
    let x = &x[..n];
    for i in 0..n {
        y[i] += c * x[i];
    }
}

/// `y + tail += c x` with the rounding errors gathered in `tail` (Ogita, Rump, Oishi 2005).
pub(super) fn add_column_compensated(y: &mut [f64], tail: &mut [f64], x: &[f64], c: f64) {
    pulp::Arch::new().dispatch(
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

/// Inner product, chosen at run time.
pub(super) fn inner_product(x: &[f64], y: &[f64]) -> f64 {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || dot(x, y),
    )
}

/// Inner product, summed in 16 lanes.
#[inline(always)]
pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
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

/// Folds columns into the smallest entry `low` and the largest magnitude `high` of each row.
///
/// Magnitudes are compared as bits, so that infinities and NaN come out on top.
pub(super) fn fold_extremes(columns: &[&[f64]], low: &mut [f64], high: &mut [u64]) {
    const COLUMNS: usize = 8;
    const ROWS: usize = 1024;
    let n = low.len();
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            for start in (0..n).step_by(ROWS) {
                let rows = start..(start + ROWS).min(n);
                let mut chunks = columns.chunks_exact(COLUMNS);
                for chunk in &mut chunks {
                    let chunk: [&[f64]; COLUMNS] = std::array::from_fn(|k| &chunk[k][rows.clone()]);
                    fold_block(chunk, &mut low[rows.clone()], &mut high[rows.clone()]);
                }
                for column in chunks.remainder() {
                    fold_block([&column[rows.clone()]], &mut low[rows.clone()], &mut high[rows.clone()]);
                }
            }
        },
    );
}

#[inline(always)]
fn fold_block<const K: usize>(columns: [&[f64]; K], low: &mut [f64], high: &mut [u64]) {
    let n = low.len();
    let columns: [&[f64]; K] = std::array::from_fn(|k| &columns[k][..n]);
    let high = &mut high[..n];
    for i in 0..n {
        let (mut least, mut most) = (low[i], high[i]);
        for column in columns {
            let value = column[i];
            let bits = value.to_bits() & MAGNITUDE;
            least = if value < least { value } else { least };
            most = if bits > most { bits } else { most };
        }
        (low[i], high[i]) = (least, most);
    }
}

/// Smallest entry and largest magnitude (as bits) of one row.
pub(super) fn extremes(row: &[f64]) -> (f64, u64) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let mut low = [f64::INFINITY; 16];
            let mut high = [0_u64; 16];
            let chunks = row.chunks_exact(16);
            for &value in chunks.remainder() {
                let bits = value.to_bits() & MAGNITUDE;
                low[0] = if value < low[0] { value } else { low[0] };
                high[0] = if bits > high[0] { bits } else { high[0] };
            }
            for chunk in chunks {
                for k in 0..16 {
                    let bits = chunk[k].to_bits() & MAGNITUDE;
                    low[k] = if chunk[k] < low[k] { chunk[k] } else { low[k] };
                    high[k] = if bits > high[k] { bits } else { high[k] };
                }
            }
            let low = low.into_iter().fold(f64::INFINITY, f64::min);
            (low, high.into_iter().max().unwrap_or(0))
        },
    )
}

/// Every bit of a double but its sign.
const MAGNITUDE: u64 = u64::MAX >> 1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_columns_agree_with_plain_loops_at_every_remainder() {
        for n in [0, 1, 7, 16, 33] {
            for k in [0, 1, 7, 8, 9, 17] {
                let columns: Vec<Vec<f64>> =
                    (0..k).map(|j| (0..n).map(|i| (i * 31 + j * 7) as f64 % 11.0 - 5.0).collect()).collect();
                let terms: Vec<(&[f64], f64)> =
                    columns.iter().enumerate().map(|(j, c)| (&c[..], j as f64 - 3.0)).collect();
                let mut y = vec![1.0; n];
                add_columns(&mut y, &terms);
                for i in 0..n {
                    let expected = 1.0 + terms.iter().map(|(c, s)| c[i] * s).sum::<f64>();
                    assert_eq!(y[i], expected, "small integers add without rounding");
                }
            }
        }
    }

    #[test]
    fn the_inner_product_of_integers_is_exact_at_every_length() {
        for n in 0..50 {
            let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
            assert_eq!(dot(&x, &x), (0..n).map(|i| (i * i) as f64).sum::<f64>());
        }
    }

    #[test]
    fn extremes_see_signs_and_values_that_are_not_finite() {
        let (low, high) = extremes(&[1.0, -3.0, 2.0]);
        assert_eq!((low, f64::from_bits(high)), (-3.0, 3.0));
        let mut row = vec![1.0; 40];
        for at in [0, 17, 39] {
            row[at] = f64::NAN;
            assert!(f64::from_bits(extremes(&row).1).is_nan());
            row[at] = 1.0;
        }
    }
}
