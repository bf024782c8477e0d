//! Products with a few columns, or on a few rows, of a matrix: scattered indices are covered by runs of eight, as
//! reading eight neighbours takes no longer than picking one.

/// Runs of eight that cover some indices below a size of at least eight.
pub(super) struct Eights {
    /// First index of each run, ascending.
    pub(super) starts: Vec<usize>,
    /// What stands at the indices covered; zero at those that are not wanted, or that an earlier run has.
    pub(super) values: Vec<[f64; 8]>,
}

impl Eights {
    /// Covers `indices` (ascending), `values` there.
    pub(super) fn cover(indices: &[usize], values: &[f64], size: usize) -> Self {
        debug_assert!(size >= 8);
        let mut cover = Self { starts: Vec::new(), values: Vec::new() };
        for (&index, &value) in indices.iter().zip(values) {
            let within = cover.starts.last().map_or(8, |start| index - start);
            if within < 8 {
                cover.values.last_mut().expect("as many as starts")[within] = value;
            } else {
                let start = index.min(size - 8);
                let mut run = [0.0; 8];
                run[index - start] = value;
                cover.starts.push(start);
                cover.values.push(run);
            }
        }
        cover
    }

    /// `y_i += row_i · v` with v the values covered; returns the largest sum of the terms' magnitudes.
    pub(super) fn add_rows<'a>(&self, y: &mut [f64], row: impl Fn(usize) -> &'a [f64]) -> f64 {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                let mut largest = 0.0_f64;
                for (i, y) in y.iter_mut().enumerate() {
                    let row = row(i);
                    let (mut sums, mut magnitudes) = ([0.0_f64; 8], [0.0_f64; 8]);
                    for (&start, values) in self.starts.iter().zip(&self.values) {
                        let entries = &row[start..start + 8];
                        for lane in 0..8 {
                            let product = entries[lane] * values[lane];
                            sums[lane] += product;
                            magnitudes[lane] += product.abs();
                        }
                    }
                    *y += total(&sums);
                    let magnitude = total(&magnitudes);
                    largest = if magnitude > largest || magnitude.is_nan() { magnitude } else { largest };
                }
                largest
            },
        )
    }

    /// `Σ_k c_k x_k` on the rows covered, from `count` columns `(x_k, c_k)`: eight sums for each run.
    pub(super) fn combine_columns<'a>(
        &self,
        count: usize,
        column: impl Fn(usize) -> (&'a [f64], f64),
    ) -> Vec<[f64; 8]> {
        let mut sums = vec![[0.0; 8]; self.starts.len()];
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for k in 0..count {
                    let (x, c) = column(k);
                    for (&start, sums) in self.starts.iter().zip(&mut sums) {
                        let x = &x[start..start + 8];
                        for lane in 0..8 {
                            sums[lane] += c * x[lane];
                        }
                    }
                }
            },
        );
        sums
    }
}

#[inline(always)]
fn total(lanes: &[f64; 8]) -> f64 {
    let [a, b, c, d] = [lanes[0] + lanes[4], lanes[1] + lanes[5], lanes[2] + lanes[6], lanes[3] + lanes[7]];
    (a + c) + (b + d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_is_covered_once_also_at_the_end() {
        for size in [8, 9, 15, 16, 17, 40] {
            for every in [1, 2, 3, 7, 9] {
                let indices: Vec<usize> = (0..size).filter(|i| i % every == 0 || i + 1 == size).collect();
                let values: Vec<f64> = indices.iter().map(|&i| 1.0 + i as f64).collect();
                let cover = Eights::cover(&indices, &values, size);
                let mut found = vec![0.0; size];
                for (&start, run) in cover.starts.iter().zip(&cover.values) {
                    run.iter().enumerate().for_each(|(lane, value)| found[start + lane] += value);
                }
                let mut expected = vec![0.0; size];
                indices.iter().zip(&values).for_each(|(&i, &value)| expected[i] = value);
                assert_eq!(found, expected);
            }
        }
    }

    #[test]
    fn a_magnitude_that_is_not_a_number_is_told() {
        let cover = Eights::cover(&[0], &[1.0], 8);
        let rows = [[f64::NAN; 8], [1.0; 8]];
        assert!(cover.add_rows(&mut [0.0; 2], |i| &rows[i]).is_nan());
        assert!(cover.add_rows(&mut [0.0; 2], |i| &rows[1 - i]).is_nan());
    }
}
