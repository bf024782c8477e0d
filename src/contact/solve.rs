//! The contact of a skin with an obstacle: on the skin's mesh, then on finer ones.

use std::time::Instant;

use crate::contact::error::ContactError;
use crate::contact::in_place::solve_in_place;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::Contact;
use crate::contact::refine::rounds::refine;
use crate::contact::report::guards::Guarded;
use crate::contact::report::record::Report;
use crate::contact::scene::Placement;
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// Solves the contact of `surface` with `obstacle` where it stands.
///
/// `g = g0 + R f, g ≥ 0, f ≥ 0, g·f = 0` on the candidates (Xie, Kanai, Date 2011, eq. 9); see the crate's root for
/// units and signs.
///
/// Returns the outcome whatever its [`ContactStatus`](crate::contact::ContactStatus): an ending is no error.
///
/// # Errors
/// [`ContactError`] by variant, for a question that is malformed, too large or interrupted.
pub fn solve_contact(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    options.validate()?;
    with_threads(options, || {
        let solved = solve(surface, Placement { obstacle, press: None }, skin, options);
        Guarded { surface, obstacle, skin, press: None }.check(solved)
    })
}

/// Solves the contact on the skin's mesh, and on finer ones as far as the options ask for it.
pub(crate) fn solve(
    surface: &Surface,
    placement: Placement,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    let started = Instant::now();
    refine(on_given_mesh(surface, &placement, skin, options)?, started, placement, skin, options)
}

/// Solves the contact on the skin's own mesh.
pub(crate) fn on_given_mesh(
    surface: &Surface,
    placement: &Placement,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Contact, ContactError> {
    let started = Instant::now();
    if let Some((approach, _)) = placement.press {
        approach.check_start(surface, placement.obstacle)?;
    }
    let scene = placement.scene(surface)?;
    let mut report = Report::default();
    if placement.press.is_some() {
        report.clock("first_touch", started);
    }
    solve_in_place(surface, &scene, skin, options, report)
}
