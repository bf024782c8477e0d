//! What the mesh that a product's matrix is given on costs area and peak pressure.

use crate::contact::figures::area::cells::mean_edge;
use crate::contact::outcome::Contact;

/// What the area and the peak pressure lose, over what the force does, where a given matrix is interpolated between its
/// vertices: fitted as what the force loses.
const AREA_PER_FORCE: f64 = 2.5;
const PEAK_PER_FORCE: f64 = 6.5;
/// How many times that is on a skin with triangles as fine as the product's, of a product that gives way alone: fitted to
/// products softer than the skin on longer triangles.
const DRAWN_TOGETHER: f64 = 1.5;

/// Estimated errors of area and peak pressure, over them, where a given matrix leaves the force in doubt.
///
/// On a skin with finer triangles than the product's a contact draws together around the product's vertices, as these alone
/// give way by themselves: the more, the more of the give is the product's.
pub(crate) fn errors_of_area_and_peak(contact: &Contact) -> [f64; 2] {
    let Some(doubt) = contact.clues.product else { return [0.0; 2] };
    let finer = doubt.edge_length / mean_edge(contact.surface(), &contact.active);
    let drawn_together = (DRAWN_TOGETHER * contact.obstacle_share.unwrap_or(0.0) * finer).max(1.0);
    [AREA_PER_FORCE, PEAK_PER_FORCE].map(|factor| factor * drawn_together * doubt.force_error)
}
