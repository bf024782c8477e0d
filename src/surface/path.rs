//! Distances along the skin.

use std::cmp::{Ordering, Reverse};
use std::collections::{BinaryHeap, HashMap};

use crate::surface::checked::Surface;

/// A distance (m) and the vertex at it, ordered by distance.
#[derive(PartialEq)]
pub(super) struct Front(pub f64, pub u32);

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
    /// Length of the shortest path of edges from the sources to every vertex within reach (Dijkstra 1959).
    ///
    /// A path of edges is longer than the shortest way over the faces, by up to 15 % on equilateral triangles.
    /// The work grows with the part within reach, not with the surface.
    ///
    /// * `sources`: vertices at distance 0
    /// * `reach`: greatest distance (m), >= 0; infinite for the whole component
    ///
    /// Returns (vertex, distance (m)), sorted by vertex.
    ///
    /// # Panics
    /// If a source is no vertex of the surface.
    pub fn skin_distances(&self, sources: &[usize], reach: f64) -> Vec<(usize, f64)> {
        let mut distances: HashMap<u32, f64> = HashMap::new();
        let mut queue = BinaryHeap::new();
        for &source in sources {
            assert!(source < self.vertices().len(), "source {source} is no vertex");
            if distances.insert(source as u32, 0.0).is_none() {
                queue.push(Reverse(Front(0.0, source as u32)));
            }
        }
        while let Some(Reverse(Front(distance, vertex))) = queue.pop() {
            if distance > distances[&vertex] {
                continue;
            }
            let here = self.vertices()[vertex as usize];
            for &neighbour in self.neighbours(vertex as usize) {
                let further = distance + (self.vertices()[neighbour as usize] - here).norm();
                let known = distances.entry(neighbour).or_insert(f64::INFINITY);
                if further < *known && further <= reach {
                    *known = further;
                    queue.push(Reverse(Front(further, neighbour)));
                }
            }
        }
        let within = distances.into_iter().filter(|(_, distance)| distance.is_finite());
        let mut found: Vec<(usize, f64)> = within.map(|(v, d)| (v as usize, d)).collect();
        found.sort_unstable_by_key(|entry| entry.0);
        found
    }
}
