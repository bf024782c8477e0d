//! The smooth surface that a mesh's normals imply: curved triangles (Vlachos et al. 2001, doi:10.1145/364338.364387).

use nalgebra::Vector3;

use crate::mesh::adjacency::corner_of;
use crate::mesh::topology::Topology;

/// Faces whose normals have a smaller cosine meet at a sharp edge: 50 degrees.
const CREASE_COSINE: f64 = 0.642_787_609_686_539_3;

/// The mesh that is refined, on a smooth surface through its vertices.
#[derive(Clone, Copy)]
pub(crate) struct SmoothMesh<'a> {
    /// Positions (n, m).
    pub vertices: &'a [Vector3<f64>],
    /// Faces (m).
    pub faces: &'a [[u32; 3]],
    /// Unit normals of the faces (m).
    pub face_normals: &'a [Vector3<f64>],
    /// Neighbourhoods.
    pub topology: &'a Topology,
}

impl SmoothMesh<'_> {
    /// Unit normal of the smooth surface at a vertex: each face weighs as the sine of its angle there over the lengths of both
    /// edges (Max 1999, doi:10.1080/10867651.1999.10487501). It is exact on a sphere, however the faces lie; weights by angle
    /// alone lean beside a short edge, and bend the skin there.
    pub fn normal(&self, vertex: u32) -> Vector3<f64> {
        let weighed = |&face: &u32| {
            let corners = self.faces[face as usize];
            let at = corner_of(&corners, vertex);
            let [own, next, last] = [0, 1, 2].map(|step| self.vertices[corners[(at + step) % 3] as usize]);
            let (to, from) = (next - own, last - own);
            to.cross(&from) / (to.norm_squared() * from.norm_squared()).max(f64::MIN_POSITIVE)
        };
        let sum: Vector3<f64> = self.topology.faces_around(vertex as usize).iter().map(weighed).sum();
        sum.try_normalize(0.0).unwrap_or_default()
    }

    /// Whether a vertex lies on a sharp edge.
    pub fn is_on_sharp_edge(&self, vertex: u32) -> bool {
        self.topology.faces_around(vertex as usize).iter().any(|&face| {
            let at = corner_of(&self.faces[face as usize], vertex);
            self.is_sharp(face, at) || self.is_sharp(face, (at + 2) % 3)
        })
    }

    /// Whether the faces at an edge meet at more than [`CREASE_COSINE`] allows.
    pub fn is_sharp(&self, face: u32, side: usize) -> bool {
        let normal = |face: usize| self.face_normals[face];
        let across = self.topology.across(face as usize, side);
        across.is_some_and(|other| normal(face as usize).dot(&normal(other)) < CREASE_COSINE)
    }
}

/// Middle of an edge on the curved triangles at it, and the unit normal there. An end on a sharp edge tells nothing of the bend,
/// and with two of them the edge is straight.
///
/// * `ends`: position (m), and unit normal where that is not on a sharp edge
/// * `of_faces`: normal of the faces at the edge
pub(crate) fn curved_middle(
    [(a, at_a), (b, at_b)]: [(Vector3<f64>, Option<Vector3<f64>>); 2],
    of_faces: impl FnOnce() -> Vector3<f64>,
) -> (Vector3<f64>, Vector3<f64>) {
    let edge = b - a;
    let bend = |along: &Vector3<f64>, normal: &Vector3<f64>| along.dot(normal) * normal;
    let (bend, normal, mirrored) = match (at_a, at_b) {
        (Some(at_a), Some(at_b)) => (bend(&edge, &at_a) + bend(&-edge, &at_b), at_a + at_b, 2.0),
        (Some(at_a), None) => (2.0 * bend(&edge, &at_a), at_a, 1.0),
        (None, Some(at_b)) => (2.0 * bend(&-edge, &at_b), at_b, 1.0),
        (None, None) => (Vector3::zeros(), of_faces(), 1.0),
    };
    let turned = normal - (mirrored * edge.dot(&normal) / edge.norm_squared()) * edge;
    (0.5 * (a + b) - bend / 8.0, turned.try_normalize(0.0).unwrap_or(normal))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Random, icosphere};
    use crate::surface::checked::Surface;

    #[test]
    fn normals_on_a_sphere_are_exact_however_uneven_its_triangles_are() {
        let (mut vertices, faces) = icosphere(8e-3, 2);
        let mut random = Random(3);
        for vertex in &mut vertices {
            let moved = *vertex + Vector3::from_fn(|_, _| 0.9e-3 * random.signed());
            *vertex = 8e-3 * moved.normalize();
        }
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        let mesh = SmoothMesh {
            vertices: surface.vertices(),
            faces: surface.faces(),
            face_normals: surface.face_normals(),
            topology: surface.topology(),
        };
        for (vertex, point) in surface.vertices().iter().enumerate() {
            assert!((mesh.normal(vertex as u32) - point.normalize()).norm() < 1e-12, "vertex {vertex}");
        }
    }
}
