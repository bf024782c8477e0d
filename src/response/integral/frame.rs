//! A flat triangle as its integrals need it.

use nalgebra::Vector3;

/// Corners, directions and lengths of a triangle. Edge `k` lies opposite to vertex `k`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriangleFrame {
    /// Corners (m), counter-clockwise about `normal`.
    pub(crate) vertices: [Vector3<f64>; 3],
    /// Unit normal.
    pub(crate) normal: Vector3<f64>,
    /// Unit tangent of each edge, counter-clockwise.
    pub(crate) tangents: [Vector3<f64>; 3],
    /// Outward unit normal of each edge, in the plane.
    pub(crate) outward: [Vector3<f64>; 3],
    /// Distance of each vertex from the edge opposite to it (m).
    pub(crate) heights: [f64; 3],
    /// Area (m²).
    pub(crate) area: f64,
    /// Center of a ball around the triangle (m).
    pub(crate) center: Vector3<f64>,
    /// Radius of that ball (m).
    pub(crate) radius: f64,
}

/// A point seen from one edge: in-plane distance `d` from the edge's line, positive inside, and the ends
/// `s0 < s1` of the edge along its tangent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeView {
    pub(crate) d: f64,
    pub(crate) s0: f64,
    pub(crate) s1: f64,
}

/// A triangle's centroid and the largest distance of a corner from it (m).
pub(crate) fn ball_around(corners: &[Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let center = (corners[0] + corners[1] + corners[2]) / 3.0;
    (center, corners.iter().map(|corner| (corner - center).norm()).fold(0.0, f64::max))
}

impl TriangleFrame {
    /// The frame of a triangle that is not degenerate.
    pub(crate) fn new(vertices: [Vector3<f64>; 3]) -> Self {
        let [a, b, c] = vertices;
        let edges = [c - b, a - c, b - a];
        // Of the three equal cross products the one over the two shorter edges is the most accurate.
        let longest = (0..3).max_by(|&i, &j| edges[i].norm_squared().total_cmp(&edges[j].norm_squared()));
        let k = longest.expect("three edges");
        let cross = edges[(k + 1) % 3].cross(&edges[(k + 2) % 3]);
        let double_area = cross.norm();
        let normal = cross / double_area;
        let lengths = edges.map(|e| e.norm());
        let tangents = edges.map(|e| e.normalize());
        let (center, radius) = ball_around(&vertices);
        Self {
            vertices,
            normal,
            tangents,
            outward: tangents.map(|t| t.cross(&normal)),
            heights: lengths.map(|l| double_area / l),
            area: 0.5 * double_area,
            center,
            radius,
        }
    }

    /// Height of `point` over the plane (m, signed) and its view of the three edges.
    pub(crate) fn view(&self, point: &Vector3<f64>) -> (f64, [EdgeView; 3]) {
        let to = self.vertices.map(|v| v - point);
        // The nearest vertex gives the height with the least rounding.
        let near = (0..3).min_by(|&i, &j| to[i].norm_squared().total_cmp(&to[j].norm_squared()));
        let z = -to[near.expect("three vertices")].dot(&self.normal);
        let edges = std::array::from_fn(|k| {
            let (a, b) = (to[(k + 1) % 3], to[(k + 2) % 3]);
            let nearer = if a.norm_squared() <= b.norm_squared() { a } else { b };
            EdgeView {
                d: nearer.dot(&self.outward[k]),
                s0: a.dot(&self.tangents[k]),
                s1: b.dot(&self.tangents[k]),
            }
        });
        (z, edges)
    }

    /// The three hat integrals out of the integral of the kernel and its first moment about the projection
    /// of the point, given as coefficients of the `outward` and `tangents` vectors of the edges.
    pub(crate) fn hats(&self, edges: &[EdgeView; 3], zeroth: f64, moment: &Vector3<f64>) -> [f64; 3] {
        std::array::from_fn(|k| (edges[k].d * zeroth - self.outward[k].dot(moment)) / self.heights[k])
    }
}
