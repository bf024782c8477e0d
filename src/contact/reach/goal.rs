//! A press to a force or an overlap.

use std::time::Instant;

use crate::contact::error::{ContactError, PressedContact};
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd};
use crate::contact::reach::on_mesh::{OnMesh, Reached};
use crate::contact::reach::search::Search;
use crate::contact::reach::target::{Quantity, Target};
use crate::contact::refine::rounds::{Begun, Rounds, begin, end_unrefined};
use crate::contact::scene::Placement;
use crate::contact::setup::Setup;

/// First depth tried for a force, in sizes of the obstacle, where that is smaller than the edges of the mesh.
const FIRST_OF_OBSTACLE: f64 = 0.1;
/// Refinements at the most: one at the depth that the given mesh asks for, one at that of the refined mesh.
pub(crate) const REFINEMENTS: usize = 2;
/// How much farther than the part of the skin that was refined was made for, in mean edges of the given mesh, an
/// obstacle may come.
pub(crate) const FARTHER: f64 = 0.5;

/// A target, and what is pressed on what.
struct Task<'a> {
    setup: Setup<'a>,
    target: Target,
}

/// Brings the obstacle to where the contact reaches the target: on the given mesh, then on the one refined there.
pub(crate) fn reach(setup: Setup, target: Target) -> Result<Contact, ContactError> {
    Task { setup, target }.run()
}

impl Task<'_> {
    fn run(&self) -> Result<Contact, ContactError> {
        let mut started = Instant::now();
        let Setup { surface, obstacle, skin, options, .. } = self.setup;
        let on_given = OnMesh::given(self.setup)?;
        let first = match self.target.quantity {
            Quantity::Force => {
                let of_obstacle = obstacle.bounding_box().map_or(f64::INFINITY, |bounds| bounds.diagonal());
                surface.mean_edge_length().min(FIRST_OF_OBSTACLE * of_obstacle)
            }
            Quantity::Overlap => self.target.value,
        };
        let search = Search {
            value: self.target.value,
            first,
            power: self.target.quantity.power(),
            limit: self.setup.limit(),
            known: None,
        };
        let (mut given, power) = match on_given.reach(self.target.quantity, &search, None, None)? {
            Reached::Goal { contact, power } => (contact, power),
            Reached::Short { contact, why } => {
                let placement = self.at(&contact);
                let contact = end_unrefined(contact, started, placement, skin)?;
                return Err(self.not_reached(contact, why));
            }
        };
        let mut before = None;
        for refinement in 1..=REFINEMENTS {
            let placement = self.at(&given);
            let travel = given.travel;
            let mut rounds = match begin(given, started, placement, skin, options)? {
                Begun::Ended(contact) => return self.unless_missed(*contact),
                Begun::Rounds(rounds) => *rounds,
            };
            let end = rounds.run()?;
            let refined_for = rounds.meshes.finest().resultant.contact_area;
            let met = (end == RefinementEnd::Target).then_some(rounds.target);
            let Some(why) = self.search_again(&mut rounds, power)? else {
                let (rounds, end) = before.unwrap_or((rounds, end));
                return rounds.conclude(end);
            };
            if let Err(why) = why {
                return Err(self.not_reached(rounds.conclude(end)?, why));
            }
            let has_gone_farther =
                |found: &Contact| found.travel - travel > FARTHER * surface.mean_edge_length();
            let found = rounds.meshes.outgrown(met, refined_for, has_gone_farther);
            let Some(found) = found.filter(|_| refinement < REFINEMENTS) else {
                return rounds.conclude(end);
            };
            started = Instant::now();
            given = on_given.solve(on_given.touch.past(found))?;
            before = Some((rounds, end));
        }
        unreachable!("the last refinement returns")
    }

    /// The contact, where it is as near to the target as jumps of the quantity are allowed to keep it.
    fn unless_missed(&self, contact: Contact) -> Result<Contact, ContactError> {
        let value = self.target.quantity.of(&contact, &self.setup.approach.direction);
        let is_near = (value / self.target.value - 1.0).abs() <= Search::UNEVENNESS;
        if is_near || matches!(contact.status, ContactStatus::Failed(_)) {
            return Ok(contact);
        }
        Err(self.not_reached(contact, "it jumps there from depth to depth".into()))
    }

    /// Searches the depth on the mesh that was refined last, and puts the contact found in the place of the one there.
    ///
    /// `None` where nothing was refined or the last contact did not end solved; `Err` says why the target is out of reach.
    fn search_again(
        &self,
        rounds: &mut Rounds,
        power: f64,
    ) -> Result<Option<Result<(), String>>, ContactError> {
        let started = Instant::now();
        let Some((part, last)) = rounds.meshes.last.as_ref() else { return Ok(None) };
        if matches!(last.status, ContactStatus::Failed(_)) {
            return Ok(None);
        }
        let skin = self.setup.refined_skin(part)?;
        let on_part = OnMesh::refined(self.setup, &rounds.meshes, part, &*skin)?;
        let past = on_part.touch.past(last);
        let value = self.target.quantity.of(last, &self.setup.approach.direction);
        if (value / self.target.value - 1.0).abs() <= Search::CLOSE {
            return Ok(Some(Ok(())));
        }
        let is_known = past > 0.0 && value > 0.0;
        let search = Search {
            value: self.target.value,
            first: if past > 0.0 { past } else { part.surface.mean_edge_length() },
            power,
            limit: self.setup.limit(),
            known: is_known.then_some((past, value)),
        };
        let known = rounds.known_on(part);
        let (contact, end) = match on_part.reach(self.target.quantity, &search, Some(known), Some(last))? {
            Reached::Goal { contact, .. } => (contact, Ok(())),
            Reached::Short { contact, why } => (contact, Err(why)),
        };
        rounds.meshes.replace_last(contact, started, &*skin, self.setup.options)?;
        Ok(Some(end))
    }

    /// The press to the depth of a contact.
    fn at(&self, contact: &Contact) -> Placement<'_> {
        self.setup.at(contact.pressed_depth())
    }

    fn not_reached(&self, contact: Contact, why: String) -> ContactError {
        let (goal, unit) = self.target.quantity.name_and_unit();
        let found = self.target.quantity.of(&contact, &self.setup.approach.direction);
        let depth = contact.pressed_depth();
        let contact = PressedContact(Box::new(contact));
        ContactError::NotReached { goal, unit, asked: self.target.value, found, depth, why, contact }
    }
}
