//! Sharp edges under force, of the obstacle and of the skin: the pressure there is infinite.

use nalgebra::Vector3;

use crate::contact::clues::LoadedEdge;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::gap::initial::Gaps;
use crate::surface::checked::Surface;

impl LoadedEdge {
    /// That of the obstacle.
    pub fn of_obstacle(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        Self::among(gaps, forces, |vertex| Some(gaps.line_at(vertex).filter(|line| line.is_sharp)?.ends))
    }

    /// That of the skin.
    pub fn of_skin(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        let surface = gaps.surface;
        Self::among(gaps, forces, |vertex| {
            let end = surface.sharp_edge_at(vertex)?;
            Some([vertex, end].map(|end| surface.vertices()[end]))
        })
    }

    /// * `edge_at`: ends (m) of the edge that a vertex is on, or held by
    fn among(
        gaps: &Gaps,
        forces: &NodeForces,
        edge_at: impl Fn(usize) -> Option<[Vector3<f64>; 2]>,
    ) -> Option<Self> {
        let on_edge = |&vertex: &usize| Some((vertex, edge_at(vertex)?));
        let (held, edges): (Vec<_>, Vec<_>) = forces.active.iter().filter_map(on_edge).unzip();
        let &ends = edges.first()?;
        let sum = |vertices: &[usize]| vertices.iter().map(|&vertex| forces.force[vertex]).sum::<f64>();
        let share = sum(&held) / sum(&forces.active);
        let undeformed = gaps.undeformed();
        let depth = held.iter().map(|&vertex| -undeformed[vertex]).collect();
        let areas = gaps.surface.vertex_areas();
        let cell: f64 = held.iter().map(|&vertex| areas[vertex].sqrt()).sum();
        let off = held.iter().zip(&edges).map(|(&vertex, ends)| beside(gaps.surface, vertex, ends));
        let cells = 1.0 + 2.0 * off.sum::<f64>() / cell;
        Some(Self { ends, held, depth, cells, share })
    }
}

/// How far (m) a vertex lies from the line through two points, seen along the normal of the skin.
fn beside(surface: &Surface, vertex: usize, ends: &[Vector3<f64>; 2]) -> f64 {
    let offset = surface.vertices()[vertex] - ends[0];
    let across = (ends[1] - ends[0]).cross(&surface.vertex_normals()[vertex]);
    across.try_normalize(0.0).map_or(0.0, |across| offset.dot(&across).abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::grid;

    #[test]
    fn a_vertex_lies_as_far_beside_an_edge_as_is_seen_along_the_skin() {
        let (vertices, faces) = grid(2, 2, 1.0);
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        // Along y at x = 0.7, deep under the flat skin.
        let ends = [Vector3::new(0.7, -3.0, -5.0), Vector3::new(0.7, 4.0, -5.0)];
        for (vertex, expected) in [(0, 0.7), (1, 0.3), (4, 0.3), (8, 1.3)] {
            assert!((beside(&surface, vertex, &ends) - expected).abs() < 1e-12);
        }
        // Along the normal no side is seen.
        let upright = [Vector3::zeros(), Vector3::z()];
        assert_eq!(beside(&surface, 8, &upright), 0.0);
    }
}
