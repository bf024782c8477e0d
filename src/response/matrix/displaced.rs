//! Displacements out of a scalar response's entries and forces.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::kernels::{SHARED_WORK, add_terms};

/// Rows of a block that one thread sums at a time, and the columns that it does so for.
const ROWS_PER_TASK: usize = 512;
const COLUMNS_AT_ONCE: usize = 32;

/// `Σ_j R_ij f_j` (m) of the first `count` rows.
///
/// * `column`: entries R_ij of each j (m/N), at least `count`
/// * `forces`: f_j (N)
pub(crate) fn displaced<'a>(
    count: usize,
    column: impl Fn(usize) -> &'a [f64] + Sync,
    forces: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let mut moved = vec![Vector3::zeros(); count];
    let sum_rows = |(task, vectors): (usize, &mut [Vector3<f64>])| {
        let (first, rows) = (task * ROWS_PER_TASK, vectors.len());
        let mut sums = [[0.0; ROWS_PER_TASK]; 3];
        for (group, forces) in forces.chunks(COLUMNS_AT_ONCE).enumerate() {
            for (axis, sums) in sums.iter_mut().enumerate() {
                let term = |k: usize| (&column(group * COLUMNS_AT_ONCE + k)[first..], forces[k][axis]);
                add_terms(&mut sums[..rows], forces.len(), term);
            }
        }
        let [x, y, z] = &sums;
        for (row, vector) in vectors.iter_mut().enumerate() {
            *vector = Vector3::new(x[row], y[row], z[row]);
        }
    };
    if count * forces.len() < SHARED_WORK {
        moved.chunks_mut(ROWS_PER_TASK).enumerate().for_each(sum_rows);
    } else {
        moved.par_chunks_mut(ROWS_PER_TASK).enumerate().for_each(sum_rows);
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Random;

    #[test]
    fn sums_in_tasks_and_groups_of_columns_are_those_of_rows() {
        let mut random = Random(5);
        for (rows, columns) in [(3, 2), (700, 33), (1100, 300)] {
            let mut list = |count: usize| -> Vec<f64> { (0..count).map(|_| random.signed()).collect() };
            let entries: Vec<Vec<f64>> = (0..columns).map(|_| list(rows + 1)).collect();
            let forces: Vec<Vector3<f64>> = (0..columns).map(|_| Vector3::from_vec(list(3))).collect();
            let moved = displaced(rows, |column| &entries[column], &forces);
            assert_eq!(moved.len(), rows);
            for (row, vector) in moved.iter().enumerate() {
                let sum: Vector3<f64> =
                    entries.iter().zip(&forces).map(|(own, force)| own[row] * force).sum();
                assert!((vector - sum).norm() < 1e-12 * columns as f64, "row {row} of {rows}");
            }
        }
    }
}
