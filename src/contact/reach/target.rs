//! What a press is to come to.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::outcome::Contact;
use crate::contact::scene::Goal;
use crate::geometry::bounds::LARGEST_COORDINATE;

/// Power of the depth that the force of a round body rises with (Hertz).
const HERTZ_POWER: f64 = 1.5;

/// A [`Goal`] whose number is in range.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Aim {
    /// A depth (m).
    Depth(f64),
    /// A value whose depth is to be found.
    Value(Target),
}

/// The value that a quantity is to take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    pub quantity: Quantity,
    /// In N or m.
    pub value: f64,
}

/// What rises with the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    /// Force along the direction (N).
    Force,
    /// Deepest penetration of the undeformed skin (m).
    Overlap,
}

impl Goal {
    /// # Errors
    /// [`ContactError::Depth`], [`ContactError::Goal`].
    pub(crate) fn aim(self) -> Result<Aim, ContactError> {
        let (quantity, value) = match self {
            Self::Depth(depth) if (0.0..=LARGEST_COORDINATE).contains(&depth) => {
                return Ok(Aim::Depth(depth));
            }
            Self::Depth(depth) => return Err(ContactError::Depth { depth }),
            Self::Force(force) => (Quantity::Force, force),
            Self::Overlap(overlap) => (Quantity::Overlap, overlap),
        };
        if value > 0.0 && value.is_finite() {
            return Ok(Aim::Value(Target { quantity, value }));
        }
        let (goal, unit) = quantity.name_and_unit();
        Err(ContactError::Goal { goal, value, unit })
    }
}

impl Quantity {
    /// Its value in a contact.
    ///
    /// * `direction`: of the press, a unit vector
    pub fn of(self, contact: &Contact, direction: &Vector3<f64>) -> f64 {
        match self {
            Self::Force => contact.resultant.force.dot(direction),
            Self::Overlap => contact.max_penetration_before,
        }
    }

    /// Power of the depth that it rises with, as a first guess.
    pub fn power(self) -> f64 {
        match self {
            Self::Force => HERTZ_POWER,
            Self::Overlap => 1.0,
        }
    }

    /// For messages.
    pub fn name_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::Force => ("force", "N"),
            Self::Overlap => ("overlap", "m"),
        }
    }
}
