//! A coarse mesh of the same skin, and where the fine one's vertices lie on it.

use nalgebra::Vector3;
use parry3d_f64::partitioning::Bvh;
use rayon::prelude::*;

use crate::geometry::closest_point::Closest;
use crate::geometry::face_tree::{Faces, face_tree};
use crate::mesh::remesh::coarsen::{FineMesh, SurfacePoint, collapse_short_edges};
use crate::surface::checked::{Surface, SurfaceError};

/// Collapses, each after the triangles were evened out.
const MOST_COLLAPSES: usize = 3;
/// Weight of where a vertex came from in a mean around it: far above the rounding of other weights, which are 0 where
/// meshes are alike on both sides.
const OWN_WEIGHT: f64 = 1e-6;

/// A skin with fewer vertices.
#[derive(Debug, Clone)]
pub struct CoarseSkin {
    /// The coarse mesh.
    pub surface: Surface,
    /// Vertex of the fine mesh from which each of the coarse one's came, ascending.
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
    /// Collapses the edges of a closed skin that are shorter than wanted, evens out the triangles left, and lifts their
    /// vertices until the mesh bounds the same volume, all round.
    ///
    /// * `edge_length`: wanted length of the edges at each vertex (n, m); a vertex with 0 stays as it is
    /// * `is_held`: vertices of faces that keep their outline (n), such as those of a cut
    ///
    /// # Errors
    /// [`SurfaceError`] of a coarse mesh that is none.
    pub fn new(fine: &Surface, edge_length: &[f64], is_held: &[bool]) -> Result<Self, SurfaceError> {
        let is_still: Vec<bool> = edge_length.iter().map(|&length| length == 0.0).collect();
        let own_edges = fine.mean_edges();
        let edge_length: Vec<f64> = edge_length
            .iter()
            .zip(own_edges)
            .map(|(&wanted, own)| if wanted == 0.0 { own } else { wanted })
            .collect();
        let project = on_surface(fine, &edge_length);
        let corner = |vertex: usize| SurfacePoint {
            point: fine.vertices()[vertex],
            normal: fine.vertex_normals()[vertex],
            edge_length: edge_length[vertex],
        };
        let mut fine_vertices: Vec<usize> = (0..fine.vertices().len()).collect();
        let mut mesh = FineMesh {
            vertices: fine_vertices.iter().map(|&vertex| corner(vertex)).collect(),
            faces: fine.faces().to_vec(),
            is_held: is_held.to_vec(),
            is_still: is_still.clone(),
        };
        // Even triangles let more edges collapse.
        for _ in 0..MOST_COLLAPSES {
            let (kept, faces) = collapse_short_edges(&mesh);
            if kept.len() == fine_vertices.len() {
                break;
            }
            fine_vertices = kept.iter().map(|&own| fine_vertices[own]).collect();
            mesh = FineMesh {
                vertices: kept.iter().map(|&own| mesh.vertices[own]).collect(),
                faces,
                is_held: fine_vertices.iter().map(|&vertex| is_held[vertex]).collect(),
                is_still: fine_vertices.iter().map(|&vertex| is_still[vertex]).collect(),
            };
            mesh.even_out(&project);
        }
        let mask = fine_vertices.iter().map(|&vertex| fine.skin_mask()[vertex]).collect();
        let inscribed = Surface::new(mesh.vertices.iter().map(|vertex| vertex.point).collect(), mesh.faces)?
            .with_skin_mask(mask)?;
        let (places, heights) = place(fine.vertices(), &inscribed, &fine_vertices);
        let may_lift: Vec<bool> =
            is_held.iter().zip(&is_still).map(|(held, still)| !held && !still).collect();
        let (surface, deviation) = fit(&inscribed, &fine_vertices, &places, &heights, &may_lift);
        Ok(Self { surface, fine_vertices, places, deviation })
    }

    /// Vertices of the fine mesh on some faces of the coarse one and the faces around those.
    pub(crate) fn around(&self, faces: &[usize]) -> Vec<usize> {
        let mut is_at = vec![false; self.surface.vertices().len()];
        for &face in faces {
            self.surface.faces()[face].iter().for_each(|&corner| is_at[corner as usize] = true);
        }
        let is_there =
            |&vertex: &usize| self.places[vertex].corners.iter().any(|&corner| is_at[corner as usize]);
        (0..self.places.len()).filter(is_there).collect()
    }

    /// Mean at each vertex of the coarse mesh of values at the fine one's vertices around it.
    pub(crate) fn means(&self, values: &[f64]) -> Vec<f64> {
        means_around(&self.fine_vertices, &self.places, values)
    }
}

/// Mean of values at places on a coarse mesh around each of its vertices, which come from `fine_vertices`.
fn means_around(fine_vertices: &[usize], places: &[CoarsePlace], values: &[f64]) -> Vec<f64> {
    // Where no place is around it, a vertex takes the value where it came from.
    let mut sums: Vec<_> =
        fine_vertices.iter().map(|&vertex| (OWN_WEIGHT * values[vertex], OWN_WEIGHT)).collect();
    for (place, value) in places.iter().zip(values) {
        for (corner, weight) in place.weights_of_corners() {
            let (sum, weights) = &mut sums[corner as usize];
            (*sum, *weights) = (*sum + weight * value, *weights + weight);
        }
    }
    sums.into_iter().map(|(sum, weights)| sum / weights).collect()
}

/// The point of a skin closest to one beside it, with its normal and the wanted length of the edges there.
///
/// * `edge_length`: at each vertex (n, m)
fn on_surface(skin: &Surface, edge_length: &[f64]) -> impl Fn(&Vector3<f64>) -> SurfacePoint {
    let (faces, tree) = (skin.as_faces(), face_tree(skin.vertices(), skin.faces()));
    move |point| {
        let (face, weights, closest) = barycentric(&faces, &tree, point);
        let corners = faces.corners[face].map(|vertex| vertex as usize);
        SurfacePoint {
            point: closest.point,
            normal: faces.normals[face],
            edge_length: corners
                .iter()
                .zip(weights)
                .map(|(&vertex, weight)| weight * edge_length[vertex])
                .sum(),
        }
    }
}

/// The face closest to a point, the first of equally close ones, with the weights of its corners at the closest point, and
/// that.
pub(crate) fn barycentric(faces: &Faces, tree: &Bvh, point: &Vector3<f64>) -> (usize, [f64; 3], Closest) {
    let (face, closest) = faces.first_closest_to_point(tree, point).expect("a mesh has faces");
    let [a, b, c] = faces.corners[face].map(|vertex| faces.vertices[vertex as usize] - closest.point);
    let normal = &faces.normals[face];
    let areas = [b.cross(&c), c.cross(&a), a.cross(&b)].map(|area| area.dot(normal).max(0.0));
    let whole: f64 = areas.iter().sum();
    (face, areas.map(|area| area / whole), closest)
}

/// The place of every point on a coarse mesh, and its height over it along the normal there (m).
fn place(points: &[Vector3<f64>], coarse: &Surface, fine_vertices: &[usize]) -> (Vec<CoarsePlace>, Vec<f64>) {
    let vertices = coarse.vertices();
    let (faces, tree) = (coarse.as_faces(), face_tree(vertices, coarse.faces()));
    let on_coarse = |point: &Vector3<f64>| {
        let (face, weights, closest) = barycentric(&faces, &tree, point);
        let height = (point - closest.point).dot(&faces.normals[face]);
        let place = CoarsePlace { corners: faces.corners[face], weights };
        (place, closest.distance_squared.sqrt().copysign(height))
    };
    let (mut places, mut heights): (Vec<_>, Vec<_>) = points.par_iter().map(on_coarse).unzip();
    // A vertex of both meshes is where it is, to the bit.
    let is_there = |&(own, &vertex): &(usize, &usize)| vertices[own] == points[vertex];
    for (own, &vertex) in fine_vertices.iter().enumerate().filter(is_there) {
        places[vertex] = CoarsePlace { corners: [own as u32; 3], weights: [1.0, 0.0, 0.0] };
        heights[vertex] = 0.0;
    }
    (places, heights)
}

/// Moves each vertex along its normal by the mean height around it, so that the chords of a bent skin take nothing off
/// its volume; returns the surface and the largest height left (m).
fn fit(
    inscribed: &Surface,
    fine_vertices: &[usize],
    places: &[CoarsePlace],
    heights: &[f64],
    may_lift: &[bool],
) -> (Surface, f64) {
    let mut lifts = means_around(fine_vertices, places, heights);
    for (lift, _) in lifts.iter_mut().zip(fine_vertices).filter(|(_, vertex)| !may_lift[**vertex]) {
        *lift = 0.0;
    }
    let lifted = inscribed.vertices().iter().zip(inscribed.vertex_normals()).zip(&lifts);
    let surface =
        inscribed.with_vertices(lifted.map(|((vertex, normal), lift)| vertex + normal * *lift).collect());
    let left = |(place, height): (&CoarsePlace, &f64)| {
        let lifted = place.weights_of_corners().map(|(corner, weight)| weight * lifts[corner as usize]);
        (height - lifted.sum::<f64>()).abs()
    };
    (surface, places.iter().zip(heights).map(left).fold(0.0, f64::max))
}
