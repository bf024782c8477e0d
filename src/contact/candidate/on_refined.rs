//! The fingers of a refined mesh: those of the given one, and others that touch on the refined mesh alone.

use crate::contact::candidate::fingers::Fingers;
use crate::contact::outcome::Contact;
use crate::mesh::distinct::distinct;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// What is known of fingers on the given mesh. A refined part of it is too small to look for ways along the skin.
#[derive(Debug, Clone)]
pub(crate) struct KnownFingers {
    surface: Surface,
    /// Of its undeformed vertices (m).
    gap: Vec<f64>,
    /// Whether a kernel answers at each of them.
    is_under_kernel: Vec<bool>,
    fingers: Fingers,
    /// The given vertex nearest to each vertex of the part.
    nearest: Vec<usize>,
}

impl KnownFingers {
    /// * `given`: the contact on the given mesh
    /// * `skin`: of that mesh
    pub fn of(given: &Contact, skin: &dyn ElasticSkin, part: &RefinedSurface) -> Self {
        let surface = given.surface().clone();
        let is_under_kernel = |vertex| skin.kernel_at(vertex).is_some();
        Self {
            is_under_kernel: (0..surface.vertices().len()).map(is_under_kernel).collect(),
            surface,
            gap: given.gap.clone(),
            fingers: given.drawing.fingers.clone(),
            nearest: part.nearest_given(),
        }
    }

    /// The finger of a vertex of the part; `None` where the skin leads to none.
    pub fn finger_of(&self, vertex: usize) -> Option<usize> {
        self.fingers.finger_of(self.nearest[vertex])
    }

    /// The fingers of candidates on the part.
    ///
    /// A patch beside no candidate of the given mesh may be a finger that touches for the first time: all of them are split
    /// anew.
    ///
    /// * `candidates`: ascending
    pub fn among(&self, part: &Surface, candidates: &[usize]) -> Fingers {
        let given = |vertex: &usize| self.nearest[*vertex];
        let is_new = |patch: &Vec<usize>| !patch.iter().any(|vertex| self.fingers.has(given(vertex)));
        let new = part.patches(candidates).into_iter().filter(is_new).flatten();
        let mut all: Vec<usize> = new.map(|vertex| given(&vertex)).collect();
        if all.is_empty() {
            return self.fingers.on_refined(part, candidates, &self.nearest);
        }
        all.extend(self.fingers.candidates.iter().flatten());
        let all = distinct(all);
        let is_under_kernel = |vertex: usize| self.is_under_kernel[vertex];
        let fingers = Fingers::split_by_tissue(&self.surface, &all, &self.gap, is_under_kernel);
        fingers.on_refined(part, candidates, &self.nearest)
    }
}
