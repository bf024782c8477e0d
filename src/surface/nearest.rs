//! The nearest of some vertices along the skin, for every vertex.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::surface::checked::Surface;
use crate::surface::path::Front;

/// What [`Surface::nearest_along_skin`] found, one entry a vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct NearestAlongSkin {
    /// Length of the shortest path of edges to a source (m); infinite where none is within reach.
    pub distance: Vec<f64>,
    /// The source at the end of that path; `u32::MAX` where none is within reach.
    pub source: Vec<u32>,
}

impl Surface {
    /// The source at the end of the shortest path of edges from every vertex within reach (Dijkstra 1959).
    ///
    /// As [`Surface::skin_distances`], for searches that cover much of the surface: about 0.2 µs a vertex.
    ///
    /// * `sources`: vertices at distance 0
    /// * `reach`: greatest distance (m), >= 0; infinite for all
    ///
    /// # Panics
    /// If a source is no vertex of the surface.
    pub fn nearest_along_skin(&self, sources: &[usize], reach: f64) -> NearestAlongSkin {
        let count = self.vertices().len();
        let mut distance = vec![f64::INFINITY; count];
        let mut source = vec![u32::MAX; count];
        let mut queue = BinaryHeap::new();
        for &vertex in sources {
            distance[vertex] = 0.0;
            source[vertex] = vertex as u32;
            queue.push(Reverse(Front(0.0, vertex as u32)));
        }
        while let Some(Reverse(Front(way, vertex))) = queue.pop() {
            let vertex = vertex as usize;
            if way > distance[vertex] {
                continue;
            }
            let here = self.vertices()[vertex];
            for &neighbour in self.neighbours(vertex) {
                let next = neighbour as usize;
                let further = way + (self.vertices()[next] - here).norm();
                if further < distance[next] && further <= reach {
                    distance[next] = further;
                    source[next] = source[vertex];
                    queue.push(Reverse(Front(further, neighbour)));
                }
            }
        }
        NearestAlongSkin { distance, source }
    }
}
