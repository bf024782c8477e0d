//! Ways between patches of candidates: along the skin, and straight through tissue or air.
//!
//! They lead from middle to middle: where a patch ends hangs on single vertices, and changes with every depth.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::geometry::solid_angle::winding_number;
use crate::surface::checked::Surface;
use crate::surface::shortest_paths::NearestAlongSkin;

/// Points on the line between two vertices that must lie inside the skin.
const LINE_POINTS: usize = 12;

/// How far the middles of two patches are from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Along the skin (m); infinite where none leads from one to the other.
    pub along_skin: f64,
    /// In a straight line (m).
    pub straight: f64,
    /// The vertices there.
    pub ends: [usize; 2],
}

/// The ways between the middles of each two patches.
///
/// Where a third one lies between two, the way along the skin leads over that one.
///
/// * `middles`: a vertex of each
/// * `near`: the nearest of them to each vertex of the skin, so far as it was looked for
pub(crate) fn ways_between(
    surface: &Surface,
    middles: &[usize],
    near: &NearestAlongSkin,
) -> Vec<([usize; 2], Way)> {
    let mut label = vec![usize::MAX; surface.vertices().len()];
    middles.iter().enumerate().for_each(|(index, &vertex)| label[vertex] = index);
    let count = middles.len();
    let mut lengths = vec![vec![f64::INFINITY; count]; count];
    for ([a, b], length) in shortest_ways(surface, near, &label) {
        lengths[a][b] = length;
        lengths[b][a] = length;
    }
    for between in 0..count {
        for a in 0..count {
            for b in 0..count {
                lengths[a][b] = lengths[a][b].min(lengths[a][between] + lengths[between][b]);
            }
        }
    }
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let way = |[a, b]: [usize; 2]| {
        let ends = [middles[a], middles[b]];
        ([a, b], Way { along_skin: lengths[a][b], straight: distance(surface, ends), ends })
    };
    pairs.map(way).collect()
}

/// The vertex of a patch that is nearest to its middle.
///
/// * `weight`: of a vertex (≥ 0)
pub(crate) fn middle(surface: &Surface, patch: &[usize], weight: impl Fn(usize) -> f64) -> usize {
    let sum = |weight: &dyn Fn(usize) -> f64| {
        let weighed =
            patch.iter().map(|&vertex| (weight(vertex), weight(vertex) * surface.vertices()[vertex]));
        weighed.fold((0.0, Vector3::zeros()), |(whole, sum), (weight, x)| (whole + weight, sum + x))
    };
    let (mut whole, mut weighed) = sum(&weight);
    if whole == 0.0 {
        (whole, weighed) = sum(&|_| 1.0);
    }
    let middle = weighed / whole;
    let squared = |vertex: usize| (surface.vertices()[vertex] - middle).norm_squared();
    let nearest = patch.iter().copied().min_by(|&a, &b| squared(a).total_cmp(&squared(b)));
    nearest.expect("no patch is empty")
}

fn distance(surface: &Surface, [a, b]: [usize; 2]) -> f64 {
    (surface.vertices()[a] - surface.vertices()[b]).norm()
}

/// Whether the straight line between two vertices of one piece of the skin runs inside that all the way, and once: where it
/// crosses itself, as fingers that overlap a thin sheet from both sides do, the line is in the tissue of neither.
pub(crate) fn joined_inside(surface: &Surface, ends: [usize; 2]) -> bool {
    let pieces = surface.topology().face_components();
    let [piece, other] = ends.map(|end| surface.faces_around(end).first().map(|&face| pieces[face as usize]));
    if piece != other {
        return false;
    }
    let [a, b] = ends.map(|end| surface.vertices()[end]);
    let inward = |end: usize, towards: Vector3<f64>| surface.vertex_normals()[end].dot(&towards) < 0.0;
    if !inward(ends[0], b - a) || !inward(ends[1], a - b) {
        return false;
    }
    let own = surface.faces().iter().zip(pieces).filter(|(_, label)| Some(**label) == piece);
    let own: Vec<[u32; 3]> = own.map(|(face, _)| *face).collect();
    (0..LINE_POINTS).all(|k| {
        let share = (k as f64 + 0.5) / LINE_POINTS as f64;
        let turns = winding_number(&a.lerp(&b, share), surface.vertices(), own.iter().copied());
        (0.5..1.5).contains(&turns)
    })
}

/// Length (m) of the shortest path of edges found between any two sets of sources, by their `label`: where the searches from
/// both meet on an edge.
pub(crate) fn shortest_ways(
    surface: &Surface,
    nearest: &NearestAlongSkin,
    label: &[usize],
) -> BTreeMap<[usize; 2], f64> {
    let mut lengths: BTreeMap<[usize; 2], f64> = BTreeMap::new();
    for vertex in 0..label.len() {
        let Some(source) = nearest.source(vertex) else { continue };
        for &other in surface.neighbours(vertex) {
            let other = other as usize;
            let Some(other_source) = nearest.source(other).filter(|_| other > vertex) else { continue };
            let [a, b] = [source, other_source].map(|end| label[end]);
            if a != b {
                let step = distance(surface, [vertex, other]);
                let length = nearest.distance[vertex] + step + nearest.distance[other];
                let known = lengths.entry([a.min(b), a.max(b)]).or_insert(length);
                *known = known.min(length);
            }
        }
    }
    lengths
}
