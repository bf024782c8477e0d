//! Contacts with the obstacle turned, each at the depth, force or overlap that is asked for.

use crate::contact::error::ContactError;
use crate::contact::outcome::{Contact, ContactStatus, Timing};
use crate::contact::reach::on_mesh::{OnMesh, Trials};
use crate::contact::reach::target::{Aim, Quantity, Target};
use crate::contact::report::record::add_timings;
use crate::contact::scene::Start;
use crate::contact::tilt::tilted::Tilted;
use crate::response::skin::elastic::ElasticSkin;

/// Overlap, over that at the beginning, beyond which a step went too far: it may put a product through a hand.
const MOST_OVERLAPS: f64 = 10.0;

/// One contact after the other on one mesh.
pub(super) struct Turns<'a> {
    tilted: &'a Tilted<'a>,
    on: &'a OnMesh<'a>,
    trials: Trials<'a>,
    last: Last,
}

/// What the next contact takes over from the last one.
struct Last {
    /// (rad)
    angles: Vec<f64>,
    /// Arms of the force along the press about the axes (m).
    arms: Vec<f64>,
    /// Of the press (m), and the way past the touch of the obstacle as it is turned (m).
    depth: f64,
    past: f64,
}

impl<'a> Turns<'a> {
    /// * `first`: a contact near what is asked for, at some `angles` (rad)
    pub fn new(
        tilted: &'a Tilted<'a>,
        on: &'a OnMesh<'a>,
        skin: &'a dyn ElasticSkin,
        first: &Contact,
        angles: &[f64],
    ) -> Result<Self, ContactError> {
        let mut trials = Trials::new(skin, None);
        trials.deepest = MOST_OVERLAPS * first.max_penetration_before;
        let (depth, past) = (first.pressed_depth(), on.touch.past(first));
        let last = Last { angles: angles.to_vec(), arms: vec![0.0; angles.len()], depth, past };
        let mut turns = Self { tilted, on, trials, last };
        if let Some(turned) = on.turned(tilted.turned_by(angles))? {
            turns.note(angles, first, turned.touch.depth);
        }
        Ok(turns)
    }

    /// Way past the touch of the last one (m).
    pub fn past(&self) -> f64 {
        self.last.past
    }

    /// What all of them took.
    pub fn timings(&self) -> &[Timing] {
        &self.trials.timings
    }

    /// The contact at some angles (rad); `None` where there is no answer.
    pub fn contact(&mut self, angles: &[f64]) -> Result<Option<Contact>, ContactError> {
        self.on.setup.options.check_interrupt("search for the balance")?;
        let Some(turned) = self.on.turned(self.tilted.turned_by(angles))? else { return Ok(None) };
        let begins = self.begins(&turned);
        let depth = match self.tilted.aim {
            Aim::Depth(_) => self.last.depth,
            Aim::Value(target) => {
                let first = self.first(target, angles, begins);
                let begins = begins - turned.touch.depth;
                let Some(past) = turned.past_at(target, begins, first, &mut self.trials)? else {
                    return Ok(None);
                };
                turned.touch.depth + past
            }
        };
        let mut contact = match turned.solve_within(depth - turned.touch.depth, &mut self.trials) {
            Err(error) if error.is_of_deeper() => return Ok(None),
            contact => match contact? {
                Some(contact) if !matches!(contact.status, ContactStatus::Failed(_)) => contact,
                _ => return Ok(None),
            },
        };
        add_timings(&mut self.trials.timings, &std::mem::take(&mut contact.timings));
        self.note(angles, &contact, begins);
        Ok(Some(contact))
    }

    /// Depth at which the obstacle touches as it is turned (m). Of one that starts from where it is, as far before the last one
    /// as then: there may be skin behind it.
    fn begins(&self, turned: &OnMesh) -> f64 {
        match turned.setup.approach.start {
            Start::Infinity => turned.touch.depth,
            Start::Current => self.last.depth - self.last.past,
        }
    }

    /// Way past that which is tried first (m). At a force the middle of the pressure stays where it is at first; where other
    /// skin comes to carry a part, no more of the way is needed than before.
    fn first(&self, target: Target, angles: &[f64], begins: f64) -> f64 {
        let Last { angles: before, arms, depth, past } = &self.last;
        let turned = angles.iter().zip(before).map(|(angle, before)| angle - before);
        let shift: f64 = match target.quantity {
            Quantity::Force => turned.zip(arms).map(|(turned, arm)| turned * arm).sum(),
            Quantity::Overlap => 0.0,
        };
        let first = depth - shift - begins;
        if first > 0.0 { first.min(*past) } else { *past }
    }

    /// * `begins`: see [`Turns::begins`]
    fn note(&mut self, angles: &[f64], contact: &Contact, begins: f64) {
        let along = Quantity::Force.of(contact, &self.on.setup.approach.direction);
        let depth = contact.pressed_depth();
        if along > 0.0 && depth > begins {
            let arms = self.tilted.moments(contact).iter().map(|moment| moment / along).collect();
            self.last = Last { angles: angles.to_vec(), arms, depth, past: depth - begins };
        }
    }
}
