//! Bringing the obstacle to the skin.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::Contact;
use crate::contact::reach::goal::reach;
use crate::contact::reach::target::Aim;
use crate::contact::report::guards::Guarded;
use crate::contact::scene::{Approach, Press};
use crate::contact::setup::Setup;
use crate::contact::solve::solve;
use crate::contact::tilt::axes::Balance;
use crate::contact::tilt::tilted::Tilted;
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
/// that went through a wall thinner than twice their depth.
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
    let setup = Setup { surface, obstacle, skin, options, approach: Approach::new(direction, press.start) };
    if let Balance::Tilt(tilt) = press.balance {
        let (point, axes) = (tilt.checked_point()?, tilt.axes.units(&direction)?);
        return Tilted { setup, aim: press.goal.aim()?, axes, point }.run();
    }
    match press.goal.aim()? {
        Aim::Depth(depth) => solve(surface, setup.at(depth), skin, options),
        Aim::Value(target) => reach(setup, target),
    }
}

/// The unit vector along the direction of a press.
pub(crate) fn unit_direction(direction: &Vector3<f64>) -> Result<Vector3<f64>, ContactError> {
    unit(direction).ok_or(ContactError::Direction { direction: (*direction).into() })
}
