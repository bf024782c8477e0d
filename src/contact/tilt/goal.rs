//! A press to a depth, a force or an overlap with an obstacle that turns to its balance.

use std::time::Instant;

use nalgebra::{DMatrix, DVector, Point3, UnitQuaternion, Vector3};

use crate::contact::error::{ContactError, PressedContact};
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd};
use crate::contact::reach::goal::{FARTHER, REFINEMENTS, reach};
use crate::contact::reach::on_mesh::{OnMesh, Trials};
use crate::contact::reach::target::{Aim, Quantity, Target};
use crate::contact::refine::rounds::{Begun, Rounds, begin, end_unrefined};
use crate::contact::report::record::add_timings;
use crate::contact::report::warning::WarningKind;
use crate::contact::scene::{Approach, Placement};
use crate::contact::setup::Setup;
use crate::contact::tilt::axes::{LARGEST_ANGLE, Turn};
use crate::contact::tilt::rest::{Beginning, Ended, Place, find};
use crate::obstacle::posed::Obstacle;
use crate::response::skin::kept::KeptSkin;

/// Moment that is left, over force times lever, and error of the force; the promise is 1e-6.
const CLOSE: f64 = 0.9e-6;
/// The same where contacts that are solved to a gap change by jumps.
const UNEVEN: f64 = 1e-3;
/// Share of the force at the beginning below which the obstacle swings free.
const FREE: f64 = 1e-4;
/// That many times as much is left of a force where it ends in doing so.
const SWINGING: f64 = 100.0;
/// Length of the first step and of those that a stiffness is measured with, as shares of the depth past the touch.
const LENGTHS: [f64; 2] = [0.5, 1e-2];

/// What is pressed on what, and turns meanwhile.
pub(crate) struct Tilted<'a> {
    pub setup: Setup<'a>,
    pub aim: Aim,
    /// Unit axes, one or two.
    pub axes: Vec<Vector3<f64>>,
    /// Point that they go through, before any travel (m).
    pub point: Vector3<f64>,
}

/// Where the obstacle came to rest on one mesh.
struct Settled {
    contact: Contact,
    turn: Turn,
    /// The angles (rad) about the axes.
    angles: Vec<f64>,
    stiffness: Option<DMatrix<f64>>,
    /// Why there is no balance.
    why: Option<&'static str>,
}

impl Tilted<'_> {
    /// Brings the obstacle to its balance: on the given mesh, then on the one refined there.
    pub fn run(&self) -> Result<Contact, ContactError> {
        let mut started = Instant::now();
        let Setup { surface, obstacle, skin, options, approach } = self.setup;
        let unrefined = options.unrefined();
        let depth = match self.aim {
            Aim::Depth(depth) => depth,
            Aim::Value(target) => {
                let untilted = reach(Setup { options: &unrefined, ..self.setup }, target)?;
                untilted.pressed_depth()
            }
        };
        let on_given = OnMesh::given(self.setup)?;
        let angles = vec![0.0; self.axes.len()];
        let first = on_given.solve(depth - on_given.touch.depth)?;
        let lever = self.lever(&first);
        let mut given = self.settle(&on_given, first, angles, None, lever)?;
        if let Some(why) = given.why {
            let placement = self.placement(&given);
            let contact = given.contact.clone();
            let contact = end_unrefined(contact, started, placement, skin)?;
            return Err(self.not_balanced(contact, &given.turn, why));
        }
        let approach = approach.on_part(surface, obstacle, options)?;
        let refined = Self { setup: Setup { approach, ..self.setup }, axes: self.axes.clone(), ..*self };
        let mut before = None;
        for refinement in 1..=REFINEMENTS {
            let placement = refined.placement(&given);
            let obstacle = given.contact.obstacle.clone();
            let mut rounds = match begin(given.contact.clone(), started, placement, skin, options)? {
                Begun::Ended(contact) => return Ok(*contact),
                Begun::Rounds(rounds) => *rounds,
            };
            let end = rounds.run()?;
            let refined_for = rounds.meshes.finest().resultant.contact_area;
            let met = (end == RefinementEnd::Target).then_some(rounds.target);
            let Some(found) = refined.settle_again(&mut rounds, &given, lever)? else {
                let (rounds, end) = before.unwrap_or((rounds, end));
                return rounds.conclude(end);
            };
            if let Some(why) = found.why {
                return Err(self.not_balanced(rounds.conclude(end)?, &found.turn, why));
            }
            let has_gone_farther = |contact: &Contact| {
                self.farthest_move(&obstacle, contact) > FARTHER * surface.mean_edge_length()
            };
            let contact = rounds.meshes.outgrown(met, refined_for, has_gone_farther);
            let Some(contact) = contact.filter(|_| refinement < REFINEMENTS) else {
                return rounds.conclude(end);
            };
            started = Instant::now();
            let contact = on_given.turned(found.turn).solve(on_given.touch.past(contact))?;
            given = Settled { contact, ..found };
            before = Some((rounds, end));
        }
        unreachable!("the last refinement returns")
    }

    /// Balances the obstacle on the mesh that was refined last, and puts the contact found in the place of the one there.
    ///
    /// `None` where nothing was refined or the last contact did not end solved.
    fn settle_again(
        &self,
        rounds: &mut Rounds,
        given: &Settled,
        lever: f64,
    ) -> Result<Option<Settled>, ContactError> {
        let started = Instant::now();
        let Some((part, last)) = rounds.meshes.last.as_ref() else { return Ok(None) };
        if last.status != ContactStatus::Solved {
            return Ok(None);
        }
        let skin = self.setup.refined_skin(part)?;
        let on_part = OnMesh::refined(self.setup, &rounds.meshes, part, &*skin)?;
        let (angles, stiffness) = (given.angles.clone(), given.stiffness.clone());
        let found = self.settle(&on_part, last.clone(), angles, stiffness, lever)?;
        rounds.meshes.replace_last(found.contact.clone(), started, &*skin, self.setup.options)?;
        Ok(Some(found))
    }

    /// Turns the obstacle, and moves it under a force, until nothing is left to turn it.
    ///
    /// * `first`: the contact at the angles (rad) to begin with
    /// * `lever`: of the forces about the point (m), to measure angles in lengths
    fn settle(
        &self,
        on: &OnMesh,
        mut first: Contact,
        angles: Vec<f64>,
        stiffness: Option<DMatrix<f64>>,
        lever: f64,
    ) -> Result<Settled, ContactError> {
        let (depth, past) = (first.pressed_depth(), on.touch.past(&first));
        if first.status != ContactStatus::Solved || past <= 0.0 {
            let turn = self.turn(&angles);
            return Ok(Settled { contact: first, turn, angles, stiffness, why: None });
        }
        let is_force = self.force().is_some();
        let own_depth = is_force.then_some(depth);
        let at = own_depth.into_iter().chain(angles.iter().map(|angle| angle * lever));
        let at = DVector::from_iterator(self.axes.len() + usize::from(is_force), at);
        let angles_at = |at: &DVector<f64>| -> Vec<f64> {
            at.iter().skip(usize::from(is_force)).map(|length| length / lever).collect()
        };
        let kept = KeptSkin::new(on.setup.skin);
        let mut trials = Trials::new(&kept, None);
        let mut timings = std::mem::take(&mut first.timings);
        let started = Beginning { at, stiffness, lengths: LENGTHS.map(|share| share * past) };
        let free = FREE * first.resultant.force.norm();
        let first = self.place(first, lever, free);
        let room = |at: &DVector<f64>, step: &DVector<f64>| {
            let end = angles_at(&(at + step));
            self.room(&angles_at(at), &end)
        };
        let ended = find(started, first, room, |at| -> Result<_, ContactError> {
            self.setup.options.check_interrupt("search for the balance")?;
            let turned = on.turned(self.turn(&angles_at(at)));
            let Some(past) = self.past(&turned, is_force.then(|| at[0] - on.touch.depth), past)? else {
                return Ok(None);
            };
            let mut contact = match turned.solve_with(past, &mut trials) {
                Err(error) if error.is_of_deeper() => return Ok(None),
                other => other?,
            };
            add_timings(&mut trials.timings, &std::mem::take(&mut contact.timings));
            let is_answer = !matches!(contact.status, ContactStatus::Failed(_));
            Ok(is_answer.then(|| self.place(contact, lever, free)))
        })?;
        let Ended { at, found: mut contact, stiffness, mut why } = ended;
        if why.is_some() && !is_force && contact.resultant.force.norm() < SWINGING * free {
            why = Some("the obstacle swings free of the skin");
        }
        let why = why.filter(|reason| !self.is_nearly_balanced(&mut contact, reason));
        add_timings(&mut timings, &trials.timings);
        contact.timings = timings;
        let angles = angles_at(&at);
        Ok(Settled { contact, turn: self.turn(&angles), angles, stiffness, why })
    }

    /// Whether next to nothing is left to turn the obstacle, of which the contact then warns.
    ///
    /// * `reason`: why it is no less
    fn is_nearly_balanced(&self, contact: &mut Contact, reason: &str) -> bool {
        let is_balanced = self.off(contact) <= UNEVEN / CLOSE;
        if is_balanced {
            let message = format!(
                "the moment about the tilt axes is balanced to {:.1e} of force times lever and no better: {reason}",
                CLOSE * self.off(contact)
            );
            contact.warn(WarningKind::Refinement, message);
        }
        is_balanced
    }

    /// Way past the touch at some angles (m); `None` where the overlap is not reached.
    ///
    /// * `own`: where it is searched together with the angles
    /// * `near`: as it was at others
    fn past(&self, on: &OnMesh, own: Option<f64>, near: f64) -> Result<Option<f64>, ContactError> {
        match (self.aim, own) {
            (_, Some(past)) => Ok(Some(past.max(0.0))),
            (Aim::Value(Target { quantity: Quantity::Overlap, value }), _) => on.past_at_overlap(value, near),
            _ => Ok(Some(near)),
        }
    }

    /// What a contact says of the way to the balance.
    ///
    /// * `free`: force below which there is nothing to be balanced (N); a force to be reached pulls back by itself
    fn place(&self, contact: Contact, lever: f64, free: f64) -> Place<Contact> {
        let along = Quantity::Force.of(&contact, &self.setup.approach.direction);
        let excess = self.force().map(|force| along - force);
        let moments = self.moments(&contact);
        let parts = excess.into_iter().chain(moments.iter().map(|moment| moment / lever));
        let gradient = DVector::from_vec(parts.collect());
        let is_free = excess.is_none() && contact.resultant.force.norm() < free;
        let off = if is_free { f64::INFINITY } else { self.off(&contact) };
        Place { gradient, off, is_free, found: contact }
    }

    /// How far from balance and force a contact is: 1 is near enough.
    fn off(&self, contact: &Contact) -> f64 {
        let force = contact.resultant.force.norm();
        if force == 0.0 {
            return f64::INFINITY;
        }
        let moments = DVector::from_vec(self.moments(contact)).norm() / (force * self.lever(contact));
        let along = Quantity::Force.of(contact, &self.setup.approach.direction);
        let excess = self.force().map_or(0.0, |force| (along / force - 1.0).abs());
        moments.max(excess) / CLOSE
    }

    /// The force to be reached along the direction (N).
    fn force(&self) -> Option<f64> {
        match self.aim {
            Aim::Value(Target { quantity: Quantity::Force, value }) => Some(value),
            _ => None,
        }
    }

    /// Moments on the skin about the axes (N m).
    fn moments(&self, contact: &Contact) -> Vec<f64> {
        let point = self.point_at(contact);
        let total = contact.resultant.moment - point.cross(&contact.resultant.force);
        self.axes.iter().map(|axis| axis.dot(&total)).collect()
    }

    /// The point where it stands (m).
    fn point_at(&self, contact: &Contact) -> Vector3<f64> {
        self.point + contact.travel * self.setup.approach.direction
    }

    /// Largest distance of a vertex under force from the point, or from the axis where that is one (m); the size of the skin
    /// without any.
    fn lever(&self, contact: &Contact) -> f64 {
        let point = self.point_at(contact);
        let surface = contact.surface();
        let distance = |&vertex: &usize| {
            let arm = surface.vertices()[vertex] - point;
            match &self.axes[..] {
                [axis] => axis.cross(&arm).norm(),
                _ => arm.norm(),
            }
        };
        let largest = contact.active.iter().map(distance).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { surface.bounding_box().diagonal() }
    }

    fn turn(&self, angles: &[f64]) -> Turn {
        let turn: Vector3<f64> = self.axes.iter().zip(angles).map(|(axis, &angle)| angle * axis).sum();
        Turn { rotation: UnitQuaternion::from_scaled_axis(turn), point: self.point }
    }

    /// Share of a step between angles (rad) that stays within the largest angle.
    fn room(&self, from: &[f64], to: &[f64]) -> f64 {
        let total = |angles: &[f64]| -> Vector3<f64> {
            self.axes.iter().zip(angles).map(|(axis, &angle)| angle * axis).sum()
        };
        let (from, to) = (total(from), total(to));
        if to.norm() <= LARGEST_ANGLE {
            return 1.0;
        }
        // |from + s way| = largest
        let way = to - from;
        let (a, b) = (way.norm_squared(), from.dot(&way));
        let c = from.norm_squared() - LARGEST_ANGLE * LARGEST_ANGLE;
        ((b * b - a * c).max(0.0).sqrt() - b) / a
    }

    /// How far an obstacle has moved where a contact is (m).
    fn farthest_move(&self, before: &Obstacle, contact: &Contact) -> f64 {
        let surface = contact.surface();
        let motion = before.pose() * contact.obstacle.pose().inverse();
        let moved = |&vertex: &usize| {
            let place = Point3::from(surface.vertices()[vertex]);
            (motion * place - place).norm()
        };
        contact.active.iter().map(moved).fold(0.0, f64::max)
    }

    /// The press to where the obstacle came to rest.
    fn placement(&self, settled: &Settled) -> Placement<'_> {
        let depth = settled.contact.pressed_depth();
        let approach = Approach { turn: Some(settled.turn), ..self.setup.approach };
        Setup { approach, ..self.setup }.at(depth)
    }

    fn not_balanced(&self, contact: Contact, turn: &Turn, why: &str) -> ContactError {
        ContactError::NotBalanced {
            point: self.point_at(&contact).into(),
            moment: DVector::from_vec(self.moments(&contact)).norm(),
            force: contact.resultant.force.norm(),
            angle: turn.rotation.angle(),
            why: why.into(),
            contact: PressedContact(Box::new(contact)),
        }
    }
}
