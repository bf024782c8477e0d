//! Vertices whose response is known, and the surface that they lie on.

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};

use crate::response::error::ResponseError;
use crate::response::matrix::options::check_directions;
use crate::response::rows::{NO_ROW, rows_of_vertices};
use crate::surface::checked::Surface;

/// Largest distance, in mean edge lengths, between the vertices of a surface and those that a response was
/// prepared for, or a part was cut out with: rounding of a rigid motion, and no more.
pub(super) const SAME_SHAPE_DISTANCE: f64 = 1e-6;

/// Nodes of a prepared response, in the order of its rows, with the shape that it was prepared for.
#[derive(Debug, Clone)]
pub struct PreparedNodes {
    nodes: Arc<[usize]>,
    /// Row of each vertex, [`NO_ROW`] for none.
    row_of: Arc<[usize]>,
    surface: Surface,
}

impl PreparedNodes {
    /// # Errors
    /// [`ResponseError::Nodes`].
    pub(crate) fn new(surface: &Surface, nodes: &[usize]) -> Result<Self, ResponseError> {
        let row_of = rows_of_vertices(surface.vertices().len(), nodes)?;
        Ok(Self { nodes: nodes.into(), row_of: row_of.into(), surface: surface.clone() })
    }

    /// The nodes, in the order of the rows.
    pub fn list(&self) -> &[usize] {
        &self.nodes
    }

    /// The surface that they lie on, where it stands now.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Row of a vertex, if it is a node.
    pub(crate) fn row(&self, vertex: usize) -> Option<usize> {
        Some(self.row_of[vertex]).filter(|&row| row != NO_ROW)
    }

    /// Rows of `nodes`.
    ///
    /// # Errors
    /// [`ResponseError::NotPrepared`] for a vertex that is no node.
    pub(crate) fn rows(&self, nodes: &[usize]) -> Result<Vec<usize>, ResponseError> {
        let unknown = |vertex: usize| self.row_of[vertex] == NO_ROW;
        if let Some(&vertex) = nodes.iter().find(|&&vertex| unknown(vertex)) {
            let missing = nodes.iter().filter(|&&vertex| unknown(vertex)).count();
            return Err(ResponseError::NotPrepared { vertex, missing, prepared: self.nodes.len() });
        }
        Ok(nodes.iter().map(|&vertex| self.row_of[vertex]).collect())
    }

    /// Displacements (m) of vertices where the nodes alone move.
    ///
    /// * `of_rows`: those of the nodes in some rows
    pub(crate) fn moved_alone(
        &self,
        vertices: &[usize],
        of_rows: impl FnOnce(&[usize]) -> Vec<Vector3<f64>>,
    ) -> Vec<Vector3<f64>> {
        let known: Vec<Option<usize>> = vertices.iter().map(|&vertex| self.row(vertex)).collect();
        let rows: Vec<usize> = known.iter().copied().flatten().collect();
        let mut moved = of_rows(&rows).into_iter();
        let of_row = |row: Option<usize>| row.and_then(|_| moved.next()).unwrap_or_default();
        known.into_iter().map(of_row).collect()
    }

    /// The same nodes after a rigid motion of the surface.
    pub(crate) fn moved(&self, motion: &Isometry3<f64>) -> Self {
        Self { surface: self.surface.moved(motion), ..self.clone() }
    }

    /// # Errors
    /// [`ResponseError::OtherSurface`], [`ResponseError::OtherShape`]: they lie on another surface.
    pub(crate) fn check_surface(&self, surface: &Surface) -> Result<(), ResponseError> {
        if surface.has_mesh_of(&self.surface) {
            return Ok(());
        }
        let (vertices, faces) = (self.surface.vertices(), self.surface.faces());
        let (found, expected) = (surface.vertices().len(), vertices.len());
        if found != expected {
            return Err(ResponseError::OtherSurface { what: "number of vertices", found, expected });
        }
        if surface.faces() != faces {
            let found = surface.faces().iter().zip(faces).filter(|(a, b)| a != b).count();
            return Err(ResponseError::OtherSurface { what: "faces that differ", found, expected: 0 });
        }
        let allowed = SAME_SHAPE_DISTANCE * surface.mean_edge_length();
        let distance = |vertex: usize| (surface.vertices()[vertex] - vertices[vertex]).norm();
        match (0..found).find(|&vertex| distance(vertex) > allowed) {
            Some(vertex) => Err(ResponseError::OtherShape { vertex, distance: distance(vertex), allowed }),
            None => Ok(()),
        }
    }

    /// Rows of `nodes`, with one direction each.
    ///
    /// # Errors
    /// [`ResponseError::NotPrepared`], [`ResponseError::DirectionCount`], [`ResponseError::Direction`].
    pub(crate) fn checked_rows(
        &self,
        nodes: &[usize],
        directions: &[Vector3<f64>],
    ) -> Result<Vec<usize>, ResponseError> {
        let rows = self.rows(nodes)?;
        check_directions(directions, nodes.len())?;
        Ok(rows)
    }
}
