//! Contact solved to the end: gaps and normals anew at the deformed skin, until the gap that is left there is small.
//!
//! With u the displacement at which a vertex X was measured, d its signed distance there and n the obstacle's normal,
//! the gap is linearized as
//!
//! ```text
//! g = d + n . (u(f) - u) = g0 + n . u(f),   g0 = d - n . u
//! ```
//!
//! so that each round poses the same problem with other initial gaps and normals. The plane between a sharp edge and the
//! undeformed skin stays: the skin that drapes over the edge has no normal of its own. So does, where much of the force would stand
//! on steep sides, the plane of skin that would slip to them.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::deformed::{Deformed, Left};
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::group::{Guess, Nearness};
use crate::contact::equilibrium::solve::solve;
use crate::contact::equilibrium::steep::steep_share;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Refinement, RefinementKind};
use crate::contact::report::record::Report;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::kept::KeptSkin;

/// Share of the gaps that a linearization at a full step leaves at the most; more, and one of half the step follows. A shorter
/// step takes away as much less.
const MOST_LEFT: f64 = 0.7;
/// The same of the turns of the normals where averaged gaps are next to none: forces on a steep rim turn long after gaps have
/// closed. No shorter step follows unless normals turn more.
const MOST_TURNED: f64 = 0.9;
/// How much longer the step after one that left less is.
const LONGER_STEP: f64 = 1.5;
/// Linearizations without gain after which the obstacle's shape is beyond gaps in planes; one that leaves the force as it was counts
/// twice.
const MOST_IN_VAIN: usize = 3;
/// Share of the force on steep sides from which on skin slips to them: between that of a rod, a quarter at four times its radius
/// while its force still rises, and of a ball whose force begins to fall, at 1.2 radii.
const SLIPPING_SHARE: f64 = 0.35;
/// Relative difference below which two linearizations leave the same gap: skin that goes from facet to facet and back comes to
/// the same forces again, and no rounding is to say which of the two is taken.
const SAME_GAP: f64 = 1e-6;
/// Least step from one linearization to the next.
const LEAST_STEP: f64 = 0.125;

/// Takes gaps and normals anew at the deformed skin until no gap of a vertex in contact is above the tolerance, and the forces
/// stand upright on the obstacle to five times it. Where skin slipped to steep sides, it begins again, with skin kept off these.
///
/// * `forces`: of the gaps as measured at the undeformed skin
/// * `was_vain`: whether none of the linearizations of a contact nearby led to a better answer; one then says whether they do
///   here
///
/// Returns the forces that leave the least gap; `gaps` are those that they were solved with.
pub(crate) fn solve_to_the_end<'a>(
    gaps: &mut Gaps<'a>,
    forces: NodeForces,
    response: &Compliance,
    was_vain: bool,
    options: &ContactOptions,
    report: &mut Report,
) -> Result<NodeForces, ContactError> {
    let (forces, first) = settle(gaps, forces, response, was_vain, options, report)?;
    let Some(mut kept_off) = first.filter(|_| gaps.steep_share.is_none()) else { return Ok(forces) };
    let share = steep_share(gaps.surface, &forces);
    if share <= SLIPPING_SHARE {
        return Ok(forces);
    }
    kept_off.steep_share = Some(share);
    let guess =
        Guess { active: &forces.active, nearness: Nearness::OfCoarser, fingers: Some(&forces.fingers) };
    let again = solve(&kept_off, response, Some(guess), options, report)?;
    if again.failure.is_some() || again.active.is_empty() {
        return Ok(forces);
    }
    *gaps = kept_off;
    Ok(settle(gaps, again, response, was_vain, options, report)?.0)
}

/// As [`solve_to_the_end`], wherever skin slips to. With the forces it returns the first gaps, where others were tried.
fn settle<'a>(
    gaps: &mut Gaps<'a>,
    forces: NodeForces,
    response: &Compliance,
    was_vain: bool,
    options: &ContactOptions,
    report: &mut Report,
) -> Result<(NodeForces, Option<Gaps<'a>>), ContactError> {
    if forces.failure.is_some() {
        return Ok((forces, None));
    }
    let (tolerance, deepest) = (options.gap_tolerance, gaps.deepest());
    let deformed = Deformed::new(gaps, response, &forces, report)?;
    let least = deformed.left(gaps, &response.traits, &forces)?;
    if least.is_settled(tolerance, deepest) || options.max_linearizations == 1 {
        return Ok((forces, None));
    }
    // A kernel's matrix holds in every round; that of a body hangs on the normals.
    let kept = KeptSkin::new(response.skin);
    let keeping = response.with_skin(&kept);
    let is_kept = !response.traits.is_kernel || response.skin.kept_factors().is_some();
    report.is_unsettled = least.largest > tolerance * deepest;
    let mut rounds = Linearizations {
        response: if is_kept { response } else { &keeping },
        options,
        was_vain,
        deformed,
        active: forces.active.clone(),
        force: forces.total(),
        best: (least, forces, gaps.clone()),
        first: None,
        before: least,
        step: 1.0,
        in_vain: if was_vain { MOST_IN_VAIN - 1 } else { 0 },
    };
    for _ in 1..options.max_linearizations {
        if rounds.before.is_settled(tolerance, deepest) || rounds.in_vain >= MOST_IN_VAIN {
            break;
        }
        rounds.add(gaps, report)?;
        options.check_interrupt("linearization")?;
    }
    let (_, forces, of_best) = rounds.best;
    *gaps = of_best;
    Ok((forces, Some(rounds.first.unwrap_or_else(|| gaps.clone()))))
}

/// Linearizations one after the other.
struct Linearizations<'a, 'b> {
    response: &'b Compliance<'b>,
    options: &'b ContactOptions<'b>,
    was_vain: bool,
    /// The skin under the last forces, where they act, and their sum (N).
    deformed: Deformed,
    active: Vec<usize>,
    force: Vector3<f64>,
    /// The least that was left, with its forces and the gaps that they were solved with.
    best: (Left, NodeForces, Gaps<'a>),
    /// The gaps of the first forces, once others leave less.
    first: Option<Gaps<'a>>,
    /// What the last round left.
    before: Left,
    /// Share of the way from the place of one linearization to the next.
    step: f64,
    in_vain: usize,
}

impl<'a> Linearizations<'a, '_> {
    /// Takes gaps and normals anew on the way to the deformed skin, and solves.
    fn add(&mut self, gaps: &mut Gaps<'a>, report: &mut Report) -> Result<(), ContactError> {
        let started = Instant::now();
        let Deformed { vertices, displacement, .. } = &self.deformed;
        let shift = vertices.iter().zip(displacement);
        let shift = shift.map(|(&vertex, u)| gaps.linearized_at(vertex).lerp(u, self.step)).collect();
        let there = Deformed::at(gaps, vertices.clone(), shift, report)?;
        let last = gaps.clone();
        gaps.linearize(&there.vertices, &there.displacement, &there.measured);
        let mut solved = |nearness| {
            let guess = Guess { active: &self.active, nearness, fingers: Some(&self.best.1.fingers) };
            solve(gaps, self.response, Some(guess), self.options, report)
        };
        let near = solved(Nearness::Near)?;
        // Where normals turn far, more nodes change sides than a near guess allows.
        let forces = match near.failure {
            Some(_) if !self.was_vain => solved(Nearness::OfCoarser)?,
            _ => near,
        };
        if forces.failure.is_some() || forces.active.is_empty() {
            // Half-way there fewer nodes change sides, and skin that was inside is not let go.
            *gaps = last;
            self.shorten();
            self.in_vain += 1;
            return Ok(());
        }
        self.take(forces, gaps, started, report)
    }

    /// Notes what forces leave, and how the next round is to go on.
    fn take(
        &mut self,
        forces: NodeForces,
        gaps: &Gaps<'a>,
        started: Instant,
        report: &mut Report,
    ) -> Result<(), ContactError> {
        self.active.clone_from(&forces.active);
        self.deformed = Deformed::new(gaps, self.response, &forces, report)?;
        let left = self.deformed.left(gaps, &self.response.traits, &forces)?;
        let total = forces.total();
        let is_same_force = (total - self.force).norm() <= self.options.gap_tolerance * total.norm();
        self.force = total;
        report.linearizations.push(round(total, &forces, left.largest, started));
        // At vertices gaps alone count: rounds that turns choose leave forces uneven by a millionth, which searches feel.
        let none = match self.response.traits.discretization {
            Discretization::Galerkin => self.options.gap_tolerance * gaps.deepest(),
            Discretization::Collocation => 0.0,
        };
        let [of_gaps, of_turns] = [MOST_LEFT, MOST_TURNED].map(|most| 1.0 - (1.0 - most) * self.step);
        let vain = if is_same_force { 2 } else { 1 };
        let is_gain = left.is_less([of_gaps, of_turns], &self.best.0, none);
        self.in_vain = if is_gain { 0 } else { self.in_vain + vain };
        if left.is_less([of_gaps, 1.0], &self.before, none) {
            self.step = (LONGER_STEP * self.step).min(1.0);
        } else {
            self.shorten();
        }
        self.before = left;
        if left.is_less([1.0 - SAME_GAP; 2], &self.best.0, none) {
            let (.., before) = std::mem::replace(&mut self.best, (left, forces, gaps.clone()));
            self.first.get_or_insert(before);
            report.is_unsettled = false;
        }
        Ok(())
    }

    fn shorten(&mut self) {
        self.step = (0.5 * self.step).max(LEAST_STEP);
    }
}

/// A round with such a force (N) that left such a gap (m).
fn round(force: Vector3<f64>, forces: &NodeForces, gap: f64, started: Instant) -> Refinement {
    Refinement {
        kind: RefinementKind::Linearization,
        nodes: forces.candidates.len(),
        force,
        contact_area: None,
        max_pressure: None,
        force_error: None,
        area_error: None,
        max_penetration: gap,
        seconds: started.elapsed().as_secs_f64(),
        end: None,
    }
}
