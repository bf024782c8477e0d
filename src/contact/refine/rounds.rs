//! Solve, look where the mesh is too coarse, refine it there, solve again.

use std::collections::HashMap;
use std::time::Instant;

use crate::contact::equilibrium::group::MOST_BY_PIVOTS;
use crate::contact::error::ContactError;
use crate::contact::figures::resultant::LoadedVertex;
use crate::contact::gap::initial::search_distance_in_overlap;
use crate::contact::in_place::{InPlace, Known};
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Clues, Contact, ContactStatus};
use crate::contact::refine::estimate::MeshError;
use crate::contact::refine::mark::{add_pressed_middles, faces_near, loaded};
use crate::contact::refine::whole::into_whole;
use crate::contact::report::cuts::Cuts;
use crate::contact::report::record::Report;
use crate::contact::scene::{Inherited, Placement};
use crate::lcp::solution::LcpStatus;
use crate::response::error::ResponseError;
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
            if let Some(reason) = self.doubt()
                && nodes > most / 2
            {
                return Ok(reason);
            }
            let mut finer = self.mesh.clone();
            finer.refine(&marked);
            let part = finer.part();
            let mut contact = match self.solve(&part) {
                Err(ContactError::Response(ResponseError::TooLarge { .. })) => {
                    return Ok("memory_limit");
                }
                other => match other? {
                    Some(contact) => contact,
                    None => return Ok("max_nodes"),
                },
            };
            if matches!(contact.status, ContactStatus::Failed(LcpStatus::Breakdown | LcpStatus::PivotLimit))
                && contact.candidates.len() > MOST_BY_PIVOTS
            {
                return Ok("a problem of many nodes that block exchanges do not end");
            }
            self.mesh = finer;
            let has_failed = matches!(contact.status, ContactStatus::Failed(_));
            let previous = self.last.as_ref().map_or(&self.given, |(_, contact)| contact);
            contact.refinements = [&previous.refinements[..], &contact.refinements].concat();
            let error = if has_failed { None } else { contact.error_after(previous, is_for_area) };
            contact.note_round(error, started);
            if has_failed {
                self.last = Some((part, contact));
                return Ok("a complementarity problem did not end solved");
            }
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

    /// Why no mesh may be fine enough.
    fn doubt(&self) -> Option<&'static str> {
        let (_, Contact { clues, .. }) = self.last.as_ref()?;
        match clues {
            Clues { edge: Some(_), .. } => Some("a sharp edge"),
            Clues { is_unsettled: true, .. } => Some("gaps that do not settle"),
            _ => None,
        }
    }

    /// The contact on a finer mesh; `None` where that has too many nodes.
    fn solve(&self, part: &RefinedSurface) -> Result<Option<Contact>, ContactError> {
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
        let most = self.options.max_nodes;
        let gaps = InPlace::gaps(&part.surface, &scene, self.options, &mut report)?;
        if gaps.penetrating.len() > most {
            return Ok(None);
        }
        let skin = self.skin.refined(part)?.expect("a skin that was refined before");
        let known = Known::of_active(self.expected(part));
        let contact =
            InPlace::solve_gaps(gaps, &*skin, Some(&known), self.options, report)?.contact(self.options)?;
        Ok((contact.candidates.len() <= most).then_some(contact))
    }

    /// Vertices of a finer part that are expected to carry force: those that do, those between two of them, and those
    /// beside one that the rim lies farther out of than half-way to its neighbours.
    fn expected(&self, part: &RefinedSurface) -> Vec<usize> {
        let given_count = self.given.surface().vertices().len();
        let (surface, contact, known) = match &self.last {
            None => (self.given.surface(), &self.given, given_count),
            Some((last, contact)) => (&last.surface, contact, given_count + last.parents().len()),
        };
        let number = |vertex| self.last.as_ref().map_or(vertex, |(last, _)| last.number(vertex));
        let is_far_in = |one: &LoadedVertex| one.contact_area > surface.vertex_areas()[one.vertex];
        let loaded: HashMap<usize, bool> =
            contact.loaded.list.iter().map(|one| (number(one.vertex), is_far_in(one))).collect();
        // `None` without force, else whether the rim is far.
        let mut found: Vec<Option<bool>> = Vec::with_capacity(part.surface.vertices().len());
        for vertex in 0..part.surface.vertices().len() {
            let number = part.number(vertex);
            found.push(if number < known {
                loaded.get(&number).copied()
            } else {
                let ends = part.parents()[vertex - part.given_vertices().len()].map(|end| found[end]);
                let is_loaded = ends.contains(&Some(true)) || !ends.contains(&None);
                is_loaded.then_some(false)
            });
        }
        (0..found.len()).filter(|&vertex| found[vertex].is_some()).collect()
    }

    /// What a refined part takes over from the given mesh.
    pub fn inherited_by(&self, part: &RefinedSurface) -> Inherited {
        let fingers = &self.given.drawing.fingers;
        Inherited {
            finger_of: part.inherit(|vertex| fingers.finger_of(vertex), |a, b| a.or(*b)),
            cuts: Cuts::of(self.given.surface(), self.skin).on_refined(part),
            search_distance: search_distance_in_overlap(self.given.surface()),
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
