//! Fingers: parts of the skin that touch without feeling each other.
//!
//! A kernel depends on the straight line between two points alone, so on a hand one fingertip would press down its
//! neighbour through the air. Candidates are on different fingers where the way along the skin is long against the
//! straight line ([`shares_tissue`]) and that line leaves the skin: a palm and the back of its hand are one.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::geometry::solid_angle::winding_number;
use crate::surface::checked::Surface;
use crate::surface::shortest_paths::{NearestAlongSkin, shares_tissue};

/// Slack of the way along the skin (mean edge lengths): between patches a few edges apart a path of edges may
/// be long against the straight line for no reason but the mesh.
const SLACK_EDGES: f64 = 4.0;

/// Share of the skin's diagonal beyond which a search along the skin may as well take all of it.
const MOST_OF_SKIN: f64 = 0.3;

/// The shortest way along the skin between two sets of candidates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Its length (m).
    pub along_skin: f64,
    /// Straight line between its ends (m).
    pub straight: f64,
    /// The vertices at its ends.
    pub ends: [usize; 2],
}

/// The fingers in contact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fingers {
    /// Candidates of each, ascending; ordered by the first. All in one where they share tissue.
    pub candidates: Vec<Vec<usize>>,
    /// Shortest way between two of them, where the skin has one, the shortest first.
    pub ways: Vec<([usize; 2], Way)>,
    /// What is known of every vertex; `None` with one finger.
    vertices: Option<NearestAlongSkin>,
    /// Finger of each candidate (n); `usize::MAX` elsewhere. Empty with one finger.
    of_candidate: Vec<usize>,
}

impl Fingers {
    /// All candidates feel each other.
    pub fn one(candidates: &[usize]) -> Self {
        Self {
            candidates: vec![candidates.to_vec()],
            ways: Vec::new(),
            vertices: None,
            of_candidate: Vec::new(),
        }
    }

    /// Fingers that only their candidates are asked of.
    pub fn listed(candidates: Vec<Vec<usize>>) -> Self {
        Self { candidates, ways: Vec::new(), vertices: None, of_candidate: Vec::new() }
    }

    /// Splits candidates into fingers: patches that share no tissue.
    ///
    /// Patches that share tissue with a third are on one finger. The search along the skin covers what could be
    /// one finger first, and the whole surface only where there are two or more.
    pub fn split_by_tissue(surface: &Surface, candidates: &[usize]) -> Self {
        let patches = surface.patches(candidates);
        if patches.len() < 2 {
            return Self::one(candidates);
        }
        let slack = SLACK_EDGES * surface.mean_edge_length();
        let mut label = vec![usize::MAX; surface.vertices().len()];
        for (index, patch) in patches.iter().enumerate() {
            patch.iter().for_each(|&vertex| label[vertex] = index);
        }
        // Two searches meet half-way, so ways up to twice the candidates' extent are found.
        let extent = Bounds::around(candidates.iter().map(|&vertex| &surface.vertices()[vertex])).diagonal();
        let reach = extent + slack;
        // Where that is most of the skin, one search serves for the fingers too.
        let covers_all = reach > MOST_OF_SKIN * surface.bounding_box().diagonal();
        let near = surface.nearest_along_skin(candidates, if covers_all { f64::INFINITY } else { reach });
        let mut finger_of_patch: Vec<usize> = (0..patches.len()).collect();
        for ([a, b], way) in shortest_ways(surface, &near, &label, reach) {
            if shares_tissue(way.along_skin, way.straight, slack) || joined_inside(surface, way.ends) {
                let (kept, merged) = (finger_of_patch[a], finger_of_patch[b]);
                finger_of_patch.iter_mut().filter(|finger| **finger == merged).for_each(|f| *f = kept);
            }
        }
        let mut by_finger: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (patch, finger) in patches.into_iter().zip(finger_of_patch) {
            by_finger.entry(finger).or_default().extend(patch);
        }
        Self::searched(surface, by_finger.into_values().collect(), covers_all.then_some(near))
    }

    /// Fingers of which the candidates are known.
    pub fn apart(surface: &Surface, fingers: Vec<Vec<usize>>) -> Self {
        Self::searched(surface, fingers, None)
    }

    /// Fingers of which the candidates are known, and maybe what is nearest to each vertex of the skin.
    fn searched(surface: &Surface, mut fingers: Vec<Vec<usize>>, nearest: Option<NearestAlongSkin>) -> Self {
        let candidates = fingers.concat();
        if fingers.len() < 2 {
            return Self::one(&candidates);
        }
        let mut label = vec![usize::MAX; surface.vertices().len()];
        fingers.iter_mut().for_each(|finger| finger.sort_unstable());
        fingers.sort_unstable_by_key(|finger| finger[0]);
        for (index, finger) in fingers.iter().enumerate() {
            finger.iter().for_each(|&vertex| label[vertex] = index);
        }
        let vertices = nearest.unwrap_or_else(|| surface.nearest_along_skin(&candidates, f64::INFINITY));
        let mut ways: Vec<_> = shortest_ways(surface, &vertices, &label, f64::INFINITY).into_iter().collect();
        ways.sort_by(|a, b| a.1.along_skin.total_cmp(&b.1.along_skin).then(a.0.cmp(&b.0)));
        Self { candidates: fingers, ways, vertices: Some(vertices), of_candidate: label }
    }

    /// Candidates by the finger that each vertex of the skin was found to belong to before.
    pub fn as_before(surface: &Surface, candidates: &[usize], finger_of: &[Option<usize>]) -> Self {
        let mut by_finger: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
        for &vertex in candidates {
            by_finger.entry(finger_of[vertex]).or_default().push(vertex);
        }
        Self::apart(surface, by_finger.into_values().collect())
    }

    /// Finger nearest to a vertex along the skin, whose forces move it; `None` where the skin leads to none.
    pub fn finger_of(&self, vertex: usize) -> Option<usize> {
        match &self.vertices {
            None => Some(0),
            Some(nearest) => nearest.source(vertex).map(|source| self.of_candidate[source]),
        }
    }

    /// Way along the skin from a vertex to its finger's candidates (m).
    pub fn distance(&self, vertex: usize) -> Option<f64> {
        self.vertices.as_ref().map(|nearest| nearest.distance[vertex])
    }

    /// Way along the skin from a finger to the next one (m); infinite where the skin leads to none.
    pub fn distance_to_next(&self, finger: usize) -> f64 {
        let of_finger = |(pair, _): &&([usize; 2], Way)| pair.contains(&finger);
        self.ways.iter().find(of_finger).map_or(f64::INFINITY, |(_, way)| way.along_skin)
    }
}

/// Points on the line between two vertices that must lie inside the skin.
const LINE_POINTS: usize = 12;

/// Whether the straight line between two vertices runs inside the skin all the way.
fn joined_inside(surface: &Surface, ends: [usize; 2]) -> bool {
    let [a, b] = ends.map(|end| surface.vertices()[end]);
    let inward = |end: usize, towards: Vector3<f64>| surface.vertex_normals()[end].dot(&towards) < 0.0;
    let inside = |k: usize| {
        let share = (k as f64 + 0.5) / LINE_POINTS as f64;
        winding_number(&a.lerp(&b, share), surface.vertices(), surface.faces().iter().copied()) > 0.5
    };
    inward(ends[0], b - a) && inward(ends[1], a - b) && (0..LINE_POINTS).all(inside)
}

/// The shortest way found between any two sets of sources, by their `label`: where the searches from
/// both meet on an edge, neither farther than `reach` (m) from its source.
fn shortest_ways(
    surface: &Surface,
    nearest: &NearestAlongSkin,
    label: &[usize],
    reach: f64,
) -> BTreeMap<[usize; 2], Way> {
    let mut ways: BTreeMap<[usize; 2], Way> = BTreeMap::new();
    let source_of = |vertex: usize| nearest.source(vertex).filter(|_| nearest.distance[vertex] <= reach);
    for vertex in 0..label.len() {
        let Some(source) = source_of(vertex) else { continue };
        for &other in surface.neighbours(vertex) {
            let other = other as usize;
            let Some(other_source) = source_of(other).filter(|_| other > vertex) else { continue };
            let ends = [source, other_source];
            let [a, b] = ends.map(|end| label[end]);
            if a == b {
                continue;
            }
            let step = |from: usize, to: usize| (surface.vertices()[from] - surface.vertices()[to]).norm();
            let along_skin = nearest.distance[vertex] + step(vertex, other) + nearest.distance[other];
            let way = Way { along_skin, straight: step(ends[0], ends[1]), ends };
            let known = ways.entry([a.min(b), a.max(b)]).or_insert(way);
            if along_skin < known.along_skin {
                *known = way;
            }
        }
    }
    ways
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::sample::grid;

    /// Two ridges of skin 20 mm apart and 40 mm deep, with a strip of flat skin beside them; the vertices at their crests.
    fn two_ridges(flat_columns: usize) -> (Surface, Vec<usize>) {
        let bent_columns = 80;
        let (flat, faces) = grid(bent_columns + flat_columns, 8, 1.0);
        let bent = |x: &Vector3<f64>| {
            let along = (2.0 * x.x / bent_columns as f64).min(2.0);
            let beside = 2e-3 * (x.x - bent_columns as f64).max(0.0);
            Vector3::new(20e-3 * along + beside, 1e-3 * x.y, -20e-3 * (1.0 - (TAU * along).cos()))
        };
        let vertices: Vec<Vector3<f64>> = flat.iter().map(bent).collect();
        let crests = (0..vertices.len()).filter(|&vertex| vertices[vertex].z < -39e-3).collect();
        (Surface::new(vertices, faces).expect("a bent grid"), crests)
    }

    #[test]
    fn fingers_are_those_of_a_search_over_the_whole_skin_wherever_they_were_found() {
        // The first search covers all of the small skin, and only what is near on the large one.
        for flat_columns in [0, 100] {
            let (surface, crests) = two_ridges(flat_columns);
            let fingers = Fingers::split_by_tissue(&surface, &crests);
            assert_eq!(fingers.candidates.len(), 2);
            assert_eq!(fingers, Fingers::apart(&surface, fingers.candidates.clone()));
            assert!(fingers.finger_of(surface.vertices().len() - 1).is_some());
        }
    }
}
