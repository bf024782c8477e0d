//! Where collocation looks at a layer's displacement on the open border of a mesh.
//!
//! Only the displacement is taken there: the initial gap of a border node is still measured at the vertex.

use nalgebra::Vector3;

use crate::surface::checked::Surface;

/// Depth inside the border in thicknesses, for layers much thinner than the mesh size.
const BORDER_DEPTH: f64 = 0.3;

/// The point at which the displacement of a vertex is taken on a layer (m).
///
/// That is the vertex, but for the open border of a mesh under a layer thinner than the mesh size. There the
/// pressure of the border hats ends with a jump, and right at a jump an incompressible layer does not move: what
/// rises on the loaded side sinks on the other. A matrix from such points is indefinite. The layer answers within
/// a fraction of its thickness beside the jump, so the point is moved inwards by up to 0.3 thicknesses, less the
/// closer the thickness h is to the length e of the shortest edge at the vertex: `0.3 h (1 - h/e)`.
pub(crate) fn displacement_point(surface: &Surface, vertex: usize, thickness: f64) -> Vector3<f64> {
    let x = surface.vertices()[vertex];
    let depth = BORDER_DEPTH * thickness * (1.0 - thickness / surface.shortest_edge(vertex));
    if depth <= 0.0 {
        return x;
    }
    inwards(surface, vertex).map_or(x, |direction| x + direction * depth)
}

/// Unit vector along the surface from a border vertex to its inside, between the two border edges; `None` for
/// an inner vertex.
fn inwards(surface: &Surface, vertex: usize) -> Option<Vector3<f64>> {
    let (points, faces) = (surface.vertices(), surface.faces());
    let around = surface.faces_around(vertex);
    let mut sum = Vector3::zeros();
    for &face in around {
        let corners = faces[face as usize];
        for other in corners.into_iter().filter(|&w| w as usize != vertex) {
            let sharing = around.iter().filter(|&&f| faces[f as usize].contains(&other)).count();
            if sharing == 1 {
                let third = corners.into_iter().find(|&w| w as usize != vertex && w != other)?;
                let (edge, to) =
                    (points[other as usize] - points[vertex], points[third as usize] - points[vertex]);
                // away from the border edge, within its face
                sum += (to - edge * (to.dot(&edge) / edge.norm_squared())).normalize();
            }
        }
    }
    sum.try_normalize(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::one_diagonal_grid;

    #[test]
    fn border_points_move_inwards_under_a_thin_layer_and_no_others() {
        let (vertices, faces) = one_diagonal_grid(2);
        let surface = Surface::new(vertices, faces).expect("a grid");
        let moved = |vertex: usize, thickness: f64| {
            displacement_point(&surface, vertex, thickness) - surface.vertices()[vertex]
        };
        let depth = 0.3 * 0.2 * 0.8;
        let diagonal = depth / 2f64.sqrt();
        for (vertex, expected) in [
            (0, Vector3::new(diagonal, diagonal, 0.0)),
            (1, Vector3::new(0.0, depth, 0.0)),
            (4, Vector3::zeros()),
            (5, Vector3::new(-depth, 0.0, 0.0)),
            (8, Vector3::new(-diagonal, -diagonal, 0.0)),
        ] {
            assert!((moved(vertex, 0.2) - expected).norm() < 1e-15, "{vertex}: {:?}", moved(vertex, 0.2));
        }
        assert!((0..9).all(|vertex| moved(vertex, 1.0) == Vector3::zeros()));
    }
}
