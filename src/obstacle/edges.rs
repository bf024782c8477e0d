//! Convex edges of an obstacle, where a skin between its own vertices may meet it first.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::node_bounds;
use crate::geometry::segment::share_along;
use crate::obstacle::posed::{Obstacle, PoseMatrix, Shape};
use crate::obstacle::primitive::Primitive;

/// An edge is sharp where its faces turn by more than this: 15 degrees.
const SHARP_COSINE: f64 = 0.966;

/// Sides of the polygons that stand for the rims of a cylinder: 0.5 % of the radius within them.
const RIM_SIDES: usize = 32;

/// A normal this near to the axis (sine) meets no side of a cylinder but its end.
const ALONG_AXIS: f64 = 1e-6;

/// A normal counts as between two others from this product of sines on, so that a face's own does not; or down to less than
/// nothing by as much, so that it does.
const INSIDE: f64 = 1e-6;

/// Error of a coordinate in another frame, as a share.
const ROUNDING: f64 = 1e-12;

/// A convex edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ConvexEdge {
    /// Its ends (m).
    pub ends: [Vector3<f64>; 2],
    /// Outward unit normals of the two faces that meet there.
    pub normals: [Vector3<f64>; 2],
}

impl ConvexEdge {
    fn placed(&self, pose: &PoseMatrix) -> Self {
        Self {
            ends: self.ends.map(|end| pose.to_world(&end)),
            normals: self.normals.map(|normal| pose.turn(&normal)),
        }
    }

    pub(super) fn is_sharp(&self) -> bool {
        let [one, other] = &self.normals;
        one.dot(other) < SHARP_COSINE
    }

    /// The part of `normal` across the edge, as a unit vector, if it lies between those of the two faces: a plane that the
    /// edge touches from inside has such a normal.
    ///
    /// * `with_faces`: whether the normal of a face itself counts
    pub fn between(&self, normal: &Vector3<f64>, with_faces: bool) -> Option<Vector3<f64>> {
        let least = if with_faces { -INSIDE } else { INSIDE };
        let along = (self.ends[1] - self.ends[0]).try_normalize(0.0)?;
        let across = (normal - along * normal.dot(&along)).try_normalize(0.0)?;
        let [one, other] = &self.normals;
        let turn = one.cross(other);
        let is_between = one.cross(&across).dot(&turn) > least && across.cross(other).dot(&turn) > least;
        (is_between && across.dot(&(one + other)) > 0.0).then_some(across)
    }

    /// Distance of a point (m).
    pub fn distance(&self, point: &Vector3<f64>) -> f64 {
        let [a, b] = &self.ends;
        ((point - a) - share_along(point, a, b) * (b - a)).norm()
    }
}

impl Obstacle {
    /// Sharp convex edges of a mesh, a box or a cylinder, each once; none of a round primitive.
    ///
    /// The rims of a cylinder are polygons.
    pub(crate) fn sharp_edges(&self) -> impl Iterator<Item = ConvexEdge> {
        let own = match self.shape() {
            Shape::Mesh(mesh) => Cow::Borrowed(mesh.sharp_edges()),
            Shape::Primitive(Primitive::Cuboid { half_extents }) => cuboid_edges(half_extents).into(),
            Shape::Primitive(Primitive::Cylinder { half_height, radius }) => {
                cylinder_rims(*half_height, *radius).into()
            }
            Shape::Primitive(_) => Cow::default(),
        };
        let pose = self.pose_matrix();
        (0..own.len()).map(move |edge| own[edge].placed(&pose))
    }

    /// Vertices of a mesh that lie at least so far along a direction (m).
    pub(crate) fn corners_beyond(
        &self,
        direction: &Vector3<f64>,
        least: f64,
    ) -> impl Iterator<Item = Vector3<f64>> {
        let own = match self.shape() {
            Shape::Mesh(mesh) => mesh.vertices(),
            Shape::Primitive(_) => &[],
        };
        let pose = self.pose_matrix();
        let (local, least) =
            (pose.turn_back(direction), least - direction.dot(&pose.to_world(&Vector3::zeros())));
        // The rounding of the two frames loses none.
        let least = least - ROUNDING * least.abs();
        own.iter().filter(move |corner| corner.dot(&local) >= least).map(move |corner| pose.to_world(corner))
    }

    /// The convex edges of a mesh that are not sharp, may meet a box in its own frame and lie between faces that face a plane
    /// with that outward unit normal.
    ///
    /// * `corners`: that the box is around (m)
    pub(crate) fn blunt_edges(
        &self,
        normal: &Vector3<f64>,
        corners: impl Iterator<Item = Vector3<f64>>,
    ) -> Vec<ConvexEdge> {
        let Shape::Mesh(mesh) = self.shape() else { return Vec::new() };
        let pose = self.pose_matrix();
        let within = Bounds::around_each(corners.map(|corner| pose.to_local(&corner)));
        let near = mesh.tree().bvh().leaves(|node| node_bounds(node).meets(&within));
        let (search, local) = (mesh.search(), pose.turn_back(normal));
        let near = near.filter(|&face| search.normals[face as usize].dot(&local) > 0.0);
        let (faces, normals): (Vec<[u32; 3]>, Vec<Vector3<f64>>) =
            near.map(|face| (search.corners[face as usize], search.normals[face as usize])).unzip();
        let mut edges = mesh_edges(search.vertices, &faces, &normals, |edge| !edge.is_sharp());
        edges.iter_mut().for_each(|edge| *edge = edge.placed(&pose));
        edges
    }

    /// Whether it has a [`line_towards`](Self::line_towards) some normals.
    pub(crate) fn is_round(&self) -> bool {
        use Primitive::{Capsule, Cylinder, Sphere};
        matches!(self.shape(), Shape::Primitive(Sphere { .. } | Capsule { .. } | Cylinder { .. }))
    }

    /// The line, or point, of a round primitive that a plane with that outward unit normal touches first.
    ///
    /// A sphere has a point, a capsule and the side of a cylinder have lines along their axes. That of a capsule is swept by
    /// what the spheres in it touch with, so that it has the one of its end.
    pub(crate) fn line_towards(&self, normal: &Vector3<f64>) -> Option<[Vector3<f64>; 2]> {
        let pose = self.pose_matrix();
        let local = pose.turn_back(normal);
        let (ends, arm) = match self.shape() {
            Shape::Primitive(Primitive::Sphere { center, radius }) => ([*center; 2], *radius * local),
            Shape::Primitive(Primitive::Capsule { a, b, radius }) => ([*a, *b], *radius * local),
            Shape::Primitive(Primitive::Cylinder { half_height, radius }) => {
                let end = Vector3::new(0.0, 0.0, *half_height);
                let across = Vector3::new(local.x, local.y, 0.0).try_normalize(ALONG_AXIS)?;
                ([-end, end], *radius * across)
            }
            _ => return None,
        };
        Some(ends.map(|end| pose.to_world(&(end + arm))))
    }
}

/// The convex edges of a mesh that are wanted.
pub(super) fn mesh_edges(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    normals: &[Vector3<f64>],
    is_wanted: impl Fn(&ConvexEdge) -> bool,
) -> Vec<ConvexEdge> {
    let mut sides: Vec<([u32; 2], u32, u32)> = Vec::with_capacity(3 * faces.len());
    for (face, corners) in (0..).zip(faces) {
        for k in 0..3 {
            let [a, b, apex] = [k, k + 1, k + 2].map(|k| corners[k % 3]);
            sides.push(([a.min(b), a.max(b)], face, apex));
        }
    }
    sides.sort_unstable();
    let point = |vertex: u32| vertices[vertex as usize];
    let convex = |pair: &[([u32; 2], u32, u32)]| {
        let &[(ends, one, _), (_, other, apex)] = pair else { return None };
        let normals = [one, other].map(|face| normals[face as usize]);
        let is_convex = (point(apex) - point(ends[0])).dot(&normals[0]) < 0.0;
        is_convex.then(|| ConvexEdge { ends: ends.map(point), normals })
    };
    sides.chunk_by(|one, other| one.0 == other.0).filter_map(convex).filter(is_wanted).collect()
}

/// The twelve edges of a box around the origin.
fn cuboid_edges(half_extents: &Vector3<f64>) -> Vec<ConvexEdge> {
    let mut edges = Vec::with_capacity(12);
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for [s, t] in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
            let mut end = Vector3::zeros();
            (end[u], end[v]) = (s * half_extents[u], t * half_extents[v]);
            let along = Vector3::ith(axis, half_extents[axis]);
            let normals = [Vector3::ith(u, s), Vector3::ith(v, t)];
            edges.push(ConvexEdge { ends: [end - along, end + along], normals });
        }
    }
    edges
}

/// Polygons inscribed in the two rims of a cylinder around the z axis.
fn cylinder_rims(half_height: f64, radius: f64) -> Vec<ConvexEdge> {
    let out = |k: usize| {
        let (sine, cosine) = (std::f64::consts::TAU * k as f64 / RIM_SIDES as f64).sin_cos();
        Vector3::new(cosine, sine, 0.0)
    };
    let side = |k: usize| {
        let (a, b) = (out(k), out((k + 1) % RIM_SIDES));
        [-1.0, 1.0].map(|end| {
            let cap = Vector3::new(0.0, 0.0, end);
            let ends = [a, b].map(|out| radius * out + half_height * cap);
            ConvexEdge { ends, normals: [cap, (a + b).normalize()] }
        })
    };
    (0..RIM_SIDES).flat_map(side).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_twelve_edges_as_a_primitive_and_as_a_mesh_and_a_ball_has_none() {
        let extents = Vector3::new(1.0, 2.0, 3.0);
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
            let edges = obstacle.translated(&shift).sharp_edges().collect::<Vec<_>>();
            assert_eq!(edges.len(), 12);
            for ConvexEdge { ends: [a, b], normals } in edges {
                assert_eq!((b - a).iter().filter(|part| **part != 0.0).count(), 1);
                assert_eq!([(a - shift).abs(), (b - shift).abs()], [extents; 2]);
                assert!(normals.iter().all(|normal| (a - shift).dot(normal) > 0.0));
            }
        }
        assert!(Obstacle::sphere(Vector3::zeros(), 1.0).expect("a ball").sharp_edges().next().is_none());
    }

    #[test]
    fn a_plane_touches_an_edge_if_its_normal_lies_between_those_of_the_faces() {
        let edge = ConvexEdge { ends: [-Vector3::x(), Vector3::x()], normals: [Vector3::y(), Vector3::z()] };
        let between = edge.between(&Vector3::new(3.0, 1.0, 1.0), false).expect("between");
        assert!((between - Vector3::new(0.0, 0.5, 0.5).normalize()).norm() < 1e-15);
        for outside in [Vector3::new(0.0, 1.0, -0.1), Vector3::new(0.0, -1.0, -1.0), Vector3::x()] {
            assert_eq!(edge.between(&outside, true), None);
        }
        assert_eq!([false, true].map(|with| edge.between(&Vector3::z(), with)), [None, Some(Vector3::z())]);
    }
}
