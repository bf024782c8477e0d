//! Averages of a field against the pressure of a node.

use crate::response::kernel::skin::Pressure;
use crate::surface::checked::Surface;

/// Average of a field against the pressure that a force at a vertex stands for, `∫ p g dA / ∫ p dA`.
///
/// On each triangle the field is the quadratic through its values at the corners and at the middles of the edges;
/// the integral over that is exact, so the error falls with the third power of the edges.
///
/// * `at_vertices`: (n,) the field at every vertex of the surface, in any unit; only those of the vertex and its
///   neighbours are read
/// * `at_middle`: the field in the middle of the edge between two vertices, asked for the edges of the triangles
///   around the vertex
///
/// With [`Gap::Weighted`](crate::response::Gap) the initial gap of a node is this average.
pub fn pressure_average(
    surface: &Surface,
    pressure: Pressure,
    vertex: usize,
    at_vertices: &[f64],
    at_middle: impl Fn(u32, u32) -> f64,
) -> f64 {
    let mut sum = 0.0;
    for &face in surface.faces_around(vertex) {
        let [a, b, c] = from_corner(surface.faces()[face as usize], vertex as u32);
        let (beside, across) = (at_middle(a, b) + at_middle(c, a), at_middle(b, c));
        let mean = match pressure {
            Pressure::Linear => {
                // ∫ l_a (quadratic shape function) dA / area, l_a the hat: corners 1/30, -1/60, -1/60, middles
                // 2/15 on the edges at a, 1/15 across
                let [at_a, at_b, at_c] = [a, b, c].map(|v| at_vertices[v as usize]);
                (2.0 * at_a - at_b - at_c + 8.0 * beside + 4.0 * across) / 60.0
            }
            // the pressure is the same over the one-ring, whose area is three vertex areas
            Pressure::OneRing => (beside + across) / 9.0,
        };
        sum += surface.face_areas()[face as usize] * mean;
    }
    sum / surface.vertex_areas()[vertex]
}

/// The corners of a face, turned so that `first` comes first.
fn from_corner([a, b, c]: [u32; 3], first: u32) -> [u32; 3] {
    match first {
        _ if first == b => [b, c, a],
        _ if first == c => [c, a, b],
        _ => [a, b, c],
    }
}
