//! How deep corners, sharp edges and thin walls of the obstacle stand in the skin.

use std::collections::HashSet;

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::gap::edge::SkinPart;
use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::{Faces, face_normals, face_tree};
use crate::obstacle::faces_near::Triangle;
use crate::obstacle::posed::Obstacle;

/// Points of an edge per length of an edge of the skin.
const POINTS_PER_EDGE: f64 = 6.0;

/// Pieces of a face per length of an edge of the skin, the least ones.
const PIECES_PER_EDGE: f64 = 3.0;

/// A piece is halved as long as it may be deeper than the deepest by so much (dimensionless).
const DEEPER: f64 = 1.05;

/// Points that one task looks at.
const POINTS_PER_TASK: usize = 64;

impl SkinPart<'_> {
    /// How deep (m) corners of a mesh and points of sharp edges stand in the skin at the most; `least` (m) where none is
    /// deeper. Faces are searched where skin went through walls: elsewhere its own vertices and triangles are as deep.
    ///
    /// In a groove of the skin the deepest of an edge lies under no triangle, but nearest to the ground between two.
    ///
    /// * `at_rest`: the points before they moved (m)
    /// * `reach`: depth (m) that none exceeds
    /// * `with_faces`: whether skin went through walls
    pub fn deepest_inside(
        &self,
        at_rest: &[Vector3<f64>],
        obstacle: &Obstacle,
        reach: f64,
        least: f64,
        with_faces: bool,
    ) -> f64 {
        let around = Bounds::around(self.points).grown(reach);
        let mut points = self.edge_points(obstacle, &around);
        points.extend(obstacle.corners_within(&around));
        let tree = face_tree(self.points, self.triangles);
        let normals = face_normals(self.points, self.triangles);
        let normals_at_rest = face_normals(at_rest, self.triangles);
        let faces = Faces { vertices: self.points, corners: self.triangles, normals: &normals };
        let border = self.border();
        // Of a point before the skin less than none; `None` farther than `within`.
        let depth = |point: &Vector3<f64>, within: f64| {
            let (face, closest) = faces.closest_to_point(&tree, point, within)?;
            let out = closest.point - point;
            // Outside a ridge it is before one of the faces that meet there. A face that was turned over tells no side, and beyond
            // the border there is more skin, or none.
            let is_behind = |face: usize| {
                let is_turned = normals[face].dot(&normals_at_rest[face]) <= 0.0;
                let is_within = self.triangles[face].iter().all(|corner| !border.contains(corner));
                is_within && !is_turned && out.dot(&normals[face]) > 0.0
            };
            let mut closest_faces = faces.all_closest_to_point(&tree, point, &closest);
            let is_inside = is_behind(face) && closest_faces.all(is_behind);
            let distance = out.norm();
            Some(if is_inside && distance <= reach { distance } else { -distance })
        };
        let depths = points.par_iter().with_min_len(POINTS_PER_TASK).filter_map(|point| depth(point, reach));
        let deepest = depths.reduce(|| least, f64::max);
        if !with_faces {
            return deepest;
        }
        let depth = |point: &Vector3<f64>| depth(point, f64::INFINITY).unwrap_or(f64::NEG_INFINITY);
        let shortest = self.mean_edge() / PIECES_PER_EDGE;
        let walls = obstacle.faces_near(&around).into_iter();
        walls.fold(deepest, |deepest, wall| deepest_on(wall, &depth, shortest, deepest))
    }

    /// Points of sharp edges within a box.
    fn edge_points(&self, obstacle: &Obstacle, around: &Bounds) -> Vec<Vector3<f64>> {
        let mut points = Vec::new();
        let spacing = self.mean_edge() / POINTS_PER_EDGE;
        for edge in obstacle.sharp_edges() {
            if !Bounds::around(&edge.ends).meets(around) {
                continue;
            }
            let [from, to] = edge.ends;
            let (length, half) = ((to - from).norm(), 0.5 * around.diagonal());
            // What is farther from the middle of the box is outside. The points are the edge's own, wherever the box ends.
            let middle = (around.center() - from).dot(&(to - from)) / length;
            let parts = (length / spacing).ceil().max(1.0);
            let part_at = |way: f64| (way / length).clamp(0.0, 1.0) * parts;
            let (start, end) = (part_at(middle - half).floor(), part_at(middle + half).ceil());
            let along = (start as usize..=end as usize).map(|part| from + part as f64 / parts * (to - from));
            points.extend(along.filter(|point| around.contains(point)));
        }
        points
    }

    /// Mean length of the edges (m).
    fn mean_edge(&self) -> f64 {
        let point = |corner: u32| self.points[corner as usize];
        let sum: f64 = self.sides().map(|[from, to]| (point(to) - point(from)).norm()).sum();
        sum / (3 * self.triangles.len()) as f64
    }

    /// Vertices on edges of one triangle alone: no other has that side in the other direction.
    fn border(&self) -> HashSet<u32> {
        let all: HashSet<[u32; 2]> = self.sides().collect();
        self.sides().filter(|&[from, to]| !all.contains(&[to, from])).flatten().collect()
    }

    /// The sides of the triangles, each in their direction.
    fn sides(&self) -> impl Iterator<Item = [u32; 2]> {
        self.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
    }
}

/// `deepest`, or how deep (m) a triangle stands in the skin at the most where that is more.
///
/// No point of it is deeper than its middle by more than it is far from that.
///
/// * `depth`: of a point (m)
/// * `shortest`: longest side (m) of a piece that is small enough
fn deepest_on(triangle: Triangle, depth: &impl Fn(&Vector3<f64>) -> f64, shortest: f64, deepest: f64) -> f64 {
    let [a, b, c] = triangle;
    let middle = (a + b + c) / 3.0;
    let here = depth(&middle);
    let deepest = deepest.max(here);
    let radius = triangle.iter().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
    let length = |[a, b, _]: &Triangle| (b - a).norm();
    let turned = [[a, b, c], [b, c, a], [c, a, b]];
    let [a, b, c] =
        turned.into_iter().max_by(|one, other| length(one).total_cmp(&length(other))).expect("three");
    if here + radius <= DEEPER * deepest || (b - a).norm() <= shortest {
        return deepest;
    }
    let middle = 0.5 * (a + b);
    [[a, middle, c], [middle, b, c]]
        .into_iter()
        .fold(deepest, |deepest, part| deepest_on(part, depth, shortest, deepest))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use super::*;
    use crate::sample::grid;

    #[test]
    fn an_edge_below_the_ground_of_a_groove_is_as_deep_as_it_is_far_from_that() {
        let (mut points, triangles) = grid(8, 8, 0.25);
        for point in &mut points {
            *point -= Vector3::new(1.0, 1.0, 0.0);
            point.z = 0.5 * point.x.abs();
        }
        let skin = SkinPart { points: &points, triangles: &triangles };
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), FRAC_PI_4);
        let edge_at = |depth: f64| {
            let shift = Vector3::new(0.0, 0.1, 2f64.sqrt() - depth);
            Obstacle::cuboid(Vector3::repeat(1.0))
                .expect("a box")
                .moved(turn.matrix(), &shift)
                .expect("a turn")
        };
        let distance = vec![0.0; points.len()];
        let of_triangles = skin.deepest_between(&edge_at(0.1), 0.5, 0.0, &distance);
        assert!(of_triangles < 0.099, "{of_triangles}");
        assert!((skin.deepest_inside(&points, &edge_at(0.1), 0.5, 0.0, false) - 0.1).abs() < 1e-12);
        assert_eq!(skin.deepest_inside(&points, &edge_at(0.1), 0.5, 0.2, false), 0.2);
        assert_eq!(skin.deepest_inside(&points, &edge_at(-0.1), 0.5, 0.0, false), 0.0);
    }

    #[test]
    fn an_edge_that_is_longer_than_the_skin_is_as_deep_however_the_scene_is_turned() {
        let (mut points, triangles) = grid(8, 8, 0.25);
        for point in &mut points {
            *point -= Vector3::new(1.0, 1.0, 0.0);
            point.z = 0.5 * point.x.abs() - 0.1 * point.y * point.y;
        }
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), FRAC_PI_4);
        let edge = Obstacle::cuboid(Vector3::new(1.0, 5.0, 1.0)).expect("a box");
        let depth_in = |turned: nalgebra::Rotation3<f64>| {
            let points: Vec<Vector3<f64>> = points.iter().map(|point| turned * point).collect();
            let shift = turned * Vector3::new(0.0, 0.1, 2f64.sqrt() - 0.1);
            let edge = edge.moved((turned * turn).matrix(), &shift).expect("a turn");
            let skin = SkinPart { points: &points, triangles: &triangles };
            skin.deepest_inside(&points, &edge, 0.5, 0.0, false)
        };
        let as_it_stands = depth_in(nalgebra::Rotation3::identity());
        assert!(as_it_stands > 0.09, "{as_it_stands}");
        for angle in [0.3, 0.7, 2.0] {
            let turned = depth_in(nalgebra::Rotation3::from_euler_angles(angle, 2.0 * angle, 0.5));
            assert!((turned - as_it_stands).abs() < 1e-12, "{turned} {as_it_stands}");
        }
    }

    #[test]
    fn a_wall_that_skin_went_through_is_deepest_between_its_edges() {
        let (mut points, triangles) = grid(8, 8, 0.25);
        for point in &mut points {
            *point -= Vector3::new(1.0, 1.0, 0.0);
            point.z = -0.5 * point.x.abs();
        }
        let skin = SkinPart { points: &points, triangles: &triangles };
        let wall = Obstacle::cuboid(Vector3::new(0.9, 3.0, 0.02)).expect("a box");
        let wall = wall.translated(&Vector3::new(0.0, 0.0, -0.3));
        // Its edges have left the skin. Under the ridge its lower side is deepest.
        assert_eq!(skin.deepest_inside(&points, &wall, 0.5, 0.0, false), 0.0);
        let deepest = skin.deepest_inside(&points, &wall, 0.5, 0.0, true);
        let exact = 0.32 / 1.25_f64.sqrt();
        assert!(deepest <= exact && exact <= DEEPER * deepest, "{deepest} of {exact}");
    }
}
