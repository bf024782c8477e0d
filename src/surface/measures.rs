//! Areas, normals and volume.

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::solid_angle::signed_volume;
use crate::mesh::topology::Topology;

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
        let mut face_normals = Vec::with_capacity(faces.len());
        let mut face_areas = Vec::with_capacity(faces.len());
        let mut vertex_normals = vec![Vector3::zeros(); vertices.len()];
        let mut vertex_areas = vec![0.0; vertices.len()];
        let mut edge_total = 0.0;
        for (face, corners) in faces.iter().enumerate() {
            let points = corners.map(|vertex| vertices[vertex as usize]);
            let edges = [points[1] - points[0], points[2] - points[1], points[0] - points[2]];
            let cross = edges[0].cross(&edges[1]);
            let length = cross.norm();
            let normal = if length > 0.0 { cross / length } else { Vector3::zeros() };
            for k in 0..3 {
                let vertex = corners[k] as usize;
                // |u × v| is twice the area at each corner.
                let angle = length.atan2(-edges[k].dot(&edges[(k + 2) % 3]));
                vertex_normals[vertex] += normal * angle;
                vertex_areas[vertex] += length / 6.0;
                if topology.across(face, k).is_none_or(|other| other > face) {
                    edge_total += edges[k].norm();
                }
            }
            face_normals.push(normal);
            face_areas.push(length / 2.0);
        }
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
        let bounding_box = Bounds::around(vertices);
        let volume = if topology.is_closed() {
            signed_volume(&bounding_box.center(), vertices, faces.iter().copied())
        } else {
            f64::NAN
        };
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
