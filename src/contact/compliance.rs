//! The response as the pipeline uses it: a square matrix over candidates, displacements anywhere under forces.

use super::{ContactError, ContactOptions, Interrupt};
use crate::response::{self, AssemblyOptions, Skin};
use crate::surface::Surface;
use faer::Mat;
use nalgebra::Vector3;

/// Rows handled at a time where displacements are wanted over the whole surface, so that memory stays small.
const ROWS_AT_ONCE: usize = 4096;

/// Relative quadrature tolerance of displacements away from the candidates, which are drawn and summed to a
/// volume but enter no complementarity.
const DISPLACEMENT_TOLERANCE: f64 = 1e-3;

/// A skin's response on a surface.
pub(super) struct Compliance<'a> {
    surface: &'a Surface,
    skin: &'a Skin,
    options: AssemblyOptions<'a>,
}

/// Displacement at a list of vertices.
pub(super) struct Field {
    /// (R f)_i (m), along the obstacle's normal.
    pub magnitude: Vec<f64>,
    /// Unit direction of Σ_j R_ij f_j n_j, turned so that a positive magnitude goes along the forces; zero where
    /// nothing moves.
    pub direction: Vec<Vector3<f64>>,
}

impl<'a> Compliance<'a> {
    pub fn new(
        surface: &'a Surface,
        skin: &'a Skin,
        options: &ContactOptions,
        interrupt: Interrupt<'a>,
    ) -> Self {
        let options = AssemblyOptions {
            tolerance: options.tolerance,
            memory_limit: options.memory_limit,
            interrupt: Some(interrupt),
            ..AssemblyOptions::default()
        };
        Self { surface, skin, options }
    }

    /// Whether a force somewhere can pull the skin towards the obstacle elsewhere.
    pub fn has_negative_entries(&self) -> bool {
        self.skin.has_negative_entries()
    }

    /// Distance beyond which a force is not felt (m); `None`: felt everywhere.
    pub fn reach(&self) -> Option<f64> {
        self.skin.reach()
    }

    /// R over `nodes` (k × k, m/N); `normals`: obstacle normal per vertex.
    pub fn square(&self, nodes: &[usize], normals: &[Vector3<f64>]) -> Result<Mat<f64>, ContactError> {
        let directions: Vec<Vector3<f64>> = nodes.iter().map(|&vertex| normals[vertex]).collect();
        Ok(response::assemble(self.surface, self.skin, nodes, Some(&directions), &self.options)?)
    }

    /// Displacement of `vertices` under the forces of `active`; `node_force` and `normals` are per vertex.
    pub fn displacement(
        &self,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Field, ContactError> {
        let mut field = Field {
            magnitude: Vec::with_capacity(vertices.len()),
            direction: Vec::with_capacity(vertices.len()),
        };
        let tolerance = self.options.tolerance.max(DISPLACEMENT_TOLERANCE);
        let options = AssemblyOptions { tolerance, ..self.options };
        for rows in vertices.chunks(ROWS_AT_ONCE) {
            let block = response::assemble_block(self.surface, self.skin, rows, active, &options)?;
            let (mut magnitude, mut vector) = (vec![0.0; rows.len()], vec![Vector3::zeros(); rows.len()]);
            for (column, &vertex) in active.iter().enumerate() {
                let (force, normal) = (node_force[vertex], normals[vertex]);
                for (row, entry) in block.col(column).iter().enumerate() {
                    let share = entry * force;
                    magnitude[row] += share;
                    vector[row] += share * normal;
                }
            }
            for (magnitude, vector) in magnitude.into_iter().zip(vector) {
                let length = vector.norm();
                let sign = if magnitude < 0.0 { -1.0 } else { 1.0 };
                field.direction.push(if length > 0.0 { vector * (sign / length) } else { Vector3::zeros() });
                field.magnitude.push(magnitude);
            }
        }
        Ok(field)
    }
}
