//! A unit force at one node, spread over the triangles around it.

use nalgebra::Vector3;

use crate::response::integral::frame::TriangleFrame;
use crate::response::kernel::basis::PressureBasis;
use crate::surface::checked::Surface;

/// A triangle that carries part of a node's unit force.
#[derive(Debug, Clone)]
pub(crate) struct LoadedFace {
    /// Geometry.
    pub(crate) frame: TriangleFrame,
    /// Pressure at the corners per newton (1/m²).
    pub(crate) density: [f64; 3],
    /// Center of a ball around the triangle (m).
    pub(crate) center: Vector3<f64>,
    /// Radius of that ball (m).
    pub(crate) radius: f64,
}

impl LoadedFace {
    /// Whether the closed form would err by more than `tolerance` within `reach` (m) of the triangle.
    pub(crate) fn loses_digits(&self, reach: f64, tolerance: f64) -> bool {
        let height = self.frame.heights.into_iter().fold(f64::INFINITY, f64::min);
        let length = 2.0 * self.frame.area / height;
        let loss = 40.0 * f64::EPSILON * (length / height).powi(2) * (reach / length).max(1.0).powi(3);
        loss > tolerance.max(2e-11)
    }
}

/// Appends the triangles that carry a unit force at `vertex`; their densities integrate to 1.
pub(crate) fn loaded_faces(
    surface: &Surface,
    vertex: usize,
    pressure: PressureBasis,
    faces: &mut Vec<LoadedFace>,
) {
    let (points, triangles) = (surface.vertices(), surface.faces());
    let vertex_area = surface.vertex_areas()[vertex];
    for &face in surface.faces_around(vertex) {
        let corners = triangles[face as usize];
        let vertices = corners.map(|v| points[v as usize]);
        let center = (vertices[0] + vertices[1] + vertices[2]) / 3.0;
        let density = match pressure {
            PressureBasis::Linear => {
                corners.map(|v| if v as usize == vertex { 1.0 / vertex_area } else { 0.0 })
            }
            // the area of the one-ring is three vertex areas
            PressureBasis::OneRing => [1.0 / (3.0 * vertex_area); 3],
        };
        let radius = vertices.iter().map(|v| (v - center).norm()).fold(0.0, f64::max);
        faces.push(LoadedFace { frame: TriangleFrame::new(vertices), density, center, radius });
    }
}

/// `Σ density · hat integrals` of one face.
pub(crate) fn weighted(density: &[f64; 3], hats: &[f64; 3]) -> f64 {
    density[0] * hats[0] + density[1] * hats[1] + density[2] * hats[2]
}
