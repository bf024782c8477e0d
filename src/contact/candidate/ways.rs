//! Ways between patches of candidates: along the skin, and straight through tissue or air.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::geometry::solid_angle::winding_number;
use crate::surface::checked::Surface;
use crate::surface::shortest_paths::NearestAlongSkin;

/// Points on the line between two vertices that must lie inside the skin.
const LINE_POINTS: usize = 12;

/// How far two patches are from each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Way {
    /// Along the skin (m); infinite where none leads from one to the other.
    pub along_skin: f64,
    /// In a straight line (m).
    pub straight: f64,
    /// The vertices at the ends of that.
    pub closest: [usize; 2],
}

/// A path of edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Path {
    /// (m)
    pub length: f64,
    /// The vertices at its ends.
    pub ends: [usize; 2],
}

/// The ways between each two patches.
///
/// Where a third one lies between two, the way along the skin leads over that one.
///
/// * `near`: what is nearest to each vertex of the skin, so far as it was looked for
pub(crate) fn ways_between(
    surface: &Surface,
    patches: &[Vec<usize>],
    near: &NearestAlongSkin,
) -> Vec<([usize; 2], Way)> {
    let mut label = vec![usize::MAX; surface.vertices().len()];
    for (index, patch) in patches.iter().enumerate() {
        patch.iter().for_each(|&vertex| label[vertex] = index);
    }
    let count = patches.len();
    let mut paths: Vec<Vec<Option<Path>>> = vec![vec![None; count]; count];
    for ([a, b], path) in shortest_ways(surface, near, &label) {
        paths[a][b] = Some(path);
        paths[b][a] = Some(path.back());
    }
    for between in 0..count {
        for a in 0..count {
            for b in (0..count).filter(|&b| b != a) {
                let (Some(to), Some(from)) = (paths[a][between], paths[between][b]) else { continue };
                let over = distance(surface, [to.ends[1], from.ends[0]]);
                let length = to.length + over + from.length;
                if paths[a][b].is_none_or(|known| length < known.length) {
                    paths[a][b] = Some(Path { length, ends: [to.ends[0], from.ends[1]] });
                }
            }
        }
    }
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    let way = |[a, b]: [usize; 2]| {
        let closest = closest(surface, &patches[a], &patches[b]);
        let along_skin = paths[a][b].map_or(f64::INFINITY, |path| path.length);
        ([a, b], Way { along_skin, straight: distance(surface, closest), closest })
    };
    pairs.map(way).collect()
}

impl Path {
    fn back(self) -> Self {
        let [a, b] = self.ends;
        Self { ends: [b, a], ..self }
    }
}

fn distance(surface: &Surface, [a, b]: [usize; 2]) -> f64 {
    (surface.vertices()[a] - surface.vertices()[b]).norm()
}

/// The two vertices of two patches that are nearest to each other.
fn closest(surface: &Surface, patch: &[usize], other: &[usize]) -> [usize; 2] {
    let pairs = patch.iter().flat_map(|&a| other.iter().map(move |&b| [a, b]));
    let squared = |[a, b]: [usize; 2]| (surface.vertices()[a] - surface.vertices()[b]).norm_squared();
    pairs.min_by(|&one, &two| squared(one).total_cmp(&squared(two))).expect("no patch is empty")
}

/// Whether the straight line between two vertices runs inside the skin all the way.
pub(crate) fn joined_inside(surface: &Surface, ends: [usize; 2]) -> bool {
    let [a, b] = ends.map(|end| surface.vertices()[end]);
    let inward = |end: usize, towards: Vector3<f64>| surface.vertex_normals()[end].dot(&towards) < 0.0;
    let inside = |k: usize| {
        let share = (k as f64 + 0.5) / LINE_POINTS as f64;
        winding_number(&a.lerp(&b, share), surface.vertices(), surface.faces().iter().copied()) > 0.5
    };
    inward(ends[0], b - a) && inward(ends[1], a - b) && (0..LINE_POINTS).all(inside)
}

/// The shortest path found between any two sets of sources, by their `label`: where the searches from
/// both meet on an edge. The lower label comes first.
pub(crate) fn shortest_ways(
    surface: &Surface,
    nearest: &NearestAlongSkin,
    label: &[usize],
) -> BTreeMap<[usize; 2], Path> {
    let mut paths: BTreeMap<[usize; 2], Path> = BTreeMap::new();
    for vertex in 0..label.len() {
        let Some(source) = nearest.source(vertex) else { continue };
        for &other in surface.neighbours(vertex) {
            let other = other as usize;
            let Some(other_source) = nearest.source(other).filter(|_| other > vertex) else { continue };
            let [a, b] = [source, other_source].map(|end| label[end]);
            if a == b {
                continue;
            }
            let length =
                nearest.distance[vertex] + distance(surface, [vertex, other]) + nearest.distance[other];
            let path = Path { length, ends: [source, other_source] };
            let path = if a < b { path } else { path.back() };
            let known = paths.entry([a.min(b), a.max(b)]).or_insert(path);
            if length < known.length {
                *known = path;
            }
        }
    }
    paths
}
