//! Candidates that were not inside: vertices that the forces elsewhere press into the obstacle.

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::solve::Equilibrium;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::InitialGaps;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// A vertex outside the candidates counts as pressed when its gap falls below this share of the deepest
/// penetration; well above the rounding of `g0 + R f`, well below anything visible.
const PRESSED_SHARE: f64 = 1e-9;

/// Vertices outside the candidates that the solved forces press into the obstacle.
pub(crate) fn pressed_outside(
    surface: &Surface,
    obstacle: &Obstacle,
    compliance: &Compliance,
    gaps: &mut InitialGaps,
    round: &Equilibrium,
    deepest: f64,
) -> Result<Vec<usize>, ContactError> {
    let active = round.active();
    let outside: Vec<usize> = (0..surface.vertices().len())
        .filter(|&vertex| surface.skin_mask()[vertex] && round.candidates.binary_search(&vertex).is_err())
        .collect();
    let displacement =
        compliance.displacement(&round.fingers, &outside, &active, &round.node_force, &gaps.normal)?;
    // How far a vertex may sink at the most; the obstacle's normal there may not be known yet.
    let sinks = |row: usize| match displacement.along_normal[row] {
        Some(rise) => -rise,
        None => displacement.vectors[row].norm(),
    };
    // An unmeasured vertex stays clear unless it sinks by more than the search distance.
    let clear_below = |vertex: usize| gaps.distance[vertex].min(gaps.search_distance);
    let sinking: Vec<usize> = (0..outside.len())
        .filter(|&row| sinks(row) > 0.0 && clear_below(outside[row]) < sinks(row))
        .collect();
    let vertices: Vec<usize> = sinking.iter().map(|&row| outside[row]).collect();
    gaps.complete(surface.vertices(), obstacle, &vertices)?;
    let rise = |row: usize| match displacement.along_normal[row] {
        Some(rise) => rise,
        None => displacement.vectors[row].dot(&gaps.normal[outside[row]]),
    };
    let is_pressed = |row: &usize| gaps.distance[outside[*row]] + rise(*row) < -PRESSED_SHARE * deepest;
    Ok(sinking.into_iter().filter(is_pressed).map(|row| outside[row]).collect())
}
