//! Which vertices enter the complementarity problem, and which of them share one.

use crate::contact::candidate::fingers::Fingers;
use crate::geometry::bounds::Bounds;
use crate::surface::checked::Surface;

/// `nodes` with their `rings`-ring, kept to vertices that may touch; ascending.
pub(crate) fn with_rings(surface: &Surface, nodes: &[usize], rings: usize) -> Vec<usize> {
    let mut grown = surface.k_ring(nodes, rings);
    grown.retain(|&vertex| surface.skin_mask()[vertex]);
    grown
}

/// Loaded candidates with a neighbour that may touch but is no candidate.
pub(crate) fn loaded_rim(surface: &Surface, candidates: &[usize], node_force: &[f64]) -> Vec<usize> {
    let mut is_candidate = vec![false; surface.vertices().len()];
    candidates.iter().for_each(|&vertex| is_candidate[vertex] = true);
    let is_open = |other: &u32| surface.skin_mask()[*other as usize] && !is_candidate[*other as usize];
    candidates
        .iter()
        .copied()
        .filter(|&vertex| node_force[vertex] > 0.0 && surface.neighbours(vertex).iter().any(is_open))
        .collect()
}

/// Splits candidates into groups that cannot feel each other, each ascending, in order of their first vertex.
///
/// On fingers that feel each other, two connected patches belong together when the boxes around their loaded triangles come
/// within `reach` (m) of each other; a response without limit of reach couples all of them.
pub(crate) fn uncoupled_groups(surface: &Surface, fingers: &Fingers, reach: Option<f64>) -> Vec<Vec<usize>> {
    let Some(reach) = reach else {
        return fingers.groups();
    };
    let mut groups: Vec<Vec<usize>> =
        fingers.groups().iter().flat_map(|group| within_reach(surface, group, reach)).collect();
    groups.sort_unstable_by_key(|group| group[0]);
    groups
}

/// The groups of candidates that may feel each other.
fn within_reach(surface: &Surface, candidates: &[usize], reach: f64) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Bounds, Vec<usize>)> = surface
        .patches(candidates)
        .into_iter()
        .map(|patch| (loaded_bounds(surface, &patch), patch))
        .collect();
    // Merge until no pair is within reach; patches are few.
    let mut first = 0;
    while first < groups.len() {
        let bounds = groups[first].0;
        match (first + 1..groups.len()).find(|&other| bounds.distance(&groups[other].0) <= reach) {
            Some(other) => {
                let (bounds, patch) = groups.swap_remove(other);
                groups[first].0 = groups[first].0.union(&bounds);
                groups[first].1.extend(patch);
                first = 0;
            }
            None => first += 1,
        }
    }
    let mut groups: Vec<Vec<usize>> = groups.into_iter().map(|(_, patch)| patch).collect();
    groups.iter_mut().for_each(|group| group.sort_unstable());
    groups
}

/// Box around all triangles that touch a vertex of `patch`: where its hats are not zero.
fn loaded_bounds(surface: &Surface, patch: &[usize]) -> Bounds {
    let rings = patch.iter().flat_map(|&vertex| surface.neighbours(vertex)).map(|&other| other as usize);
    Bounds::around(patch.iter().copied().chain(rings).map(|vertex| &surface.vertices()[vertex]))
}
