//! Fingers: parts of the skin that touch without feeling all of each other.
//!
//! A kernel depends on the straight line between two points alone, so on a hand one fingertip would press down its
//! neighbour through the air. Candidates are on different fingers where the way along the skin is long against the
//! straight line ([`shared_tissue`]) and that line leaves the skin: a palm and the back of its hand are one.

use std::collections::BTreeMap;

use faer::Mat;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::candidate::coupling::Coupling;
use crate::contact::candidate::ways::{Way, joined_inside, middle, shortest_ways, ways_between};
use crate::geometry::bounds::Bounds;
use crate::linalg::columns::par_columns;
use crate::surface::checked::Surface;
use crate::surface::shortest_paths::{NearestAlongSkin, shared_tissue};

/// Share of the skin's diagonal beyond which a search along the skin may as well take all of it.
const MOST_OF_SKIN: f64 = 0.3;

/// The fingers in contact.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fingers {
    /// Candidates of each, ascending; ordered by the first. All in one where they share their tissue.
    pub candidates: Vec<Vec<usize>>,
    /// What they feel of each other.
    pub coupling: Coupling,
    /// The way between the two that feel least of each other, where that was looked for.
    pub parting: Option<Way>,
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
            coupling: Coupling::one(),
            parting: None,
            vertices: None,
            of_candidate: Vec::new(),
        }
    }

    /// Fingers that only their candidates are asked of.
    pub fn listed(candidates: Vec<Vec<usize>>, coupling: Coupling) -> Self {
        Self { candidates, coupling, parting: None, vertices: None, of_candidate: Vec::new() }
    }

    /// Splits candidates into fingers: patches that do not feel the same of all others. What a body or a matrix passes on
    /// is right as it is.
    ///
    /// The search along the skin covers what could be one finger first, and the whole surface only where there are two or
    /// more.
    ///
    /// * `gap`: of the undeformed skin's vertices (n, m)
    /// * `is_under_kernel`: whether a kernel answers at a vertex
    pub fn split_by_tissue(
        surface: &Surface,
        candidates: &[usize],
        gap: &[f64],
        is_under_kernel: impl Fn(usize) -> bool,
    ) -> Self {
        let patches = surface.patches(candidates);
        let is_under_kernel: Vec<bool> = patches.iter().map(|patch| is_under_kernel(patch[0])).collect();
        if is_under_kernel.iter().filter(|is_so| **is_so).count() < 2 {
            return Self::one(candidates);
        }
        let pressed = |vertex: usize| surface.vertex_areas()[vertex] * (-gap[vertex]).max(0.0);
        let middles: Vec<usize> = patches.iter().map(|patch| middle(surface, patch, pressed)).collect();
        // Two searches meet half-way, so ways up to twice the patches' extent are found.
        let extent = Bounds::around(middles.iter().map(|&vertex| &surface.vertices()[vertex])).diagonal();
        let is_whole = extent > MOST_OF_SKIN * surface.bounding_box().diagonal();
        let felt_within = |reach: f64| {
            let near = surface.nearest_along_skin(&middles, reach);
            let ways = ways_between(surface, &middles, &near);
            let share = |pair: [usize; 2], way: &Way| {
                if pair.iter().all(|&patch| is_under_kernel[patch]) { felt(surface, way) } else { 1.0 }
            };
            ways.into_iter().map(|(pair, way)| (pair, share(pair, &way), way)).collect::<Vec<_>>()
        };
        let mut shares = felt_within(if is_whole { f64::INFINITY } else { extent });
        if shares.iter().all(|(_, share, _)| *share == 1.0) {
            return Self::one(candidates);
        }
        if !is_whole {
            shares = felt_within(f64::INFINITY);
        }
        let parting = shares.iter().min_by(|(_, a, _), (_, b, _)| a.total_cmp(b)).map(|(.., way)| *way);
        let coupling = Coupling::new(patches.len(), shares.into_iter().map(|(pair, share, _)| (pair, share)));
        let mut by_finger: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, patch) in patches.into_iter().enumerate() {
            by_finger.entry(coupling.same_as(index)).or_default().extend(patch);
        }
        Self { parting, ..Self::searched(surface, by_finger, &coupling, None) }
    }

    /// Patches of candidates as one solid feels them that they all press.
    ///
    /// * `normals`: of the solid at the candidates
    pub fn on_solid(surface: &Surface, candidates: &[usize], normals: &[Vector3<f64>]) -> Self {
        let patches = surface.patches(candidates);
        let pushed = |&vertex: &usize| {
            let row = candidates.binary_search(&vertex).expect("a candidate");
            surface.vertex_areas()[vertex] * normals[row]
        };
        let ways: Vec<Vector3<f64>> = patches.iter().map(|patch| patch.iter().map(pushed).sum()).collect();
        let coupling = Coupling::through_solid(&ways);
        if coupling.extremes()[0] == 1.0 {
            return Self::one(candidates);
        }
        Self::known(surface, patches, &coupling)
    }

    /// Fingers of which the candidates are known.
    pub fn known(surface: &Surface, fingers: Vec<Vec<usize>>, coupling: &Coupling) -> Self {
        Self::searched(surface, fingers.into_iter().enumerate().collect(), coupling, None)
    }

    /// * `fingers`: candidates by their numbers in `coupling`
    /// * `known`: a search from some of them
    fn searched(
        surface: &Surface,
        fingers: BTreeMap<usize, Vec<usize>>,
        coupling: &Coupling,
        known: Option<NearestAlongSkin>,
    ) -> Self {
        let mut fingers = Vec::from_iter(fingers);
        fingers.iter_mut().for_each(|(_, finger)| finger.sort_unstable());
        let candidates: Vec<usize> = fingers.iter().flat_map(|(_, finger)| finger).copied().collect();
        if fingers.len() < 2 {
            return Self::one(&candidates);
        }
        let mut label = vec![usize::MAX; surface.vertices().len()];
        fingers.sort_unstable_by_key(|(_, finger)| finger[0]);
        let (numbers, fingers): (Vec<usize>, Vec<Vec<usize>>) = fingers.into_iter().unzip();
        for (index, finger) in fingers.iter().enumerate() {
            finger.iter().for_each(|&vertex| label[vertex] = index);
        }
        let mut vertices = known.unwrap_or_else(|| surface.nearest_along_skin(&[], f64::INFINITY));
        let added: Vec<usize> =
            candidates.iter().copied().filter(|&vertex| vertices.source(vertex) != Some(vertex)).collect();
        vertices.add_sources(surface, &added, f64::INFINITY);
        Self {
            candidates: fingers,
            coupling: coupling.among(&numbers),
            parting: None,
            vertices: Some(vertices),
            of_candidate: label,
        }
    }

    /// These on a mesh refined from that of theirs: each candidate belongs to the finger that the vertex nearest to it does.
    ///
    /// * `candidates`: of that mesh, ascending
    /// * `nearest`: vertex of the mesh of these nearest to each of the refined one
    pub fn on_refined(&self, refined: &Surface, candidates: &[usize], nearest: &[usize]) -> Self {
        let mut by_finger: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for &vertex in candidates {
            let finger = self.finger_of(nearest[vertex]).unwrap_or(usize::MAX);
            by_finger.entry(finger).or_default().push(vertex);
        }
        Self { parting: self.parting, ..Self::searched(refined, by_finger, &self.coupling, None) }
    }

    /// Whether a vertex is a candidate of these.
    pub fn has(&self, vertex: usize) -> bool {
        self.candidates.iter().any(|finger| finger.binary_search(&vertex).is_ok())
    }

    /// These with the candidates that joined their patches since; `None` where a patch is new or gone, or is of two fingers.
    ///
    /// * `candidates`: ascending
    pub fn grown_to(&self, surface: &Surface, candidates: &[usize]) -> Option<Self> {
        let mut own: Vec<usize> = self.candidates.iter().flatten().copied().collect();
        own.sort_unstable();
        if own == candidates {
            return Some(self.clone());
        }
        let is_gone = |vertex: &usize| candidates.binary_search(vertex).is_err();
        let patches = surface.patches(candidates);
        if own.iter().any(is_gone) || patches.len() != surface.patches(&own).len() {
            return None;
        }
        let mut by_finger: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for patch in patches {
            let known = patch.iter().filter(|vertex| own.binary_search(vertex).is_ok());
            let mut fingers = known.map(|&vertex| self.of_candidate.get(vertex).copied().unwrap_or(0));
            let finger = fingers.next()?;
            if fingers.any(|other| other != finger) {
                return None;
            }
            by_finger.entry(finger).or_default().extend(patch);
        }
        Some(Self {
            parting: self.parting,
            ..Self::searched(surface, by_finger, &self.coupling, self.vertices.clone())
        })
    }

    /// Candidates of fingers that feel each other, each ascending; ordered by the first.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let candidates = |group: Vec<usize>| {
            let mut all: Vec<usize> =
                group.iter().flat_map(|&finger| &self.candidates[finger]).copied().collect();
            all.sort_unstable();
            all
        };
        self.coupling.groups().into_iter().map(candidates).collect()
    }

    /// Leaves of the response of `nodes` to each other what their fingers feel.
    pub fn weaken(&self, nodes: &[usize], matrix: &mut Mat<f64>) {
        if self.candidates.len() < 2 {
            return;
        }
        let of_node: Vec<usize> = nodes.iter().map(|&node| self.of_candidate[node]).collect();
        let count = self.candidates.len();
        let felt = |finger: usize| (0..count).map(|other| self.coupling.between(finger, other)).collect();
        let felt: Vec<Vec<f64>> = (0..count).map(felt).collect();
        par_columns(matrix).zip(&of_node).for_each(|(column, &finger)| {
            let entries = column.iter_mut().zip(&of_node);
            entries.for_each(|(entry, &other)| *entry *= felt[finger][other]);
        });
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

    /// Way along the skin from each to the next one (m); infinite where the skin leads to none.
    pub fn distances_to_next(&self, surface: &Surface) -> Vec<f64> {
        let mut to_next = vec![f64::INFINITY; self.candidates.len()];
        let ways = self.vertices.iter().flat_map(|near| shortest_ways(surface, near, &self.of_candidate));
        for (pair, length) in ways {
            pair.into_iter().for_each(|finger| to_next[finger] = to_next[finger].min(length));
        }
        to_next
    }
}

/// What two patches under a kernel feel of each other, from 0 to 1.
fn felt(surface: &Surface, way: &Way) -> f64 {
    let share = shared_tissue(way.along_skin, way.straight);
    if share < 1.0 && joined_inside(surface, way.ends) { 1.0 } else { share }
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
            let gap = vec![0.0; surface.vertices().len()];
            let fingers = Fingers::split_by_tissue(&surface, &crests, &gap, |_| true);
            assert_eq!(fingers.candidates.len(), 2);
            let known = Fingers::known(&surface, fingers.candidates.clone(), &fingers.coupling);
            assert_eq!(Fingers { parting: None, ..fingers.clone() }, known);
            assert!(fingers.parting.is_some_and(|way| way.along_skin.is_finite()));
            assert!(fingers.finger_of(surface.vertices().len() - 1).is_some());
        }
    }

    #[test]
    fn fingers_that_grow_are_those_that_a_search_over_the_whole_skin_finds() {
        let (surface, crests) = two_ridges(0);
        let gap = vec![0.0; surface.vertices().len()];
        let split = |candidates: &[usize]| Fingers::split_by_tissue(&surface, candidates, &gap, |_| true);
        let fingers = split(&crests);
        let wider = surface.k_ring(&crests, 2);
        let (grown, expected) = (fingers.grown_to(&surface, &wider).expect("no patch is new"), split(&wider));
        assert_eq!((&grown.candidates, &grown.coupling), (&expected.candidates, &expected.coupling));
        assert_eq!(grown.distances_to_next(&surface), expected.distances_to_next(&surface));
        for vertex in 0..gap.len() {
            assert_eq!(grown.distance(vertex), expected.distance(vertex));
            assert_eq!(grown.finger_of(vertex), expected.finger_of(vertex));
        }
        assert_eq!(fingers.grown_to(&surface, &crests), Some(fingers.clone()));
        let between = (0..gap.len()).find(|vertex| !wider.contains(vertex)).expect("skin beside the ridges");
        let with_another: Vec<usize> = [between].into_iter().chain(crests.clone()).collect();
        let all = Vec::from_iter(0..gap.len());
        let one = Fingers::one(&crests);
        assert_eq!(one.grown_to(&surface, &wider), Some(Fingers::one(&wider)));
        for other in [&with_another, &all, &crests[1..].to_vec()] {
            let mut other = other.clone();
            other.sort_unstable();
            assert_eq!(fingers.grown_to(&surface, &other), None);
        }
    }
}
