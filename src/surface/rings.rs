//! Growing a set of vertices and splitting it into patches.

use crate::surface::checked::Surface;

impl Surface {
    /// The vertices that at most `rings` edges separate from `nodes`, sorted, `nodes` included.
    ///
    /// # Panics
    /// If a node is no vertex of the surface.
    pub fn k_ring(&self, nodes: &[usize], rings: usize) -> Vec<usize> {
        let mut seen = vec![false; self.vertices().len()];
        let mut found: Vec<usize> = Vec::new();
        for &node in nodes {
            if !std::mem::replace(&mut seen[node], true) {
                found.push(node);
            }
        }
        let mut front = 0;
        for _ in 0..rings {
            let end = found.len();
            for i in front..end {
                for &neighbour in self.neighbours(found[i]) {
                    if !std::mem::replace(&mut seen[neighbour as usize], true) {
                        found.push(neighbour as usize);
                    }
                }
            }
            if found.len() == end {
                break;
            }
            front = end;
        }
        found.sort_unstable();
        found
    }

    /// Vertices of a set that an edge joins to one outside of it, ascending.
    ///
    /// * `is_in`: the set (n)
    pub(crate) fn rim(&self, is_in: &[bool]) -> Vec<usize> {
        let has_other = |vertex: usize| self.neighbours(vertex).iter().any(|&other| !is_in[other as usize]);
        (0..is_in.len()).filter(|&vertex| is_in[vertex] && has_other(vertex)).collect()
    }

    /// Splits a set of vertices into the parts that edges join, each sorted, ordered by their lowest vertex.
    ///
    /// # Panics
    /// If a node is no vertex of the surface.
    pub fn patches(&self, nodes: &[usize]) -> Vec<Vec<usize>> {
        let mut left = vec![false; self.vertices().len()];
        nodes.iter().for_each(|node| left[*node] = true);
        let mut seeds = nodes.to_vec();
        seeds.sort_unstable();
        let mut patches = Vec::new();
        for seed in seeds {
            if !std::mem::replace(&mut left[seed], false) {
                continue;
            }
            let mut patch = vec![seed];
            let mut head = 0;
            while head < patch.len() {
                for &neighbour in self.neighbours(patch[head]) {
                    if std::mem::replace(&mut left[neighbour as usize], false) {
                        patch.push(neighbour as usize);
                    }
                }
                head += 1;
            }
            patch.sort_unstable();
            patches.push(patch);
        }
        patches
    }
}
