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
