//! Integrals of Kelvin's kernels against the three hat functions of a flat triangle.
//!
//! With `r = y - x`, `n` the triangle's normal and `phi_k` the hat of corner `k`, all that Kelvin's kernels
//! need is, for every `nu`, made of three moments of each hat (and of their traces):
//!
//! ```text
//! B_k = ∫ phi_k r r' / r³ dA        (trace: ∫ phi_k / r dA)
//! D_k = ∫ phi_k (r·n) r r' / r⁵ dA  (trace: ∫ phi_k (r·n) / r³ dA)
//! E_k = ∫ phi_k r / r³ dA
//! ```
//!
//! Near the triangle they are taken in closed form ([`exact_moments`]): the in-plane gradients of `1/r` and
//! `1/r³` turn every one of them into the solid angle `W`, and `∫ds/R`, `∫s ds/R`, `∫s² ds/R`, `∫ds/R³`, ...
//! over the three edges (the notation is that of Wilton et al. 1984). So neither the singular nor the
//! near-singular integrals cost more than others or lose digits. Far away, where the closed form cancels,
//! quadrature takes over, see [`quadrature`](crate::response::body::equations::quadrature).

use nalgebra::{Matrix3, Vector3};

use crate::response::body::equations::quadrature::HatMoments;
use crate::response::body::equations::triangle::Triangle;

fn pack(m: &Matrix3<f64>) -> [f64; 6] {
    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(a, b)| 0.5 * (m[(a, b)] + m[(b, a)]))
}

/// Integrals over one edge, from its start to its end, with `s` the distance from the foot of the point.
#[derive(Default)]
struct EdgeIntegrals {
    tangent: Vector3<f64>,
    outward: Vector3<f64>,
    /// Signed in-plane distance of the edge's line from the foot of the point (m), positive inside.
    distance: f64,
    /// `∫ ds/R`, `∫ s ds/R`, `∫ s² ds/R`, `∫ R ds`.
    over_r: [f64; 3],
    r: f64,
    /// `z²∫ds/R³`, `z d∫ds/R³`, `z∫s ds/R³`, `z∫s² ds/R³`: the height makes each of them bounded.
    z2_over_r3: f64,
    zd_over_r3: f64,
    z_over_r3: [f64; 2],
    /// Part of the solid angle.
    angle: f64,
}

/// `∫ds/R` along an edge without cancellation on either side of the foot.
///
/// A point on the edge itself never meets a non-zero factor, so 0 stands for its infinite value.
fn integral_over_r(from: f64, to: f64, rho_squared: f64, length: f64) -> f64 {
    let (r_from, r_to) = ((rho_squared + from * from).sqrt(), (rho_squared + to * to).sqrt());
    let on_line = rho_squared <= (1e-14 * length) * (1e-14 * length);
    let touches = |beyond: f64, r: f64| r == 0.0 || (on_line && beyond <= 1e-14 * length);
    if from >= 0.0 {
        if touches(from, r_from) { 0.0 } else { ((to + r_to) / (from + r_from)).ln() }
    } else if to <= 0.0 {
        if touches(-to, r_to) { 0.0 } else { ((r_from - from) / (r_to - to)).ln() }
    } else if on_line {
        0.0
    } else {
        ((to + r_to) * (r_from - from) / rho_squared).ln()
    }
}

impl EdgeIntegrals {
    fn new(
        start: &Vector3<f64>,
        end: &Vector3<f64>,
        normal: &Vector3<f64>,
        foot: &Vector3<f64>,
        z: f64,
    ) -> Self {
        let edge = end - start;
        let length = edge.norm();
        let tangent = edge / length;
        let outward = tangent.cross(normal);
        let distance = (start - foot).dot(&outward);
        let from = (start - foot).dot(&tangent);
        let to = (end - foot).dot(&tangent);
        let rho_squared = distance * distance + z * z;
        let (r_from, r_to) = ((rho_squared + from * from).sqrt(), (rho_squared + to * to).sqrt());
        let logarithm = integral_over_r(from, to, rho_squared, length);
        let s_r = to * r_to - from * r_from;
        let over_r = [logarithm, r_to - r_from, 0.5 * (s_r - rho_squared * logarithm)];
        let r = 0.5 * (s_r + rho_squared * logarithm);
        let mut edge = EdgeIntegrals { tangent, outward, distance, over_r, r, ..Default::default() };
        if z != 0.0 {
            let ratio = to / r_to - from / r_from;
            edge.z2_over_r3 = z * z / rho_squared * ratio;
            edge.zd_over_r3 = z * distance / rho_squared * ratio;
            edge.z_over_r3 = [z * (1.0 / r_from - 1.0 / r_to), z * (logarithm - ratio)];
            edge.angle = (distance * to).atan2(rho_squared + z.abs() * r_to)
                - (distance * from).atan2(rho_squared + z.abs() * r_from);
        }
        edge
    }
}

/// A triangle seen from a point at height `z` (m) over `foot` (m) in its plane, with `rho` the in-plane part of `r`.
struct TriangleIntegrals<'a> {
    triangle: &'a Triangle,
    foot: Vector3<f64>,
    z: f64,
    edges: [EdgeIntegrals; 3],
    /// `z ∫1/r³`.
    solid_angle: f64,
    /// `∫1/r`, `∫rho/r`.
    i0: f64,
    i1: Vector3<f64>,
    /// `∫rho/r³`.
    v: Vector3<f64>,
    /// `3 z³ ∫1/r⁵`, `z³ ∫rho/r⁵`.
    third: f64,
    z3_rho_over_r5: Vector3<f64>,
}

impl<'a> TriangleIntegrals<'a> {
    fn new(triangle: &'a Triangle, point: &Vector3<f64>) -> Self {
        let normal = &triangle.normal;
        let mut z = (point - triangle.corners[0]).dot(normal);
        if z.abs() <= 1e-13 * triangle.radius {
            z = 0.0;
        }
        let foot = point - normal * z;
        let [a, b, c] = &triangle.corners;
        let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| EdgeIntegrals::new(from, to, normal, &foot, z));
        let solid_angle = z.signum() * edges.iter().map(|e| e.angle).sum::<f64>();
        let i0 = edges.iter().map(|e| e.distance * e.over_r[0]).sum::<f64>() - z * solid_angle;
        let (mut i1, mut v, mut third) = (Vector3::zeros(), Vector3::zeros(), solid_angle);
        let mut z3_rho_over_r5 = Vector3::zeros();
        for edge in &edges {
            i1 += edge.outward * edge.r;
            v -= edge.outward * edge.over_r[0];
            third += edge.zd_over_r3;
            z3_rho_over_r5 -= edge.outward * (z * edge.z2_over_r3 / 3.0);
        }
        Self { triangle, foot, z, edges, solid_angle, i0, i1, v, third, z3_rho_over_r5 }
    }

    /// Moments of the hat of one corner.
    fn moments(&self, corner: usize) -> [[f64; 1]; 15] {
        let Self { foot, z, edges, solid_angle, i0, i1, v, third, .. } = self;
        let (normal, corners, z) = (self.triangle.normal, &self.triangle.corners, *z);
        let nn = normal * normal.transpose();
        let in_plane = Matrix3::identity() - nn;
        // phi = value + gradient · rho, with rho from the foot
        let opposite = &edges[(corner + 1) % 3];
        let height = (corners[corner] - corners[(corner + 1) % 3]).dot(&opposite.outward);
        let gradient = opposite.outward / height;
        let value = 1.0 + gradient.dot(&(foot - corners[corner]));

        let phi_over_r = value * i0 + gradient.dot(i1);
        let z_phi_over_r3 = value * solid_angle + z * gradient.dot(v);
        let mut k = gradient * *i0; // ∫ phi rho / r³
        let mut p = gradient * i1.transpose() + in_plane * phi_over_r; // ∫ phi rho rho' / r³
        let mut q = (gradient * v.transpose() * z + in_plane * z_phi_over_r3) / 3.0; // z ∫ phi rho rho' / r⁵
        let mut h = gradient * (z * solid_angle / 3.0); // z² ∫ phi rho / r⁵
        for edge in edges {
            let at_foot = value + edge.distance * gradient.dot(&edge.outward);
            let slope = gradient.dot(&edge.tangent);
            let first = at_foot * edge.over_r[0] + slope * edge.over_r[1];
            let second = at_foot * edge.over_r[1] + slope * edge.over_r[2];
            k -= edge.outward * first;
            p -= edge.outward * (edge.outward * (edge.distance * first) + edge.tangent * second).transpose();
            if z != 0.0 {
                let across = at_foot * edge.zd_over_r3 + slope * edge.distance * edge.z_over_r3[0];
                let along = at_foot * edge.z_over_r3[0] + slope * edge.z_over_r3[1];
                q -= edge.outward * (edge.outward * across + edge.tangent * along).transpose() / 3.0;
                h -= edge.outward * ((at_foot * edge.z2_over_r3 + slope * z * edge.z_over_r3[0]) / 3.0);
            }
        }
        let zzz_phi_over_r5 = value * third / 3.0 + gradient.dot(&self.z3_rho_over_r5);
        let both = |m: &Vector3<f64>| m * normal.transpose() + normal * m.transpose();
        let b = pack(&(p - both(&k) * z + nn * (z * z_phi_over_r3)));
        let d = pack(&-(q - both(&h) + nn * zzz_phi_over_r5));
        let e = k - normal * z_phi_over_r3;
        std::array::from_fn(|c| match c {
            0..6 => [b[c]],
            6..12 => [d[c - 6]],
            _ => [e[c - 12]],
        })
    }
}

/// Moments of the three hats seen from `point`, in closed form.
///
/// `point` may be a corner: then `E` of that corner's own hat, which has no finite value, is meaningless (its
/// Cauchy value enters through the rigid translation) and all else is right.
pub(crate) fn exact_moments(triangle: &Triangle, point: &Vector3<f64>) -> HatMoments<1> {
    let integrals = TriangleIntegrals::new(triangle, point);
    std::array::from_fn(|corner| integrals.moments(corner))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::body::equations::quadrature::tests::{by_subdivision, triangles};

    fn scale(moments: &[[f64; 15]], range: std::ops::Range<usize>) -> f64 {
        moments.iter().flat_map(|m| m[range.clone()].iter()).fold(0.0, |a: f64, b| a.max(b.abs()))
    }

    #[test]
    fn the_closed_form_agrees_with_deep_subdivision_near_above_and_beside_the_triangle() {
        for triangle in triangles() {
            let [a, b, c] = triangle.corners;
            let n = triangle.normal;
            let foots = [
                triangle.centroid,
                a,
                (a + b) / 2.0,
                b + (b - a) * 0.7, // on an edge's line
                a - (c - a) * 0.2,
                triangle.centroid * 3.0 - a - b + (c - b),
            ];
            for foot in foots {
                for height in [1e-3, -0.02, 0.2, -1.5] {
                    let point = foot + n * height;
                    let expected = by_subdivision(&triangle, &point, 14);
                    let found = exact_moments(&triangle, &point).map(|hat| hat.map(|[value]| value));
                    for (range, tolerance) in [(0..6, 1e-9), (6..12, 1e-8), (12..15, 1e-8)] {
                        let size = scale(&expected, range.clone());
                        for k in 0..3 {
                            for c in range.clone() {
                                let error = (found[k][c] - expected[k][c]).abs();
                                assert!(
                                    error < tolerance * size,
                                    "hat {k}, component {c}, height {height}, foot {foot:?}: {} expected {}",
                                    found[k][c],
                                    expected[k][c]
                                );
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn at_a_corner_the_weakly_singular_integrals_are_finite_and_right() {
        for triangle in triangles() {
            let point = triangle.corners[0];
            let expected = by_subdivision(&triangle, &point, 22);
            let found = exact_moments(&triangle, &point).map(|hat| hat.map(|[value]| value));
            for k in 0..3 {
                for c in 0..6 {
                    assert!((found[k][c] - expected[k][c]).abs() < 1e-5 * scale(&expected, 0..6));
                    assert_eq!(found[k][6 + c], 0.0, "D vanishes in the triangle's plane");
                }
                for c in (12..15).filter(|_| k > 0) {
                    assert!((found[k][c] - expected[k][c]).abs() < 1e-5 * scale(&expected[1..], 12..15));
                }
            }
        }
    }
}
