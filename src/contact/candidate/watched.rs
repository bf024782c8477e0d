//! Vertices whose displacement a contact asks for once its forces are known.

use std::collections::BTreeMap;

use crate::contact::gap::initial::Gaps;
use crate::mesh::distinct::distinct;

/// Rings around the vertices inside the obstacle in which figures look at the skin beside it.
const RINGS_BESIDE: usize = 2;

/// Vertices of each finger that may touch or penetrate once others are pushed out, with those beside them, ascending.
pub(crate) fn watched(gaps: &Gaps) -> Vec<Vec<usize>> {
    let mut near = gaps.surface.k_ring(&gaps.penetrating, RINGS_BESIDE);
    // Nothing moves farther than the deepest.
    near.extend(gaps.nearer_than(gaps.deepest()));
    let known = gaps.scene.inherited.as_ref().map(|inherited| &inherited.fingers);
    let mut by_finger: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for vertex in distinct(near) {
        by_finger.entry(known.and_then(|fingers| fingers.finger_of(vertex))).or_default().push(vertex);
    }
    by_finger.into_values().collect()
}
