//! A unit force at one node, spread over the triangles around it.

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
}

impl LoadedFace {
    /// Relative error that an integral over this triangle may have within `reach` (m) of it, such that a column, to
    /// which it adds at most `force 2 (1 + ln(length / height)) reach / length`, keeps the tolerance; `None` where the
    /// closed form does.
    ///
    /// A sliver carries next to no force, so little is asked of it.
    pub(crate) fn error_beyond_closed_form(&self, reach: f64, tolerance: f64) -> Option<f64> {
        let height = self.frame.heights.into_iter().fold(f64::INFINITY, f64::min);
        let length = 2.0 * self.frame.area / height;
        let loss = 40.0 * f64::EPSILON * (length / height).powi(2) * (reach / length).max(1.0).powi(3);
        let force = self.frame.area * self.density.iter().sum::<f64>() / 3.0;
        let share = force * 2.0 * (1.0 + (length / height).ln()) * (reach / length).max(1.0);
        let allowed = tolerance.max(2e-11) / share.min(1.0);
        (loss > allowed).then_some(allowed)
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
        let density = match pressure {
            PressureBasis::Linear => {
                corners.map(|v| if v as usize == vertex { 1.0 / vertex_area } else { 0.0 })
            }
            // the area of the one-ring is three vertex areas
            PressureBasis::OneRing => [1.0 / (3.0 * vertex_area); 3],
        };
        faces.push(LoadedFace { frame: TriangleFrame::new(vertices), density });
    }
}

/// `Σ density · hat integrals` of one face.
pub(crate) fn weighted(density: &[f64; 3], hats: &[f64; 3]) -> f64 {
    density[0] * hats[0] + density[1] * hats[1] + density[2] * hats[2]
}
