//! A coarse mesh of the same skin, and where the fine one's vertices lie on it.

use nalgebra::Vector3;

use crate::geometry::face_tree::{Faces, face_tree};
use crate::mesh::coarsen::{FineMesh, collapse_short_edges};
use crate::surface::checked::{Surface, SurfaceError};

/// A skin with fewer of its own vertices.
#[derive(Debug, Clone)]
pub struct CoarseSkin {
    /// The coarse mesh.
    pub surface: Surface,
    /// Vertex of the fine mesh beside each of the coarse one's, ascending.
    pub fine_vertices: Vec<usize>,
    /// Where each vertex of the fine mesh lies on the coarse one.
    pub(crate) places: Vec<CoarsePlace>,
    /// Largest distance of a vertex of the fine mesh from the coarse one, along its normals (m).
    pub deviation: f64,
}

/// A point on a coarse mesh: values there are linear in its face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarsePlace {
    /// Corners of the face.
    pub corners: [u32; 3],
    /// Weights of the corners, ≥ 0, with sum 1.
    pub weights: [f64; 3],
}

impl CoarsePlace {
    /// Corners that the values there depend on, with their weights.
    pub fn weights_of_corners(&self) -> impl Iterator<Item = (u32, f64)> + use<> {
        self.corners.into_iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }
}

impl CoarseSkin {
    /// Collapses the edges of a closed skin that are shorter than wanted, and lifts the vertices left until the mesh
    /// bounds the same volume, all round.
    ///
    /// * `edge_length`: wanted length of the edges at each vertex (n, m), > 0
    /// * `is_held`: vertices of faces that keep their outline (n), such as those of a cut
    ///
    /// # Errors
    /// [`SurfaceError`] of a coarse mesh that is none.
    pub fn new(fine: &Surface, edge_length: &[f64], is_held: &[bool]) -> Result<Self, SurfaceError> {
        let mesh = FineMesh {
            vertices: fine.vertices(),
            faces: fine.faces(),
            normals: fine.vertex_normals(),
            edge_length,
            is_held,
        };
        let (fine_vertices, faces) = collapse_short_edges(&mesh);
        let vertices = fine_vertices.iter().map(|&vertex| fine.vertices()[vertex]).collect();
        let mask = fine_vertices.iter().map(|&vertex| fine.skin_mask()[vertex]).collect();
        let inscribed = Surface::new(vertices, faces)?.with_skin_mask(mask)?;
        let (places, heights) = place(fine.vertices(), &inscribed, &fine_vertices);
        let (surface, deviation) = fit(&inscribed, &places, &heights, |own| is_held[fine_vertices[own]]);
        Ok(Self { surface, fine_vertices, places, deviation })
    }
}

/// The place of every point on a coarse mesh, and its height over it along the normal there (m).
fn place(points: &[Vector3<f64>], coarse: &Surface, fine_vertices: &[usize]) -> (Vec<CoarsePlace>, Vec<f64>) {
    let (vertices, corners) = (coarse.vertices(), coarse.faces());
    let faces = Faces { vertices, corners, normals: coarse.face_normals() };
    let tree = face_tree(vertices, corners);
    let on_coarse = |point: &Vector3<f64>| {
        let (face, closest) = faces.closest_to_point(&tree, point, f64::INFINITY).expect("a mesh has faces");
        let normal = coarse.face_normals()[face];
        let [a, b, c] = corners[face].map(|vertex| vertices[vertex as usize] - closest.point);
        let areas = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(&normal).max(0.0));
        let whole: f64 = areas.iter().sum();
        let place = CoarsePlace { corners: corners[face], weights: areas.map(|area| area / whole) };
        (place, closest.distance_squared.sqrt().copysign((point - closest.point).dot(&normal)))
    };
    let (mut places, mut heights): (Vec<_>, Vec<_>) = points.iter().map(on_coarse).unzip();
    // A vertex of both meshes is where it is, to the bit.
    for (own, &vertex) in fine_vertices.iter().enumerate() {
        places[vertex] = CoarsePlace { corners: [own as u32; 3], weights: [1.0, 0.0, 0.0] };
        heights[vertex] = 0.0;
    }
    (places, heights)
}

/// Moves each vertex along its normal by the mean height around it, so that the chords of a bent skin take nothing off
/// its volume; returns the surface and the largest height left (m).
fn fit(
    inscribed: &Surface,
    places: &[CoarsePlace],
    heights: &[f64],
    is_held: impl Fn(usize) -> bool,
) -> (Surface, f64) {
    let mut sums = vec![(0.0, 0.0); inscribed.vertices().len()];
    for (place, height) in places.iter().zip(heights) {
        for (corner, weight) in place.corners.into_iter().zip(place.weights) {
            let (sum, weights) = &mut sums[corner as usize];
            (*sum, *weights) = (*sum + weight * height, *weights + weight);
        }
    }
    let lift = |own: usize| if is_held(own) { 0.0 } else { sums[own].0 / sums[own].1 };
    let lifts: Vec<f64> = (0..sums.len()).map(lift).collect();
    let lifted = inscribed.vertices().iter().zip(inscribed.vertex_normals()).zip(&lifts);
    let surface =
        inscribed.with_vertices(lifted.map(|((vertex, normal), lift)| vertex + normal * *lift).collect());
    let left = |(place, height): (&CoarsePlace, &f64)| {
        let lifted = place
            .corners
            .into_iter()
            .zip(place.weights)
            .map(|(corner, weight)| weight * lifts[corner as usize]);
        (height - lifted.sum::<f64>()).abs()
    };
    (surface, places.iter().zip(heights).map(left).fold(0.0, f64::max))
}
