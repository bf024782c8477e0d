//! Contacts that reach where the skin is cut, so that what lies beyond is missing from their figures.

use crate::contact::cuts::is_on_border;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::gap::initial::Gaps;
use crate::contact::report::record::Report;
use crate::contact::report::warning::WarningKind;
use crate::response::skin::elastic::ElasticSkin;

/// Share of the force from which the user is warned that it lies at a cut.
const SMALL_SHARE: f64 = 1e-3;

impl Report {
    /// Warns where vertices carry force beside a held one or the rim of the skin mask, or on an open border: each
    /// counts for the first of these. Returns the share of the force there.
    pub fn warn_of_cuts(&mut self, gaps: &Gaps, skin: &dyn ElasticSkin, forces: &NodeForces) -> f64 {
        let surface = gaps.surface;
        let refined = gaps.scene.inherited.as_ref().map(|inherited| &inherited.cuts);
        let is_held = |vertex| refined.map_or_else(|| skin.is_held(vertex), |cuts| cuts.held[vertex]);
        let ends = |vertex| refined.map_or_else(|| is_on_border(surface, vertex), |cuts| cuts.border[vertex]);
        let kinds = [
            (
                "the vertices that a body holds fixed",
                "fix fewer vertices (`Body(fixed=)`), or cut the mesh farther from it",
            ),
            (
                "the rim of the skin mask",
                "let the skin beyond it touch too (`skin_mask`), or cut the mesh farther from the contact",
            ),
            ("the open border of the mesh", "take a mesh that goes on beyond it"),
        ];
        if forces.active.is_empty() {
            return 0.0;
        }
        let total: f64 = forces.active.iter().map(|&vertex| forces.force[vertex]).sum();
        let mut carried = [0.0; 3];
        for &vertex in &forces.active {
            let mut around = surface.neighbours(vertex).iter().map(|&other| other as usize).chain([vertex]);
            let kind = if around.clone().any(is_held) {
                0
            } else if around.any(|other| !surface.skin_mask()[other]) {
                1
            } else if ends(vertex) {
                2
            } else {
                continue;
            };
            carried[kind] += forces.force[vertex];
        }
        let reached = kinds.iter().zip(carried).filter(|(_, force)| *force >= SMALL_SHARE * total);
        let (mut places, mut remedies, mut share) = (Vec::new(), Vec::new(), 0.0);
        for ((place, remedy), force) in reached {
            places.push(format!("{place}, with {force:.3e} N there ({:.2} % of all)", 100.0 * force / total));
            remedies.push(*remedy);
            share += force / total;
        }
        if share > 0.0 {
            let (places, remedies) = (places.join(", and "), remedies.join("; "));
            let message = format!(
                "the contact reaches {places}: the figures lack what lies beyond, and the pressure grows without bound there; \
                 {remedies}"
            );
            self.warn(WarningKind::Cut, message);
        }
        share
    }

    /// Warns where vertices carry force beside such as a given matrix does not know, which may bulge into the obstacle.
    pub fn warn_of_unknown(&mut self, gaps: &Gaps, skin: &dyn ElasticSkin, forces: &NodeForces) {
        let surface = gaps.surface;
        if !skin.traits(surface).is_ok_and(|traits| traits.moves_nodes_alone()) {
            return;
        }
        let is_unknown = |other: usize| surface.skin_mask()[other] && !skin.is_prepared(other);
        let is_at_rim =
            |&&vertex: &&usize| surface.neighbours(vertex).iter().any(|&other| is_unknown(other as usize));
        let sum = |force: f64, &vertex: &usize| force + forces.force[vertex];
        let total = forces.active.iter().fold(0.0, sum);
        let at_rim = forces.active.iter().filter(is_at_rim).fold(0.0, sum);
        if at_rim > SMALL_SHARE * total {
            let message = format!(
                "the contact reaches the rim of the nodes that a given matrix knows, with {at_rim:.3e} N there ({:.2} % of all): skin beyond it may come to touch, and the figures lack that; give the matrix for the vertices around these too",
                100.0 * at_rim / total
            );
            self.warn(WarningKind::Cut, message);
        }
    }
}
