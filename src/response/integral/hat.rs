//! Exact integrals of a linear density over a flat triangle.

use nalgebra::Vector3;

/// A triangle split into what its integrals need. Edge `k` lies opposite to vertex `k`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
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
}

/// A point seen from one edge: in-plane distance `d` from the edge's line, positive inside, and the ends
/// `s0 < s1` of the edge along its tangent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeView {
    pub(crate) d: f64,
    pub(crate) s0: f64,
    pub(crate) s1: f64,
}

impl Frame {
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
        Self {
            vertices,
            normal,
            tangents,
            outward: tangents.map(|t| t.cross(&normal)),
            heights: lengths.map(|l| double_area / l),
            area: 0.5 * double_area,
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

/// `ln((R1 + s1) / (R0 + s0))`, which is `asinh(s1/ρ) - asinh(s0/ρ)` with ρ² = `rho_squared` > 0, free of
/// cancellation; R = √(ρ² + s²).
pub(crate) fn log_ratio(s0: f64, s1: f64, r0: f64, r1: f64, rho_squared: f64) -> f64 {
    let near_end = if s1 >= 0.0 { rho_squared / (r1 + s1) } else { r1 - s1 };
    let far_end = if s0 <= 0.0 { rho_squared / (r0 - s0) } else { r0 + s0 };
    // (R0 + R1 + L) / (R0 + R1 - L) with L = s1 - s0, the denominator summed from positive parts.
    (2.0 * (s1 - s0) / (near_end + far_end)).ln_1p()
}

/// The closed form of [`hat_integrals`](crate::response::hat_integrals).
///
/// Relative error up to some 40 ε (length / height)² (distance / length)³, ε = 2e-16.
pub(crate) fn frame_hat_integrals(frame: &Frame, point: &Vector3<f64>) -> [f64; 3] {
    let (z, edges) = frame.view(point);
    // potential: int 1/r dA; moment: int (y - x_proj)/r dA
    let mut potential = 0.0;
    let mut moment = Vector3::zeros();
    for (k, e) in edges.iter().enumerate() {
        let rho_squared = e.d * e.d + z * z;
        let (r0, r1) = ((rho_squared + e.s0 * e.s0).sqrt(), (rho_squared + e.s1 * e.s1).sqrt());
        let mut boundary = e.s1 * r1 - e.s0 * r0;
        if rho_squared > 0.0 {
            let log = log_ratio(e.s0, e.s1, r0, r1, rho_squared);
            potential += e.d * log;
            boundary += rho_squared * log;
        }
        moment += frame.outward[k] * (0.5 * boundary);
    }
    potential -= z.abs() * solid_angle(frame, point, z);
    frame.hats(&edges, potential, &moment)
}

/// Solid angle of the triangle seen from `point`, not negative (van Oosterom, Strackee 1983).
fn solid_angle(frame: &Frame, point: &Vector3<f64>, z: f64) -> f64 {
    if z == 0.0 {
        return 0.0;
    }
    let [a, b, c] = frame.vertices.map(|v| v - point);
    let (ra, rb, rc) = (a.norm(), b.norm(), c.norm());
    let denominator = ra * rb * rc + a.dot(&b) * rc + a.dot(&c) * rb + b.dot(&c) * ra;
    2.0 * f64::atan2(2.0 * frame.area * z.abs(), denominator)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::integral::reference_values::reference_integrals;
    use crate::response::integral::subdivide::hat_integrals;

    #[test]
    fn hat_integrals_match_60_digit_quadrature() {
        let mut worst: f64 = 0.0;
        for (row, case) in reference_integrals().iter().enumerate() {
            let got = hat_integrals(&case.point, &case.triangle);
            for (k, (got, exact)) in got.iter().zip(case.inverse).enumerate() {
                let error = (got / exact - 1.0).abs();
                worst = worst.max(error);
                assert!(error < 5e-13, "row {row}, corner {k}: {error:e}");
            }
        }
        println!("worst relative error {worst:e}");
    }

    #[test]
    fn closed_form_loses_what_it_says_it_loses() {
        for (row, case) in reference_integrals().iter().enumerate() {
            let (frame, x) = (Frame::new(case.triangle), case.point);
            let got = frame_hat_integrals(&frame, &x);
            let height = frame.heights.into_iter().fold(f64::INFINITY, f64::min);
            let length = 2.0 * frame.area / height;
            let reach = (x - frame.vertices[0]).norm().max(length) / length;
            let bound = 40.0 * f64::EPSILON * (length / height).powi(2) * reach.powi(3);
            for (k, (got, exact)) in got.iter().zip(case.inverse).enumerate() {
                let error = (got / exact - 1.0).abs();
                assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
            }
        }
    }

    #[test]
    fn order_of_the_corners_permutes_the_integrals() {
        for case in reference_integrals() {
            let (x, [a, b, c]) = (case.point, case.triangle);
            let first = hat_integrals(&x, &[a, b, c]);
            let turned = hat_integrals(&x, &[b, c, a]);
            let flipped = hat_integrals(&x, &[b, a, c]);
            for (one, other) in
                [(first[0], turned[2]), (first[1], turned[0]), (first[0], flipped[1]), (first[2], flipped[2])]
            {
                assert!((one / other - 1.0).abs() < 1e-12);
            }
        }
    }
}
