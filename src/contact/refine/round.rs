//! What a contact says of the mesh that it was solved on, and what it notes of a round of refinement.

use std::time::Instant;

use crate::contact::equilibrium::product::errors_of_area_and_peak;
use crate::contact::outcome::{Clues, Contact, ContactStatus, Refinement};
use crate::contact::refine::estimate::ErrorEstimate;
use crate::contact::refine::tissue::Tissue;
use crate::response::kernel::basis::Discretization;

/// Penetration left on a mesh that is fine enough, as a share of that before.
pub(crate) const SMALL_PENETRATION: f64 = 0.02;
/// Share of the target below which the force needs no finer mesh: it may change a little with the rim.
const SMALL_SHARE: f64 = 0.95;

impl Contact {
    /// Vertices under force, and those that penetrate where averages over their triangles feel nothing of it, ascending.
    pub(crate) fn pressed(&self) -> Vec<usize> {
        let mut pressed = [&self.active[..], &self.clues.unfelt].concat();
        pressed.sort_unstable();
        pressed
    }

    /// Whether the mesh costs so little of the force that more of it is for the area alone.
    pub(crate) fn knows_force(&self, target: f64) -> bool {
        self.accuracy.mesh_error.is_some_and(|error| error < SMALL_SHARE * target)
    }

    /// Whether the mesh is so fine that between its vertices next to no penetration is left; more may stay on sharp edges
    /// and, beside what carries force, in Galerkin form.
    pub(crate) fn is_free_of_penetration(&self) -> bool {
        self.clues.edge.is_some()
            || self.accuracy.discretization == Discretization::Galerkin && self.clues.unfelt.is_empty()
            || self.max_penetration_after <= SMALL_PENETRATION * self.max_penetration_before
    }

    /// What the mesh is estimated to cost after `previous`; `None` without contact.
    ///
    /// * `is_for_area`: whether the rim alone was refined since
    pub(crate) fn error_after(&self, previous: &Contact, is_for_area: bool) -> Option<ErrorEstimate> {
        if self.status != ContactStatus::Solved {
            return None;
        }
        if previous.status != ContactStatus::Solved {
            return Some(ErrorEstimate::of_cells(self, Tissue::default()));
        }
        let mut error = ErrorEstimate::of_rounds(previous, self);
        if is_for_area {
            // Nothing but the rim was refined.
            let known = &previous.accuracy;
            error.force = error.force.max(known.mesh_error.unwrap_or(0.0));
            error.pressure = error.pressure.max(known.max_pressure_error.unwrap_or(0.0));
        }
        Some(error)
    }

    /// Adds what this round found.
    pub(crate) fn note_round(&mut self, error: Option<ErrorEstimate>, started: Instant) {
        let doubts = [self.clues.body, self.clues.product].into_iter().flatten();
        let body = doubts.map(|doubt| doubt.force_error).sum();
        self.accuracy.mesh_error = error.map(|error| error.force);
        self.accuracy.body_error = error.map(|_| body);
        self.accuracy.force_error = error.map(|error| error.force + body);
        self.accuracy.area_error = error.map(|error| error.area);
        let Clues { edge, skin_edge, ends_at_edges, at_cuts, .. } = &self.clues;
        let is_infinite = edge.is_some() || skin_edge.is_some() || *ends_at_edges > 0.0 || *at_cuts > 0.0;
        self.accuracy.max_pressure_error =
            error.map(|error| if is_infinite { f64::INFINITY } else { error.pressure });
        self.refinements.push(Refinement {
            kind: "mesh",
            nodes: self.candidates.len(),
            force: self.resultant.force,
            contact_area: Some(self.resultant.contact_area),
            max_pressure: Some(self.resultant.max_pressure),
            force_error: self.accuracy.force_error,
            area_error: self.accuracy.area_error,
            max_penetration: self.max_penetration_after,
            seconds: started.elapsed().as_secs_f64(),
            reason: "",
        });
    }

    /// Says why no further round followed.
    pub(crate) fn concluded(mut self, reason: &'static str) -> Self {
        if self.status == ContactStatus::NoContact {
            self.leave_out("estimates of error", "there is no contact");
        }
        self.refinements.last_mut().expect("a round was noted").reason = reason;
        // No round makes this less.
        if let Some(doubt) = self.clues.product {
            let [of_area, of_peak] = errors_of_area_and_peak(&doubt);
            self.accuracy.area_error = self.accuracy.area_error.map(|error| error + of_area);
            self.accuracy.max_pressure_error = self.accuracy.max_pressure_error.map(|error| error + of_peak);
        }
        self
    }
}
