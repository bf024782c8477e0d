//! The response as the pipeline uses it: a square matrix over candidates, displacements anywhere under forces.

use faer::Mat;
use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::error::ContactError;
use crate::contact::options::{ContactOptions, Interrupt};
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::{Displacements, ElasticSkin};
use crate::surface::checked::Surface;

/// Relative quadrature tolerance of displacements away from the candidates, which are drawn and summed to a
/// volume but enter no complementarity.
const DISPLACEMENT_TOLERANCE: f64 = 1e-3;

/// A skin's response on a surface.
pub(crate) struct Compliance<'a> {
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

    /// Displacement of `vertices` under the forces of `active`, each under those of its own finger; `node_force`
    /// and `normals` are per vertex. To no more than [`DISPLACEMENT_TOLERANCE`].
    pub fn displacement(
        &self,
        fingers: &Fingers,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Displacements, ContactError> {
        let tolerance = self.options.tolerance.max(DISPLACEMENT_TOLERANCE);
        let options = AssemblyOptions { tolerance, ..self.options };
        self.displacement_to(&options, fingers, vertices, active, node_force, normals)
    }

    /// `(R f)_i` (m) at `vertices`, to the tolerance of R itself; the arguments are those of
    /// [`displacement`](Self::displacement), of a response that knows no directions.
    pub fn rise(
        &self,
        fingers: &Fingers,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Vec<f64>, ContactError> {
        let moved = self.displacement_to(&self.options, fingers, vertices, active, node_force, normals)?;
        let known = |rise: Option<f64>| rise.expect("only kernels average the gap");
        Ok(moved.along_normal.into_iter().map(known).collect())
    }

    fn displacement_to(
        &self,
        options: &AssemblyOptions,
        fingers: &Fingers,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Displacements, ContactError> {
        let count = fingers.candidates.len();
        if count == 1 {
            return self.displacement_of_one(options, vertices, active, node_force, normals);
        }
        let mut all = Displacements {
            vectors: vec![Vector3::zeros(); vertices.len()],
            along_normal: vec![Some(0.0); vertices.len()],
        };
        for finger in 0..count {
            let rows: Vec<usize> =
                (0..vertices.len()).filter(|&row| fingers.of(vertices[row]) == Some(finger)).collect();
            let own: Vec<usize> = rows.iter().map(|&row| vertices[row]).collect();
            let active: Vec<usize> =
                active.iter().copied().filter(|&vertex| fingers.of(vertex) == Some(finger)).collect();
            let moved = self.displacement_of_one(options, &own, &active, node_force, normals)?;
            rows.iter().zip(moved.vectors).for_each(|(&row, vector)| all.vectors[row] = vector);
            rows.iter().zip(moved.along_normal).for_each(|(&row, rise)| all.along_normal[row] = rise);
        }
        Ok(all)
    }

    fn displacement_of_one(
        &self,
        options: &AssemblyOptions,
        vertices: &[usize],
        active: &[usize],
        node_force: &[f64],
        normals: &[Vector3<f64>],
    ) -> Result<Displacements, ContactError> {
        let forces: Vec<Vector3<f64>> =
            active.iter().map(|&vertex| node_force[vertex] * normals[vertex]).collect();
        Ok(self.skin.displacements(self.surface, vertices, active, &forces, options)?)
    }
}
