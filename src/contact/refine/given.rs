//! What the given mesh gave, before any other or without one.

use std::time::Instant;

use crate::contact::error::ContactError;
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd};
use crate::contact::refine::estimate::ErrorEstimate;
use crate::contact::refine::tissue::Tissue;
use crate::contact::scene::Placement;
use crate::response::skin::elastic::{ElasticSkin, Traits, shear_modulus_under};

/// The contact on the given mesh alone, concluded.
pub(crate) fn end_unrefined(
    mut given: Contact,
    started: Instant,
    placement: Placement,
    skin: &dyn ElasticSkin,
) -> Result<Contact, ContactError> {
    note_given(&mut given, started, placement, skin)?;
    Ok(concluded(given, RefinementEnd::NoTarget, skin))
}

/// Notes what the given mesh gave; what the contact may rely on.
pub(super) fn note_given(
    given: &mut Contact,
    started: Instant,
    placement: Placement,
    skin: &dyn ElasticSkin,
) -> Result<Traits, ContactError> {
    let traits = skin.traits(given.surface())?.with_product(placement.obstacle.material());
    if !traits.refines {
        given.leave_out(
            "estimates of error",
            "one-rings and given matrices take no other mesh to compare with",
        );
    }
    let error = (given.status == ContactStatus::Solved && traits.refines)
        .then(|| ErrorEstimate::of_cells(given, Tissue::under(given, skin)));
    given.note_round(error, started);
    Ok(traits)
}

pub(super) fn concluded(given: Contact, end: RefinementEnd, skin: &dyn ElasticSkin) -> Contact {
    let shapes = given.errors_of_peak(shear_modulus_under(skin, given.candidates.iter().copied()));
    given.concluded(end, shapes)
}
