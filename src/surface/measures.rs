//! Areas, normals and volume.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::geometry::bounds::Bounds;
use crate::geometry::solid_angle::signed_volume;
use crate::mesh::topology::Topology;

/// Fewest faces that are worth a task of their own.
const FACES_PER_TASK: usize = 1024;

/// What follows from the positions.
#[derive(Debug, Clone)]
pub(super) struct Measures {
    pub face_normals: Vec<Vector3<f64>>,
    pub face_areas: Vec<f64>,
    pub vertex_normals: Vec<Vector3<f64>>,
    pub vertex_areas: Vec<f64>,
    pub area: f64,
    pub volume: f64,
    pub mean_edge_length: f64,
    pub bounding_box: Bounds,
}

impl Measures {
    pub(super) fn new(vertices: &[Vector3<f64>], faces: &[[u32; 3]], topology: &Topology) -> Measures {
        let measured: Vec<FaceMeasures> = (0..faces.len())
            .into_par_iter()
            .with_min_len(FACES_PER_TASK)
            .map(|face| FaceMeasures::new(vertices, faces, topology, face))
            .collect();
        let of_faces = || {
            let normals: Vec<Vector3<f64>> = measured.iter().map(|face| face.normal).collect();
            let areas: Vec<f64> = measured.iter().map(|face| face.twice_area / 2.0).collect();
            let edges: f64 = measured.iter().flat_map(|face| face.edge_lengths).sum();
            (normals, areas, edges)
        };
        let of_solid = || {
            let bounding_box = Bounds::around(vertices);
            let volume = if topology.is_closed() {
                signed_volume(&bounding_box.center(), vertices, faces.iter().copied())
            } else {
                f64::NAN
            };
            (volume, bounding_box)
        };
        let (
            (mut vertex_normals, vertex_areas),
            ((face_normals, face_areas, edge_total), (volume, bounding_box)),
        ) = if faces.len() < 2 * FACES_PER_TASK {
            (at_vertices(vertices.len(), faces, &measured), (of_faces(), of_solid()))
        } else {
            rayon::join(|| at_vertices(vertices.len(), faces, &measured), || (of_faces(), of_solid()))
        };
        for (vertex, normal) in vertex_normals.iter_mut().enumerate() {
            let length = normal.norm();
            if length > 1e-12 {
                *normal /= length;
            } else {
                // The faces cancel, as on a folded sheet: take the largest.
                let around = topology.faces_around(vertex).iter().map(|face| *face as usize);
                let largest = around.max_by(|a, b| face_areas[*a].total_cmp(&face_areas[*b]));
                *normal = largest.map_or(Vector3::zeros(), |face| face_normals[face]);
            }
        }
        Measures {
            area: face_areas.iter().sum(),
            mean_edge_length: edge_total / topology.edge_count() as f64,
            face_normals,
            face_areas,
            vertex_normals,
            vertex_areas,
            volume,
            bounding_box,
        }
    }
}

/// Sums over the faces around each vertex: of the normals weighted by angle, and of thirds of the areas (m²).
fn at_vertices(count: usize, faces: &[[u32; 3]], measured: &[FaceMeasures]) -> (Vec<Vector3<f64>>, Vec<f64>) {
    let (mut normals, mut areas) = (vec![Vector3::zeros(); count], vec![0.0; count]);
    for (corners, face) in faces.iter().zip(measured) {
        for (&vertex, angle) in corners.iter().zip(face.angles) {
            normals[vertex as usize] += face.normal * angle;
            areas[vertex as usize] += face.twice_area / 6.0;
        }
    }
    (normals, areas)
}

/// Of one face.
struct FaceMeasures {
    normal: Vector3<f64>,
    twice_area: f64,
    /// At its corners (rad).
    angles: [f64; 3],
    /// Of its edges (m), 0 for one that the face across counts.
    edge_lengths: [f64; 3],
}

impl FaceMeasures {
    fn new(vertices: &[Vector3<f64>], faces: &[[u32; 3]], topology: &Topology, face: usize) -> Self {
        let points = faces[face].map(|vertex| vertices[vertex as usize]);
        let edges = [points[1] - points[0], points[2] - points[1], points[0] - points[2]];
        let cross = edges[0].cross(&edges[1]);
        let twice_area = cross.norm();
        let normal = if twice_area > 0.0 { cross / twice_area } else { Vector3::zeros() };
        // |u × v| is twice the area at each corner.
        let angles = [0, 1, 2].map(|k| twice_area.atan2(-edges[k].dot(&edges[(k + 2) % 3])));
        let is_own = |k| topology.across(face, k).is_none_or(|other| other > face);
        let edge_lengths = [0, 1, 2].map(|k| if is_own(k) { edges[k].norm() } else { 0.0 });
        Self { normal, twice_area, angles, edge_lengths }
    }
}
