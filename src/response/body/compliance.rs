//! What a body response keeps: the displacement of the whole skin per unit force at chosen nodes.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::geometry::direction::first_off_unit;
use crate::geometry::rigid_motion::check_rotation;
use crate::response::body::check::parts::{Range, check_counts, check_numbers, entries};
use crate::response::body::check::tissue::check_nodes;
use crate::response::body::error::BodyError;

/// Everything in a [`BodyCompliance`], to store it and to build it again.
#[derive(Debug, Clone)]
pub struct BodyParts {
    /// Loaded skin vertices, in the order of the columns.
    pub nodes: Vec<usize>,
    /// `(3 n, 3 k)` (m/N): entry (3 i + a, 3 j + b) is the displacement of skin vertex i along a per newton at node
    /// j along b, before `rotation`.
    pub displacement: Mat<f64>,
    /// `(m, 3 k)` (1/m²): pressure on each bone vertex per newton, before `rotation`; `None` if not asked for.
    pub bone_pressure: Option<Mat<f64>>,
    /// How the body has been turned since.
    pub rotation: Matrix3<f64>,
    /// G (Pa).
    pub shear_modulus: f64,
    /// ν.
    pub poisson_ratio: f64,
}

/// Displacement of the whole skin per unit force at chosen nodes; cheap to copy and to turn.
#[derive(Debug, Clone)]
pub struct BodyCompliance {
    parts: Arc<BodyParts>,
    rotation: Matrix3<f64>,
}

impl BodyCompliance {
    pub(crate) fn new(parts: BodyParts) -> Self {
        let rotation = parts.rotation;
        BodyCompliance { parts: Arc::new(parts), rotation }
    }

    /// Builds a compliance from stored parts.
    ///
    /// # Errors
    /// [`BodyError::Parts`]: sizes that do not belong together; [`BodyError::PartNumber`]; [`BodyError::Rotation`];
    /// [`BodyError::NoNodes`], [`BodyError::Nodes`].
    pub fn from_parts(parts: BodyParts) -> Result<Self, BodyError> {
        let (vertex_count, columns) = (parts.displacement.nrows() / 3, 3 * parts.nodes.len());
        check_counts(&[
            ("displacement rows", parts.displacement.nrows(), 3 * vertex_count),
            ("displacement columns", parts.displacement.ncols(), columns),
            ("bone pressure columns", parts.bone_pressure.as_ref().map_or(columns, Mat::ncols), columns),
        ])?;
        check_nodes(vertex_count, &vec![false; vertex_count], &parts.nodes)?;
        check_numbers("displacement", Range::Finite, entries(&parts.displacement))?;
        check_numbers("bone pressure", Range::Finite, parts.bone_pressure.iter().flat_map(entries))?;
        check_rotation(&parts.rotation)?;
        Ok(Self::new(parts))
    }

    /// The stored numbers; their rotation is the one at construction, see [`BodyCompliance::rotation`].
    pub fn parts(&self) -> &BodyParts {
        &self.parts
    }

    /// How the body has been turned in all, since its equations were solved.
    pub fn rotation(&self) -> &Matrix3<f64> {
        &self.rotation
    }

    /// Loaded skin vertices, in the order of the matrices' rows and columns.
    pub fn nodes(&self) -> &[usize] {
        &self.parts.nodes
    }

    /// Number of skin vertices.
    pub fn vertex_count(&self) -> usize {
        self.parts.displacement.nrows() / 3
    }

    /// Displacement of skin vertex `vertex` per unit force at node number `node` (3 × 3, m/N).
    pub fn block(&self, vertex: usize, node: usize) -> Matrix3<f64> {
        self.rotation * self.stored_block(vertex, node) * self.rotation.transpose()
    }

    /// Displacement of every skin vertex per newton at node number `node` along x, y and z, before the
    /// [rotation](Self::rotation) (three times 3 n, m/N).
    pub(crate) fn columns(&self, node: usize) -> [&[f64]; 3] {
        [0, 1, 2].map(|axis| self.parts.displacement.col_as_slice(3 * node + axis))
    }

    fn stored_block(&self, vertex: usize, node: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|a, b| self.parts.displacement[(3 * vertex + a, 3 * node + b)])
    }

    /// The same body turned by `rotation`.
    ///
    /// # Errors
    /// [`BodyError::Rotation`] if it is no rotation.
    pub fn moved(&self, rotation: &Matrix3<f64>) -> Result<Self, BodyError> {
        check_rotation(rotation)?;
        Ok(BodyCompliance { rotation: rotation * self.rotation, ..self.clone() })
    }

    /// Directions or forces as the stored matrices see them.
    fn all_turned_back(&self, vectors: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vectors.iter().map(|vector| self.turned_back(vector)).collect()
    }

    /// A direction or a force as the stored matrices see it.
    pub(crate) fn turned_back(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(vector)
    }

    /// Response matrix `R_ij = n_i · C_ij n_j` along the nodes' directions.
    ///
    /// * `directions`: (k) unit vectors, the obstacle's outward normal at each node
    ///
    /// Returns R (k × k, m/N).
    ///
    /// # Errors
    /// [`BodyError::Length`], [`BodyError::DirectionLength`].
    pub fn response_along(&self, directions: &[Vector3<f64>]) -> Result<Mat<f64>, BodyError> {
        check_length("directions", directions.len(), self.parts.nodes.len())?;
        if let Some((index, length)) = first_off_unit(directions) {
            return Err(BodyError::DirectionLength { index, length });
        }
        let everything: Vec<usize> = (0..self.parts.nodes.len()).collect();
        Ok(self.response_among(&everything, directions))
    }

    /// Response matrix over some of the nodes, by their place in [`BodyCompliance::nodes`], along one unit direction
    /// for each (k × k, m/N), all checked.
    pub(crate) fn response_among(&self, nodes: &[usize], directions: &[Vector3<f64>]) -> Mat<f64> {
        let directions = self.all_turned_back(directions);
        let vertices: Vec<usize> = nodes.iter().map(|&node| self.parts.nodes[node]).collect();
        let mut response = Mat::zeros(nodes.len(), nodes.len());
        for (j, (&node, n_j)) in nodes.iter().zip(&directions).enumerate() {
            let [x, y, z] = self.columns(node);
            let column = response.col_as_slice_mut(j);
            for ((entry, &vertex), n_i) in column.iter_mut().zip(&vertices).zip(&directions) {
                let along = |a: usize| {
                    x[3 * vertex + a] * n_j.x + y[3 * vertex + a] * n_j.y + z[3 * vertex + a] * n_j.z
                };
                *entry = n_i.x * along(0) + n_i.y * along(1) + n_i.z * along(2);
            }
        }
        response
    }

    /// Displacement (m) of every skin vertex under forces (N) at the nodes.
    ///
    /// # Errors
    /// [`BodyError::Length`].
    pub fn displacements(&self, forces: &[Vector3<f64>]) -> Result<Vec<Vector3<f64>>, BodyError> {
        check_length("forces", forces.len(), self.parts.nodes.len())?;
        let loaded: Vec<usize> = (0..forces.len()).filter(|&j| forces[j] != Vector3::zeros()).collect();
        let forces: Vec<Vector3<f64>> = loaded.iter().map(|&j| forces[j]).collect();
        let everywhere: Vec<usize> = (0..self.vertex_count()).collect();
        Ok(self.displacements_among(&everywhere, &loaded, &forces))
    }

    /// Displacement (m) of some skin vertices under forces (N) at some of the nodes, by their place in
    /// [`BodyCompliance::nodes`].
    pub(crate) fn displacements_among(
        &self,
        vertices: &[usize],
        nodes: &[usize],
        forces: &[Vector3<f64>],
    ) -> Vec<Vector3<f64>> {
        let mut moved = vec![Vector3::zeros(); vertices.len()];
        for (&node, force) in nodes.iter().zip(forces) {
            let force = self.turned_back(force);
            let [x, y, z] = self.columns(node).map(|column| column.as_chunks::<3>().0);
            for (sum, &vertex) in moved.iter_mut().zip(vertices) {
                let [x, y, z] = [&x[vertex], &y[vertex], &z[vertex]];
                *sum += Vector3::from_fn(|a, _| x[a] * force.x + y[a] * force.y + z[a] * force.z);
            }
        }
        moved.iter_mut().for_each(|u| *u = self.rotation * *u);
        moved
    }

    /// Pressure (Pa) on every bone vertex under forces (N) at the nodes; `None` if it was not asked for.
    ///
    /// # Errors
    /// [`BodyError::Length`].
    pub fn bone_pressures(&self, forces: &[Vector3<f64>]) -> Result<Option<Vec<f64>>, BodyError> {
        check_length("forces", forces.len(), self.parts.nodes.len())?;
        let forces = self.all_turned_back(forces);
        Ok(self.parts.bone_pressure.as_ref().map(|stored| {
            let mut sums = vec![0.0; stored.nrows()];
            for (j, force) in forces.iter().enumerate() {
                for axis in 0..3 {
                    let column = stored.col_as_slice(3 * j + axis);
                    sums.iter_mut().zip(column).for_each(|(sum, value)| *sum += value * force[axis]);
                }
            }
            sums
        }))
    }
}

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), BodyError> {
    if found == expected { Ok(()) } else { Err(BodyError::Length { what, found, expected }) }
}
