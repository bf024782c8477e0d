//! Distances and crossings between the faces of skin and bone.

use rayon::prelude::*;

use crate::geometry::crossing::triangles_meet;
use crate::geometry::face_tree::{close_pairs, face_tree};
use crate::surface::checked::Surface;

/// Two faces and their distance (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FacePair {
    pub first: usize,
    pub second: usize,
    pub distance: f64,
}

/// The two closest faces of surfaces that do not cross.
pub(crate) fn closest_faces(first: &Surface, second: &Surface) -> FacePair {
    let tree = face_tree(second.vertices(), second.faces());
    let closest = |face| {
        let (closest, distance) = second.as_faces().closest_to_face(&tree, first.as_faces(), face);
        FacePair { first: face, second: closest, distance }
    };
    (0..first.faces().len())
        .into_par_iter()
        .map(closest)
        .min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.first.cmp(&b.first)))
        .expect("a surface has faces")
}

/// All pairs of faces of the two surfaces that cross or touch, sorted.
pub(crate) fn crossings(first: &Surface, second: &Surface) -> Vec<[usize; 2]> {
    let trees = [first, second].map(|surface| face_tree(surface.vertices(), surface.faces()));
    let mut pairs = close_pairs(trees.each_ref(), 0.0);
    let (first, second) = (first.as_faces(), second.as_faces());
    pairs.retain(|&[i, j]| triangles_meet(first.triangle(i), second.triangle(j)));
    pairs.sort_unstable();
    pairs
}

/// The two closest faces of different components that are within `limit` (m) of one another; 0 m where they cross.
pub(crate) fn closest_between_components(
    surface: &Surface,
    component: impl Fn(usize) -> usize,
    limit: f64,
) -> Option<FacePair> {
    let faces = surface.as_faces();
    let tree = face_tree(surface.vertices(), surface.faces());
    close_pairs([&tree, &tree], limit)
        .into_iter()
        .filter(|&[i, j]| component(i) < component(j))
        .map(|[first, second]| {
            let is_crossing = triangles_meet(faces.triangle(first), faces.triangle(second));
            let apart = || faces.distance_squared(first, faces, second).sqrt();
            FacePair { first, second, distance: if is_crossing { 0.0 } else { apart() } }
        })
        .filter(|pair| pair.distance <= limit)
        .min_by(|a, b| a.distance.total_cmp(&b.distance).then((a.first, a.second).cmp(&(b.first, b.second))))
}
