//! What mesh and body cost the figures of a contact: estimates, no bounds.

use std::f64::consts::PI;
use std::ops::Sub;

use nalgebra::Vector3;

use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::cells::{mean_bulge, mean_edge};
use crate::contact::figures::receding::Receding;
use crate::contact::outcome::{Contact, RefinementKind};
use crate::contact::refine::tissue::Tissue;
use crate::response::kernel::basis::Discretization;

/// Relative errors of force, area and peak pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ErrorEstimate {
    pub force: f64,
    pub area: f64,
    pub pressure: f64,
}

/// Some two or three times the root mean square error of a smooth contact with one cell a radius, of force, area and peak, and
/// the power of the number of cells that it falls with (docs/accuracy.md).
const COLLOCATION: [(f64, f64); 3] = [(0.28, 2.0), (0.5, 1.5), (0.25, 2.0)];
/// The same in Galerkin form.
const GALERKIN: [(f64, f64); 3] = [(0.12, 3.0), (0.25, 1.5), (0.2, 2.0)];
/// The same of force and area under a sharp edge, as shares of what is right: nine of ten contacts of fingers with products have
/// less, on one to four cells, and a ball of 8 mm on an edge of 90 degrees.
const ON_EDGE: [(f64, f64); 2] = [(6.0, 3.0), (200.0, 5.0)];
/// What thin tissue adds to the error of force, in those of a half-space, and the square of the contact's radius in thicknesses
/// that adds half of it: there the force goes with the cube of the area, not with the power 1.5 (Johnson 1985, §5.8).
const ON_BONE: (f64, f64) = (2.0, 1.0);
/// What a sharp edge of the skin adds to the errors of force and area, over the share of the force at the vertices on it: nine
/// of ten contacts at the cut end of a finger have less, on one cell a radius and on twenty.
const ON_SKIN_EDGE: f64 = 0.1;
/// What the rim adds to the error of force in Galerkin form where it is a sharp edge of the obstacle, over the share of the area
/// there: flat punches of 3 to 20 cells a radius have 0.04 to 0.1, always too much force.
const ON_RIM: f64 = 0.08;
/// What skin that ends under force adds to the errors of force and area, over the share of the force at its end, with one cell
/// a radius; it falls with the number of cells. Its outermost hats reach half a cell beyond. Fitted: nine of ten forces and
/// eight of ten areas of 148 contacts at masks and borders have less.
const AT_CUTS: [f64; 2] = [0.7, 2.0];
/// Cells around a vertex and its neighbours, by which the deepest penetration between them is felt.
const AROUND_DEEPEST: f64 = 10.0;
/// Power of the depth that the force on a sphere goes with.
const BY_DEPTH: f64 = 1.5;
/// Share of the skin under force that touches at the least, where hollows are too fine for its triangles.
const LEAST_TOUCHED: f64 = 0.1;
/// How a figure settles from round to round.
#[derive(Debug, Clone, Copy)]
struct Settling {
    /// A round's change as a share of that before.
    next: f64,
    /// Least share of an estimate that a round leaves, as two rounds may agree by chance.
    least: f64,
}

/// Of force, area and peak. The force keeps a third on smooth skin and half on scanned fingers, whose curvature is rough; the
/// area two fifths there, with which nine of ten of their contacts are covered.
const COLLOCATION_ROUND: [Settling; 3] = [
    Settling { next: 3.0 / 7.0, least: 0.2 },
    Settling { next: 0.4, least: 0.2 },
    Settling { next: 3.0 / 7.0, least: 0.2 },
];
/// The same in Galerkin form, where the rim is felt from the triangles beside it, so that the area keeps half.
const GALERKIN_ROUND: [Settling; 3] =
    [COLLOCATION_ROUND[0], Settling { next: 0.5, least: 0.35 }, COLLOCATION_ROUND[2]];
/// What a round keeps at the least on a sharp edge, where figures settle with the first power of the cells' size or slower, as the
/// last rounds show. Of 78 contacts of fingers with ridges and 94 with rims and thin plates it covers 100 and 83 % of the forces,
/// 92 and 95 % of the areas.
pub(super) const KEPT_ON_EDGE: f64 = 0.65;
const ON_EDGE_ROUND: Settling = Settling { next: KEPT_ON_EDGE, least: 0.2 };
/// The largest that is taken from what they show.
const SLOWEST_CHANGE: f64 = 0.8;

/// What settles: a number, or a force with its direction.
trait Figure: Copy + Sub<Output = Self> {
    fn size(self) -> f64;
}

impl Figure for f64 {
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Figure for Vector3<f64> {
    fn size(self) -> f64 {
        self.norm()
    }
}

impl Settling {
    /// Error that a round leaves, over the figure.
    ///
    /// * `known`: what the round before was estimated to leave
    /// * `earlier`: two rounds before, where the change of that round counts too
    fn left<F: Figure>(self, known: Option<f64>, earlier: Option<F>, before: F, last: F) -> f64 {
        if last.size() == 0.0 {
            // Penetration without force: nothing is known.
            return f64::INFINITY;
        }
        // An infinite one was that of a sharp edge.
        let known = known.filter(|error| error.is_finite()).unwrap_or(0.0);
        let change = (last - before).size();
        let slowed = earlier.map_or(0.0, |earlier| change / (before - earlier).size());
        let next = slowed.clamp(self.next, SLOWEST_CHANGE);
        // All changes to come, each that share of the one before.
        (next / (1.0 - next) * change / last.size()).max(self.least * known)
    }
}

impl ErrorEstimate {
    /// Of the mesh as it is, from its cells and what the nodes do not feel.
    ///
    /// * `tissue`: under the forces
    pub fn of_cells(contact: &Contact, tissue: Tissue) -> Self {
        if contact.clues.is_between {
            // Corners of one triangle carry what is smaller than it: any error is possible.
            return Self { force: f64::INFINITY, area: f64::INFINITY, pressure: f64::INFINITY };
        }
        let Accuracy { cells_per_radius: cells, discretization, .. } = contact.accuracy;
        let [force, area, pressure] =
            powers(discretization).map(|(factor, power)| factor / cells.powf(power));
        let steeper = tissue.thickness.map_or(1.0, |thickness| {
            let radii = (cells * mean_edge(contact.surface(), &contact.active) / thickness).powi(2);
            1.0 + ON_BONE.0 * radii / (ON_BONE.1 + radii)
        });
        let (force, pressure) = (steeper * force + tissue.lost, pressure + tissue.lost);
        if contact.clues.edge.is_some() {
            // Always too high, of which no more than all is wrong.
            let [force, area] = [(ON_EDGE[0], steeper), (ON_EDGE[1], 1.0)]
                .map(|((factor, power), more)| more * factor / (more * factor + cells.powf(power)));
            return Self { force, area, pressure }.with_shapes(contact).with_cuts(contact);
        }
        let deepest = contact.max_penetration_before;
        let late = |unfelt: f64| unfelt / (deepest - unfelt).max(0.0);
        // Depth that the nodes do not feel. In collocation it lies between the vertices, for smooth contacts as much as the cells
        // say, and the deepest around a few cells of all. Averages over flat triangles touch later than the smooth surface does;
        // the cells are those of flat skin.
        let (late, add): (f64, fn(f64, f64) -> f64) = match discretization {
            Discretization::Collocation => {
                let share = (AROUND_DEEPEST / (PI * cells * cells)).min(1.0);
                (share * late(contact.max_penetration_after), f64::max)
            }
            Discretization::Galerkin => {
                (late(mean_bulge(contact.surface(), &contact.active).abs()), |a, b| a + b)
            }
        };
        // The powers that figures go with the depth of a sphere.
        let [force, area, pressure] = [(force, BY_DEPTH * steeper), (area, 1.0), (pressure, 0.5)]
            .map(|(of_cells, power)| add(of_cells, power * late));
        Self { force, area, pressure }.with_shapes(contact).with_cuts(contact)
    }

    /// From the last two rounds; on a sharp edge from the last three.
    pub fn of_rounds(before: &Contact, last: &Contact) -> Self {
        let earlier =
            before.refinements.iter().filter(|round| round.kind == RefinementKind::Mesh).nth_back(1);
        let earlier = earlier.filter(|_| last.clues.edge.is_some());
        let [of_force, of_area, of_peak] = match last.accuracy.discretization {
            _ if last.clues.edge.is_some() => [ON_EDGE_ROUND; 3],
            Discretization::Collocation => COLLOCATION_ROUND,
            Discretization::Galerkin => GALERKIN_ROUND,
        };
        let (known, a, b) = (&before.accuracy, &before.resultant, &last.resultant);
        let (force, area, pressure) = (
            earlier.map(|round| round.force),
            earlier.and_then(|round| round.contact_area),
            earlier.and_then(|round| round.max_pressure),
        );
        let within_rim = |contact: &Contact| contact.clues.area_within_rim;
        let settling = Self {
            force: of_force.left(known.mesh_error, force, a.force, b.force),
            area: of_area.left(known.area_error, area, within_rim(before), within_rim(last)),
            pressure: of_peak.left(known.max_pressure_error, pressure, a.max_pressure, b.max_pressure),
        };
        settling.with_shapes(last)
    }

    /// With what the shapes add that no number of cells tells: sharp edges of the skin and at the rim, whose shares go on falling
    /// with the cells, hollows of the obstacle between vertices, where what counts as touched is not, and bumps there.
    fn with_shapes(self, contact: &Contact) -> Self {
        let of_skin = contact.clues.skin_edge.as_ref().map_or(0.0, |edge| ON_SKIN_EDGE * edge.share);
        let at_rim = match contact.accuracy.discretization {
            Discretization::Collocation => 0.0,
            Discretization::Galerkin => ON_RIM * contact.clues.ends_at_edges,
        };
        let Receding { share, height, pressure } = contact.clues.receding;
        let at_bumps = (pressure / contact.resultant.max_pressure - 1.0).max(0.0);
        // As if all of the obstacle were that much farther away.
        let late = BY_DEPTH * height / contact.max_penetration_before;
        Self {
            force: self.force + of_skin + at_rim + late,
            area: self.area + of_skin + share,
            pressure: self.pressure + share / (1.0 - share).max(LEAST_TOUCHED) + at_bumps,
        }
    }

    /// With what the end of the skin adds where it is under force.
    fn with_cuts(self, contact: &Contact) -> Self {
        let share = contact.clues.at_cuts;
        if share == 0.0 {
            return self;
        }
        let [force, area] = AT_CUTS.map(|factor| factor * share / contact.accuracy.cells_per_radius);
        Self { force: self.force + force, area: self.area + area, ..self }
    }

    /// From the estimate for another contact.
    ///
    /// * `coarser`: cells a radius of that contact, over those of this one; what has more cells costs no less
    /// * `at_rim`: the same of the cells at the rim alone, which the area hangs on
    pub fn carried_over(known: &Accuracy, coarser: f64, at_rim: f64) -> Option<Self> {
        let [force, area, pressure] = powers(known.discretization).map(|(_, power)| power);
        let (coarser, at_rim) = (coarser.max(1.0), at_rim.max(1.0));
        Some(Self {
            force: known.mesh_error? * coarser.powf(force),
            area: known.area_error? * at_rim.powf(area),
            pressure: known.max_pressure_error? * coarser.powf(pressure),
        })
    }

    /// How many times coarser the cells may be until the force misses the target, and those at the rim until the area does.
    pub fn room(contact: &Contact, target: f64) -> Option<[f64; 2]> {
        let known = &contact.accuracy;
        let [(_, force), (_, area), _] = powers(known.discretization);
        let room = |error: f64, power: f64| (target / error).powf(1.0 / power);
        Some([room(contact.unbalanced() * known.mesh_error?, force), room(known.area_error?, area)])
    }
}

fn powers(discretization: Discretization) -> [(f64, f64); 3] {
    match discretization {
        Discretization::Collocation => COLLOCATION,
        Discretization::Galerkin => GALERKIN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_force_that_turns_has_not_settled() {
        let [of_force, ..] = COLLOCATION_ROUND;
        let turned = of_force.left(None, None, Vector3::x(), Vector3::y());
        // Each change is three sevenths of the one before: all to come are three quarters of the last, √2 long.
        assert!((turned - 0.75 * f64::sqrt(2.0)).abs() < 1e-12, "{turned}");
        assert_eq!(of_force.left(None, None, Vector3::x(), Vector3::x()), 0.0);
        assert_eq!(of_force.left(None, None, Vector3::x(), Vector3::zeros()), f64::INFINITY);
    }
}
