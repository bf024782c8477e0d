//! A mesh on its way along a line: the leading face on each point's line.

use nalgebra::Vector3;
use parry3d_f64::partitioning::BvhNode;
use robust::{Coord, orient2d};

use crate::geometry::bounds::Bounds;
use crate::geometry::direction::tangents;
use crate::geometry::face_tree::node_bounds;
use crate::obstacle::mesh::MeshShape;

/// Rounding of boxes and lines, as a share of the lengths involved.
const BOX_SLACK: f64 = 1e-14;

/// A mesh seen along the direction of travel: places in the plane across it, and depths along it.
pub(super) struct Shadow<'a> {
    mesh: &'a MeshShape,
    direction: Vector3<f64>,
    across: [Vector3<f64>; 2],
    places: Vec<Coord<f64>>,
    depths: Vec<f64>,
    /// The largest of them.
    farthest: f64,
}

impl<'a> Shadow<'a> {
    /// `direction` is a unit vector in the mesh's frame.
    pub fn new(mesh: &'a MeshShape, direction: &Vector3<f64>) -> Shadow<'a> {
        let mut shadow = Shadow {
            mesh,
            direction: *direction,
            across: tangents(direction),
            places: Vec::new(),
            depths: Vec::new(),
            farthest: f64::NEG_INFINITY,
        };
        shadow.places = mesh.vertices().iter().map(|v| shadow.place(v)).collect();
        shadow.depths = mesh.vertices().iter().map(|v| v.dot(direction)).collect();
        shadow.farthest = shadow.depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        shadow
    }

    fn place(&self, p: &Vector3<f64>) -> Coord<f64> {
        Coord { x: p.dot(&self.across[0]), y: p.dot(&self.across[1]) }
    }

    /// The mesh.
    pub fn mesh(&self) -> &MeshShape {
        self.mesh
    }

    /// The smallest travel `>= start` at which `p` is on the surface; `None` if there is none, or none up to
    /// `latest`. Of the faces on the line it is the one that leads, so the one of the largest depth.
    pub fn meeting(&self, p: &Vector3<f64>, start: f64, latest: f64) -> Option<f64> {
        let depth = p.dot(&self.direction);
        let slack = BOX_SLACK * (self.mesh.size() + p.norm());
        if depth - self.farthest > latest + slack {
            return None;
        }
        let place = self.place(p);
        let deepest = depth - start;
        let cost = |node: &BvhNode, _: f64| match self.depths_in_box(p, depth, node_bounds(node).grown(slack))
        {
            Some([near, far]) if near - slack <= deepest => -(far + slack),
            _ => f64::MAX,
        };
        let leaf = |face: u32, _: f64| self.depth_on_face(face, place, deepest).map(|depth| -depth);
        // Costs are minus depths; a little worse than the best so far is let through, so that ties are seen.
        let bound = latest - depth + slack;
        let (_, cost) = self.mesh.tree().bvh().find_best(bound, cost, leaf)?;
        Some(depth + cost)
    }

    /// Depths at which the line through `p` enters and leaves the box.
    #[inline]
    fn depths_in_box(&self, p: &Vector3<f64>, depth: f64, bounds: Bounds) -> Option<[f64; 2]> {
        let Bounds { low, high } = bounds;
        let [mut near, mut far] = [f64::NEG_INFINITY, f64::INFINITY];
        for axis in 0..3 {
            let speed = self.direction[axis];
            if speed == 0.0 {
                if p[axis] < low[axis] || p[axis] > high[axis] {
                    return None;
                }
                continue;
            }
            let (one, other) = ((low[axis] - p[axis]) / speed, (high[axis] - p[axis]) / speed);
            near = near.max(one.min(other));
            far = far.min(one.max(other));
        }
        (near <= far).then_some([depth + near, depth + far])
    }

    /// The largest depth up to `deepest` at which the line through `place` meets the face.
    fn depth_on_face(&self, face: u32, place: Coord<f64>, deepest: f64) -> Option<f64> {
        let face = self.mesh.faces()[face as usize].map(|v| v as usize);
        let [a, b, c] = face.map(|v| self.places[v]);
        let depths = face.map(|v| self.depths[v]);
        let weights = [orient2d(b, c, place), orient2d(c, a, place), orient2d(a, b, place)];
        if weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0) {
            return None;
        }
        let total: f64 = weights.iter().sum();
        if total != 0.0 {
            let mean: f64 = weights.iter().zip(&depths).map(|(w, depth)| w / total * depth).sum();
            let (low, high) = range(&depths);
            return Some(mean.clamp(low, high)).filter(|depth| *depth <= deepest);
        }
        // Seen edge on: its edges, which it shares with its neighbours.
        [(0, 1), (1, 2), (2, 0)]
            .into_iter()
            .filter_map(|(i, j)| {
                depth_on_edge(place, [[a, b, c][i], [a, b, c][j]], [depths[i], depths[j]], deepest)
            })
            .reduce(f64::max)
    }
}

/// The largest depth up to `deepest` at which an edge whose line holds `place` covers it.
fn depth_on_edge(place: Coord<f64>, [s, e]: [Coord<f64>; 2], depths: [f64; 2], deepest: f64) -> Option<f64> {
    let (length_x, length_y) = (e.x - s.x, e.y - s.y);
    let (low, high) = range(&depths);
    if length_x == 0.0 && length_y == 0.0 {
        // The edge points along the line.
        return (s == place && low <= deepest).then(|| high.min(deepest));
    }
    let share = if length_x.abs() >= length_y.abs() {
        (place.x - s.x) / length_x
    } else {
        (place.y - s.y) / length_y
    };
    let depth = (depths[0] + share * (depths[1] - depths[0])).clamp(low, high);
    ((0.0..=1.0).contains(&share) && depth <= deepest).then_some(depth)
}

fn range(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
}
