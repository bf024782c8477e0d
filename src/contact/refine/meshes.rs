//! The meshes that a contact was solved on: the given one, and the finest around it so far.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use crate::contact::candidate::on_refined::KnownFingers;
use crate::contact::cuts::Cuts;
use crate::contact::error::ContactError;
use crate::contact::figures::loaded::LoadedVertex;
use crate::contact::gap::initial::search_distance_in_overlap;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd};
use crate::contact::refine::estimate::ErrorEstimate;
use crate::contact::refine::mark::touched_between;
use crate::contact::refine::whole::into_whole;
use crate::contact::scene::Inherited;
use crate::response::skin::elastic::{ElasticSkin, shear_modulus_under};
use crate::surface::refined::{MeshRefinement, RefinedSurface};

/// A contact with a radius so many times that of another, or as many times smaller, wants a mesh of its own.
const ANOTHER_SIZE: f64 = 1.5;

/// A contact on the given mesh, and on the finest one so far.
#[derive(Clone)]
pub(crate) struct Meshes {
    /// On the given mesh.
    pub given: Contact,
    pub mesh: MeshRefinement,
    /// On the part of it around the contact; `None` where nothing was refined yet.
    pub last: Option<(RefinedSurface, Contact)>,
}

/// Whether a contact of one area (m²) wants another mesh than one of another.
pub(crate) fn is_of_another_size(area: f64, other: f64) -> bool {
    let ratio = (area / other).sqrt();
    !(1.0 / ANOTHER_SIZE..=ANOTHER_SIZE).contains(&ratio)
}

impl Meshes {
    /// Vertices of a finer part that are expected to carry force: those that do, those between two of them, and those
    /// beside one that the rim lies farther out of than half-way to its neighbours.
    pub fn expected(&self, part: &RefinedSurface) -> Vec<usize> {
        let given_count = self.given.surface().vertices().len();
        let (surface, contact, known) = match &self.last {
            None => (self.given.surface(), &self.given, given_count),
            Some((last, contact)) => (&last.surface, contact, given_count + last.parents().len()),
        };
        let number = |vertex| self.last.as_ref().map_or(vertex, |(last, _)| last.number(vertex));
        let is_far_in = |one: &LoadedVertex| one.contact_area > surface.vertex_areas()[one.vertex];
        let loaded: HashMap<usize, bool> =
            contact.loaded.list.iter().map(|one| (number(one.vertex), is_far_in(one))).collect();
        // `None` without force, else whether the rim is far.
        let mut found: Vec<Option<bool>> = Vec::with_capacity(part.surface.vertices().len());
        for vertex in 0..part.surface.vertices().len() {
            let number = part.number(vertex);
            found.push(if number < known {
                loaded.get(&number).copied()
            } else {
                let ends = part.parents()[vertex - part.given_vertices().len()].map(|end| found[end]);
                let is_loaded = ends.contains(&Some(true)) || !ends.contains(&None);
                is_loaded.then_some(false)
            });
        }
        (0..found.len()).filter(|&vertex| found[vertex].is_some()).collect()
    }

    /// What a refined part takes over from the given mesh.
    pub fn inherited_by(&self, part: &RefinedSurface, skin: &dyn ElasticSkin) -> Arc<Inherited> {
        Arc::new(Inherited {
            fingers: KnownFingers::of(&self.given, skin, part),
            cuts: Cuts::on_refined(self.given.surface(), skin, part),
            search_distance: search_distance_in_overlap(self.given.surface()),
        })
    }

    /// Puts a contact at another depth in the place of the last one, on the same mesh.
    ///
    /// * `skin`: of that mesh
    pub fn replace_last(
        &mut self,
        mut contact: Contact,
        started: Instant,
        skin: &dyn ElasticSkin,
        options: &ContactOptions,
    ) -> Result<(), ContactError> {
        let Some((part, last)) = &mut self.last else { return Ok(()) };
        let mut known = std::mem::take(&mut last.refinements);
        known.pop();
        known.append(&mut contact.refinements);
        contact.refinements = known;
        let error = match contact.status {
            ContactStatus::Solved => {
                let between = touched_between(&self.mesh, Some(part), &contact, skin, options)?;
                contact.clues.touched_between = between.len();
                let coarser = last.accuracy.cells_per_radius / contact.accuracy.cells_per_radius;
                ErrorEstimate::carried_over(&last.accuracy, coarser, coarser)
            }
            _ => None,
        };
        contact.note_round(error, started);
        *last = contact;
        Ok(())
    }

    /// The contact on the finest mesh so far.
    pub fn finest(&self) -> &Contact {
        self.last.as_ref().map_or(&self.given, |(_, contact)| contact)
    }

    /// The contact that a search found on the mesh refined last, where it asks for one of its own.
    ///
    /// * `target`: of the relative error where that mesh met it
    /// * `refined_for`: area of the contact that the mesh was made for (m²)
    /// * `has_gone_farther`: whether the obstacle has left that contact behind
    pub fn outgrown(
        &self,
        target: Option<f64>,
        refined_for: f64,
        has_gone_farther: impl FnOnce(&Contact) -> bool,
    ) -> Option<&Contact> {
        // Without figures (an overlap whose contact did not end solved) there is no error to mend.
        let (_, found) = self.last.as_ref()?;
        let error = found.mesh_share()?;
        let is_too_coarse = |target| error > target || found.clues.touched_between > 0;
        let is_to_mend = target.is_some_and(|target| is_too_coarse(target) || has_gone_farther(found));
        (is_to_mend || is_of_another_size(found.resultant.contact_area, refined_for)).then_some(found)
    }

    /// The last contact in the numbers of the whole skin, with why no further round followed.
    ///
    /// * `target`: of the relative error
    /// * `skin`: of the given surface
    pub fn conclude(
        self,
        end: RefinementEnd,
        target: f64,
        skin: &dyn ElasticSkin,
    ) -> Result<Contact, ContactError> {
        let modulus = shear_modulus_under(skin, self.given.candidates.iter().copied());
        let shapes = self.finest().errors_of_peak(modulus);
        let mut contact = match self.last {
            None => self.given,
            Some((part, contact)) => into_whole(self.given, contact, &part, self.mesh)?,
        };
        contact.warn_of_refinement(end, target);
        contact.warn_of_penetration_left();
        Ok(contact.concluded(end, shapes))
    }
}
