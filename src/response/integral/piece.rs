//! A triangle cut into pieces on which its integrals lose no digits: halves of its longest edge, slices of a needle.

use nalgebra::Vector3;

use crate::response::integral::frame::TriangleFrame;

/// Length / height from which a triangle is a needle, cut across its length first: halves of its longest edges would lie
/// side by side, ever more of them.
const NEEDLE_SLIMNESS: f64 = 1e5;
/// Length / height of a slice that is cut no further, and its distance / length from which it need not be.
const SLICE_LENGTH: f64 = 32.0;
const SLICE_DISTANCE: f64 = 2.5;
/// Least share of a needle's length that a slice at its tip has.
const LEAST_SLICE: f64 = 1e-15;

/// A part of the triangle, relative to the point, and the weights of the whole triangle's corners in each
/// of its own.
#[derive(Clone, Copy)]
pub(super) struct TrianglePiece {
    pub corners: [Vector3<f64>; 3],
    pub weights: [[f64; 3]; 3],
    /// As the whole triangle's corners give it: far from the point the piece's own may be rounded to a line (m²).
    pub area: f64,
}

impl TrianglePiece {
    /// The triangle itself.
    pub fn whole(point: &Vector3<f64>, triangle: &[Vector3<f64>; 3]) -> Self {
        Self {
            corners: triangle.map(|v| v - point),
            weights: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            area: TriangleFrame::new(*triangle).area,
        }
    }

    /// The corner opposite to the longest edge, and the edge's length (m).
    pub fn longest_edge(&self) -> (usize, f64) {
        (0..3)
            .map(|corner| (corner, self.edge_opposite(corner).norm()))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a triangle has three edges")
    }

    /// Whether it is cut across its length before all else.
    pub fn is_needle(&self) -> bool {
        let (_, length) = self.longest_edge();
        length * length > NEEDLE_SLIMNESS * 2.0 * self.area
    }

    /// Its halves where the edge opposite to a corner is cut in two.
    pub fn halves(&self, apex: usize) -> [Self; 2] {
        let (b, c) = ((apex + 1) % 3, (apex + 2) % 3);
        let middle = (self.corners[b] + self.corners[c]) * 0.5;
        let hats = std::array::from_fn(|k| 0.5 * (self.weights[b][k] + self.weights[c][k]));
        [c, b].map(|to| {
            let mut half = Self { area: 0.5 * self.area, ..*self };
            half.corners[to] = middle;
            half.weights[to] = hats;
            half
        })
    }

    /// A needle cut across its length, ever finer towards the point.
    pub fn slices(&self) -> Vec<Self> {
        let (apex, _) = self.longest_edge();
        let [from, to] = [(apex + 1) % 3, (apex + 2) % 3];
        let base = self.edge_opposite(apex);
        let share = (self.corners[apex] - self.corners[from]).dot(&base) / base.norm_squared();
        let foot = self.between(from, to, share);
        let ends = [foot, (self.corners[apex], self.weights[apex])];
        let mut slices = Vec::new();
        // In an isosceles needle rounding may leave nothing beyond the foot.
        let sides = [(from, share * self.area), (to, (1.0 - share) * self.area)];
        for (tip, area) in sides.into_iter().filter(|(_, area)| *area > 0.0) {
            let tip = (self.corners[tip], self.weights[tip]);
            let [length, height] = [(ends[0].0 - tip.0).norm(), (ends[1].0 - ends[0].0).norm()];
            let mut intervals = vec![[0.0, 1.0]];
            while let Some([a, b]) = intervals.pop() {
                let middle = 0.5 * (a + b);
                let distance = mixed(&tip, &ends[0], middle).0.norm();
                let own = (b - a) * length;
                if b > LEAST_SLICE && own > SLICE_LENGTH * b * height && distance < SLICE_DISTANCE * own {
                    intervals.extend([[a, middle], [middle, b]]);
                    continue;
                }
                let [near, far] = [a, b].map(|at| ends.map(|end| mixed(&tip, &end, at)));
                slices.push(TrianglePiece::new([near[0], far[0], far[1]], b * (b - a) * area));
                if a > 0.0 {
                    slices.push(TrianglePiece::new([near[0], far[1], near[1]], a * (b - a) * area));
                }
            }
        }
        slices
    }

    fn new(corners: [(Vector3<f64>, [f64; 3]); 3], area: f64) -> Self {
        Self {
            corners: corners.map(|(corner, _)| corner),
            weights: corners.map(|(_, weights)| weights),
            area,
        }
    }

    fn edge_opposite(&self, corner: usize) -> Vector3<f64> {
        self.corners[(corner + 2) % 3] - self.corners[(corner + 1) % 3]
    }

    fn between(&self, from: usize, to: usize, share: f64) -> (Vector3<f64>, [f64; 3]) {
        mixed(&(self.corners[from], self.weights[from]), &(self.corners[to], self.weights[to]), share)
    }
}

/// The place and the weights so far on the way from one to another.
fn mixed(
    from: &(Vector3<f64>, [f64; 3]),
    to: &(Vector3<f64>, [f64; 3]),
    share: f64,
) -> (Vector3<f64>, [f64; 3]) {
    let place = from.0 + (to.0 - from.0) * share;
    (place, std::array::from_fn(|k| from.1[k] + share * (to.1[k] - from.1[k])))
}
