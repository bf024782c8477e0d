//! Where the mesh of the last round is to be finer.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow::{self, Break, Continue};

use crate::contact::clues::LoadedEdge;
use crate::contact::error::ContactError;
use crate::contact::outcome::RefinementEnd;
use crate::contact::refine::mark::{loaded, pressed_between, too_large};
use crate::contact::refine::meshes::Meshes;
use crate::surface::refined::RefinedSurface;

/// Breadth of the skin held on a sharp edge with which triangles are as small as it has use for, in half the breadth of what
/// stands in the skin there times the root of the target: figures go on changing with the logarithm of the cells there.
const FINEST_ON_EDGE: f64 = 1.3;
/// The same at the least, in the length of the edge over the most nodes times that root, as a contact has some 20 times as many
/// nodes as its length has breadths: where they ran out, skin with a row of vertices on the edge came to triangles of half the
/// breadth.
const LEAST_ON_EDGE: f64 = 530.0;
/// How much broader it may be where an edge has all but left the skin than at its deepest. So few triangles come to be too large
/// at the same depth, as all would that are halves of one, and those that carry little force are larger.
const BROADER_AT_ENDS: f64 = 1.0;
/// A round for fewer of the triangles on the edge, as a share of all, is not worth its time; one for all but so few takes all.
const FEW_LARGER: f64 = 0.03;

/// Where a round makes the mesh finer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Finer {
    /// Wherever the skin is pressed.
    Pressed,
    /// On a sharp edge, where triangles are larger than that has use for: so large a share of those there.
    Larger { share: f64 },
    /// At the rim of what is pressed.
    Rim,
    /// Where it is touched away from all force.
    Elsewhere,
}

/// The meshes so far, and how good the figures are to be.
pub(super) struct Wanting<'a> {
    pub meshes: &'a Meshes,
    /// Of the relative error.
    pub target: f64,
    /// That a contact may have.
    pub max_nodes: usize,
}

impl Wanting<'_> {
    /// Where the next round is to make the mesh finer: all that is pressed, until the force is known well enough, then its rim,
    /// and what is touched away from all force where force and area are as good as wanted. On a sharp edge triangles get as
    /// small as that has use for: figures that hang on their size must not jump from one depth to the next.
    ///
    /// * `touches_elsewhere_alone`: whether the mesh is fine enough but for where it is touched away from all force
    pub fn next(&self, touches_elsewhere_alone: bool) -> ControlFlow<RefinementEnd, Finer> {
        let Some((part, contact)) = &self.meshes.last else { return Continue(Finer::Pressed) };
        if let Some(edge) = &contact.clues.edge {
            let share = self.share_of_larger(edge, part);
            if share < FEW_LARGER {
                return Break(RefinementEnd::SharpEdge);
            }
            if share < 1.0 - FEW_LARGER && !touches_elsewhere_alone {
                return Continue(Finer::Larger { share });
            }
        }
        Continue(if touches_elsewhere_alone {
            Finer::Elsewhere
        } else if contact.knows_force(self.target) {
            Finer::Rim
        } else {
            Finer::Pressed
        })
    }

    /// Share of the triangles on a sharp edge that are larger than it has use for.
    fn share_of_larger(&self, edge: &LoadedEdge, part: &RefinedSurface) -> f64 {
        let count = |marked: &[bool]| marked.iter().filter(|&&is_marked| is_marked).count() as f64;
        count(&self.larger()) / count(&loaded(&self.meshes.mesh, &part.numbers(&edge.held)))
    }

    /// Triangles that are larger than a sharp edge has use for.
    fn larger(&self) -> Vec<bool> {
        let mut longest = BTreeMap::new();
        if let Some((part, contact)) = &self.meshes.last
            && let Some(edge) = &contact.clues.edge
        {
            let deepest = contact.max_penetration_before;
            let finest = FINEST_ON_EDGE * deepest;
            let least = LEAST_ON_EDGE * edge.length / self.max_nodes as f64;
            let along = edge.depth.iter().zip(&edge.spread);
            longest.extend(part.numbers(&edge.held).into_iter().zip(along).map(
                |(vertex, (depth, spread))| {
                    let from_deepest = (1.0 - depth / deepest).clamp(0.0, 1.0).sqrt();
                    let broader = 1.0 + BROADER_AT_ENDS * from_deepest;
                    let breadth = self.target.sqrt() * (finest * spread).max(least) * broader;
                    (vertex, breadth / edge.cells)
                },
            ));
        }
        too_large(&self.meshes.mesh, |vertex| longest.get(&vertex).copied())
    }

    /// Vertices whose triangles are too large, by their numbers in the whole refined surface.
    pub fn vertices(&self, finer: Finer) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.pressed() };
        let is_free = |&other: &u32| contact.node_force[other as usize] == 0.0;
        let at_rim = |&vertex: &usize| part.surface.neighbours(vertex).iter().any(is_free);
        match finer {
            Finer::Pressed => self.pressed(),
            Finer::Larger { .. } => {
                let held = contact.clues.edge.as_ref().map_or(Vec::new(), |edge| part.numbers(&edge.held));
                let larger = self.larger();
                let leaves = (0..larger.len()).filter(|&leaf| larger[leaf]);
                let corners: BTreeSet<usize> =
                    leaves.flat_map(|leaf| self.meshes.mesh.corners(leaf)).collect();
                held.into_iter().filter(|vertex| corners.contains(vertex)).collect()
            }
            Finer::Rim => {
                let rim = contact.pressed().into_iter().filter(at_rim);
                rim.map(|vertex| part.number(vertex)).collect()
            }
            Finer::Elsewhere => part.numbers(&contact.clues.unfelt),
        }
    }

    /// Vertices under force or in the obstacle without feeling any, by their numbers in the whole refined surface, ascending.
    fn pressed(&self) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.meshes.given.pressed() };
        contact.pressed().into_iter().map(|vertex| part.number(vertex)).collect()
    }

    /// Triangles to cut.
    ///
    /// * `wanting`: the [`vertices`](Self::vertices)
    /// * `between`: triangles away from all force that the obstacle touches between their vertices
    pub fn marked(
        &self,
        wanting: &[usize],
        finer: Finer,
        between: &[usize],
    ) -> Result<Vec<bool>, ContactError> {
        let mut marked = match finer {
            Finer::Larger { .. } => self.larger(),
            _ => loaded(&self.meshes.mesh, wanting),
        };
        if finer == Finer::Rim {
            // Only those that the rim runs through.
            let pressed = self.pressed();
            let is_under = |corner: &usize| pressed.binary_search(corner).is_ok();
            for (leaf, marked) in marked.iter_mut().enumerate() {
                *marked &= !self.meshes.mesh.corners(leaf).iter().all(is_under);
            }
        }
        between.iter().for_each(|&leaf| marked[leaf] = true);
        if self.meshes.last.is_none() {
            let given = &self.meshes.given;
            let between = pressed_between(&self.meshes.mesh, &given.gap, &given.obstacle, &marked)?;
            between.into_iter().for_each(|leaf| marked[leaf] = true);
        }
        Ok(marked)
    }
}
