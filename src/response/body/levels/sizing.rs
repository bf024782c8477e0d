//! The coarse skin and bone of a body: edges as long as the tissue allows, shorter where that mesh would cross itself or the bone.

use std::time::Instant;

use crate::geometry::face_tree::find_crossings;
use crate::response::body::check::distance::crossings;
use crate::response::body::check::tissue::{check_nodes, check_uncrossed};
use crate::response::body::error::BodyError;
use crate::response::body::levels::thickness::{mean_thickness, tissue_thickness};
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarseSkin;

/// Coarse meshes tried where the tissue decides, each with edges of [`SHORTER_EDGES`] times the length where the one before
/// crosses itself or the bone, or everywhere.
const MOST_COARSE_MESHES: usize = 16;
const SHORTER_EDGES: f64 = 0.7;

/// Rings of vertices around the rim of held skin that stay as they are, but on skins with too many: tractions are steepest
/// there, and how stiffly a small patch holds a body hangs on its outline. Small patches, and fingers beside their cut, were up
/// to 23 % too stiff without a ring, and are 2 % at the most with one.
const KEPT_RINGS: usize = 1;

/// Wanted length of the edges of a coarse bone, as a share of the tissue's thickness.
const BONE_EDGE_PER_THICKNESS: f64 = 0.35;

/// A bone with fewer vertices, where it may have: edges by its distance from the skin and by its own size.
pub(crate) fn coarse_bone(bone: &Surface, skin: &Surface) -> Surface {
    let widest = mean_thickness(bone);
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

/// A body on a coarse skin.
pub(crate) struct OnCoarse {
    pub skin: CoarseSkin,
    /// Vertices to prepare: those asked for, or all that move where edges are long away from them.
    pub nodes: Vec<usize>,
}

/// What a coarse skin was refused for, and the vertices of the skin there; none where that is all of it.
struct Refused {
    reason: String,
    at: Vec<usize>,
}

impl Body {
    /// This body on its coarse skin; `None` where the skin itself is as coarse as that.
    ///
    /// * `fixed`: vertices of the skin that do not move (n)
    /// * `nodes`: vertices where contact is expected
    ///
    /// # Errors
    /// [`BodyError::CoarseEdgeLength`], [`BodyError::CoarseMesh`], [`BodyError::Interrupted`]; what [`Body::prepare`] finds
    /// wrong with the nodes.
    pub(crate) fn coarse_skin(
        &self,
        skin: &Surface,
        fixed: &[bool],
        nodes: &[usize],
        interrupt: Option<&(dyn Fn() -> bool + Sync)>,
    ) -> Result<Option<OnCoarse>, BodyError> {
        let start = Instant::now();
        let vertex_count = skin.vertices().len();
        if self.coarse_edge_length == Some(0.0) {
            return Ok(None);
        }
        check_nodes(vertex_count, fixed, nodes)?;
        let kept = skin.k_ring(&skin.rim(fixed), KEPT_RINGS);
        let (mut edge_length, has_many, tries) = match self.coarse_edge_length {
            Some(length) => {
                let size = skin.bounding_box().diagonal();
                if !(length > 0.0 && length <= size) {
                    return Err(BodyError::CoarseEdgeLength { value: length, size });
                }
                (vec![length; vertex_count], false, 1)
            }
            None => {
                let (wanted, has_many) = self.wanted_edges(skin, fixed, &kept, nodes);
                (wanted, has_many, MOST_COARSE_MESHES)
            }
        };
        if !has_many {
            kept.iter().for_each(|&vertex| edge_length[vertex] = 0.0);
        }
        let own_edges = skin.mean_edges();
        // Where they would be shorter than the skin's own, that stays as it is.
        let shorter =
            |length: f64, own: f64| if SHORTER_EDGES * length < own { 0.0 } else { SHORTER_EDGES * length };
        let mut coarse = self.coarse_body(skin, &edge_length, fixed);
        for _ in 1..tries {
            let Err(refused) = &coarse else { break };
            if interrupt.is_some_and(|interrupt| interrupt()) {
                let seconds = start.elapsed().as_secs_f64();
                return Err(BodyError::Interrupted { stage: "coarse mesh", seconds });
            }
            let everywhere: Vec<usize> = (0..vertex_count).collect();
            let at = if refused.at.is_empty() { &everywhere } else { &refused.at };
            at.iter().for_each(|&at| edge_length[at] = shorter(edge_length[at], own_edges[at]));
            coarse = self.coarse_body(skin, &edge_length, fixed);
        }
        let coarse = match coarse {
            Ok(coarse) => coarse,
            Err(Refused { reason, .. }) => {
                check_uncrossed(skin)?;
                return Err(BodyError::CoarseMesh { reason });
            }
        };
        Ok(coarse.map(|coarse| {
            let moving = || (0..vertex_count).filter(|&vertex| !fixed[vertex]).collect();
            OnCoarse { skin: coarse, nodes: if has_many { moving() } else { nodes.to_vec() } }
        }))
    }

    /// The skin with edges of so many m, if that is a body around the same bone; `None` where it is the skin itself.
    fn coarse_body(
        &self,
        skin: &Surface,
        edge_length: &[f64],
        fixed: &[bool],
    ) -> Result<Option<CoarseSkin>, Refused> {
        let everywhere = |reason: String| Refused { reason, at: Vec::new() };
        let coarse =
            CoarseSkin::new(skin, edge_length, fixed).map_err(|error| everywhere(error.to_string()))?;
        if coarse.fine_vertices.len() == skin.vertices().len() {
            return Ok(None);
        }
        let own_crossings = find_crossings(coarse.surface.vertices(), coarse.surface.faces());
        if let Some([one, other]) = own_crossings.first() {
            let reason = format!("its faces {one} and {other} cross");
            return Err(Refused { reason, at: coarse.around(own_crossings.as_flattened()) });
        }
        let held = coarse.fine_vertices.iter().map(|&vertex| fixed[vertex]).collect();
        let body = Self { fixed: self.fixed.as_ref().map(|_| held), ..self.clone() };
        match body.held_vertices(&coarse.surface) {
            Ok(_) => Ok(Some(coarse)),
            Err(error) => {
                let pairs = self.bone.as_ref().map_or_else(Vec::new, |bone| crossings(&coarse.surface, bone));
                let faces: Vec<usize> = pairs.into_iter().map(|[face, _]| face).collect();
                Err(Refused { reason: error.to_string(), at: coarse.around(&faces) })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::icosphere;

    #[test]
    fn the_outline_of_held_skin_and_one_ring_stay_on_a_coarse_skin() {
        let (vertices, faces) = icosphere(8e-3, 4);
        let held: Vec<bool> = vertices.iter().map(|vertex| vertex.z > 6e-3).collect();
        let skin = Surface::new(vertices, faces).expect("a ball");
        let body = Body { fixed: Some(held.clone()), ..Body::default() };
        let nodes: Vec<usize> = (0..held.len()).filter(|&vertex| !held[vertex]).collect();
        let fixed = body.held_vertices(&skin).expect("a sound body");
        let coarse = body.coarse_skin(&skin, &fixed, &nodes, None).expect("free nodes");
        let coarse = coarse.expect("a coarse skin").skin;
        assert!(coarse.fine_vertices.len() < skin.vertices().len() / 2);
        for &vertex in &skin.k_ring(&skin.rim(&held), 1) {
            let own = coarse.fine_vertices.binary_search(&vertex).expect("a vertex that stays");
            assert_eq!(coarse.surface.vertices()[own], skin.vertices()[vertex]);
        }
    }
}
