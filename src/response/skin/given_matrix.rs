//! A matrix that somebody else computed or measured.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::error::ResponseError;
use crate::response::matrix::displaced::displaced_at;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::misfit::misfit;
use crate::response::skin::nodes::PreparedNodes;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarsePlace;

/// Displacements along the force (k × k, m/N): R of a contact is that times the cosine between the obstacle's normals.
/// Vertices other than the nodes stay where they are.
#[derive(Debug, Clone)]
pub struct GivenMatrix {
    matrix: Arc<Mat<f64>>,
    nodes: PreparedNodes,
    has_negative_entries: bool,
    misfit: Option<Arc<str>>,
}

impl GivenMatrix {
    /// * `nodes`: (k,) vertices, in the order of the rows
    /// * `matrix`: displacement along the force per newton (k × k, m/N), finite
    ///
    /// # Errors
    /// [`ResponseError::Nodes`], [`ResponseError::MatrixShape`],
    /// [`ResponseError::MatrixEntry`].
    pub fn new(surface: &Surface, nodes: &[usize], matrix: Mat<f64>) -> Result<Self, ResponseError> {
        let nodes = PreparedNodes::new(surface, nodes)?;
        let (rows, columns, count) = (matrix.nrows(), matrix.ncols(), nodes.list().len());
        if (rows, columns) != (count, count) {
            return Err(ResponseError::MatrixShape { rows, columns, nodes: count });
        }
        for (column, entries) in matrix.col_iter().enumerate() {
            if let Some((row, &value)) = entries.iter().enumerate().find(|(_, value)| !value.is_finite()) {
                return Err(ResponseError::MatrixEntry { row, column, value });
            }
        }
        let has_negative_entries = matrix.col_iter().any(|column| column.iter().any(|&entry| entry < 0.0));
        let misfit = misfit(&nodes, |i, j| matrix[(i, j)]).map(Arc::from);
        Ok(Self { matrix: Arc::new(matrix), nodes, has_negative_entries, misfit })
    }

    /// Displacement along the force per newton (k × k, m/N).
    pub fn response_matrix(&self) -> &Mat<f64> {
        &self.matrix
    }

    /// Vertices whose response is known.
    pub fn nodes(&self) -> &PreparedNodes {
        &self.nodes
    }

    pub(crate) fn has_negative_entries(&self) -> bool {
        self.has_negative_entries
    }

    /// Rows that a place on the surface depends on, with their weights; vertices that are no nodes stay where they are.
    pub(crate) fn rows_at(&self, place: &CoarsePlace) -> impl Iterator<Item = (usize, f64)> {
        let known = |(corner, weight)| Some((self.nodes.row(corner as usize)?, weight));
        place.weights_of_corners().filter_map(known)
    }

    /// The same after a rigid motion of the surface.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Self {
        Self { nodes: self.nodes.moved(motion), ..self.clone() }
    }
}

impl ElasticSkin for GivenMatrix {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.nodes.check_surface(surface)?;
        Ok(Traits::of_matrix(self.has_negative_entries(), false))
    }

    fn is_scalar(&self, _: usize) -> bool {
        true
    }

    fn misfit(&self) -> Option<&str> {
        self.misfit.as_deref()
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.nodes.row(vertex).is_some()
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let rows = self.nodes.checked_rows(asked.nodes, directions)?;
        Ok(Mat::from_fn(rows.len(), rows.len(), |i, j| self.matrix[(rows[i], rows[j])]))
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let columns = self.nodes.rows(asked.nodes)?;
        let of_rows =
            |rows: &[usize]| displaced_at(rows, |column| self.matrix.col_as_slice(columns[column]), forces);
        Ok(self.nodes.moved_alone(vertices, of_rows))
    }
}
