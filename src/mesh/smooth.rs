//! The smooth surface that a mesh's normals imply: curved triangles (Vlachos et al. 2001, doi:10.1145/364338.364387).

use nalgebra::Vector3;

use crate::mesh::topology::Topology;

/// Faces whose normals have a smaller cosine meet at a sharp edge: 50 degrees.
const CREASE_COSINE: f64 = 0.642_787_609_686_539_3;

/// The mesh that is refined, on a smooth surface of which it knows points and normals.
#[derive(Clone, Copy)]
pub(crate) struct SmoothMesh<'a> {
    /// Positions (n, m).
    pub vertices: &'a [Vector3<f64>],
    /// Unit normals (n).
    pub normals: &'a [Vector3<f64>],
    /// Faces (m).
    pub faces: &'a [[u32; 3]],
    /// Unit normals of the faces (m).
    pub face_normals: &'a [Vector3<f64>],
    /// Neighbourhoods.
    pub topology: &'a Topology,
}

impl SmoothMesh<'_> {
    /// Whether the faces at an edge meet at more than [`CREASE_COSINE`] allows.
    pub fn is_sharp(&self, face: u32, side: usize) -> bool {
        let normal = |face: usize| self.face_normals[face];
        let across = self.topology.across(face as usize, side);
        across.is_some_and(|other| normal(face as usize).dot(&normal(other)) < CREASE_COSINE)
    }
}

/// Middle of an edge on the curved triangles at it, and the normal there; a sharp end tells nothing of the bend, and with two of
/// them the edge is straight.
///
/// * `ends`: position (m) and unit normal
/// * `is_sharp`: whether they lie on a sharp edge
pub(crate) fn curved_middle(
    [(a, at_a), (b, at_b)]: [(Vector3<f64>, Vector3<f64>); 2],
    is_sharp: [bool; 2],
) -> (Vector3<f64>, Vector3<f64>) {
    let edge = b - a;
    let [bend_a, bend_b] = [edge.dot(&at_a) * at_a, -edge.dot(&at_b) * at_b];
    let bend = match is_sharp {
        [false, false] => bend_a + bend_b,
        [false, true] => 2.0 * bend_a,
        [true, false] => 2.0 * bend_b,
        [true, true] => Vector3::zeros(),
    };
    let sum = at_a + at_b;
    let normal = sum - (2.0 * edge.dot(&sum) / edge.norm_squared()) * edge;
    (0.5 * (a + b) - bend / 8.0, normal.try_normalize(0.0).unwrap_or(at_a))
}
