//! The response as the pipeline uses it: a square matrix over candidates, displacements anywhere under forces.

use super::{ContactError, ContactOptions, Interrupt};
use crate::response::{AssemblyOptions, Displacements, ElasticSkin};
use crate::surface::Surface;
use faer::Mat;
use nalgebra::Vector3;

/// Relative quadrature tolerance of displacements away from the candidates, which are drawn and summed to a
/// volume but enter no complementarity.
const DISPLACEMENT_TOLERANCE: f64 = 1e-3;

/// A skin's response on a surface.
pub(super) struct Compliance<'a> {
    surface: &'a Surface,
    pub skin: &'a dyn ElasticSkin,
    options: AssemblyOptions<'a>,
}

impl<'a> Compliance<'a> {
    pub fn new(
        surface: &'a Surface,
        skin: &'a dyn ElasticSkin,
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

    /// R over `nodes` (k × k, m/N); `normals`: obstacle normal per vertex.
    pub fn square(&self, nodes: &[usize], normals: &[Vector3<f64>]) -> Result<Mat<f64>, ContactError> {
        let directions: Vec<Vector3<f64>> = nodes.iter().map(|&vertex| normals[vertex]).collect();
        Ok(self.skin.response_matrix(self.surface, nodes, &directions, &self.options)?)
    }

    /// Displacement of `vertices` under the forces of `active`; `node_force` and `normals` are per vertex.
    pub fn displacement(
        &self,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Displacements, ContactError> {
        let tolerance = self.options.tolerance.max(DISPLACEMENT_TOLERANCE);
        let options = AssemblyOptions { tolerance, ..self.options };
        let forces: Vec<Vector3<f64>> =
            active.iter().map(|&vertex| node_force[vertex] * normals[vertex]).collect();
        Ok(self.skin.displacements(self.surface, vertices, active, &forces, &options)?)
    }
}
