//! What the user should know of a contact, in sentences.

use nalgebra::Vector3;

use crate::contact::clues::LoadedEdge;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::steep::{MOST_STEEP, PULLING_COSINE, steep_share};
use crate::contact::error::ContactError;
use crate::contact::figures::penetration::after::{Penetration, SMALL_PENETRATION};
use crate::contact::first_touch::touch_rounding;
use crate::contact::gap::initial::Gaps;
use crate::contact::outcome::{Contact, RefinementEnd};
use crate::contact::refine::product::errors_of_area_and_peak;
use crate::contact::report::digits::Digits;
use crate::contact::report::record::Report;
use crate::contact::report::warning::WarningKind;
use crate::geometry::solid_angle::winding_number;
use crate::response::kernel::basis::Discretization;
use crate::surface::checked::Surface;

/// Penetration left at the deformed skin, as a share of that before, from which the user is warned.
const UNRESOLVED_SHARE: f64 = 0.05;
/// How far off the obstacle the force may act in the mean, as a share of the penetration before: contacts that settled are below a
/// tenth of it.
pub(crate) const MOST_APART: f64 = 5e-3;
/// Penetration over the mean edge of the skin up to which they touch.
const TOUCHING_PENETRATION: f64 = 1e-6;

/// Why it is left between vertices.
const COARSE_MESH: &str = "it does between vertices, so the mesh there is coarser than the obstacle's features; refine it (`target_error`, `max_nodes`), and do not trust force and area there";

/// The same beside a sharp edge, whose figures tell what the mesh costs them.
const BESIDE_EDGE: &str = "it does between the vertices beside a sharp edge; refine the mesh there (`target_error`, `max_nodes`) where that matters";

/// The same of averaged gaps, whose estimates of error hold nevertheless.
const BETWEEN_AVERAGES: &str = "averages over triangles leave it beside what carries force; refine the mesh there (`target_error`, `max_nodes`), or take gaps at the nodes (collocation), where that matters";

/// Share of the coarse edges that the square of the error asks for, so that those made of it meet the target: they come out
/// longer than asked for by up to a fifth.
const EDGE_MARGIN: f64 = 0.8;

impl Report {
    /// Warns where skin went through a wall.
    pub fn warn_of_walls(&mut self, gaps: &Gaps) {
        let went_through = gaps.entry.through_walls;
        if went_through > 0 {
            let of_way = match gaps.scene.press {
                Some(_) => "",
                None => {
                    "; in overlap that is the inward normal of the skin, and beside the rim of a wall it may have been another: `press` knows the way, the estimates of error do not"
                }
            };
            let message = format!(
                "{went_through} vertices went through a wall thinner than twice their depth: their gaps are measured back the way they came, to where they met it, as gaps along the closest normal would push them out at its sides{of_way}"
            );
            self.warn(WarningKind::Penetration, message);
        }
    }

    /// Warns of an obstacle so deep (m) in the skin between vertices, none of which meets it.
    pub fn warn_of_unmet(&mut self, surface: &Surface, depth: f64) {
        if depth > TOUCHING_PENETRATION * surface.mean_edge_length() {
            let message = format!(
                "skin and obstacle stand {depth:.3e} m in one another between the vertices of the skin, none of which is in the obstacle: no force is not the answer here; refine the skin there, or press deeper"
            );
            self.warn(WarningKind::Penetration, message);
        }
    }

    /// Warns of an obstacle that lies inside the skin, with no vertex of the skin in it.
    ///
    /// Skin that is open has no inside; behind its nearest vertex counts as such.
    pub fn warn_of_swallowed(&mut self, gaps: &Gaps) -> Result<(), ContactError> {
        let (surface, obstacle) = (gaps.surface, &gaps.scene.obstacle);
        if obstacle.bounding_box().is_none() {
            return Ok(());
        }
        let nearest = {
            let distances = gaps.undeformed();
            let order = |&a: &usize, &b: &usize| distances[a].total_cmp(&distances[b]);
            (0..distances.len()).min_by(order).expect("a surface has vertices")
        };
        let measured = gaps.at(&[nearest])?;
        // Where it touches, the point is on the skin.
        if measured.distance[0] <= touch_rounding(surface) {
            return Ok(());
        }
        let inwards = measured.distance[0] * measured.normal[0];
        let is_inside = if surface.is_closed() {
            let on_obstacle = surface.vertices()[nearest] - inwards;
            winding_number(&on_obstacle, surface.vertices(), surface.faces().iter().copied()) > 0.5
        } else {
            inwards.dot(&surface.vertex_normals()[nearest]) > 0.0
        };
        if is_inside {
            let message = "the obstacle lies inside the skin and no vertex of the skin in it: nothing is pressed; check its place and unit, or press it on from outside";
            self.warn(WarningKind::Penetration, message.to_string());
        }
        Ok(())
    }

    /// Warns of vertices under force that the obstacle's normal pulls outward.
    pub fn warn_of_pull(&mut self, gaps: &Gaps, forces: &NodeForces) {
        let outward = gaps.surface.vertex_normals();
        let is_pulled = |&&vertex: &&usize| {
            forces.vectors[vertex].dot(&outward[vertex]) > PULLING_COSINE * forces.vectors[vertex].norm()
        };
        let pulled = forces.active.iter().filter(is_pulled).count();
        if pulled > 0 {
            let why = match gaps.scene.press {
                Some(_) if pulled == forces.active.len() => {
                    "the skin is pressed from behind: turn the direction, or the faces of the skin, around"
                }
                Some(_) => {
                    "the obstacle stands in the skin farther than the gaps are followed: press less deep"
                }
                None => {
                    "the obstacle stands in the skin farther than the gaps are followed: bring it there by a press, or overlap it less"
                }
            };
            let message = format!(
                "the obstacle's normal points out of the skin at {pulled} of {} vertices under force, which are pulled and not pressed; {why}",
                forces.active.len()
            );
            self.warn(WarningKind::Penetration, message);
        }
    }

    /// Warns of force on sides of the obstacle that are steep to the skin.
    pub fn warn_of_steep_sides(&mut self, gaps: &Gaps, forces: &NodeForces) {
        let share = gaps.steep_share.unwrap_or_else(|| steep_share(gaps.surface, forces));
        if share > MOST_STEEP {
            let message = format!(
                "{:.0} % of the force stands on sides of the obstacle that are steeper than 60 degrees to the skin: the linear answer is for small slopes and lays no skin around what goes in so deep; force and area there are a guess, whatever their errors of the mesh: press less deep",
                100.0 * share
            );
            self.warn(WarningKind::Depth, message);
        }
    }

    /// Notes sharp edges that carry force.
    ///
    /// * `obstacle`: ends (m) of one of the obstacle
    pub fn note_edges(&mut self, obstacle: Option<[Vector3<f64>; 2]>, skin: Option<&LoadedEdge>) {
        let point = |x: &Vector3<f64>| format!("({:.4}, {:.4}, {:.4})", x.x, x.y, x.z);
        for (whose, ends) in [("obstacle", obstacle), ("skin", skin.map(|edge| edge.ends))] {
            let Some([a, b]) = &ends else { continue };
            let why = format!(
                "a sharp edge of the {whose} carries force, as from {} to {} m, where the pressure is infinite: take means over an area; an edge that stands for a round one wants a finer mesh of the {whose}",
                point(a),
                point(b)
            );
            self.leave_out("a finite peak pressure", why);
        }
    }

    /// Warns where the obstacle is too finely shaped for gaps linearized at this depth, or the mesh too coarse for
    /// averaged ones.
    pub fn warn_of_penetration(&mut self, discretization: Discretization, before: f64, left: &Penetration) {
        if left.apart > MOST_APART * before {
            let message = format!(
                "the force acts {:.3e} m off the obstacle in the mean, of a depth of {before:.3e} m: on flanks and rims as steep and fine as these the gaps did not settle, and the force is a guess; press less deep, or allow more `max_linearizations`",
                left.apart
            );
            self.warn(WarningKind::Penetration, message);
        }
        if left.depth <= UNRESOLVED_SHARE * before {
            return;
        }
        let cause = match discretization {
            _ if !left.is_at_vertex => COARSE_MESH,
            Discretization::Collocation => {
                "the obstacle has features (a thin rim, an edge) no larger than the depth, where gaps along the closest normal do not hold; press less deep or thicken the feature, and do not trust force and area there"
            }
            Discretization::Galerkin => {
                "gaps are averaged over triangles as large as the features of this contact; refine the mesh there, or take the gap at the nodes"
            }
        };
        self.warn(WarningKind::Penetration, still_penetrates(left.depth, before, cause));
    }
}

fn still_penetrates(after: f64, before: f64, cause: &str) -> String {
    format!("the deformed skin still penetrates by {after:.3e} m of {before:.3e} m: {cause}")
}

impl Contact {
    /// Warns where the refinement ended before its target, and where a body's mesh costs more than that.
    pub(crate) fn warn_of_refinement(&mut self, end: RefinementEnd, target: f64) {
        let reason = match end {
            RefinementEnd::MaxNodes | RefinementEnd::MemoryLimit => format!("`{}`", end.as_str()),
            RefinementEnd::SharpEdge => {
                format!("{}, where a smaller `target_error` makes the mesh finer", end.as_str())
            }
            _ => end.as_str().to_string(),
        };
        let percent = |share: f64| format!("{} %", Digits(100.0 * share, 3));
        let cost_of = |share: f64| {
            if share.is_finite() {
                format!("about {}", percent(share))
            } else {
                "an unknown part".to_string()
            }
        };
        let mut short = Vec::new();
        if let (Some(force), Some(area)) = (self.accuracy.mesh_error, self.accuracy.area_error)
            && (self.unbalanced() * force).max(area) > target
        {
            let carried = if self.unbalanced() < 1.0 { " that the patches carry" } else { "" };
            let (force, area) = (cost_of(self.unbalanced() * force), cost_of(area));
            short.push(format!(
                "the mesh around the contact costs {force} of the force{carried} and {area} of the area: the refinement ended: {reason}"
            ));
        }
        if end == RefinementEnd::ForceLost {
            short.push(
                "on a finer mesh nothing carries force: force and area are a guess; press less deep"
                    .to_string(),
            );
        }
        let places = self.clues.touched_between + self.clues.unfelt.len();
        if places > 0 {
            short.push(format!(
                "the product touches the skin at {places} places away from all force that the mesh is too coarse for: the refinement ended: {reason}"
            ));
        }
        if let Some(doubt) = self.clues.body.filter(|doubt| doubt.force_error > target) {
            let cost = percent(doubt.force_error);
            let length = EDGE_MARGIN * doubt.edge_length * (target / doubt.force_error).sqrt();
            short.push(format!(
                "the coarse mesh of the body costs about {cost} of the force: prepare it with `coarse_edge_length={length:.2e}` m"
            ));
        }
        if let Some(doubt) = self.clues.product
            && let [of_area, _] = errors_of_area_and_peak(self)
            && of_area > target
        {
            let (force, area) = (percent(doubt.force_error), percent(of_area));
            let length = doubt.edge_length * target / of_area;
            short.push(format!(
                "the mesh that the product's matrix is given on costs about {force} of the force and {area} of the area: take edges of {length:.2e} m there"
            ));
        }
        if !short.is_empty() {
            let message = format!("the target of {} is not met: {}", percent(target), short.join("; "));
            self.warn(WarningKind::Refinement, message);
        }
    }

    /// Warns of what is left on a refined mesh and too little to be warned of on any.
    pub(crate) fn warn_of_penetration_left(&mut self) {
        let (before, after) = (self.max_penetration_before, self.max_penetration_after);
        if after > SMALL_PENETRATION * before && after <= UNRESOLVED_SHARE * before {
            let cause = match self.accuracy.discretization {
                _ if self.clues.edge.is_some() => BESIDE_EDGE,
                Discretization::Collocation => COARSE_MESH,
                Discretization::Galerkin => BETWEEN_AVERAGES,
            };
            self.warn(WarningKind::Penetration, still_penetrates(after, before, cause));
        }
    }
}
