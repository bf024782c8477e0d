//! Displacements out of a scalar response's entries and forces.

use faer::Mat;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::kernels::{SHARED_WORK, add_terms};

/// Rows of a block that one thread sums at a time, and the columns that it does so for.
const ROWS_PER_TASK: usize = 128;
const COLUMNS_AT_ONCE: usize = 32;

/// `Σ_j R_ij f_j` (m) of all rows.
///
/// * `block`: entries R_ij (m/N), a column for each force
/// * `forces`: f_j (N)
pub(crate) fn displaced(block: &Mat<f64>, forces: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let places = Vec::from_iter(0..block.nrows());
    displaced_at(&places, |column| block.col_as_slice(column), forces)
}

/// `Σ_j R_ij f_j` (m) of rows by their places, in that order.
///
/// * `column`: entries R_ij of each j (m/N) up to the last of the places
/// * `forces`: f_j (N)
pub(crate) fn displaced_at<'a>(
    places: &[usize],
    column: impl Fn(usize) -> &'a [f64] + Sync,
    forces: &[Vector3<f64>],
) -> Vec<Vector3<f64>> {
    let count = places.iter().max().map_or(0, |last| last + 1);
    // The sums as the entries lie, of whole runs of rows with one that is asked for.
    let mut moved = vec![Vector3::zeros(); count];
    let mut is_asked = vec![false; count.div_ceil(ROWS_PER_TASK)];
    places.iter().for_each(|place| is_asked[place / ROWS_PER_TASK] = true);
    let sum_rows = |(task, vectors): (usize, &mut [Vector3<f64>])| {
        if !is_asked[task] {
            return;
        }
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
    let runs = is_asked.iter().filter(|is_asked| **is_asked).count();
    if runs * ROWS_PER_TASK * forces.len() < SHARED_WORK {
        moved.chunks_mut(ROWS_PER_TASK).enumerate().for_each(sum_rows);
    } else {
        moved.par_chunks_mut(ROWS_PER_TASK).enumerate().for_each(sum_rows);
    }
    places.iter().map(|&place| moved[place]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Random;

    #[test]
    fn sums_in_tasks_and_groups_of_columns_are_those_of_rows() {
        let mut random = Random(5);
        for (rows, columns) in [(3, 2), (700, 33), (1100, 300)] {
            let entries = Mat::from_fn(rows, columns, |_, _| random.signed());
            let forces: Vec<Vector3<f64>> =
                (0..columns).map(|_| Vector3::from_fn(|_, _| random.signed())).collect();
            let moved = displaced(&entries, &forces);
            assert_eq!(moved.len(), rows);
            let some = [rows - 1, 0, rows / 2];
            let at_some = displaced_at(&some, |column| entries.col_as_slice(column), &forces);
            assert_eq!(at_some, some.map(|row| moved[row]));
            for (row, vector) in moved.iter().enumerate() {
                let terms = forces.iter().enumerate().map(|(column, force)| entries[(row, column)] * force);
                let sum: Vector3<f64> = terms.sum();
                assert!((vector - sum).norm() < 1e-12 * columns as f64, "row {row} of {rows}");
            }
        }
    }
}
