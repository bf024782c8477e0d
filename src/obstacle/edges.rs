//! Sharp edges of an obstacle, where a skin between its own vertices may meet it first.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::node_bounds;
use crate::obstacle::posed::{Obstacle, Shape};
use crate::obstacle::primitive::Primitive;

/// An edge is sharp where its faces turn by more than this: 15 degrees.
const SHARP_COSINE: f64 = 0.966;

/// A normal counts as between two others from this product of sines on, so that a face's own does not.
const INSIDE: f64 = 1e-6;

/// A sharp convex edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SharpEdge {
    /// Its ends (m).
    pub ends: [Vector3<f64>; 2],
    /// Outward unit normals of the two faces that meet there.
    pub normals: [Vector3<f64>; 2],
}

impl SharpEdge {
    /// The part of `normal` across the edge, as a unit vector, if it lies between those of the two faces: a plane that the
    /// edge touches from inside has such a normal.
    pub fn between(&self, normal: &Vector3<f64>) -> Option<Vector3<f64>> {
        let along = (self.ends[1] - self.ends[0]).try_normalize(0.0)?;
        let across = (normal - along * normal.dot(&along)).try_normalize(0.0)?;
        let [one, other] = &self.normals;
        let turn = one.cross(other);
        let is_between = one.cross(&across).dot(&turn) > INSIDE && across.cross(other).dot(&turn) > INSIDE;
        (is_between && across.dot(&(one + other)) > 0.0).then_some(across)
    }
}

impl Obstacle {
    /// Sharp convex edges of a mesh or a box near `bounds` (m), each once; none of a round primitive.
    pub(crate) fn sharp_edges_near(&self, bounds: &Bounds) -> Vec<SharpEdge> {
        let pose = self.pose_matrix();
        let corner = |k: usize| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { bounds.low[axis] } else { bounds.high[axis] };
            pose.to_local(&Vector3::new(pick(0), pick(1), pick(2)))
        };
        let local = Bounds::around(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner));
        let edges = match self.shape() {
            Shape::Mesh(mesh) => {
                let mut sides: BTreeMap<[u32; 2], Vec<(u32, u32)>> = BTreeMap::new();
                for face in mesh.tree().bvh().leaves(|node| node_bounds(node).meets(&local)) {
                    let corners = mesh.faces()[face as usize];
                    for k in 0..3 {
                        let [a, b, apex] = [k, k + 1, k + 2].map(|k| corners[k % 3]);
                        sides.entry([a.min(b), a.max(b)]).or_default().push((face, apex));
                    }
                }
                let sharp = |(ends, sides): ([u32; 2], Vec<(u32, u32)>)| {
                    let &[(one, _), (other, apex)] = &sides[..] else { return None };
                    let normals = [one, other].map(|face| mesh.normals()[face as usize]);
                    let point = |vertex: u32| mesh.vertices()[vertex as usize];
                    let is_convex = (point(apex) - point(ends[0])).dot(&normals[0]) < 0.0;
                    let is_sharp = normals[0].dot(&normals[1]) < SHARP_COSINE;
                    (is_convex && is_sharp).then(|| SharpEdge { ends: ends.map(point), normals })
                };
                sides.into_iter().filter_map(sharp).collect()
            }
            Shape::Primitive(Primitive::Cuboid { half_extents }) => cuboid_edges(half_extents),
            Shape::Primitive(_) => Vec::new(),
        };
        let placed = |edge: SharpEdge| SharpEdge {
            ends: edge.ends.map(|end| pose.to_world(&end)),
            normals: edge.normals.map(|normal| pose.turn(&normal)),
        };
        edges.into_iter().map(placed).collect()
    }
}

/// The twelve edges of a box around the origin.
fn cuboid_edges(half_extents: &Vector3<f64>) -> Vec<SharpEdge> {
    let mut edges = Vec::with_capacity(12);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for [s, t] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
            let mut end = Vector3::zeros();
            (end[u], end[v]) = (s * half_extents[u], t * half_extents[v]);
            let along = Vector3::ith(axis, half_extents[axis]);
            let normals = [Vector3::ith(u, s), Vector3::ith(v, t)];
            edges.push(SharpEdge { ends: [end - along, end + along], normals });
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_as_a_primitive_and_as_a_mesh_and_a_ball_has_none() {
        let extents = Vector3::new(1.0, 2.0, 3.0);
        let around = Bounds { low: Vector3::repeat(-9.0), high: Vector3::repeat(9.0) };
        let cuboid = Obstacle::cuboid(extents).expect("a box");
        let corner = |k: usize| {
            let sign = |axis: usize| if k >> axis & 1 == 0 { -1.0 } else { 1.0 };
            extents.component_mul(&Vector3::new(sign(0), sign(1), sign(2)))
        };
        let squares = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let faces = squares.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
        let vertices = (0..8).map(corner).collect();
        let mesh = Obstacle::mesh(vertices, faces, &Default::default()).expect("a closed mesh");
        for obstacle in [cuboid, mesh] {
            let shift = Vector3::new(0.5, 0.0, -1.0);
            let edges = obstacle.translated(&shift).sharp_edges_near(&around);
            assert_eq!(edges.len(), 12);
            for SharpEdge { ends: [a, b], normals } in edges {
                assert_eq!((b - a).iter().filter(|part| **part != 0.0).count(), 1);
                assert_eq!([(a - shift).abs(), (b - shift).abs()], [extents; 2]);
                assert!(normals.iter().all(|normal| (a - shift).dot(normal) > 0.0));
            }
        }
        assert!(
            Obstacle::sphere(Vector3::zeros(), 1.0).expect("a ball").sharp_edges_near(&around).is_empty()
        );
    }

    #[test]
    fn a_plane_touches_an_edge_if_its_normal_lies_between_those_of_the_faces() {
        let edge = SharpEdge { ends: [-Vector3::x(), Vector3::x()], normals: [Vector3::y(), Vector3::z()] };
        let between = edge.between(&Vector3::new(3.0, 1.0, 1.0)).expect("between");
        assert!((between - Vector3::new(0.0, 0.5, 0.5).normalize()).norm() < 1e-15);
        for outside in [Vector3::new(0.0, 1.0, -0.1), Vector3::new(0.0, -1.0, -1.0), Vector3::x()] {
            assert_eq!(edge.between(&outside), None);
        }
    }
}
