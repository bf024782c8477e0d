//! What a contact asks of a skin.

use faer::Mat;
use nalgebra::Vector3;

use crate::response::error::ResponseError;
use crate::response::kernel::skin::{Gap, Pressure, Skin};
use crate::response::matrix::collocation::{assemble, assemble_block};
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;

/// Displacement of some vertices under forces at others.
#[derive(Debug, Clone)]
pub struct Displacements {
    /// u (m), one vector a vertex.
    pub vectors: Vec<Vector3<f64>>,
    /// `(R f)_i` (m), along the obstacle's normal at each vertex, where the response does not depend on directions;
    /// `None` where the vector is the whole truth.
    pub along_normal: Vec<Option<f64>>,
}

/// What a contact asks of a skin: a [`Skin`] computes it, a [`PreparedSkin`](crate::response::PreparedSkin) looks it up.
pub trait ElasticSkin: Sync {
    /// Whether this skin fits the surface.
    ///
    /// # Errors
    /// [`ResponseError`] saying what does not.
    fn check_surface(&self, surface: &Surface) -> Result<(), ResponseError>;

    /// Whether a force somewhere can pull the skin towards the obstacle elsewhere.
    fn has_negative_entries(&self) -> bool;

    /// Distance beyond which a force is not felt (m); `None`: felt everywhere.
    fn reach(&self) -> Option<f64>;

    /// Whether a displacement follows from the straight line to the force, in ignorance of the body's shape.
    fn is_kernel(&self) -> bool;

    /// How a node's force is spread.
    fn pressure(&self) -> Pressure;

    /// How the gap of a node is measured.
    fn gap(&self) -> Gap;

    /// Whether the response to a force at `vertex` is known.
    fn knows(&self, vertex: usize) -> bool;

    /// Vertices that each solved body moves. Such a body tells the change of its volume to first order, and its
    /// deformed skin is to keep to that.
    fn bodies(&self) -> Vec<Vec<usize>> {
        Vec::new()
    }

    /// R over `nodes` along `directions` (k × k, m/N).
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn response_matrix(
        &self,
        surface: &Surface,
        nodes: &[usize],
        directions: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Mat<f64>, ResponseError>;

    /// Displacement of `vertices` under `forces` (N) at `nodes`.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn displacements(
        &self,
        surface: &Surface,
        vertices: &[usize],
        nodes: &[usize],
        forces: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Displacements, ResponseError>;
}

/// Rows handled at a time where displacements are wanted over the whole surface, so that memory stays small.
const ROWS_AT_ONCE: usize = 4096;

impl ElasticSkin for Skin {
    fn check_surface(&self, surface: &Surface) -> Result<(), ResponseError> {
        self.check_against(surface)
    }

    fn has_negative_entries(&self) -> bool {
        self.has_negative_entries()
    }

    fn reach(&self) -> Option<f64> {
        self.reach()
    }

    fn is_kernel(&self) -> bool {
        true
    }

    fn pressure(&self) -> Pressure {
        self.pressure()
    }

    fn gap(&self) -> Gap {
        self.gap()
    }

    fn knows(&self, _: usize) -> bool {
        true
    }

    fn response_matrix(
        &self,
        surface: &Surface,
        nodes: &[usize],
        directions: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Mat<f64>, ResponseError> {
        assemble(surface, self, nodes, Some(directions), options)
    }

    fn displacements(
        &self,
        surface: &Surface,
        vertices: &[usize],
        nodes: &[usize],
        forces: &[Vector3<f64>],
        options: &AssemblyOptions,
    ) -> Result<Displacements, ResponseError> {
        // Displacements are those of the vertices, however the gap is measured.
        let at_vertices = self.with_gap(Gap::Node);
        let mut vectors = Vec::with_capacity(vertices.len());
        let mut along_normal = Vec::with_capacity(vertices.len());
        for rows in vertices.chunks(ROWS_AT_ONCE) {
            let block = assemble_block(surface, &at_vertices, rows, nodes, options)?;
            add_products(&block, forces, &mut vectors, &mut along_normal);
        }
        Ok(Displacements { vectors, along_normal: along_normal.into_iter().map(Some).collect() })
    }
}

/// Appends `Σ_j R_ij f_j` and `Σ_j R_ij |f_j|` of every row of a block.
pub(crate) fn add_products(
    block: &Mat<f64>,
    forces: &[Vector3<f64>],
    vectors: &mut Vec<Vector3<f64>>,
    along_normal: &mut Vec<f64>,
) {
    let first = vectors.len();
    vectors.resize(first + block.nrows(), Vector3::zeros());
    along_normal.resize(first + block.nrows(), 0.0);
    for (column, force) in block.col_iter().zip(forces) {
        let size = force.norm();
        for (row, entry) in column.iter().enumerate() {
            vectors[first + row] += *entry * force;
            along_normal[first + row] += *entry * size;
        }
    }
}
