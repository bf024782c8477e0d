//! Shortest ways along the skin, and which parts of it share tissue.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::surface::checked::Surface;

/// Longest way along the skin, over the straight line, between points that share tissue.
///
/// Around a round finger the way is π/2 of the straight line at most, and a path of edges up to 15 % longer than
/// that: 1.81. An oval section of 3 : 2 gives 1.98 between the middles of its flat sides. From one finger to the next
/// the way leads down to the web and up again, many times the gap between them.
pub const LONGEST_DETOUR: f64 = 2.0;
/// The same between points that share all of it: over a bent palm, and along a path of edges on flat skin.
pub const SHORT_DETOUR: f64 = 1.5;

/// How much of the tissue between two points of the skin couples them: the share of the force at one that moves the other.
///
/// 1 up to `along_skin = SHORT_DETOUR · straight`, 0 from `LONGEST_DETOUR · straight` on, and straight in between, so that
/// no force jumps where a contact grows. Points that are close in space but far along the skin lie on different fingers, with
/// air in between.
///
/// * `along_skin`: distance along the skin (m), see [`Surface::skin_distances`]; infinite for another component
/// * `straight`: straight-line distance (m)
pub fn shared_tissue(along_skin: f64, straight: f64) -> f64 {
    if along_skin <= SHORT_DETOUR * straight {
        return 1.0;
    }
    let left = LONGEST_DETOUR * straight - along_skin;
    (left / ((LONGEST_DETOUR - SHORT_DETOUR) * straight)).max(0.0)
}

/// What [`Surface::nearest_along_skin`] found, one entry a vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestAlongSkin {
    /// Length of the shortest path of edges to a source (m); infinite where none is within reach.
    pub distance: Vec<f64>,
    /// The source at the end of that path; `u32::MAX` where none is within reach.
    source: Vec<u32>,
}

impl NearestAlongSkin {
    /// The source at the end of the shortest path from a vertex; `None` where none is within reach.
    pub fn source(&self, vertex: usize) -> Option<usize> {
        Some(self.source[vertex]).filter(|source| *source != u32::MAX).map(|source| source as usize)
    }

    /// Adds sources on the skin that was searched: only what they are nearest to is searched again.
    ///
    /// * `reach`: that of the search before (m)
    ///
    /// # Panics
    /// If a source is no vertex of the surface.
    pub fn add_sources(&mut self, surface: &Surface, sources: &[usize], reach: f64) {
        let mut queue = BinaryHeap::new();
        for &vertex in sources {
            self.distance[vertex] = 0.0;
            self.source[vertex] = vertex as u32;
            queue.push(Reverse(Front(0.0, vertex as u32)));
        }
        while let Some(Reverse(Front(way, vertex))) = queue.pop() {
            let vertex = vertex as usize;
            if way > self.distance[vertex] {
                continue;
            }
            let here = surface.vertices()[vertex];
            for &neighbour in surface.neighbours(vertex) {
                let next = neighbour as usize;
                let further = way + (surface.vertices()[next] - here).norm();
                if further < self.distance[next] && further <= reach {
                    self.distance[next] = further;
                    self.source[next] = self.source[vertex];
                    queue.push(Reverse(Front(further, neighbour)));
                }
            }
        }
    }
}

/// A distance (m) and the vertex at it, ordered by distance.
#[derive(PartialEq)]
struct Front(f64, u32);

impl Eq for Front {}

impl Ord for Front {
    fn cmp(&self, other: &Front) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

impl PartialOrd for Front {
    fn partial_cmp(&self, other: &Front) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Surface {
    /// The source at the end of the shortest path of edges from every vertex within reach (Dijkstra 1959).
    ///
    /// A path of edges is longer than the shortest way over the faces, by up to 15 % on equilateral triangles.
    ///
    /// * `sources`: vertices at distance 0
    /// * `reach`: greatest distance (m), >= 0; infinite for all
    ///
    /// # Panics
    /// If a source is no vertex of the surface.
    pub fn nearest_along_skin(&self, sources: &[usize], reach: f64) -> NearestAlongSkin {
        let count = self.vertices().len();
        let mut nearest =
            NearestAlongSkin { distance: vec![f64::INFINITY; count], source: vec![u32::MAX; count] };
        nearest.add_sources(self, sources, reach);
        nearest
    }

    /// Length of the shortest path of edges from the sources to every vertex within reach, as (vertex, distance (m)) sorted
    /// by vertex; see [`Surface::nearest_along_skin`].
    ///
    /// # Panics
    /// If a source is no vertex of the surface.
    pub fn skin_distances(&self, sources: &[usize], reach: f64) -> Vec<(usize, f64)> {
        let nearest = self.nearest_along_skin(sources, reach);
        nearest.distance.into_iter().enumerate().filter(|(_, distance)| distance.is_finite()).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn opposite_points_of_a_round_finger_share_tissue_and_those_of_two_fingers_do_not() {
        let diameter = 16e-3;
        assert!(shared_tissue(1.15 * 0.5 * PI * diameter, diameter) > 0.0);
        // 2 mm of air between two fingers, 30 mm above the web
        assert_eq!(shared_tissue(2.0 * 30e-3 + 2e-3, 2e-3), 0.0);
        assert_eq!(shared_tissue(f64::INFINITY, 1e-3), 0.0);
    }

    #[test]
    fn what_is_shared_fades_without_a_jump() {
        let straight = 10e-3;
        let [whole, none] = [SHORT_DETOUR, LONGEST_DETOUR].map(|detour| detour * straight);
        let middle = 0.5 * (whole + none);
        for (way, expected) in [(whole, 1.0), (whole + 1e-9, 1.0), (middle, 0.5), (none - 1e-9, 0.0)] {
            assert!((shared_tissue(way, straight) - expected).abs() < 1e-6);
        }
        assert_eq!(shared_tissue(1e-3, 0.0), 0.0);
    }
}
