//! Green cuts: what becomes of a triangle with halved edges that is not cut in four.
//!
//! It is cut in two or three where that leaves half of the smallest angle of the given face; else its longest edge is halved
//! too, or it is cut in four as well (Rivara 1984). No choice hangs on the numbering or on rounding.

use nalgebra::Vector3;

use crate::mesh::remesh::red_green::RedGreen;
use crate::mesh::remesh::smooth::SmoothMesh;

/// Least share of the smallest angle of the given face that a green cut leaves.
const LEAST_ANGLE_SHARE: f64 = 0.5;

/// Lengths and angles whose ratio is nearer to one are the same.
const SAME_RATIO: f64 = 1e-6;

/// What becomes of a leaf beside halved edges.
pub(super) enum Fate {
    Stays(Replacement),
    HalvesToo([u32; 2]),
    TurnsRed,
}

/// One to three triangles in the place of a leaf.
#[derive(Clone, Copy)]
pub(super) struct Replacement {
    count: usize,
    all: [[u32; 3]; 3],
}

impl Replacement {
    fn none(corners: [u32; 3]) -> Self {
        Self { count: 1, all: [corners; 3] }
    }

    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        self.all.into_iter().take(self.count)
    }
}

impl RedGreen {
    /// What becomes of a leaf with the halved edges that it has.
    pub(super) fn fate(&self, mesh: &SmoothMesh, leaf: usize) -> Fate {
        let corners = self.leaves[leaf].corners;
        let middles = [0, 1, 2].map(|side| self.middle_of(corners[side], corners[(side + 1) % 3]));
        // The halved edge before which one is whole comes first.
        let Some((turn, first)) = (0..3).find_map(|side| {
            middles[side].filter(|_| middles[(side + 2) % 3].is_none()).map(|it| (side, it))
        }) else {
            return if middles[0].is_none() {
                Fate::Stays(Replacement::none(corners))
            } else {
                Fate::TurnsRed
            };
        };
        let [p, q, r] = [0, 1, 2].map(|corner| corners[(turn + corner) % 3]);
        let second = middles[(turn + 1) % 3];
        let is_halved_again =
            |from, middle, to| [[from, middle], [middle, to]].into_iter().any(|half| self.is_halved(half));
        if is_halved_again(p, first, q) || second.is_some_and(|second| is_halved_again(q, second, r)) {
            return Fate::TurnsRed;
        }
        let least = |corners: [u32; 3]| smallest_angle(corners.map(|vertex| self.point(mesh, vertex)));
        let worst = |cuts: &Replacement| cuts.triangles().map(least).fold(f64::INFINITY, f64::min);
        let allowed = LEAST_ANGLE_SHARE * least(mesh.faces[self.leaves[leaf].face as usize]);
        let Some(second) = second else {
            let cut = Replacement { count: 2, all: [[p, first, r], [first, q, r], [p; 3]] };
            if worst(&cut) >= allowed {
                return Fate::Stays(cut);
            }
            let longest = self.longest_edge(mesh, corners).filter(|&ends| !self.is_halved(ends));
            return longest.map_or(Fate::TurnsRed, Fate::HalvesToo);
        };
        let ways = [
            Replacement { count: 3, all: [[first, q, second], [p, first, second], [p, second, r]] },
            Replacement { count: 3, all: [[first, q, second], [p, first, r], [first, second, r]] },
        ];
        let angles = ways.each_ref().map(worst);
        let better = usize::from(angles[1] > angles[0]);
        if angles[better] < allowed || (angles[0] - angles[1]).abs() < SAME_RATIO * angles[better] {
            return Fate::TurnsRed;
        }
        Fate::Stays(ways[better])
    }

    fn is_halved(&self, [from, to]: [u32; 2]) -> bool {
        self.middle_of(from, to).is_some()
    }

    /// The longest edge of a triangle, if there is one.
    fn longest_edge(&self, mesh: &SmoothMesh, corners: [u32; 3]) -> Option<[u32; 2]> {
        let length = |[from, to]: [u32; 2]| (self.point(mesh, from) - self.point(mesh, to)).norm();
        let [a, b, c] = corners;
        let mut edges = [[a, b], [b, c], [c, a]].map(|ends| (length(ends), ends));
        edges.sort_by(|a, b| b.0.total_cmp(&a.0));
        (edges[0].0 > (1.0 + SAME_RATIO) * edges[1].0).then_some(edges[0].1)
    }
}

/// Smallest angle of a triangle (rad).
pub(crate) fn smallest_angle(corners: [Vector3<f64>; 3]) -> f64 {
    let angle = |k: usize| {
        let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
        u.cross(&v).norm().atan2(u.dot(&v))
    };
    angle(0).min(angle(1)).min(angle(2))
}
