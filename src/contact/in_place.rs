//! The contact of a skin with an obstacle at a given place, on one mesh.

use std::time::Instant;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::linearization::solve_to_the_end;
use crate::contact::equilibrium::solve as equilibrium;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::Contact;
use crate::contact::report::record::Report;
use crate::contact::scene::Scene;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

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
    let mut gaps = Gaps::measure(
        surface,
        scene,
        options.search_distance,
        traits.discretization == Discretization::Collocation,
    )?;
    report.clock("signed_distance", started);
    report.note_gaps(&gaps);
    report.warn_of_scene(&gaps);
    if gaps.penetrating.is_empty() {
        return Ok(Contact::apart(&gaps, &traits, options, report));
    }

    // 2-4. Candidates, response, complementarity.
    let response = Compliance::new(surface, skin, traits, options).with_product(&gaps)?;
    let forces = equilibrium::solve(&gaps, &response, None, options, &mut report)?;
    let forces = solve_to_the_end(&mut gaps, forces, &response, options, &mut report)?;
    report.note_forces(&gaps, &response, &forces, options);
    if let Some(ending) = forces.failure {
        return Ok(Contact::failed(ending, &gaps, forces, &traits, options, report));
    }

    // 5-6. Figures; the drawn skin when somebody asks.
    Contact::solved(&gaps, forces, &response, options, report)
}
