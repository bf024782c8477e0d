//! Where the mesh of the last round is to be finer.

use crate::contact::error::ContactError;
use crate::contact::refine::mark::{loaded, pressed_between};
use crate::contact::refine::rounds::Rounds;

impl Rounds<'_> {
    /// Vertices whose triangles are too large, by their numbers in the whole refined surface: all that are pressed, those at the
    /// rim where the force is known well enough and the area is not, or those away from all force where both are.
    pub(super) fn wanting(&self, is_for_area: bool) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.meshes.given.pressed() };
        if self.touches_elsewhere_alone {
            return part.numbers(&contact.clues.unfelt);
        }
        if !is_for_area {
            return self.pressed();
        }
        let is_free = |&other: &u32| contact.node_force[other as usize] == 0.0;
        let at_rim = |&vertex: &usize| part.surface.neighbours(vertex).iter().any(is_free);
        contact.pressed().into_iter().filter(at_rim).map(|vertex| part.number(vertex)).collect()
    }

    /// Vertices under force, by their numbers in the whole refined surface, ascending.
    fn pressed(&self) -> Vec<usize> {
        let Some((part, contact)) = &self.meshes.last else { return self.meshes.given.pressed() };
        contact.pressed().into_iter().map(|vertex| part.number(vertex)).collect()
    }

    /// Triangles to cut.
    pub(super) fn marked(&self, wanting: &[usize], is_for_area: bool) -> Result<Vec<bool>, ContactError> {
        let mut marked = loaded(&self.meshes.mesh, wanting);
        if is_for_area && !self.touches_elsewhere_alone {
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
