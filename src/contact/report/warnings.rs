//! What the user should know of a contact, in sentences.

use crate::contact::outcome::ContactStatus;
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::skin::Gap;
use crate::surface::checked::Surface;

/// Penetration left at the deformed skin, as a share of that before, from which the user is warned.
const UNRESOLVED_SHARE: f64 = 0.05;

/// Skin and obstacle differing in size by this factor suggest that one is in another unit.
const SUSPICIOUS_SIZE_RATIO: f64 = 100.0;

/// Says when the obstacle is too finely shaped for the gaps linearised at this depth, or the mesh too coarse for
/// averaged gaps.
pub(crate) fn penetration_warning(
    status: ContactStatus,
    gap: Gap,
    before: f64,
    after: f64,
) -> Option<String> {
    let unresolved = status == ContactStatus::Solved && after > UNRESOLVED_SHARE * before;
    let cause = match gap {
        Gap::Node => {
            "the obstacle has features (a thin rim, an edge) no larger than the depth, where gaps along the closest normal do not hold; press less deep or thicken the feature, and do not trust force and area there"
        }
        Gap::Weighted => {
            "gaps are averaged over triangles as large as the features of this contact; refine the mesh there, or take the gap at the nodes"
        }
    };
    unresolved
        .then(|| format!("the deformed skin still penetrates by {after:.3e} m of {before:.3e} m: {cause}"))
}

/// Says when gaps were measured back along the travel.
pub(crate) fn thin_wall_warning(went_through: usize) -> Option<String> {
    (went_through > 0).then(|| {
        format!(
            "{went_through} vertices went through a wall thinner than their depth: their gaps are measured back along the press to where they met it, as gaps along the closest normal would push them out at its sides"
        )
    })
}

/// Says when skin and obstacle look as if they were in different units.
pub(crate) fn size_warning(surface: &Surface, obstacle: &Obstacle) -> Option<String> {
    let (low, high) = surface.bounding_box();
    let (obstacle_low, obstacle_high) = obstacle.bounding_box()?;
    let (skin, product) = ((high - low).norm(), (obstacle_high - obstacle_low).norm());
    let ratio = product / skin;
    let suspicious =
        obstacle.kind() == "mesh" && !(1.0 / SUSPICIOUS_SIZE_RATIO..SUSPICIOUS_SIZE_RATIO).contains(&ratio);
    suspicious.then(|| {
        format!(
            "the obstacle's diagonal ({product:.4e} m) is {ratio:.3e} times the skin's ({skin:.4e} m): is one of them in another unit? Lengths are metres; `unit=\"mm\"` converts a file when it is read"
        )
    })
}
