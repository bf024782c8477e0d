//! Convex edges of an obstacle, where a skin between its own vertices may meet it first.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::node_bounds;
use crate::obstacle::convex_edge::{ConvexEdge, cuboid_edges, cylinder_rims, mesh_edges};
use crate::obstacle::mesh::MeshShape;
use crate::obstacle::posed::{Obstacle, Shape};
use crate::obstacle::primitive::Primitive;

/// A normal this near to the axis (sine) meets no side of a cylinder but its end.
const ALONG_AXIS: f64 = 1e-6;

/// Error of a coordinate in another frame, as a share.
const FRAME_ROUNDING: f64 = 1e-12;

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
        let pose = self.pose_matrix();
        let (local, least) =
            (pose.turn_back(direction), least - direction.dot(&pose.to_world(&Vector3::zeros())));
        // The rounding of the two frames loses none.
        let least = least - FRAME_ROUNDING * least.abs();
        self.own_corners()
            .iter()
            .filter(move |corner| corner.dot(&local) >= least)
            .map(move |corner| pose.to_world(corner))
    }

    /// Vertices of a mesh in its own frame; none of a primitive.
    fn own_corners(&self) -> &[Vector3<f64>] {
        self.as_mesh().map_or(&[], MeshShape::vertices)
    }

    /// Vertices of a mesh within a box.
    pub(crate) fn corners_within(&self, bounds: &Bounds) -> impl Iterator<Item = Vector3<f64>> {
        let pose = self.pose_matrix();
        self.own_corners()
            .iter()
            .map(move |corner| pose.to_world(corner))
            .filter(|corner| bounds.contains(corner))
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
        let Some(mesh) = self.as_mesh() else { return Vec::new() };
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
}
