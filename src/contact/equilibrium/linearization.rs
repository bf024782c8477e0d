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
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::group::{Guess, Nearness};
use crate::contact::equilibrium::growth::PRESSED_SHARE;
use crate::contact::equilibrium::solve::solve;
use crate::contact::equilibrium::steep::steep_share;
use crate::contact::error::ContactError;
use crate::contact::figures::motion::candidates::CandidateMotion;
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Refinement, RefinementKind};
use crate::contact::report::record::Report;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::Traits;
use crate::response::skin::kept::KeptSkin;

/// Share of the gaps that a linearization at a full step leaves at the most; more, and one of half the step follows. A shorter
/// step takes away as much less.
const MOST_LEFT: f64 = 0.7;
/// How much longer the step after one that left less is.
const LONGER_STEP: f64 = 1.5;
/// Linearizations without gain after which the obstacle's shape is beyond gaps in planes; one that leaves the force as it was counts
/// twice.
const MOST_IN_VAIN: usize = 3;
/// How far normals may turn, over the gap tolerance, so that forces are off by some such share of theirs: on sides as steep as a
/// ball's that the skin folds around, gaps vanish long before the forces stand upright on it.
const TURNED_PER_GAP: f64 = 5.0;
/// Share of the force on steep sides from which on skin slips to them: between that of a rod, a quarter at four times its radius
/// while its force still rises, and of a ball whose force begins to fall, at 1.2 radii.
const SLIPPING_SHARE: f64 = 0.35;
/// Least step from one linearization to the next.
const LEAST_STEP: f64 = 0.125;

/// What a linearization leaves.
#[derive(Debug, Clone, Copy)]
struct Left {
    /// Gaps of vertices under force and penetration of others (m).
    largest: f64,
    /// Root of the mean square, over those that are more than rounded: it falls steadily where single vertices come and go.
    mean: f64,
    /// How far the normals have turned from those that the forces act along: root of the mean square, by force.
    turned: f64,
}

impl Left {
    /// * `rounding`: of the gaps (m)
    /// * `turned`: [`Left::turned`]
    fn of(gaps: impl Iterator<Item = f64>, rounding: f64, turned: f64) -> Self {
        let (mut largest, mut squares, mut count) = (0.0_f64, 0.0, 0_usize);
        for gap in gaps.filter(|gap| *gap > rounding) {
            (largest, squares, count) = (largest.max(gap), squares + gap * gap, count + 1);
        }
        Self { largest, mean: (squares / count.max(1) as f64).sqrt(), turned }
    }

    /// * `tolerance`: of gaps, as a share of the deepest
    fn is_settled(&self, tolerance: f64, deepest: f64) -> bool {
        self.largest <= tolerance * deepest && self.turned <= TURNED_PER_GAP * tolerance
    }
}

/// The skin around a contact where its forces put it.
struct Deformed {
    /// Candidates and the vertices beside the active ones, but for those on sharp edges, ascending.
    vertices: Vec<usize>,
    /// u (m).
    displacement: Vec<Vector3<f64>>,
    /// Signed distance (m) and normal there.
    measured: Measured,
}

impl Deformed {
    fn new(
        gaps: &Gaps,
        response: &Compliance,
        forces: &NodeForces,
        report: &mut Report,
    ) -> Result<Self, ContactError> {
        let (started, surface) = (Instant::now(), gaps.surface);
        let is_other =
            |vertex: &usize| surface.skin_mask()[*vertex] && forces.candidates.binary_search(vertex).is_err();
        let mut beside = surface.k_ring(&forces.active, 1);
        beside.retain(|vertex| is_other(vertex) && response.is_prepared(*vertex));
        let found = response.displace_coarsely(forces.applied(), &beside)?;
        let motion = CandidateMotion::new(gaps, response, forces)?;
        let candidates = forces.candidates.iter().copied().zip(motion.displacement);
        let mut moved: Vec<(usize, Vector3<f64>)> = candidates.chain(beside.into_iter().zip(found)).collect();
        moved.retain(|(vertex, _)| gaps.line_at(*vertex).is_none());
        moved.sort_unstable_by_key(|(vertex, _)| *vertex);
        let (vertices, displacement) = moved.into_iter().unzip();
        report.clock("response", started);
        Self::at(gaps, vertices, displacement, report)
    }

    fn at(
        gaps: &Gaps,
        vertices: Vec<usize>,
        displacement: Vec<Vector3<f64>>,
        report: &mut Report,
    ) -> Result<Self, ContactError> {
        let started = Instant::now();
        let measured = gaps.measured_at(&vertices, &displacement)?;
        report.clock("signed_distance", started);
        Ok(Self { vertices, displacement, measured })
    }

    /// What forces leave; gaps in Galerkin form are how far the averaged ones of nodes under force are from those solved with.
    fn left(&self, gaps: &Gaps, traits: &Traits, forces: &NodeForces) -> Result<Left, ContactError> {
        let turned = self.turned(forces);
        let rounding = PRESSED_SHARE * gaps.deepest();
        if traits.discretization == Discretization::Galerkin {
            // Solved, the gap is as far from nothing as another linearization changes it.
            let mut anew = gaps.clone();
            anew.linearize(&self.vertices, &self.displacement, &self.measured);
            let [before, after] = [gaps, &anew].map(|gaps| gaps.averaged(traits.basis, &forces.active));
            let changes = before?.into_iter().zip(after?).map(|(before, after)| (after - before).abs());
            return Ok(Left::of(changes, rounding, turned));
        }
        let rows = self.vertices.iter().zip(&self.measured.distance);
        let off = |(&vertex, &distance): (&usize, &f64)| {
            if forces.force[vertex] > 0.0 { distance.abs() } else { (-distance).max(0.0) }
        };
        Ok(Left::of(rows.map(off), rounding, turned))
    }

    /// [`Left::turned`] of such forces.
    fn turned(&self, forces: &NodeForces) -> f64 {
        let (mut squares, mut total) = (0.0, 0.0);
        for (&vertex, normal) in self.vertices.iter().zip(&self.measured.normal) {
            let force = forces.force[vertex];
            if force > 0.0 {
                squares += force * (forces.vectors[vertex] / force - normal).norm_squared();
                total += force;
            }
        }
        if total > 0.0 { f64::sqrt(squares / total) } else { 0.0 }
    }
}

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
    let traits = response.traits;
    if forces.failure.is_some() {
        return Ok(forces);
    }
    let (tolerance, deepest) = (options.gap_tolerance, gaps.deepest());
    let deformed = Deformed::new(gaps, response, &forces, report)?;
    let least = deformed.left(gaps, &traits, &forces)?;
    if least.is_settled(tolerance, deepest) {
        return Ok(forces);
    }
    // A kernel's matrix holds in every round; that of a body hangs on the normals.
    let kept = KeptSkin::new(response.skin);
    let keeping = response.with_skin(&kept);
    let is_kept = !response.traits.is_kernel || response.skin.kept_factors().is_some();
    let given = response;
    let response = if is_kept { response } else { &keeping };
    report.is_unsettled = options.max_linearizations > 1 && least.largest > tolerance * deepest;
    let mut rounds = Linearizations {
        response,
        options,
        was_vain,
        deformed,
        active: forces.active.clone(),
        force: forces.vectors.iter().sum(),
        best: (least.mean, forces, gaps.clone()),
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
    let share = steep_share(gaps.surface, &forces);
    let has_slipped = share > SLIPPING_SHARE && options.max_linearizations > 1;
    if gaps.steep_share.is_some() || !has_slipped {
        return Ok(forces);
    }
    let mut kept_off = rounds.first.unwrap_or_else(|| gaps.clone());
    kept_off.steep_share = Some(share);
    let guess =
        Guess { active: &forces.active, nearness: Nearness::OfCoarser, fingers: Some(&forces.fingers) };
    let again = solve(&kept_off, given, Some(guess), options, report)?;
    if again.failure.is_some() || again.active.is_empty() {
        return Ok(forces);
    }
    *gaps = kept_off;
    solve_to_the_end(gaps, again, given, was_vain, options, report)
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
    /// The least mean gap left (m), with its forces and the gaps that they were solved with.
    best: (f64, NodeForces, Gaps<'a>),
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
        // The last attempt looks for an answer far away as well.
        let is_last = report.is_unsettled && self.in_vain + 1 == MOST_IN_VAIN && !self.was_vain;
        let nearness = if is_last { Nearness::OfCoarser } else { Nearness::Near };
        let guess = Guess { active: &self.active, nearness, fingers: Some(&self.best.1.fingers) };
        let forces = solve(gaps, self.response, Some(guess), self.options, report)?;
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
        let total: Vector3<f64> = forces.vectors.iter().sum();
        let is_same_force = (total - self.force).norm() <= self.options.gap_tolerance * total.norm();
        self.force = total;
        report.linearizations.push(round(total, &forces, left.largest, started));
        let settling = 1.0 - (1.0 - MOST_LEFT) * self.step;
        if left.mean > settling * self.before.mean {
            self.shorten();
        } else {
            self.step = (LONGER_STEP * self.step).min(1.0);
        }
        self.before = left;
        let least = self.best.0;
        let vain = if is_same_force { 2 } else { 1 };
        self.in_vain = if left.mean < settling * least { 0 } else { self.in_vain + vain };
        if left.mean < least {
            let (.., before) = std::mem::replace(&mut self.best, (left.mean, forces, gaps.clone()));
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
