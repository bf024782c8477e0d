//! A response computed once for a surface, stored, moved with it and used for every product.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::body::compliance::BodyCompliance;
use crate::response::body::solve::{Body, BodyOptions};
use crate::response::error::ResponseError;
use crate::response::kernel::skin::{Gap, Pressure, Skin};
use crate::response::matrix::collocation::assemble;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::{Displacements, ElasticSkin};
use crate::surface::checked::Surface;

/// Largest distance, in mean edge lengths, between the vertices of a surface and those that a response was
/// prepared for: rounding of a rigid motion, and no more.
const SAME_SHAPE: f64 = 1e-6;

/// What was computed.
#[derive(Debug, Clone)]
pub enum PreparedResponse {
    /// R of a kernel over the nodes (k × k, m/N), and the skin that it came from.
    Kernel {
        /// Material and kernel.
        skin: Skin,
        /// R (k × k, m/N).
        matrix: Arc<Mat<f64>>,
    },
    /// The compliance of a body.
    Body(BodyCompliance),
    /// 3 × 3 blocks that somebody else computed or measured, in the form of a body's compliance; vertices other
    /// than the nodes stay.
    GivenBlocks(BodyCompliance),
    /// A matrix that somebody else computed or measured (k × k, m/N), along the obstacle's normals.
    Given(Arc<Mat<f64>>),
}

/// A response computed once for a surface; it goes wherever a [`Skin`] goes.
#[derive(Debug, Clone)]
pub struct PreparedSkin {
    response: PreparedResponse,
    nodes: Arc<[usize]>,
    /// Row of each vertex; `usize::MAX` where its response is not known.
    row_of: Arc<[usize]>,
    /// Shape that it was prepared for, where it stands now.
    vertices: Arc<[Vector3<f64>]>,
    faces: Arc<[[u32; 3]]>,
}

impl PreparedSkin {
    /// Puts a response that is known already to the surface and nodes that it belongs to.
    ///
    /// # Errors
    /// [`ResponseError::NodeOutOfRange`], [`ResponseError::RepeatedNode`], [`ResponseError::MatrixShape`],
    /// [`ResponseError::MatrixEntry`].
    pub fn new(
        surface: &Surface,
        nodes: &[usize],
        response: PreparedResponse,
    ) -> Result<Self, ResponseError> {
        let vertex_count = surface.vertices().len();
        let mut row_of = vec![usize::MAX; vertex_count];
        for (row, &vertex) in nodes.iter().enumerate() {
            let index = row;
            let known =
                *row_of.get(vertex).ok_or(ResponseError::NodeOutOfRange { index, vertex, vertex_count })?;
            if known != usize::MAX {
                return Err(ResponseError::RepeatedNode { vertex, first: known, second: row });
            }
            row_of[vertex] = row;
        }
        if let PreparedResponse::Kernel { matrix, .. } | PreparedResponse::Given(matrix) = &response {
            let (rows, columns) = (matrix.nrows(), matrix.ncols());
            if (rows, columns) != (nodes.len(), nodes.len()) {
                return Err(ResponseError::MatrixShape { rows, columns, nodes: nodes.len() });
            }
            for (column, entries) in matrix.col_iter().enumerate() {
                if let Some((row, &value)) = entries.iter().enumerate().find(|(_, value)| !value.is_finite())
                {
                    return Err(ResponseError::MatrixEntry { row, column, value });
                }
            }
        }
        Ok(Self {
            response,
            nodes: nodes.into(),
            row_of: row_of.into(),
            vertices: surface.vertices().into(),
            faces: surface.faces().into(),
        })
    }

    /// Computes the response matrix of a kernel over `nodes`.
    ///
    /// # Errors
    /// As [`assemble`].
    pub fn of_kernel(
        surface: &Surface,
        skin: &Skin,
        nodes: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let matrix = Arc::new(assemble(surface, skin, nodes, None, options)?);
        Self::new(surface, nodes, PreparedResponse::Kernel { skin: skin.clone(), matrix })
    }

    /// Solves a body for unit forces at `nodes`.
    ///
    /// # Errors
    /// [`ResponseError::Body`] as [`Body::prepare`].
    pub fn of_body(
        surface: &Surface,
        body: &Body,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<Self, ResponseError> {
        let compliance = body.prepare(surface, shear_modulus, poisson_ratio, nodes, options)?;
        Self::new(surface, nodes, PreparedResponse::Body(compliance))
    }

    /// What was computed.
    pub fn response(&self) -> &PreparedResponse {
        &self.response
    }

    /// Vertices whose response is known, in the order of the rows.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Vertices (m) of the surface that it belongs to, where it stands now.
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// Faces of the surface that it belongs to.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The same response for the surface after a rigid motion.
    ///
    /// # Errors
    /// [`ResponseError::Body`] if a body's compliance refuses the rotation.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let turn = motion.rotation.to_rotation_matrix();
        let response = match &self.response {
            PreparedResponse::Body(compliance) => PreparedResponse::Body(compliance.moved(turn.matrix())?),
            PreparedResponse::GivenBlocks(blocks) => {
                PreparedResponse::GivenBlocks(blocks.moved(turn.matrix())?)
            }
            other => other.clone(),
        };
        let shift = motion.translation.vector;
        let vertices = self.vertices.iter().map(|vertex| turn * vertex + shift).collect();
        Ok(Self { response, vertices, ..self.clone() })
    }

    /// Pressure (Pa) on every vertex of the bone under a force (N) at every vertex of the surface; `None` if the
    /// body was not asked for it or there is no body.
    ///
    /// # Errors
    /// [`ResponseError::ForceCount`]; [`ResponseError::NotPrepared`] for a force where the response is not known.
    pub fn bone_pressures(&self, forces: &[Vector3<f64>]) -> Result<Option<Vec<f64>>, ResponseError> {
        let (found, expected) = (forces.len(), self.vertices.len());
        if found != expected {
            return Err(ResponseError::ForceCount { found, expected });
        }
        let PreparedResponse::Body(compliance) = &self.response else { return Ok(None) };
        let loaded: Vec<usize> = (0..found).filter(|&vertex| forces[vertex] != Vector3::zeros()).collect();
        self.rows(&loaded)?;
        let at_nodes: Vec<Vector3<f64>> = self.nodes.iter().map(|&vertex| forces[vertex]).collect();
        Ok(compliance.bone_pressures(&at_nodes)?)
    }

    /// Rows of `nodes`.
    fn rows(&self, nodes: &[usize]) -> Result<Vec<usize>, ResponseError> {
        let unknown = |vertex: usize| self.row_of[vertex] == usize::MAX;
        if let Some(&vertex) = nodes.iter().find(|&&vertex| unknown(vertex)) {
            let missing = nodes.iter().filter(|&&vertex| unknown(vertex)).count();
            return Err(ResponseError::NotPrepared { vertex, missing, prepared: self.nodes.len() });
        }
        Ok(nodes.iter().map(|&vertex| self.row_of[vertex]).collect())
    }
}

impl ElasticSkin for PreparedSkin {
    fn check_surface(&self, surface: &Surface) -> Result<(), ResponseError> {
        let (found, expected) = (surface.vertices().len(), self.vertices.len());
        if found != expected {
            return Err(ResponseError::OtherSurface { what: "number of vertices", found, expected });
        }
        if surface.faces() != &self.faces[..] {
            let differ = |(a, b): (&[u32; 3], &[u32; 3])| a != b;
            let faces = surface.faces().iter().zip(self.faces.iter());
            let found = faces.filter(|pair| differ(*pair)).count();
            return Err(ResponseError::OtherSurface { what: "faces that differ", found, expected: 0 });
        }
        let allowed = SAME_SHAPE * surface.mean_edge_length();
        let distance = |vertex: usize| (surface.vertices()[vertex] - self.vertices[vertex]).norm();
        match (0..found).find(|&vertex| distance(vertex) > allowed) {
            Some(vertex) => Err(ResponseError::OtherShape { vertex, distance: distance(vertex), allowed }),
            None => Ok(()),
        }
    }

    fn has_negative_entries(&self) -> bool {
        match &self.response {
            PreparedResponse::Kernel { skin, .. } => skin.has_negative_entries(),
            PreparedResponse::Body(_) | PreparedResponse::GivenBlocks(_) => true,
            PreparedResponse::Given(matrix) => {
                matrix.col_iter().any(|column| column.iter().any(|&entry| entry < 0.0))
            }
        }
    }

    fn reach(&self) -> Option<f64> {
        match &self.response {
            PreparedResponse::Kernel { skin, .. } => skin.reach(),
            _ => None,
        }
    }

    fn is_kernel(&self) -> bool {
        matches!(self.response, PreparedResponse::Kernel { .. })
    }

    fn pressure(&self) -> Pressure {
        match &self.response {
            PreparedResponse::Kernel { skin, .. } => skin.pressure(),
            _ => Pressure::Linear,
        }
    }

    fn gap(&self) -> Gap {
        match &self.response {
            PreparedResponse::Kernel { skin, .. } => skin.gap(),
            _ => Gap::Node,
        }
    }

    fn knows(&self, vertex: usize) -> bool {
        self.row_of[vertex] != usize::MAX
    }

    fn bodies(&self) -> Vec<Vec<usize>> {
        match &self.response {
            PreparedResponse::Body(_) => vec![(0..self.vertices.len()).collect()],
            _ => Vec::new(),
        }
    }

    fn response_matrix(
        &self,
        _: &Surface,
        nodes: &[usize],
        directions: &[Vector3<f64>],
        _: &AssemblyOptions,
    ) -> Result<Mat<f64>, ResponseError> {
        let rows = self.rows(nodes)?;
        let size = nodes.len();
        if directions.len() != size {
            return Err(ResponseError::DirectionCount { directions: directions.len(), nodes: size });
        }
        Ok(match &self.response {
            PreparedResponse::Kernel { matrix, .. } | PreparedResponse::Given(matrix) => {
                Mat::from_fn(size, size, |i, j| matrix[(rows[i], rows[j])])
            }
            PreparedResponse::Body(compliance) | PreparedResponse::GivenBlocks(compliance) => {
                compliance.response_among(&rows, directions)?
            }
        })
    }

    fn displacements(
        &self,
        surface: &Surface,
        vertices: &[usize],
        nodes: &[usize],
        forces: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Displacements, ResponseError> {
        let rows = self.rows(nodes)?;
        match &self.response {
            PreparedResponse::Kernel { skin, .. } => {
                skin.displacements(surface, vertices, nodes, forces, options)
            }
            PreparedResponse::Body(compliance) | PreparedResponse::GivenBlocks(compliance) => {
                let mut all = vec![Vector3::zeros(); self.nodes.len()];
                rows.iter().zip(forces).for_each(|(&row, force)| all[row] = *force);
                let moved = compliance.displacements(&all)?;
                let vectors = vertices.iter().map(|&vertex| moved[vertex]).collect();
                Ok(Displacements { vectors, along_normal: vec![None; vertices.len()] })
            }
            PreparedResponse::Given(matrix) => {
                // Nothing is known of the other vertices: they stay.
                let entry = |vertex: usize, row: usize| match self.row_of[vertex] {
                    usize::MAX => 0.0,
                    known => matrix[(known, row)],
                };
                let block = Mat::from_fn(vertices.len(), rows.len(), |i, j| entry(vertices[i], rows[j]));
                let (mut vectors, mut along_normal) = (Vec::new(), Vec::new());
                crate::response::skin::elastic::add_products(&block, forces, &mut vectors, &mut along_normal);
                Ok(Displacements { vectors, along_normal: along_normal.into_iter().map(Some).collect() })
            }
        }
    }
}
