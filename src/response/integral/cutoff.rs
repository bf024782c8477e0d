//! Exact integrals over a triangle, or over the part of it that a cutoff sphere leaves.

use nalgebra::Vector3;

use crate::response::integral::frame::TriangleFrame;

/// A radial kernel f whose integrals over the plane, at height z, are known in closed form.
///
/// With polar coordinates (s, θ) about the projection of the point, and a function Φ with dΦ/ds = s f(s, z):
/// the integral of f over a region is a sum over its boundary of `∫dθ ∫_0^{s(θ)} f s ds`, and its first
/// moment is `∮ Φ m dl` with the outward normal m. Both therefore add up over pieces of the boundary.
pub(crate) trait PlanarKernel {
    /// `∫dθ ∫_0^{s(θ)} f s ds` and `∫ Φ dl` along the straight piece from s0 to s1 of a line at distance d.
    fn edge(&self, d: f64, s0: f64, s1: f64, z: f64) -> (f64, f64);
    /// `∫_0^radius f s ds` and Φ(radius).
    fn disc(&self, radius: f64, z: f64) -> (f64, f64);
}

/// `1/r`, with Φ = r.
///
/// Without a cutoff the three integrals have a relative error of at most 40 ε (length / height)² (distance / length)³,
/// ε = 2e-16.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inverse;

impl PlanarKernel for Inverse {
    fn edge(&self, d: f64, s0: f64, s1: f64, z: f64) -> (f64, f64) {
        let rho_squared = d * d + z * z;
        let (r0, r1) = ((rho_squared + s0 * s0).sqrt(), (rho_squared + s1 * s1).sqrt());
        let ends = s1 * r1 - s0 * r0;
        if rho_squared == 0.0 {
            return (0.0, 0.5 * ends);
        }
        let (log, height) = (log_ratio(s0, s1, r0, r1, rho_squared), z.abs());
        let angle =
            f64::atan2(d * s1, rho_squared + height * r1) - f64::atan2(d * s0, rho_squared + height * r0);
        (d * log - height * angle, 0.5 * (rho_squared * log + ends))
    }

    fn disc(&self, radius: f64, z: f64) -> (f64, f64) {
        let r = radius.hypot(z);
        // r - |z|
        (if r > 0.0 { radius * radius / (r + z.abs()) } else { 0.0 }, r)
    }
}

/// `ln((R1 + s1) / (R0 + s0))`, which is `asinh(s1/ρ) - asinh(s0/ρ)` with ρ² = `rho_squared` > 0, free of
/// cancellation; R = √(ρ² + s²).
fn log_ratio(s0: f64, s1: f64, r0: f64, r1: f64, rho_squared: f64) -> f64 {
    let near_end = if s1 >= 0.0 { rho_squared / (r1 + s1) } else { r1 - s1 };
    let far_end = if s0 <= 0.0 { rho_squared / (r0 - s0) } else { r0 + s0 };
    // (R0 + R1 + L) / (R0 + R1 - L) with L = s1 - s0, the denominator summed from positive parts.
    (2.0 * (s1 - s0) / (near_end + far_end)).ln_1p()
}

/// The three hat integrals of `kernel` over the points of the triangle within `cutoff` (m) of `point`.
pub(crate) fn hats_within(
    frame: &TriangleFrame,
    point: &Vector3<f64>,
    kernel: &impl PlanarKernel,
    cutoff: f64,
) -> [f64; 3] {
    let (z, edges) = frame.view(point);
    if z.abs() >= cutoff {
        return [0.0; 3];
    }
    // The sphere cuts the plane in a circle of this radius about the projection of the point.
    let radius = if cutoff.is_finite() { ((cutoff - z) * (cutoff + z)).sqrt() } else { f64::INFINITY };
    let mut zeroth = 0.0;
    let mut moment = Vector3::zeros();
    for (k, e) in edges.iter().enumerate() {
        let half_chord = if e.d.abs() < radius { ((radius - e.d) * (radius + e.d)).sqrt() } else { 0.0 };
        let (inner0, inner1) = (e.s0.clamp(-half_chord, half_chord), e.s1.clamp(-half_chord, half_chord));
        if inner0 < inner1 {
            let (sector, boundary) = kernel.edge(e.d, inner0, inner1, z);
            zeroth += sector;
            moment += frame.outward[k] * boundary;
        }
        // What of the edge lies outside the circle is replaced by the arc under the same angle.
        for (s0, s1) in [(e.s0, e.s1.min(-half_chord)), (e.s0.max(half_chord), e.s1)] {
            if s0 < s1 {
                let (angle, mean) = arc(e.d, s0, s1);
                let (sector, boundary) = kernel.disc(radius, z);
                zeroth += angle * sector;
                let turn = frame.outward[k] * mean.0 + frame.tangents[k] * mean.1;
                moment += turn * (radius * boundary);
            }
        }
    }
    frame.hats(&edges, zeroth, &moment)
}

/// Angle under which a piece of an edge is seen, and the integral of the unit radial vector over that angle
/// in the (outward, tangent) directions of the edge.
fn arc(d: f64, s0: f64, s1: f64) -> (f64, (f64, f64)) {
    let (r0, r1) = (d.hypot(s0), d.hypot(s1));
    let angle = f64::atan2(d * (s1 - s0), d * d + s0 * s1);
    (angle, (s1 / r1 - s0 / r0, d / r0 - d / r1))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::response::integral::gaussian::Gaussian;
    use crate::sample::reference_integrals;

    fn sum(h: [f64; 3]) -> f64 {
        h.iter().sum()
    }

    #[test]
    fn a_disc_inside_a_triangle_has_its_closed_form() {
        let big = TriangleFrame::new([
            Vector3::new(-1.0, -1.0, 0.0),
            Vector3::new(1.5, -1.0, 0.0),
            Vector3::new(0.0, 1.5, 0.0),
        ]);
        for z in [0.0, 1e-9, 0.1, -0.2] {
            let x = Vector3::new(0.05, -0.1, z);
            let cutoff: f64 = 0.4;
            let radius = (cutoff * cutoff - z * z).sqrt();
            let inverse = sum(hats_within(&big, &x, &Inverse, cutoff));
            assert!((inverse / (2.0 * PI * (cutoff - z.abs())) - 1.0).abs() < 1e-14);
            let c: f64 = 0.3;
            let gaussian = sum(hats_within(&big, &x, &Gaussian { width: c }, cutoff));
            let fade = |r: f64| (-0.5 * r * r / (c * c)).exp();
            let exact = 2.0 * PI * c * c * fade(z) * (1.0 - fade(radius));
            assert!((gaussian / exact - 1.0).abs() < 1e-14);
            assert_eq!(sum(hats_within(&big, &Vector3::new(0.0, 0.0, 0.5), &Inverse, cutoff)), 0.0);
        }
    }

    #[test]
    fn without_a_cut_the_closed_form_loses_what_it_says_it_loses() {
        for (row, case) in reference_integrals().iter().enumerate() {
            let (frame, x) = (TriangleFrame::new(case.triangle), case.point);
            let got = hats_within(&frame, &x, &Inverse, f64::INFINITY);
            let height = frame.heights.into_iter().fold(f64::INFINITY, f64::min);
            let length = 2.0 * frame.area / height;
            let reach = (x - frame.vertices[0]).norm().max(length) / length;
            // slivers seen from three edge lengths away lose the most
            let bound = (40.0 * f64::EPSILON * (length / height).powi(2) * reach.powi(3)).min(1e-7);
            for (k, (got, exact)) in got.iter().zip(case.inverse).enumerate() {
                let error = (got / exact - 1.0).abs();
                assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
            }
        }
    }

    #[test]
    fn cut_integrals_match_a_fine_midpoint_sum() {
        let corners =
            [Vector3::new(0.0, 0.0, 0.0), Vector3::new(1.0, 0.1, 0.2), Vector3::new(0.3, 0.9, -0.1)];
        let frame = TriangleFrame::new(corners);
        for (x, cutoff) in [
            (Vector3::new(0.2, 0.1, 0.3), 0.6),
            (Vector3::new(-0.3, 0.4, 0.0), 0.7),
            (Vector3::new(1.2, 0.8, 0.1), 0.9),
            (Vector3::new(0.5, 0.45, 0.3), 0.55),
        ] {
            let n = 800;
            let (mut inverse, mut gaussian) = ([0.0; 3], [0.0; 3]);
            let mut add = |l: [f64; 3]| {
                let y = corners[0] * l[0] + corners[1] * l[1] + corners[2] * l[2];
                let r = (x - y).norm();
                if r < cutoff {
                    for k in 0..3 {
                        inverse[k] += l[k] / r;
                        gaussian[k] += l[k] * (-0.5 * r * r / 0.16).exp();
                    }
                }
            };
            for i in 0..n {
                for j in 0..n - i {
                    let (u, v) = ((i as f64 + 1.0 / 3.0) / n as f64, (j as f64 + 1.0 / 3.0) / n as f64);
                    add([1.0 - u - v, u, v]);
                    if j + 1 < n - i {
                        let (u, v) = ((i as f64 + 2.0 / 3.0) / n as f64, (j as f64 + 2.0 / 3.0) / n as f64);
                        add([1.0 - u - v, u, v]);
                    }
                }
            }
            let cell = frame.area / (n * n) as f64;
            let got = hats_within(&frame, &x, &Inverse, cutoff);
            let smooth = hats_within(&frame, &x, &Gaussian { width: 0.4 }, cutoff);
            for k in 0..3 {
                // the staircase of the cut circle errs by about n^-1.5
                assert!((got[k] - inverse[k] * cell).abs() < 1e-4 * sum(got), "{got:?}");
                assert!((smooth[k] - gaussian[k] * cell).abs() < 1e-4 * sum(smooth), "{smooth:?}");
            }
        }
    }
}
