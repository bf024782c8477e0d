//! What mesh and body cost the figures of a contact: estimates, no bounds.

use std::f64::consts::PI;

use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::area::cells::{mean_bulge, mean_edge};
use crate::contact::figures::penetration::receding::Receding;
use crate::contact::outcome::{Contact, RefinementKind};
use crate::contact::refine::mesh_errors::{MeshErrors, SLOWEST_CHANGE, Settling};
use crate::contact::refine::tissue::Tissue;
use crate::response::kernel::basis::Discretization;

/// Relative errors of force, area and peak pressure: that of the force over the length of its resultant.
///
/// What cells and shapes cost each patch is a share of what the patch carries, of which a resultant is the less the more its
/// forces, or the patches, balance each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ErrorEstimate {
    pub force: f64,
    pub area: f64,
    pub pressure: f64,
}

/// Errors of force and area under a sharp edge with one cell a radius, as shares of what is right, and the powers of the number
/// of cells that they fall with: fitted to contacts of fingers with products, and to a ball on an edge of 90 degrees.
const ON_EDGE: [(f64, f64); 2] = [(6.0, 3.0), (200.0, 5.0)];
/// What thin tissue adds to the error of force, in those of a half-space, and the square of the contact's radius in thicknesses
/// that adds half of it: there the force goes with the cube of the area, not with the power 1.5 (Johnson 1985, §5.8).
const ON_BONE: (f64, f64) = (2.0, 1.0);
/// What a sharp edge of the skin adds to the errors of force and area, over the share of the force at the vertices on it: fitted
/// to contacts at the cut end of a finger.
const ON_SKIN_EDGE: f64 = 0.1;
/// What skin that ends under force adds to the errors of force and area, over the share of the force at its end, with one cell
/// a radius; it falls with the number of cells. Its outermost hats reach half a cell beyond: fitted to contacts at masks and
/// borders.
const AT_CUTS: [f64; 2] = [0.7, 2.0];
/// Cells around a vertex and its neighbours, by which the deepest penetration between them is felt.
const AROUND_DEEPEST: f64 = 10.0;
/// How much later averages over flat triangles touch than these stand off the smooth surface in the mean, on meshes of all shapes.
const LATER: f64 = 1.25;
/// Power of the depth that the force on a sphere goes with.
pub(super) const BY_DEPTH: f64 = 1.5;
/// Share of the skin under force that touches at the least, where hollows are too fine for its triangles.
const LEAST_TOUCHED: f64 = 0.1;
/// What a round keeps at the least on a sharp edge, where figures settle with the first power of the cells' size or slower, as the
/// last rounds show: fitted to fingers on ridges, rims and thin plates.
pub(super) const KEPT_ON_EDGE: f64 = 0.55;
const ON_EDGE_ROUND: Settling = Settling { next: KEPT_ON_EDGE, least: 0.2 };
/// The same where all force is on the edge, as under a blade thinner than the cells: figures go with the logarithm of their size.
const ON_LINE_ROUND: Settling = Settling { next: SLOWEST_CHANGE, ..ON_EDGE_ROUND };
/// Share of the force on an edge from which that is all.
const ON_LINE: f64 = 0.95;

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
            MeshErrors::of(discretization).of_cells.map(|(factor, power)| factor / cells.powf(power));
        let steeper = tissue.thickness.map_or(1.0, |thickness| {
            let radii = (cells * mean_edge(contact.surface(), &contact.active) / thickness).powi(2);
            1.0 + ON_BONE.0 * radii / (ON_BONE.1 + radii)
        });
        let (force, pressure) = (steeper * force + tissue.lost, pressure + tissue.lost);
        if contact.clues.edge.is_some() {
            // Always too high, of which no more than all is wrong.
            let [force, area] = [(ON_EDGE[0], steeper), (ON_EDGE[1], 1.0)]
                .map(|((factor, power), more)| more * factor / (more * factor + cells.powf(power)));
            let force = force / contact.unbalanced();
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
                (late(LATER * mean_bulge(contact.surface(), &contact.active).abs()), |a, b| a + b)
            }
        };
        // The powers that figures go with the depth of a sphere.
        let [force, area, pressure] = [(force, BY_DEPTH * steeper), (area, 1.0), (pressure, 0.5)]
            .map(|(of_cells, power)| add(of_cells, power * late));
        Self { force: force / contact.unbalanced(), area, pressure }.with_shapes(contact).with_cuts(contact)
    }

    /// From the last two rounds; on a sharp edge from the last three.
    pub fn of_rounds(before: &Contact, last: &Contact) -> Self {
        let earlier =
            before.refinements.iter().filter(|round| round.kind == RefinementKind::Mesh).nth_back(1);
        let earlier = earlier.filter(|_| last.clues.edge.is_some());
        let [of_force, of_area, of_peak] = match &last.clues.edge {
            Some(edge) if edge.share > ON_LINE => [ON_LINE_ROUND; 3],
            Some(_) => [ON_EDGE_ROUND; 3],
            None => MeshErrors::of(last.accuracy.discretization).settling,
        };
        let (known, a, b) = (&before.accuracy, &before.resultant, &last.resultant);
        let (force, area, pressure) = (
            earlier.map(|round| round.force),
            earlier.and_then(|round| round.contact_area),
            earlier.and_then(|round| round.max_pressure),
        );
        let within_rim = |contact: &Contact| contact.clues.area_within_rim;
        let mut of_force = of_force.left(known.mesh_error, force, a.force, b.force);
        if last.clues.edge.is_some() && of_force.is_finite() {
            // Forces fall from round to round there, by factors: what is left to fall is no more than all of it.
            let share = last.unbalanced();
            of_force = -f64::exp_m1(-share * of_force) / share;
        }
        let settling = Self {
            force: of_force,
            area: of_area.left(known.area_error, area, within_rim(before), within_rim(last)),
            pressure: of_peak.left(known.max_pressure_error, pressure, a.max_pressure, b.max_pressure),
        };
        settling.with_shapes(last)
    }

    /// With what the shapes add that no number of cells tells: sharp edges of the skin and at the rim, whose shares go on falling
    /// with the cells, hollows of the obstacle between vertices, where what counts as touched is not, and bumps there.
    fn with_shapes(self, contact: &Contact) -> Self {
        let of_skin = contact.clues.skin_edge.as_ref().map_or(0.0, |edge| ON_SKIN_EDGE * edge.share);
        let at_rim = MeshErrors::of(contact.accuracy.discretization).on_rim * contact.clues.ends_at_edges;
        let Receding { share, height, pressure } = contact.clues.receding;
        let at_bumps = (pressure / contact.resultant.max_pressure - 1.0).max(0.0);
        // As if all of the obstacle were that much farther away.
        let late = BY_DEPTH * height / contact.max_penetration_before;
        Self {
            force: self.force + (of_skin + at_rim + late) / contact.unbalanced(),
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
        Self { force: self.force + force / contact.unbalanced(), area: self.area + area, ..self }
    }

    /// From the estimate for another contact.
    ///
    /// * `coarser`: cells a radius of that contact, over those of this one; what has more cells costs no less
    /// * `at_rim`: the same of the cells at the rim alone, which the area hangs on
    pub fn carried_over(known: &Accuracy, coarser: f64, at_rim: f64) -> Option<Self> {
        let [force, area, pressure] = MeshErrors::of(known.discretization).of_cells.map(|(_, power)| power);
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
        let [(_, force), (_, area), _] = MeshErrors::of(known.discretization).of_cells;
        let room = |error: f64, power: f64| (target / error).powf(1.0 / power);
        Some([room(contact.unbalanced() * known.mesh_error?, force), room(known.area_error?, area)])
    }
}
