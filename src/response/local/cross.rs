//! Matrices of low rank from a few of their rows and columns.
//!
//! Adaptive cross approximation with partial pivoting (Bebendorf 2000, Numer. Math. 86, 565-589): the residual of a
//! row and of the column of its largest entry make one more term of rank 1.

use faer::Mat;

/// Rows and columns of a matrix, computed when asked for.
pub(super) trait Entries {
    /// Writes row i.
    fn row(&mut self, i: usize, values: &mut [f64]);
    /// Writes column j.
    fn column(&mut self, j: usize, values: &mut [f64]);
}

/// Allowed error of a block in the Frobenius norm: a share of its own norm, and as much for every entry.
#[derive(Debug, Clone, Copy)]
pub(super) struct Allowance {
    pub(super) relative: f64,
    pub(super) each: f64,
}

/// `left · rightᵀ`, both column by column.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LowRank {
    pub(super) rank: usize,
    pub(super) left: Vec<f64>,
    pub(super) right: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Position of the largest magnitude among those not used.
fn largest(values: &[f64], used: &[bool]) -> Option<usize> {
    let free = (0..values.len()).filter(|&i| !used[i]);
    free.max_by(|&a, &b| values[a].abs().total_cmp(&values[b].abs()))
}

/// A matrix within the allowance of the given one; `None` where it would take no less memory than the entries.
///
/// * `shape`: rows and columns
/// * `looks`: row to begin with, best one of the largest, and rows at which the result is checked
pub(super) fn cross_approximation(
    entries: &mut impl Entries,
    shape: (usize, usize),
    looks: &[usize],
    allowance: Allowance,
) -> Option<LowRank> {
    let (m, n) = shape;
    let mut found = LowRank { rank: 0, left: Vec::new(), right: Vec::new() };
    let (mut used_rows, mut used_columns) = (vec![false; m], vec![false; n]);
    let (mut row, mut column) = (vec![0.0; n], vec![0.0; m]);
    let mut looks = looks.iter().copied();
    let mut norm_squared = 0.0_f64;
    let mut next = looks.next();
    while let Some(i) = next {
        let allowed = allowance.relative * norm_squared.sqrt() + allowance.each * ((m * n) as f64).sqrt();
        used_rows[i] = true;
        entries.row(i, &mut row);
        for k in 0..found.rank {
            let share = found.left[k * m + i];
            row.iter_mut().zip(&found.right[k * n..]).for_each(|(r, v)| *r -= share * v);
        }
        let pivot = largest(&row, &used_columns).filter(|&j| row[j] != 0.0);
        let is_quiet = dot(&row, &row) * m as f64 <= allowed * allowed;
        let Some(j) = pivot.filter(|_| !is_quiet) else {
            next = looks.find(|&i| !used_rows[i]);
            continue;
        };
        if (found.rank + 1) * (m + n) >= m * n {
            return None;
        }
        used_columns[j] = true;
        entries.column(j, &mut column);
        for k in 0..found.rank {
            let share = found.right[k * n + j];
            column.iter_mut().zip(&found.left[k * m..]).for_each(|(c, u)| *c -= share * u);
        }
        let inverse = 1.0 / row[j];
        row.iter_mut().for_each(|r| *r *= inverse);
        let size_squared = dot(&column, &column) * dot(&row, &row);
        for k in 0..found.rank {
            norm_squared +=
                2.0 * dot(&found.left[k * m..][..m], &column) * dot(&found.right[k * n..][..n], &row);
        }
        norm_squared = (norm_squared + size_squared).max(0.0);
        let allowed = allowance.relative * norm_squared.sqrt() + allowance.each * ((m * n) as f64).sqrt();
        next = if size_squared <= allowed * allowed {
            looks.find(|&i| !used_rows[i])
        } else {
            largest(&column, &used_rows)
        };
        found.left.extend(&column);
        found.right.extend(&row);
        found.rank += 1;
    }
    let allowed = allowance.relative * norm_squared.sqrt() + allowance.each * ((m * n) as f64).sqrt();
    Some(found.recompressed(shape, 0.5 * allowed))
}

impl LowRank {
    /// Entry (i, j) of a block of m rows and n columns.
    pub(super) fn at(&self, i: usize, j: usize, m: usize, n: usize) -> f64 {
        (0..self.rank).map(|k| self.left[k * m + i] * self.right[k * n + j]).sum()
    }

    /// The shortest sum within `allowed` of this one in the Frobenius norm: singular values of the small core between
    /// orthonormal bases.
    fn recompressed(self, shape: (usize, usize), allowed: f64) -> Self {
        let (m, n) = shape;
        if self.rank < 2 {
            return self;
        }
        let (left, left_core) = orthonormal(self.left.clone(), m, self.rank);
        let (right, right_core) = orthonormal(self.right.clone(), n, self.rank);
        let core = &left_core * right_core.transpose();
        let Ok(parts) = core.thin_svd() else {
            return self;
        };
        let values = parts.S().column_vector();
        let mut rank = self.rank;
        let mut left_out = 0.0;
        while rank > 0 {
            left_out += values[rank - 1] * values[rank - 1];
            if left_out > allowed * allowed {
                break;
            }
            rank -= 1;
        }
        if rank == self.rank {
            return self;
        }
        let turned = |basis: &[f64], length: usize, turn: faer::MatRef<'_, f64>, scaled: bool| {
            let mut list = vec![0.0; rank * length];
            for k in 0..rank {
                let out = &mut list[k * length..][..length];
                for l in 0..self.rank {
                    let share = turn[(l, k)] * if scaled { values[k] } else { 1.0 };
                    out.iter_mut().zip(&basis[l * length..]).for_each(|(o, b)| *o += share * b);
                }
            }
            list
        };
        Self { rank, left: turned(&left, m, parts.U(), true), right: turned(&right, n, parts.V(), false) }
    }
}

/// Orthonormal columns and the triangle by which they give the old ones (Gram-Schmidt, each column twice).
fn orthonormal(mut columns: Vec<f64>, length: usize, count: usize) -> (Vec<f64>, Mat<f64>) {
    let mut triangle = Mat::zeros(count, count);
    for k in 0..count {
        let (before, rest) = columns.split_at_mut(k * length);
        let column = &mut rest[..length];
        for _ in 0..2 {
            for (l, other) in before.chunks_exact(length).enumerate() {
                let share = dot(other, column);
                triangle[(l, k)] += share;
                column.iter_mut().zip(other).for_each(|(c, o)| *c -= share * o);
            }
        }
        let norm = dot(column, column).sqrt();
        triangle[(k, k)] = norm;
        if norm > 0.0 {
            column.iter_mut().for_each(|c| *c /= norm);
        }
    }
    (columns, triangle)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Known(Mat<f64>);

    impl Entries for Known {
        fn row(&mut self, i: usize, values: &mut [f64]) {
            values.iter_mut().enumerate().for_each(|(j, value)| *value = self.0[(i, j)]);
        }

        fn column(&mut self, j: usize, values: &mut [f64]) {
            values.iter_mut().enumerate().for_each(|(i, value)| *value = self.0[(i, j)]);
        }
    }

    fn rebuilt(found: &LowRank, (m, n): (usize, usize)) -> Mat<f64> {
        Mat::from_fn(m, n, |i, j| {
            (0..found.rank).map(|k| found.left[k * m + i] * found.right[k * n + j]).sum()
        })
    }

    #[test]
    fn products_of_two_vectors_are_found_exactly() {
        let shape = (30, 20);
        let matrix = Mat::from_fn(30, 20, |i, j| (1.0 + i as f64) * (j as f64 - 7.5) + (i * i) as f64);
        let scale = matrix.norm_l2();
        let allowance = Allowance { relative: 1e-10, each: 0.0 };
        let found =
            cross_approximation(&mut Known(matrix.clone()), shape, &[3, 20], allowance).expect("of low rank");
        assert_eq!(found.rank, 2);
        assert!((matrix - rebuilt(&found, shape)).norm_l2() < 1e-10 * scale);
    }

    #[test]
    fn a_smooth_kernel_is_within_either_allowance() {
        let shape = (40, 50);
        let matrix = Mat::from_fn(40, 50, |i, j| 1.0 / (3.0 + 0.02 * i as f64 + 0.03 * j as f64));
        for tolerance in [1e-2, 1e-4, 1e-8] {
            for allowance in
                [Allowance { relative: tolerance, each: 0.0 }, Allowance { relative: 0.0, each: tolerance }]
            {
                let found = cross_approximation(&mut Known(matrix.clone()), shape, &[0, 20], allowance);
                let found = found.expect("of low rank");
                let allowed =
                    allowance.relative * matrix.norm_l2() + allowance.each * (40.0f64 * 50.0).sqrt();
                assert!((&matrix - rebuilt(&found, shape)).norm_l2() <= allowed);
                assert!(0 < found.rank && found.rank < 10);
            }
        }
    }

    #[test]
    fn all_looks_are_taken_whether_or_not_their_row_is_used_or_quiet() {
        // two groups of rows and columns that have nothing to do with each other
        let matrix =
            Mat::from_fn(20, 20, |i, j| if i / 10 == j / 10 { (1 + i % 10 + j) as f64 } else { 0.0 });
        let allowance = Allowance { relative: 1e-10, each: 0.0 };
        let found = cross_approximation(&mut Known(matrix.clone()), (20, 20), &[0, 9, 0, 3, 15], allowance);
        let found = found.expect("of low rank");
        assert_eq!(found.rank, 4);
        assert!((&matrix - rebuilt(&found, (20, 20))).norm_l2() < 1e-10 * matrix.norm_l2());
    }

    #[test]
    fn nothing_has_rank_zero_and_an_identity_is_refused() {
        let allowance = Allowance { relative: 1e-3, each: 0.0 };
        let nothing =
            cross_approximation(&mut Known(Mat::zeros(9, 7)), (9, 7), &[0, 5], allowance).expect("zero");
        assert_eq!(nothing.rank, 0);
        let identity = Mat::identity(12, 12);
        assert_eq!(cross_approximation(&mut Known(identity), (12, 12), &[0], allowance), None);
    }
}
