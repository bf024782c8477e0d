//! Searches among the faces of a mesh through a tree of boxes.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode, BvhWorkspace};
use rayon::prelude::*;

use crate::geometry::bounds::Bounds;
use crate::geometry::closest_point::{Closest, closest_on_triangle, triangle_distance_squared};
use crate::geometry::crossing::{crossing_along, triangles_cross};

/// Slack of a search's reach squared, far above rounding (dimensionless).
const REACH_SLACK: f64 = 1.0 + 1e-9;
/// Squared distances within this ratio of the least are equal (dimensionless).
const EQUALLY_CLOSE: f64 = 1.0 + 1e-6;

/// The faces of a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Faces<'a> {
    /// Positions (m).
    pub vertices: &'a [Vector3<f64>],
    /// Vertex indices of each face, in range.
    pub corners: &'a [[u32; 3]],
    /// Unit normal of each face.
    pub normals: &'a [Vector3<f64>],
}

/// Unit normal of each face; zero of one without area.
pub(crate) fn face_normals(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let normal = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default()
    };
    faces.iter().map(normal).collect()
}

/// Tree of the boxes around faces.
pub(crate) fn face_tree(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Bvh {
    box_tree(faces.iter().map(|face| Bounds::around(face.map(|v| &vertices[v as usize]))))
}

/// Tree of boxes.
pub(crate) fn box_tree(boxes: impl Iterator<Item = Bounds>) -> Bvh {
    let vector = |v: Vector3<f64>| Vector::new(v.x, v.y, v.z);
    let boxes: Vec<Aabb> = boxes.map(|bounds| Aabb::new(vector(bounds.low), vector(bounds.high))).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
}

/// The box of a node (m).
#[inline]
pub(crate) fn node_bounds(node: &BvhNode) -> Bounds {
    let vector = |v: Vector| Vector3::new(v.x, v.y, v.z);
    Bounds { low: vector(node.mins()), high: vector(node.maxs()) }
}

/// All pairs of faces that have points in common beyond the edge or vertex that they share, smaller index
/// first, sorted.
///
/// Touching counts, as do faces that lie on one another. The verdict is exact for the coordinates as given
/// (Shewchuk 1997, doi:10.1007/PL00009321); faces without area cross nothing.
///
/// * `vertices`: (n) points (m), finite
/// * `faces`: (m) triangles of vertex indices, in range
///
/// # Panics
///
/// If a face names a vertex that does not exist.
pub fn find_crossings(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Vec<[usize; 2]> {
    crossings_within(vertices, faces, &face_tree(vertices, faces))
}

/// [`find_crossings`] with the tree of the faces' boxes at hand.
pub(crate) fn crossings_within(vertices: &[Vector3<f64>], faces: &[[u32; 3]], tree: &Bvh) -> Vec<[usize; 2]> {
    let mut close = Vec::new();
    tree.traverse_bvtt_single_tree::<false>(&mut BvhWorkspace::default(), &mut |i, j| close.push([i, j]));
    let mut crossing: Vec<[usize; 2]> = close
        .par_iter()
        .filter(|pair| triangles_cross(vertices, pair.map(|face| faces[face as usize])))
        .map(|&[i, j]| [i.min(j) as usize, i.max(j) as usize])
        .collect();
    crossing.sort_unstable();
    crossing
}

/// Pairs of faces of two meshes whose boxes are at most `reach` (m) apart.
pub(crate) fn close_pairs(trees: [&Bvh; 2], reach: f64) -> Vec<[usize; 2]> {
    let is_close =
        |a: &BvhNode, b: &BvhNode| node_bounds(a).distance_squared(&node_bounds(b)) <= reach * reach;
    trees[0].leaf_pairs(trees[1], is_close).map(|(i, j)| [i as usize, j as usize]).collect()
}

#[inline]
fn distance_squared_to_box(p: &Vector3<f64>, node: &BvhNode) -> f64 {
    let (low, high) = (node.mins(), node.maxs());
    let gap = |p: f64, low: f64, high: f64| (low - p).max(p - high).max(0.0);
    let [x, y, z] = [gap(p.x, low.x, high.x), gap(p.y, low.y, high.y), gap(p.z, low.z, high.z)];
    x * x + y * y + z * z
}

impl<'a> Faces<'a> {
    #[inline]
    pub fn triangle(&self, face: usize) -> [&'a Vector3<f64>; 3] {
        self.corners[face].map(|vertex| &self.vertices[vertex as usize])
    }

    /// The face closest to a point and its point there; `None` if it is surely farther than `reach` (m).
    ///
    /// * `tree`: [`face_tree`] of these faces
    pub fn closest_to_point(&self, tree: &Bvh, p: &Vector3<f64>, reach: f64) -> Option<(usize, Closest)> {
        let (face, (_, closest)) = tree.find_best(
            reach * reach * REACH_SLACK + f64::MIN_POSITIVE,
            |node: &BvhNode, _| distance_squared_to_box(p, node),
            |face, _| {
                let closest = self.closest(p, face);
                Some((closest.distance_squared, closest))
            },
        )?;
        Some((face as usize, closest))
    }

    /// As [`Faces::closest_to_point`], but of faces that are equally close, but for what rounding can do, the first.
    ///
    /// Below an edge the closest point jumps from face to face: where they are alike rounding decides nothing then.
    pub fn first_closest_to_point(&self, tree: &Bvh, p: &Vector3<f64>) -> Option<(usize, Closest)> {
        let (face, closest) = self.closest_to_point(tree, p, f64::INFINITY)?;
        let first = self.all_closest_to_point(tree, p, &closest).min();
        // On a face, to rounding, its box can be farther away than it is itself.
        Some(first.map_or((face, closest), |first| (first, self.closest(p, first as u32))))
    }

    /// The faces that are closest to a point but for what rounding can do, at a distance known.
    pub fn all_closest_to_point(
        &self,
        tree: &Bvh,
        p: &Vector3<f64>,
        closest: &Closest,
    ) -> impl Iterator<Item = usize> {
        let reach_squared = closest.distance_squared * EQUALLY_CLOSE;
        tree.leaves(move |node| distance_squared_to_box(p, node) <= reach_squared)
            .filter(move |&face| self.closest(p, face).distance_squared <= reach_squared)
            .map(|face| face as usize)
    }

    fn closest(&self, p: &Vector3<f64>, face: u32) -> Closest {
        closest_on_triangle(p, self.triangle(face as usize), &self.normals[face as usize])
    }

    /// Winding number of closed faces around a point: the faces that a ray along a coordinate axis meets, 1 from behind,
    /// -1 from the front.
    ///
    /// Exact (Shewchuk 1997, doi:10.1007/PL00009321); `None` if the line of the ray meets an edge.
    ///
    /// * `tree`: [`face_tree`] of these faces
    pub fn winding_along(&self, tree: &Bvh, p: &Vector3<f64>, axis: usize) -> Option<i32> {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let is_met = |node: &BvhNode| {
            let Bounds { low, high } = node_bounds(node);
            p[axis] <= high[axis] && low[u] <= p[u] && p[u] <= high[u] && low[v] <= p[v] && p[v] <= high[v]
        };
        tree.leaves(is_met).map(|face| crossing_along(axis, p, self.triangle(face as usize))).sum()
    }

    /// The face closest to a face of another mesh that crosses none of these, and their distance (m).
    ///
    /// * `tree`: [`face_tree`] of these faces, of which there is one at least
    pub fn closest_to_face(&self, tree: &Bvh, other: Faces, face: usize) -> (usize, f64) {
        let bounds = Bounds::around(other.triangle(face));
        let (closest, distance_squared) = tree
            .find_best(
                f64::INFINITY,
                |node: &BvhNode, _| node_bounds(node).distance_squared(&bounds),
                |own, _| Some(self.distance_squared(own as usize, other, face)),
            )
            .expect("a mesh has faces");
        (closest as usize, distance_squared.sqrt())
    }

    /// Square of the distance (m²) of a face from a face of another mesh that it does not cross.
    pub fn distance_squared(&self, face: usize, other: Faces, other_face: usize) -> f64 {
        triangle_distance_squared(
            [self.triangle(face), other.triangle(other_face)],
            [&self.normals[face], &other.normals[other_face]],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::crossing::triangles_meet;
    use crate::geometry::solid_angle::winding_number;
    use crate::sample::Mesh;

    /// Unit box whose lid rises along x.
    fn box_with_slanted_lid() -> Mesh {
        let corner = |i: usize| {
            let (x, y, top) = ((i & 1) as f64, (i >> 1 & 1) as f64, i >> 2 & 1);
            Vector3::new(x, y, if top == 1 { 1.0 + 0.5 * x } else { 0.0 })
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        ((0..8).map(corner).collect(), faces)
    }

    proptest::proptest! {
        #[test]
        fn windings_along_every_axis_equal_those_of_the_solid_angle(
            point in proptest::array::uniform3(-0.3..1.8),
            inward in proptest::bool::ANY,
        ) {
            let mut mesh = box_with_slanted_lid();
            if inward {
                mesh.1.iter_mut().for_each(|face| face.swap(1, 2));
            }
            let point = Vector3::from(point);
            let expected = winding_number(&point, &mesh.0, mesh.1.iter().copied()).round() as i32;
            let faces = Faces { vertices: &mesh.0, corners: &mesh.1, normals: &face_normals(&mesh.0, &mesh.1) };
            let tree = face_tree(&mesh.0, &mesh.1);
            for axis in 0..3 {
                proptest::prop_assert_eq!(faces.winding_along(&tree, &point, axis), Some(expected));
            }
        }

        #[test]
        fn closest_and_crossing_faces_of_two_meshes_equal_those_of_all_pairs(
            shift in proptest::array::uniform3(-2.0..2.0),
            angles in proptest::array::uniform3(-3.0..3.0),
        ) {
            let one = box_with_slanted_lid();
            let turn = nalgebra::Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
            let other: Mesh =
                (one.0.iter().map(|v| turn * v + Vector3::from(shift)).collect(), one.1.clone());
            let normals = [&one, &other].map(|(vertices, faces)| face_normals(vertices, faces));
            let first = Faces { vertices: &one.0, corners: &one.1, normals: &normals[0] };
            let second = Faces { vertices: &other.0, corners: &other.1, normals: &normals[1] };
            let trees = [face_tree(&one.0, &one.1), face_tree(&other.0, &other.1)];
            let meets = |&[i, j]: &[usize; 2]| triangles_meet(first.triangle(i), second.triangle(j));
            let mut found: Vec<[usize; 2]> =
                close_pairs(trees.each_ref(), 0.0).into_iter().filter(meets).collect();
            found.sort_unstable();
            let all = (0..12).flat_map(|i| (0..12).map(move |j| [i, j]));
            proptest::prop_assert_eq!(found, all.filter(meets).collect::<Vec<_>>());
            for face in 0..12 {
                let (_, distance) = first.closest_to_face(&trees[0], second, face);
                let all = (0..12).map(|own| first.distance_squared(own, second, face));
                let least = all.fold(f64::INFINITY, f64::min).sqrt();
                proptest::prop_assert!((distance - least).abs() <= 1e-15 * (1.0 + least));
            }
        }
    }

    #[test]
    fn rounding_does_not_choose_between_equally_close_faces() {
        let roof = [[-1.0, 0.0, 0.0], [0.0, -2.0, 1.0], [0.0, 2.0, 1.0], [1.0, 0.0, 0.0]].map(Vector3::from);
        let mesh = (roof.to_vec(), vec![[0, 1, 2], [1, 3, 2]]);
        let faces = Faces { vertices: &mesh.0, corners: &mesh.1, normals: &face_normals(&mesh.0, &mesh.1) };
        let tree = face_tree(&mesh.0, &mesh.1);
        for x in [-1e-9, -1e-16, 0.0, 1e-16, 1e-9] {
            let below = Vector3::new(x, 0.0, 0.8);
            let (face, closest) = faces.first_closest_to_point(&tree, &below).expect("two faces");
            assert_eq!(face, 0);
            assert!((closest.point - Vector3::new(-0.1, 0.0, 0.9)).norm() <= 1e-8);
        }
        let aside = Vector3::new(1e-3, 0.0, 0.8);
        assert_eq!(faces.first_closest_to_point(&tree, &aside).expect("two faces").0, 1);
    }

    #[test]
    fn a_ray_through_an_edge_has_no_winding() {
        let mesh = box_with_slanted_lid();
        let faces = Faces { vertices: &mesh.0, corners: &mesh.1, normals: &face_normals(&mesh.0, &mesh.1) };
        let tree = face_tree(&mesh.0, &mesh.1);
        let on_a_diagonal = Vector3::new(0.25, 0.25, 0.5);
        assert_eq!(faces.winding_along(&tree, &on_a_diagonal, 2), None);
        assert_eq!(faces.winding_along(&tree, &on_a_diagonal, 1), Some(1));
    }
}
