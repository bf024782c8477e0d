//! Candidates that were not inside: the forces elsewhere press them into the obstacle.

use crate::contact::candidate::groups::loaded_rim;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::gap::entry::FACING_BACK;
use crate::contact::gap::initial::Gaps;

/// A vertex outside the candidates counts as pressed when its gap falls below this share of the deepest
/// penetration; well above the rounding of `g0 + R f`, well below anything visible.
pub(crate) const PRESSED_SHARE: f64 = 1e-9;

/// Vertices that ask for a larger set of candidates: the loaded rim, and what the forces press into the obstacle.
pub(crate) fn wanting(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
) -> Result<Vec<usize>, ContactError> {
    let mut wanting = loaded_rim(gaps.surface, &forces.candidates, &forces.force);
    if response.traits.negative_entries {
        wanting.extend(pressed_outside(gaps, response, forces)?);
    }
    Ok(wanting)
}

/// Vertices outside the candidates that the solved forces press into the obstacle.
fn pressed_outside(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
) -> Result<Vec<usize>, ContactError> {
    let may_touch = gaps.surface.skin_mask();
    // Nothing bulges by as much as it is pressed in elsewhere.
    let highest = gaps.deepest().min(gaps.search_distance);
    let mut outside = gaps.nearer_than(highest);
    outside.retain(|vertex| may_touch[*vertex] && forces.candidates.binary_search(vertex).is_err());
    let moved = response.displace_coarsely(forces.applied(), &outside)?;
    let there = gaps.at(&outside)?;
    let pressed = PRESSED_SHARE * gaps.deepest();
    let is_pressed = |&row: &usize| {
        let (moved, normal) = (&moved[row], &there.normal[row]);
        // No force along a side that faces back would press.
        let is_met = normal.dot(&gaps.way_in(outside[row])) >= FACING_BACK;
        is_met && there.distance[row] + moved.dot(normal) < -pressed
    };
    Ok((0..outside.len()).filter(is_pressed).map(|row| outside[row]).collect())
}
