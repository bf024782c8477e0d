//! A press to a force or an overlap.

use std::time::Instant;

use crate::contact::error::{ContactError, PressedContact};
use crate::contact::outcome::{Contact, ContactStatus};
use crate::contact::reach::on_mesh::{JUMPS, OnMesh, Reached};
use crate::contact::reach::on_refined::{MeshSearch, Searched, search_on_refined};
use crate::contact::reach::search::Search;
use crate::contact::reach::target::{Quantity, Target};
use crate::contact::refine::given::end_unrefined;
use crate::contact::refine::rounds::Rounds;
use crate::contact::report::record::add_timings;
use crate::contact::setup::Setup;

/// First depth tried for a force, in sizes of the obstacle, where that is smaller than the edges of the mesh.
const FIRST_OF_OBSTACLE: f64 = 0.1;

/// A target, and what is pressed on what.
struct Task<'a> {
    setup: Setup<'a>,
    target: Target,
}

/// Brings the obstacle to where the contact reaches the target: on the given mesh, then on the one refined there.
pub(crate) fn reach(setup: Setup, target: Target) -> Result<Contact, ContactError> {
    Task { setup, target }.run()
}

/// The contact on the given mesh that reaches the target, or jumps over it where a finer mesh follows.
pub(crate) fn reach_on(on_given: &OnMesh, target: Target) -> Result<Contact, ContactError> {
    let task = Task { setup: on_given.setup, target };
    let started = Instant::now();
    match task.begin_on(on_given)? {
        Reached::Goal { contact, .. } => Ok(contact),
        Reached::Short { contact, why, .. } => {
            let placement = task.setup.at(contact.pressed_depth());
            let contact = end_unrefined(contact, started, placement, task.setup.skin)?;
            Err(task.missed(contact, &target.quantity.power(), why))
        }
    }
}

impl Task<'_> {
    fn run(&self) -> Result<Contact, ContactError> {
        let started = Instant::now();
        let on_given = OnMesh::given(self.setup)?;
        let (contact, found) = match self.begin_on(&on_given)? {
            Reached::Goal { contact, power } => (contact, Searched { hint: power, why: None }),
            Reached::Short { contact, why, .. } => {
                let power = self.target.quantity.power();
                (contact, Searched { hint: power, why: Some(why) })
            }
        };
        search_on_refined(self, &on_given, started, contact, found)
    }

    /// The search on the given mesh, where another follows on a finer one: what a coarse mesh jumps over that may not.
    fn begin_on(&self, on_given: &OnMesh) -> Result<Reached, ContactError> {
        match self.search_on(on_given)? {
            Reached::Short { contact, above: Some(above), .. } if self.setup.may_refine()? => {
                let mut beyond = on_given.solve(above)?;
                add_timings(&mut beyond.timings, &contact.timings);
                Ok(Reached::Goal { contact: beyond, power: self.target.quantity.power() })
            }
            reached => Ok(reached),
        }
    }

    /// The search on the given mesh.
    fn search_on(&self, on_given: &OnMesh) -> Result<Reached, ContactError> {
        let Setup { surface, obstacle, .. } = self.setup;
        let first = match self.target.quantity {
            Quantity::Force => {
                let of_obstacle = obstacle.bounding_box().map_or(f64::INFINITY, |bounds| bounds.diagonal());
                surface.mean_edge_length().min(FIRST_OF_OBSTACLE * of_obstacle)
            }
            Quantity::Overlap => self.target.value,
        };
        on_given.reach(self.target.quantity, &self.setup.search(self.target, first), None, None)
    }
}

impl MeshSearch for Task<'_> {
    /// The power of the depth that the quantity rises with.
    type Hint = f64;

    fn search_again(&self, rounds: &mut Rounds, &power: &f64) -> Result<Option<Searched<f64>>, ContactError> {
        let started = Instant::now();
        let Some((part, last)) = rounds.meshes.last.as_ref() else { return Ok(None) };
        if matches!(last.status, ContactStatus::Failed(_)) {
            return Ok(None);
        }
        let value = self.target.quantity.of(last, &self.setup.approach.direction);
        if (value / self.target.value - 1.0).abs() <= Search::TOLERANCE {
            return Ok(Some(Searched { hint: power, why: None }));
        }
        let skin = self.setup.refined_skin(part)?;
        let on_part = OnMesh::refined(self.setup, &rounds.meshes, part, &*skin)?;
        let past = on_part.touch.past(last);
        let is_known = past > 0.0 && value > 0.0;
        let first = if past > 0.0 { past } else { part.surface.mean_edge_length() };
        let known_point = is_known.then_some((past, value));
        let search = Search { power, known: known_point, ..self.setup.search(self.target, first) };
        let known = rounds.known_on(part);
        let (mut contact, why) =
            match on_part.reach(self.target.quantity, &search, Some(known), Some(last))? {
                Reached::Goal { contact, .. } => (contact, None),
                Reached::Short { contact, why, .. } => (contact, Some(why)),
            };
        add_timings(&mut contact.timings, &last.timings);
        rounds.meshes.replace_last(contact, started, &*skin, self.setup.options)?;
        Ok(Some(Searched { hint: power, why }))
    }

    fn way_between(&self, from: &Contact, to: &Contact) -> f64 {
        to.travel - from.travel
    }

    fn unless_missed(&self, contact: Contact, _: &f64) -> Result<Contact, ContactError> {
        let value = self.target.quantity.of(&contact, &self.setup.approach.direction);
        // As jumps of the quantity are allowed to keep it.
        let is_near = (value / self.target.value - 1.0).abs() <= Search::UNEVENNESS;
        if is_near || matches!(contact.status, ContactStatus::Failed(_)) {
            return Ok(contact);
        }
        Err(self.missed(contact, &self.target.quantity.power(), JUMPS.into()))
    }

    fn missed(&self, contact: Contact, _: &f64, why: String) -> ContactError {
        let (goal, unit) = self.target.quantity.name_and_unit();
        let found = self.target.quantity.of(&contact, &self.setup.approach.direction);
        let depth = contact.pressed_depth();
        let contact = PressedContact(Box::new(contact));
        ContactError::NotReached { goal, unit, asked: self.target.value, found, depth, why, contact }
    }
}
