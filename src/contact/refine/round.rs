//! What a contact says of the mesh that it was solved on, and what it notes of a round of refinement.

use std::time::Instant;

use crate::contact::clues::Clues;
use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::penetration::after::SMALL_PENETRATION;
use crate::contact::outcome::{Contact, ContactStatus, Patch, Refinement, RefinementEnd, RefinementKind};
use crate::contact::refine::estimate::{BY_DEPTH, ErrorEstimate, KEPT_ON_EDGE};
use crate::contact::refine::mesh_errors::MeshErrors;
use crate::contact::refine::product::errors_of_area_and_peak;
use crate::contact::refine::tissue::Tissue;
use crate::contact::refine::wanting::Finer;
use crate::contact::report::warnings::MOST_APART;
use crate::response::kernel::basis::Discretization;

/// What the area errs over what the force does, where that is for the body's mesh: fitted to two levels against one on a finger.
/// The peak errs as much as the force.
const AREA_PER_BODY: f64 = 0.6;
/// What the figures err per share of the depth that the force acts off the obstacle, against settled gaps: fitted to balls of
/// skin on rounded holes.
const PER_SHARE_APART: f64 = 50.0;
/// Resultant of a pressure that is even over a hemisphere, over the sum of its forces.
const LEFT_OF_HEMISPHERE: f64 = 0.5;

impl Contact {
    /// Vertices under force, and those that penetrate where averages over their triangles feel nothing of it, ascending.
    pub(crate) fn pressed(&self) -> Vec<usize> {
        let mut pressed = [&self.active[..], &self.clues.unfelt].concat();
        pressed.sort_unstable();
        pressed
    }

    /// Whether the mesh costs so little of the force that a finer rim is enough.
    pub(crate) fn knows_force(&self, target: f64) -> bool {
        let [of_force, _] = MeshErrors::of(self.accuracy.discretization).left_by_rim;
        self.accuracy.mesh_error.is_some_and(|error| of_force * error < target)
    }

    /// Whether the mesh is so fine that between its vertices next to no penetration is left; more may stay on sharp edges
    /// and, beside what carries force, in Galerkin form.
    pub(crate) fn is_free_of_penetration(&self) -> bool {
        self.clues.edge.is_some()
            || self.accuracy.discretization == Discretization::Galerkin && self.clues.unfelt.is_empty()
            || self.max_penetration_after <= SMALL_PENETRATION * self.max_penetration_before
    }

    /// Whether the force acts so far off the obstacle that the gaps did not settle.
    pub(crate) fn is_apart(&self) -> bool {
        self.clues.apart > MOST_APART
    }

    /// What the mesh is estimated to cost after `previous`; `None` without contact.
    ///
    /// * `finer`: where the mesh was made finer since
    pub(crate) fn error_after(&self, previous: &Contact, finer: Finer) -> Option<ErrorEstimate> {
        if self.status != ContactStatus::Solved {
            return None;
        }
        if previous.status != ContactStatus::Solved {
            return Some(ErrorEstimate::of_cells(self, Tissue::default()));
        }
        let error = ErrorEstimate::of_rounds(previous, self);
        let [of_force, of_area] = match finer {
            Finer::Pressed => return Some(error),
            Finer::Larger { share } => [1.0 - (1.0 - KEPT_ON_EDGE) * share; 2],
            Finer::Rim => MeshErrors::of(self.accuracy.discretization).left_by_rim,
            Finer::Elsewhere => [1.0; 2],
        };
        let left = |share: f64, known: Option<f64>| share * known.unwrap_or(0.0);
        let known = &previous.accuracy;
        Some(ErrorEstimate {
            force: error.force.max(left(of_force, known.mesh_error)),
            area: error.area.max(left(of_area, known.area_error)),
            pressure: error.pressure.max(left(1.0, known.max_pressure_error)),
        })
    }

    /// Adds what this round found.
    pub(crate) fn note_round(&mut self, error: Option<ErrorEstimate>, started: Instant) {
        let doubts = [self.clues.body, self.clues.product].into_iter().flatten();
        // A sum of none would be -0.
        let body =
            doubts.map(|doubt| doubt.force_error).fold(0.0, |sum, error| sum + error) / self.unbalanced();
        self.accuracy.mesh_error = error.map(|error| error.force);
        self.accuracy.body_error = error.map(|_| body);
        self.accuracy.force_error = error.map(|error| error.force + body);
        self.accuracy.area_error = error.map(|error| error.area);
        let Clues { edge, skin_edge, ends_at_edges, at_cuts, .. } = &self.clues;
        let is_infinite = edge.is_some() || skin_edge.is_some() || *ends_at_edges > 0.0 || *at_cuts > 0.0;
        self.accuracy.max_pressure_error =
            error.map(|error| if is_infinite { f64::INFINITY } else { error.pressure });
        self.refinements.push(Refinement {
            kind: RefinementKind::Mesh,
            nodes: self.candidates.len(),
            force: self.resultant.force,
            contact_area: Some(self.resultant.contact_area),
            max_pressure: Some(self.resultant.max_pressure),
            force_error: self.accuracy.force_error,
            area_error: self.accuracy.area_error,
            max_penetration: self.max_penetration_after,
            seconds: started.elapsed().as_secs_f64(),
            end: None,
        });
    }

    /// What the mesh costs, to be held against a target: the larger of the error of the area, over the area, and that of the
    /// force, over what the patches carry, each by itself. In a grasp or a ring forces balance each other, and next to nothing is
    /// left in all that an error could be a share of.
    pub(crate) fn mesh_share(&self) -> Option<f64> {
        let Accuracy { mesh_error, area_error, .. } = self.accuracy;
        Some((mesh_error? * self.unbalanced()).max(area_error?))
    }

    /// Share of what the patches carry, each by itself, that is left in all. What the forces of one patch carry is no less than a
    /// hemisphere under even pressure has left of them: beyond that, as in a ring, they balance each other too.
    pub(crate) fn unbalanced(&self) -> f64 {
        let carried = |patch: &Patch| {
            let sum: f64 = patch.vertices.iter().map(|&vertex| self.node_force[vertex]).sum();
            patch.resultant.force.norm().max(LEFT_OF_HEMISPHERE * sum)
        };
        let carried: f64 = self.patches.iter().map(carried).sum();
        if carried > 0.0 { self.resultant.force.norm() / carried } else { 1.0 }
    }

    /// Says why no further round followed.
    ///
    /// * `shapes`: [`errors_of_peak`](Self::errors_of_peak)
    pub(crate) fn concluded(mut self, end: RefinementEnd, shapes: [f64; 2]) -> Self {
        if self.status == ContactStatus::NoContact {
            self.leave_out("estimates of error", "there is no contact");
        }
        self.refinements.last_mut().expect("a round was noted").end = Some(end);
        // No round makes these less. The estimate of a mesh that was taken as it is knows of penetration.
        let [area, peak] = errors_of_area_and_peak(&self);
        let body = self.clues.body.map_or(0.0, |doubt| doubt.force_error);
        let (of_area, of_peak) = (area + AREA_PER_BODY * body, peak + body);
        let is_told = end == RefinementEnd::NoTarget || self.is_free_of_penetration();
        let deepest = self.max_penetration_after / self.max_penetration_before;
        let [late, above] =
            if is_told { [0.0; 2] } else { [BY_DEPTH * self.clues.mean_penetration, deepest] };
        let apart = match end {
            RefinementEnd::ForceLost => f64::INFINITY,
            _ if self.is_apart() => PER_SHARE_APART * self.clues.apart,
            _ => 0.0,
        };
        let of_force = (apart + late) / self.unbalanced();
        let [at_facets, at_creases] = shapes;
        let Accuracy { force_error, mesh_error, area_error, max_pressure_error, .. } = &mut self.accuracy;
        *max_pressure_error = max_pressure_error.map(|error| error.max(at_creases));
        let more = [
            (force_error, of_force),
            (mesh_error, of_force),
            (area_error, apart + late + of_area),
            (max_pressure_error, apart + above + of_peak + at_facets),
        ];
        for (error, more) in more {
            *error = error.map(|error| error + more);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::contact::{ContactOptions, solve_contact};
    use crate::obstacle::posed::Obstacle;
    use crate::response::kernel::skin::{Kernel, KernelSkin};
    use crate::sample::grid;
    use crate::surface::checked::Surface;

    #[test]
    fn what_a_round_left_as_it_was_keeps_its_error() {
        let (vertices, faces) = grid(8, 8, 1e-3);
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        let ball = Obstacle::sphere(Vector3::new(4e-3, 4e-3, 0.0499), 0.05).expect("a sphere");
        let skin = KernelSkin::new(60e3, 0.45, Kernel::HalfSpace).expect("valid constants");
        let given = ContactOptions::on_given_mesh();
        let mut before = solve_contact(&surface, &ball, &skin, &given).expect("a valid request");
        let last = before.clone();
        before.accuracy.mesh_error = Some(0.2);
        before.accuracy.area_error = Some(0.3);
        let after = |finer: Finer| {
            let error = last.error_after(&before, finer).expect("a solved contact");
            [error.force, error.area]
        };
        assert_eq!(after(Finer::Elsewhere), [0.2, 0.3]);
        let larger = |share: f64| after(Finer::Larger { share });
        assert_eq!(larger(0.0), [0.2, 0.3]);
        assert!(larger(0.1)[0] > 0.18 && larger(0.1)[0] > larger(1.0)[0]);
        // Two rounds may agree by chance.
        let [force, area] = after(Finer::Pressed);
        assert!((force - 0.04).abs() < 1e-12 && (area - 0.06).abs() < 1e-12, "{force} {area}");
        let [of_force, of_area] = MeshErrors::of(Discretization::Collocation).left_by_rim;
        assert_eq!(after(Finer::Rim), [0.2 * of_force, 0.3 * of_area]);
    }
}
