//! Products whose response does not know how thin they are.

use std::f64::consts::{FRAC_2_PI, PI};
use std::iter::{once, successors};

use crate::contact::outcome::{Contact, Patch, Resultant};
use crate::contact::report::warning::{Warning, WarningKind};
use crate::geometry::direction::unit;

/// Share of its thickness up to which a layer is pressed in.
pub(super) const LAYER_SHARE: f64 = 0.5;
/// Radius of a contact as a share of the product's thickness, from which a half-space gives way more than twice as much as a
/// layer of that thickness on something rigid ([`sphere_on_layer`](crate::reference::sphere_on_layer)).
const THICKNESS_SHARE: f64 = 0.5;
/// Share of the work that goes into the product below which half as much would change the force by less than 1 %.
const FELT_SHARE: f64 = 0.02;
/// Rise of the force by a rigid back from which it is told.
const FELT_RISE: f64 = 0.1;
/// That of a contact of radius a on a back at depth h, over a/h of a product that takes all of the work, to the first order:
/// 2 φ(0) / π, the kernel of an incompressible layer being K (1/r - φ(r/h)/h).
const RISE_BY_BACK: f64 = 1.7702 * FRAC_2_PI;

/// Of a product that is a layer.
pub(super) fn product_range(contact: &Contact) -> Option<Warning> {
    let thickness = contact.obstacle.material()?.kernel()?.layer_at(0)?;
    let deepest = deepest_in_product(contact);
    (deepest > LAYER_SHARE * thickness).then(|| Warning {
        kind: WarningKind::ResponseRange,
        message: format!(
            "the product is pressed in by {deepest:.4e} m, more than half of the {thickness:.4e} m of its layer: so thin it is stiffer than the linear layer; press less deep"
        ),
    })
}

/// Of a product that is a half-space to the response, and thin.
pub(super) fn product_thickness(contact: &Contact) -> Option<Warning> {
    let share = contact.obstacle_share.filter(|&share| share > FELT_SHARE)?;
    contact.obstacle.material()?.kernel().filter(|kernel| kernel.layer_at(0).is_none())?;
    let moved = deepest_in_product(contact);
    let thin = |patch: &Patch| {
        let Resultant { force, center_of_pressure: center, contact_area, .. } = &patch.resultant;
        let radius = (contact_area / PI).sqrt();
        let outward = unit(force)?;
        // From both sides of the product, from no farther away than it needs, as there may be more of it behind a cavity.
        let thickness_within = |thickest: f64| {
            let reach = moved + thickest;
            let ends = [center + reach * outward, center - reach * outward];
            let ways =
                contact.obstacle.farthest_surfaces(&ends, &[-outward, outward], &[2.0 * reach; 2]).ok()?;
            Some(ways[0]? + ways[1]? - 2.0 * reach)
        };
        let rise_at = |thickness: f64| RISE_BY_BACK * share * radius / thickness;
        let first = radius / THICKNESS_SHARE;
        let further = successors(Some(2.0 * first), |reach| Some(2.0 * reach));
        let felt = further.take_while(|&reach| rise_at(0.5 * reach) > FELT_RISE);
        let thickness = once(first).chain(felt).find_map(thickness_within)?;
        let rise = rise_at(thickness);
        (radius > THICKNESS_SHARE * thickness || rise > FELT_RISE).then_some((thickness, radius, rise))
    };
    let (thickness, radius, rise) = contact.patches.iter().find_map(thin)?;
    Some(Warning {
        kind: WarningKind::ResponseRange,
        message: format!(
            "the product is {thickness:.4e} m thick under a contact of {radius:.4e} m radius, and its response is that of a half-space, which has no other side: on something rigid the force is higher by {:.0} % to the first order, and held at its ends it bends; take a layer or a given matrix",
            100.0 * rise
        ),
    })
}

fn deepest_in_product(contact: &Contact) -> f64 {
    contact.drawing.motion.product.iter().map(|moved| moved.norm()).fold(0.0, f64::max)
}
