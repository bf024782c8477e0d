//! Solve, look where the mesh is too coarse, refine it there, solve again.

use std::time::Instant;

use crate::contact::error::ContactError;
use crate::contact::in_place::solve_in_place;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, ContactStatus, Refinement};
use crate::contact::refine::estimate::MeshError;
use crate::contact::refine::mark::{add_pressed_middles, faces_near, loaded};
use crate::contact::refine::whole::into_whole;
use crate::contact::report::cuts::Cuts;
use crate::contact::report::record::Report;
use crate::contact::scene::{Inherited, Placement};
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::refined::{MeshRefinement, RefinedSurface};

/// Rounds in which the figures may fail to settle before the refinement gives up.
const UNSETTLED_ROUNDS: usize = 2;
/// Mesh cells in the depth with which a contact on a sharp edge is as fine as it gets: its figures go on changing with
/// the logarithm of the cells.
const CELLS_PER_DEPTH_ON_EDGE: f64 = 8.0;
/// A contact of fewer vertices under force says nothing of those to come.
const FEW_VERTICES: usize = 12;
/// A mesh with more contact nodes is not refined for the penetration between them alone.
const FEW_NODES: usize = 300;
/// A figure that keeps more than this share from one round to the next does not settle.
const SETTLING: f64 = 0.8;
/// Penetration left on a mesh that is fine enough, as a share of that before.
const SMALL_PENETRATION: f64 = 0.02;
/// Share of the target below which the force needs no finer mesh.
const SMALL_SHARE: f64 = 0.6;
/// Rounds at the most: each halves the edges.
const MAX_ROUNDS: usize = 12;

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
    placement: &Placement,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    match begin(given, started, placement, skin, options)? {
        Begun::Ended(contact) => Ok(*contact),
        Begun::Rounds(mut rounds) => {
            let reason = rounds.run()?;
            rounds.conclude(reason)
        }
    }
}

/// Notes what the given mesh gave, and looks whether it is to be refined.
pub(crate) fn begin<'a>(
    mut given: Contact,
    started: Instant,
    placement: &'a Placement,
    skin: &'a dyn ElasticSkin,
    options: &'a ContactOptions,
) -> Result<Begun<'a>, ContactError> {
    let ended = |contact: Contact| Ok(Begun::Ended(Box::new(contact)));
    let surface = given.surface().clone();
    let traits = skin.traits(&surface)?.with_product(placement.obstacle.material());
    if !traits.refines {
        given.leave_out(
            "estimates of error",
            "one-rings and given matrices take no other mesh to compare with",
        );
    }
    let error =
        (given.status == ContactStatus::Solved && traits.refines).then(|| MeshError::of_cells(&given));
    given.note_round(error, started);
    let target = match options.target_error {
        None => return ended(given.concluded("the mesh was taken as it is")),
        Some(_) if !traits.refines => {
            given.leave_out("refinement", "one-rings and given matrices take the mesh as it is");
            return ended(given.concluded("the response takes the mesh as it is"));
        }
        Some(target) => target,
    };
    if matches!(given.status, ContactStatus::Failed(_)) {
        return ended(given.concluded("a complementarity problem did not end solved"));
    }
    // Where forces can press skin outside, it must be there.
    let margin = if traits.negative_entries { given.max_penetration_before } else { 0.0 };
    let mesh = MeshRefinement::new(&surface, faces_near(&given, &surface, margin));
    Ok(Begun::Rounds(Box::new(Rounds { given, mesh, last: None, placement, skin, options, target })))
}

/// The rounds of a refinement.
pub(crate) struct Rounds<'a> {
    /// On the given mesh.
    given: Contact,
    mesh: MeshRefinement,
    /// On the finest mesh so far.
    pub last: Option<(RefinedSurface, Contact)>,
    placement: &'a Placement<'a>,
    skin: &'a dyn ElasticSkin,
    options: &'a ContactOptions<'a>,
    pub target: f64,
}

impl Rounds<'_> {
    /// Refines until the target is met, or something else ends it: says what.
    pub fn run(&mut self) -> Result<&'static str, ContactError> {
        let mut unsettled = 0;
        let mut before = f64::INFINITY;
        let mut left = f64::INFINITY;
        for _ in 0..MAX_ROUNDS {
            let started = Instant::now();
            let is_for_area = self.last.as_ref().is_some_and(|(_, contact)| contact.knows_force(self.target));
            let wanting = self.wanting(is_for_area);
            let marked = self.marked(&wanting)?;
            if !marked.contains(&true) {
                return Ok("nothing carries force");
            }
            let (nodes, most) = (self.predicted_nodes(&wanting), self.options.max_nodes);
            if nodes > most {
                return Ok("max_nodes");
            }
            if self.is_on_edge() && nodes > most / 2 {
                return Ok("a sharp edge");
            }
            let mut finer = self.mesh.clone();
            finer.refine(&marked);
            let part = finer.part();
            let mut contact = match self.solve(&part) {
                Err(ContactError::Response(ResponseError::TooLarge { .. })) => {
                    return Ok("memory_limit");
                }
                other => other?,
            };
            if contact.candidates.len() > self.options.max_nodes {
                return Ok("max_nodes");
            }
            self.mesh = finer;
            if matches!(contact.status, ContactStatus::Failed(_)) {
                self.last = Some((part, contact));
                return Ok("a complementarity problem did not end solved");
            }
            let previous = self.last.as_ref().map_or(&self.given, |(_, contact)| contact);
            contact.refinements = [&previous.refinements[..], &contact.refinements].concat();
            let error = contact.error_after(previous, is_for_area);
            contact.note_round(error, started);
            let may_settle = contact.clues.edge.is_none() && contact.active.len() >= FEW_VERTICES;
            let is_fine_on_edge = contact.clues.edge.is_some_and(|edge| {
                edge.edge_length * CELLS_PER_DEPTH_ON_EDGE <= contact.max_penetration_before
            });
            let left_before = std::mem::replace(&mut left, contact.max_penetration_after);
            let is_resolved = contact.is_free_of_penetration()
                || left > SETTLING * left_before
                || contact.candidates.len() > FEW_NODES;
            self.last = Some((part, contact));
            match error {
                Some(error) if error.worst() <= self.target && is_resolved => {
                    return Ok("target_error");
                }
                Some(_) if is_fine_on_edge => return Ok("a sharp edge"),
                Some(error) => {
                    unsettled =
                        if error.worst() > SETTLING * before && may_settle { unsettled + 1 } else { 0 };
                    before = error.worst();
                }
                None => {}
            }
            if unsettled >= UNSETTLED_ROUNDS {
                return Ok("force or area does not settle");
            }
        }
        Ok("the most rounds")
    }

    /// Vertices whose triangles are too large, by their numbers in the whole refined surface: all under force, or those at the
    /// rim where the force is known well enough and the area is not.
    fn wanting(&self, is_for_area: bool) -> Vec<usize> {
        let Some((part, contact)) = &self.last else { return self.given.pressed() };
        let active = contact.pressed();
        if !is_for_area {
            return active.into_iter().map(|vertex| part.number(vertex)).collect();
        }
        let is_free = |&other: &u32| contact.node_force[other as usize] == 0.0;
        let at_rim = |&vertex: &usize| part.surface.neighbours(vertex).iter().any(is_free);
        active.into_iter().filter(at_rim).map(|vertex| part.number(vertex)).collect()
    }

    /// Triangles to cut.
    fn marked(&self, wanting: &[usize]) -> Result<Vec<bool>, ContactError> {
        let mut marked = loaded(&self.mesh, wanting);
        if self.last.is_none() {
            add_pressed_middles(&self.mesh, &self.given.gap, &self.given.obstacle, &mut marked)?;
        }
        Ok(marked)
    }

    /// Contact nodes that the next round will have at the least: edges are halved around those wanting.
    fn predicted_nodes(&self, wanting: &[usize]) -> usize {
        let contact = self.last.as_ref().map_or(&self.given, |(_, contact)| contact);
        contact.candidates.len() + 3 * wanting.len()
    }

    /// Whether a sharp edge carries force, so that no mesh is the last.
    fn is_on_edge(&self) -> bool {
        self.last.as_ref().is_some_and(|(_, contact)| contact.clues.edge.is_some())
    }

    /// The contact on a finer mesh.
    fn solve(&self, part: &RefinedSurface) -> Result<Contact, ContactError> {
        if self.options.is_interrupted() {
            return Err(ContactError::Interrupted { stage: "refinement" });
        }
        let started = Instant::now();
        let mut scene = self.placement.scene(&part.surface, true)?;
        scene.inherited = Some(self.inherited_by(part));
        let mut report = Report::default();
        if self.placement.press.is_some() {
            report.clock("first_touch", started);
        }
        let skin = self.skin.refined(part)?.expect("a skin that was refined before");
        solve_in_place(&part.surface, &scene, &*skin, self.options, report)
    }

    /// What a refined part takes over from the given mesh.
    pub fn inherited_by(&self, part: &RefinedSurface) -> Inherited {
        let fingers = &self.given.drawing.fingers;
        Inherited {
            finger_of: part.inherit(|vertex| fingers.finger_of(vertex), |a, b| a.or(*b)),
            cuts: Cuts::of(self.given.surface(), self.skin).on_refined(part),
        }
    }

    /// Puts a contact at another depth in the place of the last one, on the same mesh.
    pub fn replace_last(&mut self, mut contact: Contact, started: Instant) {
        let Some((_, last)) = &mut self.last else { return };
        let mut known = std::mem::take(&mut last.refinements);
        known.pop();
        known.append(&mut contact.refinements);
        contact.refinements = known;
        let error = match contact.status {
            ContactStatus::Solved => MeshError::carried_over(last, &contact),
            _ => None,
        };
        contact.note_round(error, started);
        *last = contact;
    }

    /// The last contact on a refined mesh, with the larger of what force and area leave.
    pub fn last_figures(&self) -> Option<(&Contact, f64)> {
        let (_, contact) = self.last.as_ref()?;
        let accuracy = &contact.accuracy;
        Some((contact, accuracy.mesh_error?.max(accuracy.area_error?)))
    }

    /// The last contact in the numbers of the whole skin, with why no further round followed.
    pub fn conclude(self, reason: &'static str) -> Result<Contact, ContactError> {
        let mut contact = match self.last {
            None => self.given,
            Some((part, contact)) => into_whole(self.given, contact, &part, self.mesh)?,
        };
        contact.warn_of_refinement(reason, self.target);
        Ok(contact.concluded(reason))
    }
}

impl Contact {
    /// Vertices under force; those that penetrate where averages over their triangles feel nothing of it.
    fn pressed(&self) -> Vec<usize> {
        if !self.active.is_empty() {
            return self.active.clone();
        }
        let may_touch = self.surface().skin_mask();
        (0..self.gap.len()).filter(|&vertex| may_touch[vertex] && self.gap[vertex] < 0.0).collect()
    }

    /// Whether the mesh costs so little of the force that more of it is for the area alone.
    fn knows_force(&self, target: f64) -> bool {
        self.accuracy.mesh_error.is_some_and(|error| error < SMALL_SHARE * target)
    }

    /// Whether the mesh is so fine that between its vertices next to no penetration is left; more may stay on sharp edges
    /// and in Galerkin form.
    pub(crate) fn is_free_of_penetration(&self) -> bool {
        self.clues.edge.is_some()
            || self.accuracy.discretization == Discretization::Galerkin
            || self.max_penetration_after <= SMALL_PENETRATION * self.max_penetration_before
    }

    /// What the mesh is estimated to cost after `previous`; `None` without contact.
    ///
    /// * `is_for_area`: whether the rim alone was refined since
    fn error_after(&self, previous: &Contact, is_for_area: bool) -> Option<MeshError> {
        if self.status != ContactStatus::Solved {
            return None;
        }
        if previous.status != ContactStatus::Solved {
            return Some(MeshError::of_cells(self));
        }
        let mut error = MeshError::of_rounds(previous, self);
        if is_for_area {
            // Nothing but the rim was refined.
            let known = &previous.accuracy;
            error.force = error.force.max(known.mesh_error.unwrap_or(0.0));
            error.pressure = error.pressure.max(known.max_pressure_error.unwrap_or(0.0));
        }
        Some(error)
    }

    /// Adds what this round found.
    fn note_round(&mut self, error: Option<MeshError>, started: Instant) {
        let body = self.clues.body.map_or(0.0, |doubt| doubt.force_error);
        self.accuracy.mesh_error = error.map(|error| error.force);
        self.accuracy.body_error = error.map(|_| body);
        self.accuracy.force_error = error.map(|error| error.force + body);
        self.accuracy.area_error = error.map(|error| error.area);
        let is_infinite = self.clues.edge.is_some();
        self.accuracy.max_pressure_error =
            error.map(|error| if is_infinite { f64::INFINITY } else { error.pressure });
        self.refinements.push(Refinement {
            kind: "mesh",
            nodes: self.candidates.len(),
            force: self.resultant.force,
            contact_area: Some(self.resultant.contact_area),
            max_pressure: Some(self.resultant.max_pressure),
            force_error: self.accuracy.force_error,
            area_error: self.accuracy.area_error,
            max_penetration: self.max_penetration_after,
            seconds: started.elapsed().as_secs_f64(),
            reason: "",
        });
    }

    /// Says why no further round followed.
    fn concluded(mut self, reason: &'static str) -> Self {
        if self.status == ContactStatus::NoContact {
            self.leave_out("estimates of error", "there is no contact");
        }
        self.refinements.last_mut().expect("a round was noted").reason = reason;
        self
    }
}
