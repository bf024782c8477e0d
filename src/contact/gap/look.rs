//! How far skin in overlap looks back for the way that it came in.

use std::collections::BTreeMap;

use crate::contact::gap::entry::Entered;
use crate::contact::gap::measured::Measured;
use crate::surface::checked::Surface;

/// Where skin in overlap stands deeper than this share of the search distance, some may stand deeper than that.
const DEEP_SHARE: f64 = 0.7;
/// How far around such a patch the skin looks farther, in its search distance: what the patch holds deeper than it looked is no
/// farther.
const AROUND_PATCH: f64 = 2.0;

/// Lets the skin around a patch look farther where the patch stands nearly as deep as it looked, and nowhere else: another
/// finger would find walls that it never met.
///
/// No farther than half the breadth of the skin's body under the deepest vertex: what stands farther in came through the skin
/// on the other side.
///
/// * `entered`: vertices whose gap is measured back the way they came
/// * `reach`: how far each vertex looks (n, m)
///
/// Returns whether some shall.
pub(super) fn reach_farther(
    surface: &Surface,
    entered: &[Entered],
    measured: &Measured,
    reach: &mut [f64],
) -> bool {
    let mut is_farther = false;
    let vertices: Vec<usize> = entered.iter().map(|entered| entered.point).collect();
    for patch in surface.patches(&vertices) {
        let deepest = measured.deepest_of(&patch).expect("no patch is empty");
        if -measured.distance[deepest] <= DEEP_SHARE * reach[deepest] {
            continue;
        }
        let breadth = surface.breadth_along(deepest, &-surface.vertex_normals()[deepest]);
        let farther = (2.0 * reach[deepest]).min(0.5 * breadth.unwrap_or(f64::INFINITY));
        if farther <= reach[deepest] {
            continue;
        }
        is_farther = true;
        for (vertex, _) in surface.skin_distances(&patch, AROUND_PATCH * farther) {
            reach[vertex] = reach[vertex].max(farther);
        }
    }
    is_farther
}

/// Lets vertices that left the obstacle again look no farther than half the breadth of the skin's body under them: on a mesh whose
/// edges are half as long as that, skin would find what came in through the other side.
///
/// Returns whether some did.
pub(super) fn look_no_farther(surface: &Surface, entered: &[Entered], reach: &mut [f64]) -> bool {
    let left = entered.iter().filter(|entered| entered.has_left);
    let ways: BTreeMap<usize, f64> = left.map(|entered| (entered.point, entered.way)).collect();
    let mut is_nearer = false;
    for patch in surface.patches(&ways.keys().copied().collect::<Vec<_>>()) {
        let breadths = surface.breadths(&patch, |vertex| 2.0 * ways[&vertex]);
        for (&vertex, breadth) in patch.iter().zip(breadths) {
            if let Some(breadth) = breadth {
                reach[vertex] = 0.5 * breadth;
                is_nearer = true;
            }
        }
    }
    is_nearer
}
