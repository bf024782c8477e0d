//! What is left of a body without its near kernel, on the coarse mesh.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::linalg::kernels;
use crate::response::body::compliance::BodyCompliance;
use crate::response::body::levels::gathered::{Blocks, Gathered, MOST_TIMES_ASKED};
use crate::response::body::levels::near::NearKernel;
use crate::response::error::ResponseError;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::rows::{NO_ROW, rows_of_vertices};
use crate::surface::checked::Surface;

/// Rows and columns of near blocks at a time, so that memory stays small.
const NEAR_BLOCKS_AT_ONCE: usize = 256;

/// What is left of a body without its near kernel, on the coarse mesh.
#[derive(Debug, Clone)]
pub(crate) struct Remainder {
    /// `B - N`, or B where `near` is to be taken off when it is asked for.
    compliance: BodyCompliance,
    near: Option<(Surface, NearKernel)>,
    /// Column (in blocks of 3) of each coarse vertex, [`NO_ROW`] for none.
    columns: Arc<[usize]>,
    gathered: Gathered,
}

impl Remainder {
    /// * `near`: coarse mesh where it stands now, and the kernel to take off `compliance` there
    /// * `gathered`: what was asked of the same compliance before, wherever it was turned to
    pub fn new(compliance: &BodyCompliance, near: Option<(Surface, NearKernel)>, gathered: Gathered) -> Self {
        let columns = rows_of_vertices(compliance.vertex_count(), compliance.nodes());
        let columns = columns.expect("a compliance has checked its nodes").into();
        Self { compliance: compliance.clone(), near, columns, gathered }
    }

    /// Number of coarse vertices whose response is known.
    pub fn loaded_count(&self) -> usize {
        self.compliance.nodes().len()
    }

    /// Whether the response to a force at a coarse vertex is known.
    pub fn is_loaded(&self, vertex: u32) -> bool {
        self.columns[vertex as usize] != NO_ROW
    }

    /// A direction or a force as the [blocks](Self::blocks) see it.
    pub fn turned_back(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.compliance.turned_back(vector)
    }

    /// Displacement of `rows` at least per newton at `columns` at least, coarse vertices, along the axes that the body was
    /// solved in.
    pub fn between(
        &self,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Arc<Blocks>, ResponseError> {
        self.gathered.between(rows, columns, |rows, columns| self.gather(rows, columns, options))
    }

    fn gather(
        &self,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Mat<f64>, ResponseError> {
        let mut all = Mat::zeros(3 * rows.len(), 3 * columns.len());
        for (j, &column) in columns.iter().enumerate() {
            for (axis, stored) in self.compliance.columns(self.columns[column]).into_iter().enumerate() {
                let blocks = all.col_as_slice_mut(3 * j + axis).as_chunks_mut::<3>().0;
                let stored = stored.as_chunks::<3>().0;
                blocks.iter_mut().zip(rows).for_each(|(block, &row)| *block = stored[row]);
            }
        }
        let rotation = self.compliance.rotation();
        self.for_each_near_block(rows, columns, options, |i, j, block| {
            let block = rotation.transpose() * block * rotation;
            for b in 0..3 {
                (0..3).for_each(|a| all[(3 * i + a, 3 * j + b)] -= block[(a, b)]);
            }
        })?;
        Ok(all)
    }

    /// Displacement (m) of `rows` under `forces` (N) at `columns`, coarse vertices.
    pub fn displacements(
        &self,
        rows: &[usize],
        columns: &[usize],
        forces: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        if rows.len() > MOST_TIMES_ASKED * columns.len() {
            // So many are drawn, which is asked for once.
            let loaded: Vec<usize> = columns.iter().map(|&column| self.columns[column]).collect();
            let mut moved = self.compliance.displacements_among(rows, &loaded, forces);
            self.for_each_near_block(rows, columns, options, |i, j, block| moved[i] -= block * forces[j])?;
            return Ok(moved);
        }
        let blocks = self.between(rows, columns, options)?;
        let place = |&column: &usize| 3 * blocks.columns.of(column);
        let first: Vec<usize> = columns.iter().map(place).collect();
        let loads: Vec<Vector3<f64>> = forces.iter().map(|force| self.turned_back(force)).collect();
        let mut sums = vec![0.0; blocks.entries.nrows()];
        kernels::add_terms(&mut sums, 3 * columns.len(), |k| {
            (blocks.entries.col_as_slice(first[k / 3] + k % 3), loads[k / 3][k % 3])
        });
        let sums = sums.as_chunks::<3>().0;
        let turned = |&row: &usize| self.compliance.rotation() * Vector3::from(sums[blocks.rows.of(row)]);
        Ok(rows.iter().map(turned).collect())
    }

    /// What is to be taken off at each of `rows` per newton at each of `columns` (m/N).
    fn for_each_near_block(
        &self,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
        mut work: impl FnMut(usize, usize, Matrix3<f64>),
    ) -> Result<(), ResponseError> {
        let Some((surface, near)) = &self.near else { return Ok(()) };
        for (of_rows, rows) in rows.chunks(NEAR_BLOCKS_AT_ONCE).enumerate() {
            for (of_columns, columns) in columns.chunks(NEAR_BLOCKS_AT_ONCE).enumerate() {
                let near = near.blocks(surface, rows, columns, options)?;
                for j in 0..columns.len() {
                    for i in 0..rows.len() {
                        work(
                            NEAR_BLOCKS_AT_ONCE * of_rows + i,
                            NEAR_BLOCKS_AT_ONCE * of_columns + j,
                            near.block(i, j),
                        );
                    }
                }
            }
        }
        Ok(())
    }
}
