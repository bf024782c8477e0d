//! A convex edge, and those of a mesh, a box and a cylinder in their own frames.

use nalgebra::Vector3;

use crate::geometry::segment::share_along;
use crate::obstacle::pose_matrix::PoseMatrix;

/// An edge is sharp where its faces turn by more than this: 15 degrees.
const SHARP_COSINE: f64 = 0.966;

/// Sides of the polygons that stand for the rims of a cylinder: 0.5 % of the radius within them.
pub(super) const RIM_SIDES: usize = 32;

/// A normal counts as between two others from this product of sines on, so that a face's own does not; or down to less than
/// nothing by as much, so that it does.
const BETWEEN_SINES: f64 = 1e-6;

/// A convex edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ConvexEdge {
    /// Its ends (m).
    pub ends: [Vector3<f64>; 2],
    /// Outward unit normals of the two faces that meet there.
    pub normals: [Vector3<f64>; 2],
}

impl ConvexEdge {
    /// Where the obstacle stands.
    pub(super) fn placed(&self, pose: &PoseMatrix) -> Self {
        Self {
            ends: self.ends.map(|end| pose.to_world(&end)),
            normals: self.normals.map(|normal| pose.turn(&normal)),
        }
    }

    /// Whether its faces turn so much that it is sharp.
    pub fn is_sharp(&self) -> bool {
        let [one, other] = &self.normals;
        one.dot(other) < SHARP_COSINE
    }

    /// The part of `normal` across the edge, as a unit vector, if it lies between those of the two faces: a plane that the
    /// edge touches from inside has such a normal.
    ///
    /// * `with_faces`: whether the normal of a face itself counts
    pub fn between(&self, normal: &Vector3<f64>, with_faces: bool) -> Option<Vector3<f64>> {
        let least = if with_faces { -BETWEEN_SINES } else { BETWEEN_SINES };
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
pub(super) fn cuboid_edges(half_extents: &Vector3<f64>) -> Vec<ConvexEdge> {
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
pub(super) fn cylinder_rims(half_height: f64, radius: f64) -> Vec<ConvexEdge> {
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
