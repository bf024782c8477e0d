//! Thickness of the tissue over what does not move.

use rayon::prelude::*;

use crate::geometry::face_tree::{Faces, face_normals, face_tree};
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;

/// What is held is behind skin that it faces away from: above this cosine between the normals it is beside it.
const BEHIND_COSINE: f64 = -0.5;

/// What is held farther away than so many mean thicknesses of the body is as good as not there.
const FARTHEST_HELD: f64 = 3.0;

/// Tissue over it is no thinner than so many edges of the skin, which knows no thinner one.
const LEAST_EDGES: f64 = 2.0;

/// Thickness of the tissue (n, m): distance of each vertex of the skin from the bone, or of the bone from the skin. It
/// varies no faster than the surface runs, so it needs no smoothing.
pub(super) fn tissue_thickness(skin: &Surface, bone: &Surface) -> Vec<f64> {
    let (faces, tree) = (bone.as_faces(), face_tree(bone.vertices(), bone.faces()));
    let distance = |point| {
        let (_, closest) = faces.closest_to_point(&tree, point, f64::INFINITY).expect("a bone has faces");
        closest.distance_squared.sqrt()
    };
    skin.vertices().par_iter().map(distance).collect()
}

/// The same (n, m) in tissue without bone over what is held behind it, as a pad that is glued to a plate; `None` where nothing is.
///
/// * `is_held`: vertices that do not move (n)
fn thickness_over_held(skin: &Surface, is_held: &[bool]) -> Option<Vec<f64>> {
    let held = skin.faces().iter().filter(|face| face.iter().all(|&corner| is_held[corner as usize]));
    let held: Vec<[u32; 3]> = held.copied().collect();
    let normals = face_normals(skin.vertices(), &held);
    let (faces, tree) = (
        Faces { vertices: skin.vertices(), corners: &held, normals: &normals },
        face_tree(skin.vertices(), &held),
    );
    let (reach, own_edges) = (FARTHEST_HELD * mean_thickness(skin), skin.mean_edges());
    let distance = |vertex: usize| {
        let (face, closest) = faces.closest_to_point(&tree, &skin.vertices()[vertex], reach)?;
        (normals[face].dot(&skin.vertex_normals()[vertex]) < BEHIND_COSINE)
            .then(|| closest.distance_squared.sqrt())
    };
    let found: Vec<Option<f64>> = (0..own_edges.len()).into_par_iter().map(distance).collect();
    let moves_over_held = (0..found.len()).any(|vertex| !is_held[vertex] && found[vertex].is_some());
    let thickness = |(distance, own): (Option<f64>, &f64)| distance.unwrap_or(reach).max(LEAST_EDGES * own);
    moves_over_held.then(|| found.into_iter().zip(&own_edges).map(thickness).collect())
}

/// 2 V / A: the mean thickness (m) of a body.
pub(super) fn mean_thickness(skin: &Surface) -> f64 {
    2.0 * skin.volume() / skin.area()
}

impl Body {
    /// Thickness of the tissue at each vertex of the skin (n, m), where something is behind it that does not move.
    ///
    /// * `is_held`: vertices of the skin that do not (n)
    pub(crate) fn tissue_thickness(&self, skin: &Surface, is_held: &[bool]) -> Option<Vec<f64>> {
        match &self.bone {
            Some(bone) => Some(tissue_thickness(skin, bone)),
            None => thickness_over_held(skin, is_held),
        }
    }
}
