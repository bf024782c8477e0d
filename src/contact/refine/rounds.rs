//! Solve, look where the mesh is too coarse, refine it there, solve again.

use std::collections::HashMap;
use std::ops::ControlFlow::{self, Break, Continue};
use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::clues::Clues;
use crate::contact::equilibrium::group::MOST_BY_PIVOTS;
use crate::contact::error::ContactError;
use crate::contact::figures::area::cells::mean_edge;
use crate::contact::figures::penetration::after::SMALL_PENETRATION;
use crate::contact::in_place::{InPlace, Known};
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd, RefinementKind, Timing};
use crate::contact::refine::given::{concluded, note_given};
use crate::contact::refine::mark::{faces_near, touched_between};
use crate::contact::refine::mesh_errors::SLOWEST_CHANGE;
use crate::contact::refine::meshes::Meshes;
use crate::contact::refine::product::errors_of_area_and_peak;
use crate::contact::refine::wanting::{Finer, Wanting};
use crate::contact::report::record::{Report, add_timings};
use crate::contact::scene::Placement;
use crate::lcp::solution::LcpStatus;
use crate::response::error::ResponseError;
use crate::response::skin::elastic::ElasticSkin;
use crate::response::skin::kept::KeptSkin;
use crate::surface::refined::{MeshRefinement, RefinedSurface};

/// Rounds in which the figures may fail to settle before the refinement gives up.
const UNSETTLED_ROUNDS: usize = 2;
/// A contact of fewer vertices under force says nothing of those to come.
const FEW_UNDER_FORCE: usize = 100;
/// A mesh with more contact nodes is not refined for the penetration between them alone.
pub(crate) const FEW_NODES: usize = 300;
/// Rounds at the most.
const MAX_ROUNDS: usize = 12;
/// What a round leaves of the edges.
const EDGE_SHARE: f64 = 0.5;

/// What is to be done about the mesh of a contact.
pub(crate) enum Begun<'a> {
    /// Nothing: the contact, concluded.
    Ended(Box<Contact>),
    /// To refine it.
    Rounds(Box<Rounds<'a>>),
}

/// Refines the mesh of a contact that was solved on the given one, as far as the options ask for it.
pub(crate) fn refine(
    given: Contact,
    started: Instant,
    placement: Placement,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    match begin(given, started, placement, skin, options)? {
        Begun::Ended(contact) => Ok(*contact),
        Begun::Rounds(mut rounds) => {
            let end = rounds.run()?;
            rounds.conclude(end)
        }
    }
}

/// Notes what the given mesh gave, and looks whether it is to be refined.
pub(crate) fn begin<'a>(
    mut given: Contact,
    started: Instant,
    placement: Placement<'a>,
    skin: &'a dyn ElasticSkin,
    options: &'a ContactOptions,
) -> Result<Begun<'a>, ContactError> {
    let traits = note_given(&mut given, started, placement, skin)?;
    let ended = |given, end| Ok(Begun::Ended(Box::new(concluded(given, end, skin))));
    let target = match options.target_error {
        None => return ended(given, RefinementEnd::NoTarget),
        Some(_) if !traits.refines => {
            given.leave_out("refinement", "one-rings and given matrices take the mesh as it is");
            return ended(given, RefinementEnd::Response);
        }
        Some(target) => target,
    };
    if matches!(given.status, ContactStatus::Failed(_)) {
        return ended(given, RefinementEnd::NotSolved);
    }
    let deepest = given.max_penetration_before;
    let near = faces_near(&given.gap, &given.candidates, deepest, given.surface(), &traits);
    let mesh = MeshRefinement::new(given.surface(), near);
    let was_linearized = given.refinements.iter().any(|round| round.kind == RefinementKind::Linearization);
    let moved = given.candidates.iter().copied().zip(given.drawing.motion.displacement.iter().copied());
    let linearized_at = moved.filter(|_| was_linearized).collect();
    let meshes = Meshes { given, mesh, last: None };
    Ok(Begun::Rounds(Box::new(Rounds {
        meshes,
        between: Vec::new(),
        touches_elsewhere_alone: false,
        linearized_at,
        steep_share: None,
        placement,
        skin,
        options,
        target,
    })))
}

/// How the rounds settle.
struct SoFar {
    /// Rounds in a row in which the figures failed to.
    unsettled: usize,
    /// Estimate after the last round, and the penetration that it left (m).
    worst: f64,
    left: f64,
}

/// The rounds of a refinement.
pub(crate) struct Rounds<'a> {
    pub meshes: Meshes,
    /// Triangles away from all force that the obstacle touches between their vertices.
    between: Vec<usize>,
    /// Whether the mesh is fine enough but for where it is touched away from all force.
    touches_elsewhere_alone: bool,
    /// Displacements (m) at which its gaps were linearized, by the vertex' number in the whole refined surface.
    linearized_at: HashMap<usize, Vector3<f64>>,
    /// [`InPlace::steep_share`].
    steep_share: Option<f64>,
    placement: Placement<'a>,
    skin: &'a dyn ElasticSkin,
    options: &'a ContactOptions<'a>,
    pub target: f64,
}

impl Rounds<'_> {
    /// Refines until the target is met, or something else ends it: says what.
    pub fn run(&mut self) -> Result<RefinementEnd, ContactError> {
        if self.is_given_enough()? {
            return Ok(RefinementEnd::Target);
        }
        let mut so_far = SoFar { unsettled: 0, worst: f64::INFINITY, left: f64::INFINITY };
        for _ in 0..MAX_ROUNDS {
            let started = Instant::now();
            let next = match self.wanting().next(self.touches_elsewhere_alone) {
                Continue(next) => next,
                Break(end) => return Ok(end),
            };
            let finer = match self.finer(next)? {
                Continue(finer) => finer,
                Break(end) => return Ok(end),
            };
            let part = finer.part();
            let mut contact = match self.solved_on(&finer, &part)? {
                Continue(contact) => contact,
                Break(end) => return Ok(end),
            };
            self.meshes.mesh = finer;
            let previous = self.meshes.finest();
            contact.refinements = [&previous.refinements[..], &contact.refinements].concat();
            let solving: f64 = contact.timings.iter().map(|timing| timing.seconds).sum();
            let rest = (started.elapsed().as_secs_f64() - solving).max(0.0);
            add_timings(&mut contact.timings, &previous.timings);
            add_timings(&mut contact.timings, &[Timing { stage: "refinement", seconds: rest }]);
            let has_failed = matches!(contact.status, ContactStatus::Failed(_));
            let error = if has_failed { None } else { contact.error_after(previous, next) };
            contact.note_round(error, started);
            let end = if has_failed {
                Some(RefinementEnd::NotSolved)
            } else {
                self.touches_elsewhere_alone = self.is_met(&contact) && self.touches_elsewhere(&contact);
                self.ending(&contact, &mut so_far)
            };
            self.meshes.last = Some((part, contact));
            if let Some(end) = end {
                return Ok(end);
            }
        }
        Ok(RefinementEnd::MostRounds)
    }

    /// Whether the given mesh meets the target with next to no penetration. On a sharp edge one mesh says too little.
    fn is_given_enough(&self) -> Result<bool, ContactError> {
        let Meshes { given, mesh, .. } = &self.meshes;
        let is_left = given.max_penetration_after > SMALL_PENETRATION * given.max_penetration_before;
        if !self.is_met(given) || is_left || given.is_apart() || given.clues.edge.is_some() {
            return Ok(false);
        }
        Ok(touched_between(mesh, None, given, self.skin, self.options)?.is_empty())
    }

    fn wanting(&self) -> Wanting<'_> {
        Wanting { meshes: &self.meshes, target: self.target, max_nodes: self.options.max_nodes }
    }

    /// The mesh of the next round, or why there is none.
    fn finer(&self, next: Finer) -> Result<ControlFlow<RefinementEnd, MeshRefinement>, ContactError> {
        let finest = self.meshes.finest();
        if let Some(product) = finest.clues.product
            && errors_of_area_and_peak(finest)[0] > finest.accuracy.area_error.unwrap_or(0.0).max(self.target)
            && EDGE_SHARE * mean_edge(finest.surface(), &finest.active) < product.edge_length
        {
            return Ok(Break(RefinementEnd::ProductMesh));
        }
        let wanting = self.wanting().vertices(next);
        let marked = self.wanting().marked(&wanting, next, &self.between)?;
        if !marked.contains(&true) {
            return Ok(Break(RefinementEnd::NoForce));
        }
        // At the least: edges are halved around those wanting.
        let (nodes, most) = (finest.candidates.len() + 3 * wanting.len(), self.options.max_nodes);
        if nodes > most {
            return Ok(Break(RefinementEnd::MaxNodes));
        }
        if let Some(end) = self.doubt()
            && nodes > most / 2
        {
            return Ok(Break(end));
        }
        let mut finer = self.meshes.mesh.clone();
        finer.refine(&marked);
        Ok(Continue(finer))
    }

    /// The contact on a finer mesh, or why that is too much.
    fn solved_on(
        &mut self,
        finer: &MeshRefinement,
        part: &RefinedSurface,
    ) -> Result<ControlFlow<RefinementEnd, Contact>, ContactError> {
        let contact = match self.solve(finer, part) {
            Err(ContactError::Response(ResponseError::TooLarge { .. })) => {
                return Ok(Break(RefinementEnd::MemoryLimit));
            }
            other => match other? {
                Some(contact) => contact,
                None => return Ok(Break(RefinementEnd::MaxNodes)),
            },
        };
        let is_lost = !matches!(contact.status, ContactStatus::Failed(_))
            && contact.pressed().is_empty()
            && self.between.is_empty();
        if is_lost && !self.meshes.finest().active.is_empty() {
            return Ok(Break(RefinementEnd::ForceLost));
        }
        let has_no_end =
            matches!(contact.status, ContactStatus::Failed(LcpStatus::Breakdown | LcpStatus::PivotLimit));
        if has_no_end && contact.candidates.len() > MOST_BY_PIVOTS {
            return Ok(Break(RefinementEnd::NotSolvedOnFiner));
        }
        Ok(Continue(contact))
    }

    fn is_met(&self, contact: &Contact) -> bool {
        contact.mesh_share().is_some_and(|share| share <= self.target)
    }

    fn touches_elsewhere(&self, contact: &Contact) -> bool {
        !self.between.is_empty() || !contact.clues.unfelt.is_empty()
    }

    /// Why no further round follows, if none does.
    fn ending(&self, contact: &Contact, so_far: &mut SoFar) -> Option<RefinementEnd> {
        let left_before = std::mem::replace(&mut so_far.left, contact.max_penetration_after);
        let share = contact.mesh_share()?;
        let is_met = self.is_met(contact);
        let is_resolved = !self.touches_elsewhere(contact)
            && (contact.is_free_of_penetration()
                || so_far.left > SLOWEST_CHANGE * left_before
                || contact.candidates.len() > FEW_NODES);
        if is_met && is_resolved {
            return Some(if contact.is_apart() {
                RefinementEnd::UnsettledGaps
            } else {
                RefinementEnd::Target
            });
        }
        let may_settle = contact.clues.edge.is_none() && contact.active.len() >= FEW_UNDER_FORCE;
        let is_unsettled = !is_met && share > SLOWEST_CHANGE * so_far.worst && may_settle;
        so_far.unsettled = if is_unsettled { so_far.unsettled + 1 } else { 0 };
        so_far.worst = share;
        (so_far.unsettled >= UNSETTLED_ROUNDS).then_some(RefinementEnd::Unsettled)
    }

    /// Why no mesh may be fine enough.
    fn doubt(&self) -> Option<RefinementEnd> {
        let (_, Contact { clues, .. }) = self.meshes.last.as_ref()?;
        match clues {
            Clues { edge: Some(_), .. } => Some(RefinementEnd::SharpEdge),
            Clues { is_unsettled: true, .. } => Some(RefinementEnd::UnsettledGaps),
            _ => None,
        }
    }

    /// The contact on a finer mesh; `None` where that has too many nodes.
    fn solve(
        &mut self,
        finer: &MeshRefinement,
        part: &RefinedSurface,
    ) -> Result<Option<Contact>, ContactError> {
        self.options.check_interrupt("refinement")?;
        let started = Instant::now();
        let mut scene = self.placement.scene(&part.surface)?;
        scene.inherited = Some(self.meshes.inherited_by(part, self.skin));
        let mut report = Report::default();
        if self.placement.press.is_some() {
            report.clock("first_touch", started);
        }
        let most = self.options.max_nodes;
        let gaps = InPlace::gaps(&part.surface, &scene, self.options, &mut report)?;
        if gaps.penetrating.len() > most {
            return Ok(None);
        }
        let skin = self.skin.refined(part)?.expect("a skin that was refined before");
        let known = self.known_on(part);
        let kept = KeptSkin::new(&*skin);
        let skin = if skin.as_kernel().is_some() { &kept } else { &*skin };
        let solved = InPlace::solve(gaps, skin, Some(&known), self.options, report)?;
        self.steep_share = solved.steep_share();
        let linearized = solved.known().into_iter().flat_map(Known::into_linearized);
        self.linearized_at = linearized.map(|(vertex, at)| (part.number(vertex), at)).collect();
        let mut contact = solved.contact(self.options)?;
        self.between = match contact.status {
            ContactStatus::Solved => touched_between(finer, Some(part), &contact, skin, self.options)?,
            _ => Vec::new(),
        };
        contact.clues.touched_between = self.between.len();
        Ok((contact.candidates.len() <= most).then_some(contact))
    }

    /// What the last contact knows of that on a mesh as fine or finer.
    pub fn known_on(&self, part: &RefinedSurface) -> Known {
        let active = self.meshes.expected(part);
        if self.options.max_linearizations == 1 {
            return Known::of_active(active);
        }
        let linearized_at = part.inherit_known(&self.linearized_at, |a, b| 0.5 * (a + b));
        Known::linearized(active, linearized_at, self.steep_share)
    }

    /// The last contact in the numbers of the whole skin, with why no further round followed.
    pub fn conclude(self, end: RefinementEnd) -> Result<Contact, ContactError> {
        self.meshes.conclude(end, self.target, self.skin)
    }
}
