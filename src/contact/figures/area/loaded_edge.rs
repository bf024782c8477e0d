//! Sharp edges under force, of the obstacle and of the skin: the pressure there is infinite.

use nalgebra::Vector3;

use crate::contact::clues::LoadedEdge;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::gap::edge::Line;
use crate::contact::gap::initial::Gaps;
use crate::surface::checked::Surface;

/// Least and largest spread of an edge: steeper ones would use up all nodes at a small depth, and what stands in the skin beside
/// flatter ones has ends of its own.
const SPREADS: [f64; 2] = [0.8, 1.6];

impl LoadedEdge {
    /// That of the obstacle.
    pub fn of_obstacle(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        Self::among(gaps, forces, |vertex| gaps.line_at(vertex).filter(|line| line.faces.is_some()).copied())
    }

    /// That of the skin.
    pub fn of_skin(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        let surface = gaps.surface;
        Self::among(gaps, forces, |vertex| {
            let end = surface.sharp_edge_at(vertex)?;
            Some(Line { ends: [vertex, end].map(|end| surface.vertices()[end]), faces: None })
        })
    }

    /// * `edge_at`: the edge that a vertex is on, or held by
    fn among(gaps: &Gaps, forces: &NodeForces, edge_at: impl Fn(usize) -> Option<Line>) -> Option<Self> {
        let on_edge = |&vertex: &usize| Some((vertex, edge_at(vertex)?));
        let (held, edges): (Vec<_>, Vec<_>) = forces.active.iter().filter_map(on_edge).unzip();
        let ends = edges.first()?.ends;
        let sum = |vertices: &[usize]| vertices.iter().map(|&vertex| forces.force[vertex]).sum::<f64>();
        let share = sum(&held) / sum(&forces.active);
        let undeformed = gaps.undeformed();
        let depth = held.iter().map(|&vertex| -undeformed[vertex]).collect();
        let normals = held.iter().map(|&vertex| &gaps.surface.vertex_normals()[vertex]);
        let spread = edges.iter().zip(normals).map(|(line, normal)| spread(line, normal)).collect();
        let areas = gaps.surface.vertex_areas();
        let cell: f64 = held.iter().map(|&vertex| areas[vertex].sqrt()).sum();
        let off = held.iter().zip(&edges).map(|(&vertex, line)| beside(gaps.surface, vertex, &line.ends));
        let cells = 1.0 + 2.0 * off.sum::<f64>() / cell;
        Some(Self { ends, held, depth, spread, length: cell / cells, cells, share })
    }
}

/// Half the breadth of what stands in the skin at an edge of the obstacle over its depth, by the angles of the faces to the skin.
fn spread(line: &Line, skin_normal: &Vector3<f64>) -> f64 {
    let [least, largest] = SPREADS;
    let of_face = |face: &Vector3<f64>| face.angle(&-skin_normal).tan().recip();
    let of_faces = line.faces.iter().flatten().map(of_face);
    (0.5 * of_faces.sum::<f64>()).clamp(least, largest)
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
    fn an_edge_spreads_as_its_faces_lean() {
        let faces = |degrees: [f64; 2]| {
            let [one, other] = degrees.map(f64::to_radians);
            [Vector3::new(-one.sin(), 0.0, one.cos()), Vector3::new(other.sin(), 0.0, other.cos())]
        };
        let down = -Vector3::z();
        // of a blade, of a box upright and leaning, and of two facets
        for (degrees, expected) in [
            ([87.0, 87.0], 0.8),
            ([45.0, 45.0], 1.0),
            ([30.0, 60.0], 2.0 / 3.0_f64.sqrt()),
            ([5.0, 12.0], 1.6),
        ] {
            let line = Line { ends: [Vector3::zeros(), Vector3::y()], faces: Some(faces(degrees)) };
            assert!((spread(&line, &down) - expected).abs() < 1e-12, "{degrees:?}");
        }
    }

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
