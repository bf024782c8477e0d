//! Thickness of the tissue, and how long the edges of a coarse mesh may be over it.

use rayon::prelude::*;

use crate::geometry::face_tree::{Faces, face_tree, find_crossings};
use crate::response::body::check::tissue::check_nodes;
use crate::response::body::error::BodyError;
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarseSkin;

/// Wanted length of the coarse edges, as a share of the tissue's thickness. Collapses make some up to 1.5 times as long.
const EDGE_PER_THICKNESS: f64 = 0.4;

/// The same for the edges of a coarse bone.
const BONE_EDGE_PER_THICKNESS: f64 = 0.35;

/// Thickness of the tissue (n, m): distance of each vertex of the skin from the bone, or of the bone from the skin. It
/// varies no faster than the surface runs, so it needs no smoothing.
pub(crate) fn tissue_thickness(skin: &Surface, bone: &Surface) -> Vec<f64> {
    let (vertices, corners) = (bone.vertices(), bone.faces());
    let faces = Faces { vertices, corners, normals: bone.face_normals() };
    let tree = face_tree(vertices, corners);
    let distance = |point| {
        let (_, closest) = faces.closest_to_point(&tree, point, f64::INFINITY).expect("a bone has faces");
        closest.distance_squared.sqrt()
    };
    skin.vertices().par_iter().map(distance).collect()
}

/// A bone with fewer vertices, where it may have: edges by its distance from the skin and by its own size.
pub(crate) fn coarse_bone(bone: &Surface, skin: &Surface) -> Surface {
    let widest = 2.0 * bone.volume() / bone.area();
    let wanted = |depth: f64| BONE_EDGE_PER_THICKNESS * depth.min(widest);
    let edge_length: Vec<f64> = tissue_thickness(bone, skin).into_iter().map(wanted).collect();
    let coarse = CoarseSkin::new(bone, &edge_length, &vec![false; edge_length.len()]);
    match coarse {
        Ok(coarse) if find_crossings(coarse.surface.vertices(), coarse.surface.faces()).is_empty() => {
            coarse.surface
        }
        _ => bone.clone(),
    }
}

impl Body {
    /// The coarse skin of this body and the vertices of the skin that do not move (n); `None` where the skin itself is as
    /// coarse as that.
    ///
    /// * `nodes`: vertices that may be loaded
    ///
    /// # Errors
    /// [`BodyError::CoarseEdgeLength`], [`BodyError::CoarseMesh`]; what [`Body::prepare`] finds wrong with the body.
    pub(crate) fn coarse_skin(
        &self,
        skin: &Surface,
        nodes: &[usize],
    ) -> Result<Option<(CoarseSkin, Vec<bool>)>, BodyError> {
        let vertex_count = skin.vertices().len();
        if self.coarse_edge_length == Some(0.0) {
            return Ok(None);
        }
        let (_, fixed) = self.check(skin)?;
        check_nodes(vertex_count, &fixed, nodes)?;
        let edge_length = match self.coarse_edge_length {
            Some(length) => {
                let size = skin.bounding_box().diagonal();
                if !(length > 0.0 && length <= size) {
                    return Err(BodyError::CoarseEdgeLength { value: length, size });
                }
                vec![length; vertex_count]
            }
            None => {
                // 2 V / A: the mean thickness of what has no bone within reach.
                let deepest = 2.0 * skin.volume() / skin.area();
                let mut thickness = match &self.bone {
                    Some(bone) => tissue_thickness(skin, bone),
                    None => vec![deepest; vertex_count],
                };
                thickness.iter_mut().for_each(|t| *t = EDGE_PER_THICKNESS * t.min(deepest));
                thickness
            }
        };
        let refused = |reason: String| BodyError::CoarseMesh { reason };
        let coarse =
            CoarseSkin::new(skin, &edge_length, &fixed).map_err(|error| refused(error.to_string()))?;
        if coarse.fine_vertices.len() == vertex_count {
            return Ok(None);
        }
        let held = coarse.fine_vertices.iter().map(|&vertex| fixed[vertex]).collect();
        let body = Self { fixed: self.fixed.as_ref().map(|_| held), ..self.clone() };
        body.check(&coarse.surface).map_err(|error| refused(error.to_string()))?;
        let crossings = find_crossings(coarse.surface.vertices(), coarse.surface.faces());
        match crossings.first() {
            Some([one, other]) => Err(refused(format!("its faces {one} and {other} cross"))),
            None => Ok(Some((coarse, fixed))),
        }
    }
}
