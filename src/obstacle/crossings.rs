//! Pairs of faces that cross.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};
use rayon::prelude::*;

use crate::geometry::crossing::triangles_cross;

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
    let boxes: Vec<Aabb> = faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|v| vertices[v as usize]);
            let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
            Aabb::new(Vector::new(low.x, low.y, low.z), Vector::new(high.x, high.y, high.z))
        })
        .collect();
    crossing_pairs(vertices, faces, &Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes))
}

/// [`find_crossings`] with the tree of the faces' boxes at hand.
pub(super) fn crossing_pairs(vertices: &[Vector3<f64>], faces: &[[u32; 3]], tree: &Bvh) -> Vec<[usize; 2]> {
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
