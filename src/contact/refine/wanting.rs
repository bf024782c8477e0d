//! Where the mesh of the last round is to be finer.

use crate::contact::error::ContactError;
use crate::contact::refine::mark::{loaded, pressed_between};
use crate::contact::refine::rounds::Rounds;

/// Where a round makes the mesh finer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Finer {
    /// Wherever the skin is pressed.
    Pressed,
    /// At the rim of that.
    Rim,
    /// Where it is touched away from all force.
    Elsewhere,
}

impl Rounds<'_> {
    /// Where the next round is to make the mesh finer: all that is pressed, until the force is known well enough, then its rim,
    /// and what is touched away from all force where force and area are as good as wanted.
    pub(super) fn next(&self) -> Finer {
        match &self.meshes.last {
            Some(_) if self.touches_elsewhere_alone => Finer::Elsewhere,
            Some((_, contact)) if contact.knows_force(self.target) => Finer::Rim,
            _ => Finer::Pressed,
        }
    }

    /// Vertices whose triangles are too large, by their numbers in the whole refined surface.
    pub(super) fn wanting(&self, finer: Finer) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.meshes.given.pressed() };
        let is_free = |&other: &u32| contact.node_force[other as usize] == 0.0;
        let at_rim = |&vertex: &usize| part.surface.neighbours(vertex).iter().any(is_free);
        match finer {
            Finer::Pressed => self.pressed(),
            Finer::Rim => {
                let rim = contact.pressed().into_iter().filter(at_rim);
                rim.map(|vertex| part.number(vertex)).collect()
            }
            Finer::Elsewhere => part.numbers(&contact.clues.unfelt),
        }
    }

    /// Vertices under force, by their numbers in the whole refined surface, ascending.
    fn pressed(&self) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.meshes.given.pressed() };
        contact.pressed().into_iter().map(|vertex| part.number(vertex)).collect()
    }

    /// Triangles to cut.
    pub(super) fn marked(&self, wanting: &[usize], finer: Finer) -> Result<Vec<bool>, ContactError> {
        let mut marked = loaded(&self.meshes.mesh, wanting);
        if finer == Finer::Rim {
            // Only those that the rim runs through.
            let pressed = self.pressed();
            let is_under = |corner: &usize| pressed.binary_search(corner).is_ok();
            for (leaf, marked) in marked.iter_mut().enumerate() {
                *marked &= !self.meshes.mesh.corners(leaf).iter().all(is_under);
            }
        }
        self.between.iter().for_each(|&leaf| marked[leaf] = true);
        if self.meshes.last.is_none() {
            let given = &self.meshes.given;
            let between = pressed_between(&self.meshes.mesh, &given.gap, &given.obstacle, &marked)?;
            between.into_iter().for_each(|leaf| marked[leaf] = true);
        }
        Ok(marked)
    }
}
