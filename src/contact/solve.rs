//! The contact of a skin with an obstacle at a given place.

use std::time::Instant;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::solve as equilibrium;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::Contact;
use crate::contact::report::record::Report;
use crate::contact::scene::Scene;
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
        let scene = Scene { obstacle: obstacle.clone(), travel: 0.0, press: None, depth_bound: None };
        solve_in_place(surface, &scene, skin, options, Report::default())
    })
}

/// Solves the contact where the obstacle of `scene` stands.
pub(crate) fn solve_in_place(
    surface: &Surface,
    scene: &Scene,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
    mut report: Report,
) -> Result<Contact, ContactError> {
    if !surface.skin_mask().contains(&true) {
        return Err(ContactError::NoSkin { vertex_count: surface.vertices().len() });
    }
    let traits = skin.traits(surface)?;

    // 1. Gaps; back along the press where the skin came in through another side.
    let started = Instant::now();
    let gaps = Gaps::measure(surface, scene, &traits, options.search_distance)?;
    report.clock("signed_distance", started);
    report.note_gaps(&gaps);
    report.warn_of_scene(&gaps);
    if gaps.penetrating.is_empty() {
        return Ok(Contact::apart(&gaps, &traits, options, report));
    }

    // 2-4. Candidates, response, complementarity.
    let response = Compliance::new(surface, skin, traits, options);
    let forces = equilibrium::solve(&gaps, &response, options, &mut report)?;
    report.note_forces(&gaps, &response, &forces, options);
    if let Some(ending) = forces.failure {
        return Ok(Contact::failed(ending, &gaps, forces, &traits, options, report));
    }

    // 5-6. Figures; the drawn skin when somebody asks.
    Contact::solved(&gaps, forces, &response, options, report)
}
