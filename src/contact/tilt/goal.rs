//! A press to a depth, a force or an overlap with an obstacle that turns to its balance.

use std::time::Instant;

use nalgebra::{DMatrix, DVector, Point3};

use crate::contact::error::{ContactError, PressedContact};
use crate::contact::outcome::{Contact, ContactStatus};
use crate::contact::reach::goal::reach_on;
use crate::contact::reach::on_mesh::OnMesh;
use crate::contact::reach::on_refined::{MeshSearch, Searched, search_on_refined};
use crate::contact::reach::search::Search;
use crate::contact::reach::target::{Aim, Target};
use crate::contact::refine::rounds::Rounds;
use crate::contact::report::record::add_timings;
use crate::contact::report::warning::WarningKind;
use crate::contact::setup::Setup;
use crate::contact::tilt::axes::Turn;
use crate::contact::tilt::rest::{Beginning, Ended, Place, find};
use crate::contact::tilt::tilted::Tilted;
use crate::contact::tilt::turns::Turns;
use crate::response::skin::kept::KeptSkin;

/// Moment that is left, over force times lever; the promise is 1e-6.
const TOLERANCE: f64 = 0.9e-6;
/// The same where contacts that are solved to a gap change by jumps.
const UNEVENNESS: f64 = 1e-3;
/// Share of the force at the beginning below which the obstacle swings free.
const FREE_FORCE: f64 = 1e-4;
/// That many times as much is left of a force where it ends in doing so.
const SWINGING_FORCE: f64 = 100.0;
/// Length of the first step and of those that a stiffness is measured with, as shares of the depth past the touch.
const STEP_LENGTHS: [f64; 2] = [0.5, 1e-2];

/// How the obstacle stands on one mesh.
#[derive(Clone)]
pub(crate) struct Posture {
    /// The angles (rad) about the axes.
    angles: Vec<f64>,
    stiffness: Option<DMatrix<f64>>,
    /// Of the forces about the point (m), to measure angles in lengths.
    lever: f64,
}

impl Tilted<'_> {
    /// Brings the obstacle to its balance: on the given mesh, then on the one refined there.
    pub fn run(&self) -> Result<Contact, ContactError> {
        let started = Instant::now();
        let Setup { surface, obstacle, options, approach, .. } = self.setup;
        let on_given = OnMesh::given(self.setup)?;
        let first = match self.aim {
            Aim::Depth(depth) => {
                let mut first = on_given.solve(depth - on_given.touch.depth)?;
                on_given.add_first_touch(&mut first.timings);
                first
            }
            Aim::Value(target) => reach_on(&on_given, target)?,
        };
        let upright =
            Posture { angles: vec![0.0; self.axes.len()], stiffness: None, lever: self.lever(&first) };
        let (contact, mut found) = self.settle(&on_given, first, upright)?;
        if contact.status == ContactStatus::Solved && self.setup.may_refine()? {
            // A contact that changes by jumps on a coarse mesh may not on a finer one.
            found.why = None;
        }
        let approach = approach.on_part(surface, obstacle, options)?;
        let refined = Self { setup: Setup { approach, ..self.setup }, axes: self.axes.clone(), ..*self };
        let on_given = OnMesh { setup: refined.setup, ..on_given };
        search_on_refined(&refined, &on_given, started, contact, found)
    }

    /// Turns the obstacle until nothing is left to turn it, at the depth, force or overlap that is asked for.
    ///
    /// * `first`: a contact near that, in the posture `from`
    fn settle(
        &self,
        on: &OnMesh,
        mut first: Contact,
        from: Posture,
    ) -> Result<(Contact, Searched<Posture>), ContactError> {
        let kept = KeptSkin::new(on.setup.skin);
        let mut turns = Turns::new(self, on, &kept, &first, &from.angles)?;
        let past = turns.past();
        // On a mesh as coarse as the contact nothing may carry force: there is nothing to be balanced yet.
        let is_loaded = first.status == ContactStatus::Solved && first.resultant.force.norm() > 0.0;
        if !is_loaded || past <= 0.0 {
            return Ok((first, Searched { hint: from, why: None }));
        }
        let mut timings = std::mem::take(&mut first.timings);
        if self.is_off_value(&first, Search::TOLERANCE) {
            first = match turns.contact(&from.angles)? {
                Some(contact) => contact,
                None => {
                    add_timings(&mut timings, turns.timings());
                    first.timings = timings;
                    let why = Some("what is asked for is not reached as the obstacle stands".to_string());
                    return Ok((first, Searched { hint: from, why }));
                }
            };
        }
        let Posture { angles, stiffness, lever } = from;
        let at = DVector::from_vec(angles) * lever;
        let angles_at = |at: &DVector<f64>| -> Vec<f64> { (at / lever).as_slice().to_vec() };
        let begun = Beginning { at, stiffness, lengths: STEP_LENGTHS.map(|share| share * past) };
        let free = FREE_FORCE * first.resultant.force.norm();
        let first = self.place(first, lever, free);
        let room = |at: &DVector<f64>, step: &DVector<f64>| {
            let end = angles_at(&(at + step));
            self.room(&angles_at(at), &end)
        };
        let ended = find(begun, first, room, |at| -> Result<_, ContactError> {
            let contact = turns.contact(&angles_at(at))?;
            Ok(contact.map(|contact| self.place(contact, lever, free)))
        })?;
        let Ended { at, found: mut contact, stiffness, mut why } = ended;
        if why.is_some() && contact.resultant.force.norm() < SWINGING_FORCE * free {
            why = Some("the obstacle swings free of the skin");
        }
        let why = why.filter(|reason| !self.is_nearly_balanced(&mut contact, reason));
        if let Aim::Value(Target { quantity, value }) = self.aim {
            on.warn_of_jump(quantity, value, &mut contact);
        }
        add_timings(&mut timings, turns.timings());
        contact.timings = timings;
        let hint = Posture { angles: angles_at(&at), stiffness, lever };
        Ok((contact, Searched { hint, why: why.map(String::from) }))
    }

    /// Whether a contact is not at the value asked for.
    fn is_off_value(&self, contact: &Contact, tolerance: f64) -> bool {
        let Aim::Value(Target { quantity, value }) = self.aim else { return false };
        (quantity.of(contact, &self.setup.approach.direction) / value - 1.0).abs() > tolerance
    }

    /// Whether next to nothing is left to turn the obstacle, of which the contact then warns.
    ///
    /// * `reason`: why it is no less
    fn is_nearly_balanced(&self, contact: &mut Contact, reason: &str) -> bool {
        let is_balanced = self.off(contact) <= UNEVENNESS / TOLERANCE;
        if is_balanced {
            let message = format!(
                "the moment about the tilt axes is balanced to {:.1e} of force times lever and no better: {reason}",
                TOLERANCE * self.off(contact)
            );
            contact.warn(WarningKind::Refinement, message);
        }
        is_balanced
    }

    /// What a contact says of the way to the balance.
    ///
    /// * `free`: force below which there is nothing to be balanced (N)
    fn place(&self, contact: Contact, lever: f64, free: f64) -> Place<Contact> {
        let gradient = DVector::from_vec(self.moments(&contact)) / lever;
        let is_free = contact.resultant.force.norm() < free;
        let off = if is_free { f64::INFINITY } else { self.off(&contact) };
        Place { gradient, off, is_free, found: contact }
    }

    /// How far from balance a contact is: 1 is near enough.
    fn off(&self, contact: &Contact) -> f64 {
        let force = contact.resultant.force.norm();
        if force == 0.0 {
            return f64::INFINITY;
        }
        DVector::from_vec(self.moments(contact)).norm() / (force * self.lever(contact)) / TOLERANCE
    }
}

impl MeshSearch for Tilted<'_> {
    type Hint = Posture;

    fn turn(&self, posture: &Posture) -> Option<Turn> {
        Some(self.turned_by(&posture.angles))
    }

    fn search_again(
        &self,
        rounds: &mut Rounds,
        posture: &Posture,
    ) -> Result<Option<Searched<Posture>>, ContactError> {
        let started = Instant::now();
        let Some((part, last)) = rounds.meshes.last.as_ref() else { return Ok(None) };
        if last.status != ContactStatus::Solved {
            return Ok(None);
        }
        let skin = self.setup.refined_skin(part)?;
        let on_part = OnMesh::refined(self.setup, &rounds.meshes, part, &*skin)?;
        let (mut contact, found) = self.settle(&on_part, last.clone(), posture.clone())?;
        on_part.add_first_touch(&mut contact.timings);
        rounds.meshes.replace_last(contact, started, &*skin, self.setup.options)?;
        Ok(Some(found))
    }

    /// The farthest that the obstacle has moved at a vertex under force.
    fn way_between(&self, from: &Contact, to: &Contact) -> f64 {
        let surface = to.surface();
        let motion = from.obstacle.pose() * to.obstacle.pose().inverse();
        let moved = |&vertex: &usize| {
            let place = Point3::from(surface.vertices()[vertex]);
            (motion * place - place).norm()
        };
        to.active.iter().map(moved).fold(0.0, f64::max)
    }

    fn unless_missed(&self, contact: Contact, posture: &Posture) -> Result<Contact, ContactError> {
        let is_near =
            self.off(&contact) <= UNEVENNESS / TOLERANCE && !self.is_off_value(&contact, Search::UNEVENNESS);
        if contact.status != ContactStatus::Solved || is_near {
            return Ok(contact);
        }
        Err(self.missed(contact, posture, "it does not settle".to_string()))
    }

    fn missed(&self, contact: Contact, posture: &Posture, why: String) -> ContactError {
        let why = match contact.status {
            _ if contact.resultant.force.norm() > 0.0 => why,
            ContactStatus::NoContact => "it has left the skin".to_string(),
            _ => "nothing carries force there, as the mesh is coarser than the contact".to_string(),
        };
        ContactError::NotBalanced {
            point: self.point_at(&contact).into(),
            moment: DVector::from_vec(self.moments(&contact)).norm(),
            force: contact.resultant.force.dot(&self.setup.approach.direction),
            asked: self.force(),
            angle: self.turned_by(&posture.angles).rotation.angle(),
            why,
            contact: PressedContact(Box::new(contact)),
        }
    }
}
