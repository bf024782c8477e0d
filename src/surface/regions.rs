//! The skin in pieces of a given size, and which of them share tissue.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use super::path::Front;
use super::{LONGEST_DETOUR, Surface, shares_tissue};

/// No region yet.
const NONE: u32 = u32::MAX;

/// A partition of the skin: each vertex belongs to the nearest of some seeds along the skin.
///
/// Distances between seeds lead along the skin from seed to seed of neighbouring regions, so they cost no more on a
/// fine mesh than on a coarse one.
#[derive(Debug)]
pub(crate) struct SkinRegions {
    /// Region of each vertex.
    of_vertex: Vec<u32>,
    /// Vertex in the middle of each region.
    seeds: Vec<u32>,
    /// No vertex is farther from its seed along the skin (m).
    radius: f64,
    /// Where each region's part of `beside` starts, and the end.
    starts: Vec<usize>,
    /// Neighbouring regions, with the way to their seeds (m).
    beside: Vec<(u32, f64)>,
}

impl SkinRegions {
    /// Regions of which no vertex is farther than `radius` (m) from the seed.
    pub(crate) fn new(surface: &Surface, radius: f64) -> Self {
        let points = surface.vertices();
        let mut spread = Spread::new(points.len());
        let way = |v: u32| {
            let ring = surface.neighbours(v as usize).iter();
            ring.map(move |&w| (w, (points[w as usize] - points[v as usize]).norm()))
        };
        // Seeds: the first vertex that no earlier seed reaches.
        let mut seeds = Vec::new();
        let mut is_covered = vec![false; points.len()];
        for vertex in 0..points.len() {
            if !is_covered[vertex] {
                seeds.push(vertex as u32);
                spread.from(&[vertex as u32], radius, way);
                spread.reached.iter().for_each(|&v| is_covered[v as usize] = true);
            }
        }
        spread.from(&seeds, radius, way);
        let of_vertex = std::mem::take(&mut spread.source);
        let distances = std::mem::take(&mut spread.distance);
        // Edges of the mesh that lead from region to region, the shortest way of each pair first.
        let mut ways: Vec<(u32, u32, f64)> = Vec::new();
        for (v, &from) in of_vertex.iter().enumerate() {
            let crossing = way(v as u32).filter(|(w, _)| of_vertex[*w as usize] != from);
            ways.extend(crossing.map(|(w, length)| {
                (from, of_vertex[w as usize], distances[v] + length + distances[w as usize])
            }));
        }
        ways.sort_unstable_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        ways.dedup_by_key(|entry| (entry.0, entry.1));
        let starts =
            (0..=seeds.len()).map(|region| ways.partition_point(|w| (w.0 as usize) < region)).collect();
        let beside = ways.iter().map(|entry| (entry.1, entry.2)).collect();
        Self { of_vertex, seeds, radius, starts, beside }
    }

    /// Number of regions.
    pub(crate) fn count(&self) -> usize {
        self.seeds.len()
    }

    /// Region of a vertex.
    pub(crate) fn of(&self, vertex: usize) -> usize {
        self.of_vertex[vertex] as usize
    }

    /// Vertex in the middle of a region.
    pub(crate) fn seed(&self, region: usize) -> usize {
        self.seeds[region] as usize
    }

    /// Pairs of regions that may have vertices within `reach` (m) of each other, by whether they share tissue.
    ///
    /// They do as [`shares_tissue`] says of their seeds, with one region's width as slack.
    pub(crate) fn pairs_within(&self, surface: &Surface, reach: f64) -> RegionPairs {
        let point = |region: usize| surface.vertices()[self.seed(region)];
        let (width, near) = (2.0 * self.radius, reach + 2.0 * self.radius);
        let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
        let cell = |region: usize| <[i64; 3]>::from(point(region).map(|c| (c / near).floor() as i64));
        for region in 0..self.count() {
            cells.entry(cell(region)).or_default().push(region as u32);
        }
        let mut spread = Spread::new(self.count());
        let way = |a: u32| self.beside[self.starts[a as usize]..self.starts[a as usize + 1]].iter().copied();
        let mut sharing: Vec<Vec<u32>> = (0..self.count() as u32).map(|region| vec![region]).collect();
        let mut apart = vec![Vec::new(); self.count()];
        for region in 0..self.count() {
            spread.from(&[region as u32], LONGEST_DETOUR * near + width, way);
            let [x, y, z] = cell(region);
            let around = (0..27).map(|k| [x + k / 9 - 1, y + k / 3 % 3 - 1, z + k % 3 - 1]);
            for &other in around.filter_map(|key| cells.get(&key)).flatten() {
                // Each pair once: rounding may differ on the way back.
                let straight = (point(other as usize) - point(region)).norm();
                if other as usize > region && straight < near {
                    let along = spread.distance[other as usize];
                    let lists = if shares_tissue(along, straight, width) { &mut sharing } else { &mut apart };
                    lists[region].push(other);
                    lists[other as usize].push(region as u32);
                }
            }
        }
        sharing.iter_mut().chain(&mut apart).for_each(|others| others.sort_unstable());
        RegionPairs { sharing, apart }
    }
}

/// Per region others within reach, ascending.
#[derive(Debug)]
pub(crate) struct RegionPairs {
    /// Those that share tissue with it, itself included.
    pub(crate) sharing: Vec<Vec<u32>>,
    /// Those that do not.
    pub(crate) apart: Vec<Vec<u32>>,
}

/// Shortest ways from some sources (Dijkstra 1959), with memory that is used again.
struct Spread {
    distance: Vec<f64>,
    /// Number of the source that each place is nearest to.
    source: Vec<u32>,
    reached: Vec<u32>,
    queue: BinaryHeap<Reverse<Front>>,
}

impl Spread {
    fn new(places: usize) -> Self {
        let (distance, source) = (vec![f64::INFINITY; places], vec![NONE; places]);
        Self { distance, source, reached: Vec::new(), queue: BinaryHeap::new() }
    }

    fn from<I: Iterator<Item = (u32, f64)>>(&mut self, sources: &[u32], limit: f64, way: impl Fn(u32) -> I) {
        for &place in &self.reached {
            self.distance[place as usize] = f64::INFINITY;
            self.source[place as usize] = NONE;
        }
        self.reached.clear();
        for (number, &place) in sources.iter().enumerate() {
            self.distance[place as usize] = 0.0;
            self.source[place as usize] = number as u32;
            self.reached.push(place);
            self.queue.push(Reverse(Front(0.0, place)));
        }
        while let Some(Reverse(Front(distance, place))) = self.queue.pop() {
            if distance > self.distance[place as usize] {
                continue;
            }
            for (next, length) in way(place) {
                let further = distance + length;
                let known = self.distance[next as usize];
                if further < known && further <= limit {
                    if known == f64::INFINITY {
                        self.reached.push(next);
                    }
                    self.distance[next as usize] = further;
                    self.source[next as usize] = self.source[place as usize];
                    self.queue.push(Reverse(Front(further, next)));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A strip that is folded: two flat legs 2 mm apart, 20 mm long, joined by a flat bottom.
    fn folded(cells: usize) -> Surface {
        let (leg, bottom) = (20e-3, 2e-3);
        let length = 2.0 * leg + bottom;
        let mut vertices = Vec::new();
        for i in 0..=cells {
            let s = length * i as f64 / cells as f64;
            let (x, z) = if s < leg {
                (0.0, leg - s)
            } else if s < leg + bottom {
                (s - leg, 0.0)
            } else {
                (bottom, s - leg - bottom)
            };
            vertices.extend((0..=4).map(|j| Vector3::new(x, 1e-3 * j as f64, z)));
        }
        let at = |i: usize, j: usize| (5 * i + j) as u32;
        let mut faces = Vec::new();
        for i in 0..cells {
            for j in 0..4 {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        Surface::new(vertices, faces).expect("a strip is a valid surface")
    }

    #[test]
    fn no_vertex_is_farther_from_its_seed_than_the_radius() {
        let surface = folded(60);
        for radius in [1e-4, 1.5e-3, 1.0] {
            let regions = SkinRegions::new(&surface, radius);
            for region in 0..regions.count() {
                let near = surface.skin_distances(&[regions.seed(region)], radius);
                let own = (0..surface.vertices().len()).filter(|&v| regions.of(v) == region);
                for vertex in own {
                    assert!(near.binary_search_by_key(&vertex, |entry| entry.0).is_ok());
                }
            }
        }
        assert_eq!(SkinRegions::new(&surface, 1e-4).count(), surface.vertices().len());
        assert_eq!(SkinRegions::new(&surface, 1.0).count(), 1);
    }

    #[test]
    fn legs_of_a_fold_are_apart_above_the_bottom_and_joined_near_it() {
        let surface = folded(84);
        let (radius, reach) = (1e-3, 6e-3);
        let regions = SkinRegions::new(&surface, radius);
        let RegionPairs { sharing, apart } = regions.pairs_within(&surface, reach);
        let mut pairs = 0;
        for (a, others) in apart.iter().enumerate() {
            assert!(sharing[a].contains(&(a as u32)) && sharing[a].iter().all(|b| !others.contains(b)));
            let (p, mine) = (surface.vertices()[regions.seed(a)], regions.seed(a));
            for &b in others {
                assert!(apart[b as usize].contains(&(a as u32)), "the relation is symmetric");
                let q = surface.vertices()[regions.seed(b as usize)];
                assert!(p.x != q.x, "one leg is in one piece");
                pairs += 1;
            }
            // every pair of legs' seeds at a height of 10 mm or more, at once
            for b in (0..regions.count()).filter(|&b| p.z.min(surface.vertices()[regions.seed(b)].z) > 10e-3)
            {
                let q = surface.vertices()[regions.seed(b)];
                if (p.x - q.x).abs() > 1e-3 && (p - q).norm() < reach {
                    assert!(others.contains(&(b as u32)), "{mine} {b}");
                }
            }
        }
        assert!(pairs > 0);
    }
}
