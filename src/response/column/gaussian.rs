//! One column of the paper's kernel: half-space less a Gaussian, cut off.

use nalgebra::Vector3;

use crate::response::column::half_space::{Scratch, half_space_values};
use crate::response::column::load::{LoadedFace, weighted};
use crate::response::integral::cutoff::{Inverse, hats_within};
use crate::response::integral::gauss::{RulePoint, triangle_rule};
use crate::response::integral::gaussian::Gaussian;
use crate::response::integral::hat::hat_integrals;
use crate::response::simd::points::Targets;

/// Widths beyond which the Gaussian is below 1e-17.
const SILENT_WIDTHS: f64 = 9.0;
/// Share of the cutoff from which on a triangle that it leaves whole is far enough for a rule.
const FAR_SHARE: f64 = 0.5;
/// Most points of a rule in each direction; beyond, the closed form costs less.
const MOST_RULE_POINTS: usize = 12;
/// The closed form's own error.
const LEAST_TOLERANCE: f64 = 1e-13;

/// `K/r - a exp(-r²/2c²)` for r < cutoff, 0 beyond.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corrected {
    /// K (m²/N).
    pub(crate) constant: f64,
    /// a (m/N).
    pub(crate) height: f64,
    /// c (m).
    pub(crate) width: f64,
    /// Cutoff (m).
    pub(crate) cutoff: f64,
}

impl Corrected {
    /// Sets `scratch.values` to the displacement of all targets by the load on `scratch.faces`.
    ///
    /// Within the cutoff the Gaussian is taken off the half-space by a Gauss rule; where the cutoff crosses the load, each
    /// triangle is taken by itself.
    pub(crate) fn values(&self, targets: &Targets, scratch: &mut Scratch, tolerance: f64) {
        half_space_values(targets, scratch, self.constant, tolerance, self.cutoff);
        let Scratch { faces, values, .. } = scratch;
        let load: Vec<_> = faces.iter().map(|face| (face, self.point_forces(face, tolerance))).collect();
        for (i, value) in values[..targets.rows.len()].iter_mut().enumerate() {
            let x = targets.point(i);
            if faces.iter().all(|face| (x - face.center).norm() + face.radius <= self.cutoff) {
                let taken = load.iter().map(|(face, forces)| self.gaussian(face, forces.as_deref(), &x));
                *value -= self.height * taken.sum::<f64>();
            } else {
                *value = load.iter().map(|(face, forces)| self.share(face, forces.as_deref(), &x)).sum();
            }
        }
    }

    /// The load of a face as point forces, places (m) and shares of the unit force, by a Gauss rule that keeps the
    /// tolerance; `None` where it needs too many points.
    ///
    /// Along each of the two directions of an n × n rule the density is linear, so that the error is at most twice what
    /// the best polynomial of degree m - 1 = 2n - 2 leaves of the kernel, `2 |f⁽ᵐ⁾| / m! (radius / 2)ᵐ`. Derivatives of 1/r
    /// are at most `m! / rᵐ⁺¹`, those of exp(-t²/2c²) at most `1.09 √m! / cᵐ` (Cramér's bound of the Hermite functions).
    fn point_forces(&self, face: &LoadedFace, tolerance: f64) -> Option<Vec<(Vector3<f64>, f64)>> {
        let closest = FAR_SHARE * self.cutoff - face.radius;
        let inverse_ratio = 0.5 * face.radius / closest;
        let gaussian_ratio = 0.5 * face.radius / self.width;
        // the Gaussian as a multiple of K/r
        let share = self.height * self.cutoff.min(SILENT_WIDTHS * self.width) / self.constant;
        let keeps = |n: &usize| {
            let order = 2 * n - 1;
            let inverse = inverse_ratio.powi(order as i32) * (1.0 + 2.0 * inverse_ratio);
            let gaussian: f64 = (1..=order).map(|m| gaussian_ratio / (m as f64).sqrt()).product();
            8.0 * (inverse + 1.09 * share * gaussian) <= tolerance.max(LEAST_TOLERANCE)
        };
        let n = (1..=MOST_RULE_POINTS).find(|n| closest > 0.0 && keeps(n))?;
        let [a, b, c] = face.frame.vertices;
        let force = |(l, weight): &RulePoint| {
            (a * l[0] + b * l[1] + c * l[2], weight * face.frame.area * weighted(&face.density, l))
        };
        Some(triangle_rule(n).iter().map(force).collect())
    }

    /// `∫ p(y) exp(-r²/2c²) dA` over one face that lies within the cutoff.
    fn gaussian(&self, face: &LoadedFace, forces: Option<&[(Vector3<f64>, f64)]>, x: &Vector3<f64>) -> f64 {
        let falloff = -0.5 / (self.width * self.width);
        match forces {
            Some(forces) => {
                forces.iter().map(|(y, share)| share * ((x - y).norm_squared() * falloff).exp()).sum()
            }
            None if (x - face.center).norm() > face.radius + SILENT_WIDTHS * self.width => 0.0,
            None => {
                let smooth = Gaussian { width: self.width };
                weighted(&face.density, &hats_within(&face.frame, x, &smooth, self.cutoff))
            }
        }
    }

    /// One face's share of the displacement at x.
    fn share(&self, face: &LoadedFace, forces: Option<&[(Vector3<f64>, f64)]>, x: &Vector3<f64>) -> f64 {
        let distance = (x - face.center).norm();
        let is_far = distance >= FAR_SHARE * self.cutoff && distance + face.radius <= self.cutoff;
        match forces {
            Some(forces) if is_far => {
                let inverse: f64 = forces.iter().map(|(y, share)| share / (x - y).norm()).sum();
                self.constant * inverse - self.height * self.gaussian(face, Some(forces), x)
            }
            _ => self.exact(face, x),
        }
    }

    /// One face's share of the displacement at x, in closed form.
    pub(crate) fn exact(&self, face: &LoadedFace, x: &Vector3<f64>) -> f64 {
        let distance = (x - face.center).norm();
        if distance - face.radius >= self.cutoff {
            return 0.0;
        }
        let inverse = if distance + face.radius > self.cutoff {
            hats_within(&face.frame, x, &Inverse, self.cutoff)
        } else {
            hat_integrals(x, &face.frame.vertices)
        };
        let smooth = hats_within(&face.frame, x, &Gaussian { width: self.width }, self.cutoff);
        self.constant * weighted(&face.density, &inverse) - self.height * weighted(&face.density, &smooth)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::response::column::load::loaded_faces;
    use crate::response::integral::gauss::gauss_interval;
    use crate::response::kernel::basis::PressureBasis;
    use crate::surface::checked::Surface;

    /// A bent hexagon of some 1 mm around the origin, loaded in the middle.
    fn hexagon() -> Surface {
        let ring = |k: usize| {
            let angle = k as f64 * PI / 3.0 + 0.1 * k as f64;
            Vector3::new(1.2e-3 * angle.cos(), 1e-3 * angle.sin(), 0.2e-3 * (k % 3) as f64)
        };
        let vertices: Vec<_> = std::iter::once(Vector3::zeros()).chain((0..6).map(ring)).collect();
        let faces = (0..6u32).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect();
        Surface::new(vertices, faces).expect("a hexagon")
    }

    /// One face's share in polar coordinates about the projection of x: Gauss rules along each ray and over the angle,
    /// between the angles of the corners and of the points where the cutoff crosses an edge.
    fn by_rays(kernel: &Corrected, face: &LoadedFace, x: &Vector3<f64>) -> f64 {
        let normal = face.frame.normal;
        let z = (x - face.center).dot(&normal);
        if z.abs() >= kernel.cutoff {
            return 0.0;
        }
        let foot = x - normal * z;
        let radius = (kernel.cutoff * kernel.cutoff - z * z).sqrt();
        let across = (face.frame.vertices[1] - face.frame.vertices[0]).normalize();
        let axes = [across, normal.cross(&across)];
        let corners = face.frame.vertices.map(|corner| axes.map(|axis| (corner - foot).dot(&axis)));
        let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b]));
        let mut turns = vec![-PI, PI];
        for ([ax, ay], [bx, by]) in sides {
            turns.push(ay.atan2(ax));
            let (ex, ey) = (bx - ax, by - ay);
            // seen from close by, an edge runs away towards its own two directions
            for (side, k) in [-1.0, 1.0].into_iter().flat_map(|side| (0..8).map(move |k| (side, k))) {
                let angle = ey.atan2(ex) + side * 0.25f64.powi(k);
                turns.extend([angle, angle + PI, angle - PI].into_iter().filter(|turn| turn.abs() < PI));
            }
            let (p, q) = ((ax * ex + ay * ey), ex * ex + ey * ey);
            let root = p * p - q * (ax * ax + ay * ay - radius * radius);
            for t in [-1.0, 1.0].map(|sign| (sign * root.max(0.0).sqrt() - p) / q) {
                if root > 0.0 && (0.0..1.0).contains(&t) {
                    turns.push((ay + t * ey).atan2(ax + t * ex));
                }
            }
        }
        turns.sort_by(f64::total_cmp);
        let rule = gauss_interval(20);
        let ray = |angle: f64| -> f64 {
            let (sin, cos) = angle.sin_cos();
            // where the ray is on the inner side of all three edges
            let (mut from, mut to) = (0.0_f64, radius);
            for ([ax, ay], [bx, by]) in sides {
                let (ex, ey) = (bx - ax, by - ay);
                let (at_foot, slope) = (ay * ex - ax * ey, ex * sin - ey * cos);
                let crossing = at_foot / slope;
                if slope > 0.0 { from = from.max(crossing) } else { to = to.min(crossing) }
            }
            if from >= to {
                return 0.0;
            }
            let value = |s: f64| {
                let y = foot + axes[0] * (s * cos) + axes[1] * (s * sin);
                let edge = |k: usize| face.frame.vertices[(k + 1) % 3] - y;
                let share = |k: usize| edge(k).cross(&edge(k + 1)).dot(&normal) / (2.0 * face.frame.area);
                let pressure: f64 = (0..3).map(|k| face.density[k] * share(k)).sum();
                let r = s.hypot(z);
                let u = kernel.constant / r - kernel.height * (-0.5 * (r / kernel.width).powi(2)).exp();
                pressure * u * s
            };
            rule.iter().map(|(t, w)| w * (to - from) * value(from + t * (to - from))).sum()
        };
        let over = |pair: &[f64]| -> f64 {
            let step = pair[1] - pair[0];
            rule.iter().map(|(t, w)| w * step * ray(pair[0] + t * step)).sum()
        };
        turns.windows(2).map(over).sum()
    }

    /// Compares with both references at each tolerance; returns how many points were cut and how many lie beyond.
    fn check(kernel: &Corrected, points: &[Vector3<f64>]) -> (usize, usize) {
        let (surface, targets) = (hexagon(), Targets::new(points));
        let mut scratch = Scratch::new(&targets);
        loaded_faces(&surface, 0, PressureBasis::Linear, &mut scratch.faces);
        let scale = kernel.constant / kernel.cutoff;
        let reference = |x: &Vector3<f64>| {
            let exact: f64 = scratch.faces.iter().map(|face| kernel.exact(face, x)).sum();
            let rays: f64 = scratch.faces.iter().map(|face| by_rays(kernel, face, x)).sum();
            assert!((exact - rays).abs() < 1e-10 * scale, "{x:?}: {exact:e}, by rays {rays:e}");
            rays
        };
        let expected: Vec<f64> = points.iter().map(reference).collect();
        for tolerance in [1e-3, 1e-6, 1e-9] {
            kernel.values(&targets, &mut scratch, tolerance);
            for (&value, &row) in scratch.values.iter().zip(&targets.rows) {
                let error = (value - expected[row as usize]).abs() / scale;
                let x = points[row as usize];
                assert!(error <= tolerance, "{x:?} at {tolerance:e}, width {}: {error:e}", kernel.width);
            }
        }
        let is_cut = |x: &&Vector3<f64>| x.norm() + 1.2e-3 > kernel.cutoff;
        let beyond = expected.iter().filter(|&&u| u == 0.0).count();
        (points.iter().filter(is_cut).count() - beyond, beyond)
    }

    fn kernels() -> [Corrected; 3] {
        [8e-3, 2e-3, 0.3e-3].map(|width| Corrected {
            constant: 1.3e-6,
            height: 1.3e-6 / width,
            width,
            cutoff: 6e-3,
        })
    }

    #[test]
    fn what_the_cutoff_cuts_matches_the_closed_form_and_rays() {
        let point = |k: usize| {
            let angle = 0.7 * k as f64;
            let distance = 5e-3 + 0.07e-3 * k as f64;
            Vector3::new(distance * angle.cos(), distance * angle.sin(), 2e-3 * (0.3 * angle).sin())
        };
        let points: Vec<_> = (0..40).map(point).collect();
        for kernel in kernels() {
            let (cut, beyond) = check(&kernel, &points);
            assert!(cut > 10 && beyond > 5, "{cut} {beyond}");
        }
    }

    #[test]
    fn points_above_and_behind_the_load_are_cut_as_those_beside_it() {
        // all directions from straight above over beside to straight behind, at distances about the cutoff
        let mut points = Vec::new();
        for k in 0..=36 {
            let (polar, azimuth) = (5f64.to_radians() * k as f64, 1.3 * k as f64);
            for distance in [4.9e-3, 5.5e-3, 5.9e-3, 5.99e-3, 6.05e-3, 6.3e-3] {
                let (sin, cos) = polar.sin_cos();
                points.push(Vector3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos) * distance);
            }
        }
        // a plate just closer than the cutoff, so fine that points project on corners, edges and faces
        for i in -8..=8 {
            for j in -8..=8 {
                points.push(Vector3::new(0.15e-3 * f64::from(i), 0.15e-3 * f64::from(j), 5.9e-3));
            }
        }
        for kernel in kernels() {
            let (cut, _) = check(&kernel, &points);
            assert!(cut > 400, "{cut}");
        }
    }
}
