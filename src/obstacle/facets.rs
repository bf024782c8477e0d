//! How blunt the facets of a mesh meet.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::geometry::segment::share_along;
use crate::obstacle::mesh::MeshShape;
use crate::obstacle::posed::Obstacle;

impl Obstacle {
    /// What facets of a mesh that meet within `reach` (m) of a point on it make the pressure there grow by, over E\* and for
    /// cells smaller by a factor of e: β/π at a ridge that falls off by β (rad) on both sides, β/2 at a tip (Johnson 1985,
    /// §5.2); 0 of a primitive.
    pub(crate) fn facet_growth(&self, point: &Vector3<f64>, reach: f64) -> f64 {
        self.as_mesh().map_or(0.0, |mesh| mesh.facet_growth(&self.pose_matrix().to_local(point), reach))
    }
}

impl MeshShape {
    fn facet_growth(&self, point: &Vector3<f64>, reach: f64) -> f64 {
        let (faces, tree) = (self.search(), self.tree());
        let (face, closest) =
            faces.closest_to_point(tree.bvh(), point, f64::INFINITY).expect("a checked mesh has faces");
        let known = tree.pseudo_normals_if_oriented().expect("the tree is built oriented");
        let numbers = self.faces()[face].map(|vertex| vertex as usize);
        let corners = numbers.map(|vertex| self.vertices()[vertex]);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        // Down from what is convex.
        let slope = |top: &Vector3<f64>, normal: Vector3<f64>| {
            if normal.dot(&(center - top)) < 0.0 { normal.angle(&faces.normals[face]) } else { 0.0 }
        };
        let growth = |side: usize| {
            let [from, to] = [side, side + 1].map(|k| corners[k % 3]);
            let nearest = from + share_along(&closest.point, &from, &to) * (to - from);
            let is_near = |place: &Vector3<f64>| (closest.point - place).norm() <= reach;
            let [ridge, tip] =
                [known.edges_pseudo_normal[face][side], known.vertices_pseudo_normal[numbers[side]]]
                    .map(|normal| Vector3::new(normal.x, normal.y, normal.z));
            let at_ridge = if is_near(&nearest) { slope(&from, ridge) / PI } else { 0.0 };
            let at_tip = if is_near(&from) { slope(&from, tip) / 2.0 } else { 0.0 };
            at_ridge.max(at_tip)
        };
        (0..3).map(growth).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obstacle::mesh::MeshObstacleOptions;

    /// A roof of slope 0.1 along x over a block, from -1 to 1 across.
    fn roof() -> Obstacle {
        let z = 0.1_f64.tan();
        let corners = [
            [-2.0, -1.0, 0.0],
            [2.0, -1.0, 0.0],
            [2.0, 1.0, 0.0],
            [-2.0, 1.0, 0.0],
            [-2.0, 0.0, z],
            [2.0, 0.0, z],
        ];
        let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 5], [0, 5, 4], [2, 3, 4], [2, 4, 5], [1, 2, 5], [3, 0, 4]];
        let vertices = corners.map(Vector3::from).to_vec();
        Obstacle::mesh(vertices, faces.to_vec(), &MeshObstacleOptions::default()).expect("a closed mesh")
    }

    #[test]
    fn pressure_grows_at_ridges_and_tips_and_not_between_them() {
        let roof = roof().translated(&Vector3::x());
        let at = |x: f64, y: f64, reach: f64| {
            roof.facet_growth(&Vector3::new(1.0 + x, y, (1.0 - y.abs()) * 0.1_f64.tan()), reach)
        };
        assert!((at(0.0, 0.1, 0.2) - 0.1 / PI).abs() < 1e-12);
        assert_eq!(at(0.0, 0.5, 0.2), 0.0);
        // The gable ends turn by a right angle.
        assert!(at(1.9, 0.5, 0.2) > 0.1);
        assert_eq!(
            Obstacle::sphere(Vector3::zeros(), 1.0).expect("a ball").facet_growth(&Vector3::x(), 1.0),
            0.0
        );
    }
}
