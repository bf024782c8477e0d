//! Bringing the obstacle to the skin: first touch, then a depth.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::Contact;
use crate::contact::reach::goal::{Target, reach};
use crate::contact::reach::on_mesh::Quantity;
use crate::contact::report::guards::Guarded;
use crate::contact::scene::{Approach, Goal, Press};
use crate::contact::setup::Setup;
use crate::contact::solve::solve;
use crate::contact::tilt::axes::Balance;
use crate::contact::tilt::goal::Tilted;
use crate::geometry::direction::unit;
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// Moves the obstacle along a direction to a depth, a force or an overlap, and solves the contact there.
///
/// The depth of a force or an overlap is searched on the given mesh, which is refined there, and again on the refined
/// mesh, to a relative 1e-6 of the value; force and overlap rise with the depth.
///
/// From infinity, the depth counts from the *first touch*: the position along the line of travel at which the
/// obstacle first meets the skin, at a vertex or between vertices. The travel reported may be negative, for a scene
/// that starts in overlap.
///
/// With [`Balance::Tilt`] the obstacle turns as well, until the moment about the axes through the point is below 1e-6 of
/// the force times the largest distance of a loaded vertex from the point. The depth is then the travel of that point
/// past the first touch of the obstacle as it was given, and the contact's obstacle is the one that has turned.
///
/// Vertices that came in through another side of the obstacle than their closest one (beside an edge, through the rim
/// of a can) get the way back along the travel for their gap, which `left_out` counts; a warning counts those
/// that went through a wall thinner than their depth.
///
/// # Errors
/// [`ContactError`] by variant; among them a direction that cannot be normalised, a negative depth, a force or an
/// overlap that is not positive or cannot be reached (with the largest contact found), an obstacle that never meets
/// the skin or finds no balance, and a current position that already penetrates.
pub fn press(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    press: &Press,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    let guarded = Guarded { surface, obstacle, skin, press: Some(press) };
    options.validate()?;
    with_threads(options, || guarded.check(pressed(surface, obstacle, skin, press, options)))
}

fn pressed(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    press: &Press,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    let direction = unit_direction(&press.direction)?;
    let approach = |depth| Approach::new(direction, press.start, depth);
    let tilt = match press.balance {
        Balance::None => None,
        Balance::Tilt(tilt) => Some((tilt.checked_point()?, tilt.axes.units(&direction)?)),
    };
    let setup = |depth| Setup { surface, obstacle, skin, options, press: approach(depth) };
    let tilted = |depth, target| {
        let (point, axes) = tilt.clone()?;
        Some(Tilted { setup: setup(depth), target, axes, point })
    };
    let (quantity, value) = match press.goal {
        Goal::Depth(depth) => {
            if !(depth >= 0.0 && depth.is_finite()) {
                return Err(ContactError::Depth { depth });
            }
            if let Some(tilted) = tilted(depth, None) {
                return tilted.run();
            }
            return solve(surface, &setup(depth).at(depth), skin, options);
        }
        Goal::Force(force) => (Quantity::Force, force),
        Goal::Overlap(overlap) => (Quantity::Overlap, overlap),
    };
    if !(value > 0.0 && value.is_finite()) {
        let (goal, unit) = quantity.name_and_unit();
        return Err(ContactError::Goal { goal, value, unit });
    }
    let target = Target { quantity, value };
    if let Some(tilted) = tilted(0.0, Some(target)) {
        return tilted.run();
    }
    reach(setup(0.0), target)
}

/// The unit vector along the direction of a press.
pub(crate) fn unit_direction(direction: &Vector3<f64>) -> Result<Vector3<f64>, ContactError> {
    unit(direction).ok_or(ContactError::Direction { direction: (*direction).into() })
}
