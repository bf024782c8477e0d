//! Node forces that end all penetration: solve, look at the rest, add what got pressed, repeat.

use std::time::Instant;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::candidate::groups::{uncoupled_groups, with_rings};
use crate::contact::discretization::prepared;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::group::{EXPECTED_RINGS, GroupProblem, Guess};
use crate::contact::equilibrium::growth::wanting;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::report::record::Report;
use crate::mesh::distinct::distinct;

/// Rings added to the penetrating vertices where a response has negative entries: three in Xie, Kanai, Date 2011, §2.5, before
/// anything looked beyond them.
const DEFAULT_RINGS: usize = 1;

/// Finds the node forces.
pub(crate) fn solve(
    gaps: &Gaps,
    response: &Compliance,
    guess: Option<Guess>,
    options: &ContactOptions,
    report: &mut Report,
) -> Result<NodeForces, ContactError> {
    let traits = &response.traits;
    // On a refined mesh it is known from the one before that few others are pressed; these are found below.
    let is_first = gaps.scene.inherited.is_none();
    let rings = options.rings.unwrap_or(if traits.negative_entries && is_first { DEFAULT_RINGS } else { 0 });
    let mut candidates = traits.discretization.start_set(gaps, response, rings)?;
    if let Some(guess) = guess.filter(|_| traits.negative_entries) {
        // What it grew by before would be found again, one solve later.
        candidates.extend(prepared(gaps, response, with_rings(gaps.surface, guess.active, EXPECTED_RINGS)));
        candidates = distinct(candidates);
    }
    if is_first {
        check_free(&candidates, response)?;
    }
    let mut before = guess.and_then(|guess| guess.fingers).cloned();
    for growth in 0.. {
        let forces = solve_on(candidates, before, gaps, response, guess, options, report)?;
        if forces.failure.is_some() || rings == 0 && !traits.negative_entries {
            return Ok(forces);
        }
        let started = Instant::now();
        let wanting = wanting(gaps, response, &forces)?;
        report.clock("response", started);
        if wanting.is_empty() {
            return Ok(forces);
        }
        let mut grown = prepared(gaps, response, with_rings(gaps.surface, &wanting, rings.max(1)));
        grown.extend(wanting.iter().chain(&forces.candidates));
        let grown = distinct(grown);
        if grown == forces.candidates {
            // The rest is held, or not prepared and not pressed.
            return Ok(forces);
        }
        if growth == options.max_growths {
            let skin_vertices = gaps.surface.skin_mask().iter().filter(|&&may_touch| may_touch).count();
            let candidates = forces.candidates.len();
            return Err(ContactError::Growth { growths: growth, candidates, skin_vertices });
        }
        candidates = grown;
        before = Some(forces.fingers);
        options.check_interrupt("candidates")?;
    }
    unreachable!("the loop ends by a return")
}

/// Refuses candidates that a body holds in place.
fn check_free(candidates: &[usize], response: &Compliance) -> Result<(), ContactError> {
    let is_held = |vertex: &usize| response.skin.is_held(*vertex) && !response.is_prepared(*vertex);
    let held: Vec<usize> = candidates.iter().copied().filter(is_held).collect();
    match held.first() {
        Some(&vertex) => Err(ContactError::Held { vertex, count: held.len() }),
        None => Ok(()),
    }
}

/// Solves the complementarity problems of `candidates`, one for each group that feels no other.
///
/// * `before`: fingers of a contact of the same undeformed skin
fn solve_on(
    candidates: Vec<usize>,
    before: Option<Fingers>,
    gaps: &Gaps,
    response: &Compliance,
    guess: Option<Guess>,
    options: &ContactOptions,
    report: &mut Report,
) -> Result<NodeForces, ContactError> {
    let traits = &response.traits;
    let grown = before.and_then(|fingers| fingers.grown_to(gaps.surface, &candidates));
    let fingers = match (grown, &gaps.scene.inherited) {
        _ if options.couple_fingers => Fingers::one(&candidates),
        (Some(grown), _) => grown,
        (None, Some(inherited)) => inherited.fingers.among(gaps.surface, &candidates),
        (None, None) => {
            let is_under_kernel = |vertex| response.skin.kernel_at(vertex).is_some();
            Fingers::split_by_tissue(gaps.surface, &candidates, &gaps.undeformed(), is_under_kernel)
        }
    };
    let at_candidates = gaps.at(&candidates)?;
    let on_product = response.on_product(&candidates, &at_candidates.normal);
    let mut forces = NodeForces::none(gaps, candidates, fingers, on_product, at_candidates);
    let groups = if response.has_product() {
        vec![forces.candidates.clone()]
    } else {
        uncoupled_groups(gaps.surface, &forces.fingers, traits.reach)
    };
    let problem = GroupProblem { gaps, response, guess, options };
    for group in groups {
        problem.solve(&group, &mut forces, report)?;
    }
    if forces.failure.is_none() {
        traits.discretization.vertex_gap(gaps, response, &mut forces)?;
    }
    Ok(forces)
}
