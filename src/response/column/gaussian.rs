//! One column of the paper's kernel: half-space less a Gaussian, cut off.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::half_space::{Scratch, half_space_values};
use crate::response::column::load::{LoadedFace, weighted};
use crate::response::integral::cutoff::{Inverse, hats_within};
use crate::response::integral::edge_quadrature::EdgePotential;
use crate::response::integral::gaussian::Gaussian;
use crate::response::integral::hat_simd::NearFace;
use crate::response::integral::subdivide::subdivided_hat_integrals;
use crate::response::series::taylor::{DEGREES, MAX_DEGREE, RadialSeries, TOGETHER};
use crate::response::simd::functions::exp_negative;
use crate::response::simd::lanes::Lanes;
use crate::response::simd::points::{BLOCK, Targets};

/// Widths beyond which the Gaussian is below 1e-17.
const SILENT: f64 = 9.0;
/// Radii of a load from which on a cutoff can be cut along edges.
const FAR_CUT: f64 = 3.0;
/// Room, as a share of the cutoff, of the quadrature along edges; points project beside a triangle by twice as much.
const BESIDE: f64 = 0.1;

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
    pub(crate) fn values(&self, targets: &Targets, scratch: &mut Scratch, tolerance: f64) {
        half_space_values(targets, scratch, self.constant, tolerance, self.cutoff);
        pulp::Arch::new().dispatch(TakeOff { kernel: self, targets, scratch, tolerance });
        pulp::Arch::new().dispatch(Cut { kernel: self, targets, scratch, tolerance });
    }

    /// Error of the Gaussian's part, as a multiple of its height, that keeps the tolerance.
    fn allowed(&self, tolerance: f64) -> f64 {
        let reach = self.cutoff.min(SILENT * self.width);
        tolerance.max(1e-13) * self.constant / (self.height * reach)
    }

    /// The lowest degree of a series of the Gaussian that keeps the tolerance.
    ///
    /// Derivatives of order m of exp(-t²/2c²) are at most 1.09 √m! / cᵐ (Cramér's bound of the Hermite functions).
    fn series_degree(&self, series: &RadialSeries, tolerance: f64) -> Option<usize> {
        let ratio = series.radius / self.width;
        DEGREES.into_iter().find(|&degree| {
            let first: f64 = (1..=degree + 1).map(|m| ratio / (m as f64).sqrt()).product();
            let next = ratio / (degree as f64 + 2.0).sqrt();
            next < 0.9 && 1.09 * first * series.mean(degree + 1) <= self.allowed(tolerance) * (1.0 - next)
        })
    }

    /// Whether x, projected on the plane of a face, is outside it by at least `distance` (m): no arc of the cutoff then
    /// runs around the projection.
    fn projects_beside(face: &LoadedFace, x: &Vector3<f64>, distance: f64) -> bool {
        let arm = x - face.center;
        let height = arm.dot(&face.frame.normal);
        (arm - face.frame.normal * height).norm() >= face.radius + distance
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
            subdivided_hat_integrals(&face.frame.vertices, x)
        };
        let smooth = hats_within(&face.frame, x, &Gaussian { width: self.width }, self.cutoff);
        self.constant * weighted(&face.density, &inverse) - self.height * weighted(&face.density, &smooth)
    }
}

/// Takes the Gaussian off the values.
struct TakeOff<'a> {
    kernel: &'a Corrected,
    targets: &'a Targets,
    scratch: &'a mut Scratch,
    tolerance: f64,
}

impl WithSimd for TakeOff<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, targets, scratch, tolerance } = self;
        scratch.fill_series(simd, MAX_DEGREE);
        let half_edge = scratch.half_edge();
        let degree = kernel.series_degree(&scratch.series, tolerance);
        let Scratch { series, values, near, faces, rule, .. } = scratch;
        let far = kernel.cutoff.min(SILENT * kernel.width) + series.radius;
        near.index.clear();
        for start in (0..values.len()).step_by(BLOCK) {
            let at = |i: usize| Vector3::new(targets.x[i], targets.y[i], targets.z[i]);
            let felt = |i: usize| (at(i) - series.center).norm_squared() < far * far;
            if !(start..start + BLOCK).any(felt) {
                continue;
            }
            match degree {
                Some(degree) => kernel.series(simd, series, degree, targets, start, values),
                None => {
                    let last = targets.rows.len().min(start + BLOCK);
                    near.index.extend((start..last).filter(|&i| felt(i)).map(|i| i as u32));
                }
            }
        }
        // too narrow for a series
        near.gather(targets);
        let potential = Potential { constant: 0.0, height: 1.0, width: kernel.width, cutoff: None };
        rule.set(half_edge, 2.0 * kernel.width, 4.0, kernel.allowed(tolerance));
        for face in faces.iter().map(NearFace::new) {
            for i in (0..near.values.len()).step_by(S::F64_LANES) {
                let integral = face.along_edges(near.place(simd, i), rule, &potential);
                (integral + Lanes::load(simd, &near.values, i)).store(&mut near.values, i);
            }
        }
        for (&i, sum) in near.index.iter().zip(&near.values) {
            values[i as usize] += kernel.height * sum;
        }
    }
}

impl Corrected {
    /// Takes the Gaussian off one block, as a series.
    #[inline(always)]
    fn series<S: Simd>(
        &self,
        simd: S,
        series: &RadialSeries,
        degree: usize,
        targets: &Targets,
        start: usize,
        values: &mut [f64],
    ) {
        let zero = Lanes::splat(simd, 0.0);
        let ratio = series.radius / self.width;
        let falloff = zero.all(-0.5 * ratio * ratio);
        let step = TOGETHER * S::F64_LANES;
        for first in (start..start + BLOCK).step_by(step) {
            let place = series.place(simd, targets, first);
            let mut slopes = [[zero; TOGETHER]; MAX_DEGREE + 1];
            for k in 0..TOGETHER {
                let [x, y, z] = [place[0][k], place[1][k], place[2][k]];
                let mut slope = exp_negative(x.mul_add(x, y.mul_add(y, z * z)) * falloff);
                for (n, slot) in slopes[..=degree].iter_mut().enumerate() {
                    slot[k] = slope;
                    slope = slope * falloff * zero.all(1.0 / (n as f64 + 1.0));
                }
            }
            let gaussian = series.evaluate(degree, &place, &slopes);
            for (k, gaussian) in gaussian.into_iter().enumerate() {
                let from = first + k * S::F64_LANES;
                gaussian.mul_add(zero.all(-self.height), Lanes::load(simd, values, from)).store(values, from);
            }
        }
    }
}

/// Sets what the cutoff cuts and what lies beyond it.
struct Cut<'a> {
    kernel: &'a Corrected,
    targets: &'a Targets,
    scratch: &'a mut Scratch,
    tolerance: f64,
}

impl WithSimd for Cut<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, targets, scratch, tolerance } = self;
        let half_edge = scratch.half_edge();
        let Scratch { series, values, near, faces, rule, .. } = scratch;
        let &Corrected { constant, height, width, cutoff } = kernel;
        near.index.clear();
        for (i, value) in values[..targets.rows.len()].iter_mut().enumerate() {
            let x = Vector3::new(targets.x[i], targets.y[i], targets.z[i]);
            let distance = (x - series.center).norm();
            if distance - series.radius >= cutoff {
                *value = 0.0;
            } else if distance + series.radius > cutoff {
                near.index.push(i as u32);
            }
        }
        // half of the way from an edge to the projection of the point, where the integrands are singular
        let room = half_edge.max(BESIDE * cutoff);
        let is_small = cutoff >= FAR_CUT * series.radius;
        near.index.retain(|&i| {
            let i = i as usize;
            let x = Vector3::new(targets.x[i], targets.y[i], targets.z[i]);
            let along_edges =
                is_small && faces.iter().all(|face| Corrected::projects_beside(face, &x, 2.0 * room));
            if !along_edges {
                values[i] = faces.iter().map(|face| kernel.exact(face, &x)).sum();
            }
            along_edges
        });
        if near.index.is_empty() {
            return;
        }
        near.gather(targets);
        let potential = Potential { constant, height, width, cutoff: Some(cutoff) };
        // Potential and moment of a face cancel by the square of the distance over its size.
        let bound = 16.0 * (1.0 + height * cutoff / constant) * (cutoff / half_edge).powi(2);
        rule.set(half_edge, (2.0 * width).min(room), bound, tolerance.max(1e-13));
        for face in faces.iter().map(NearFace::new) {
            for i in (0..near.values.len()).step_by(S::F64_LANES) {
                let integral = face.along_edges(near.place(simd, i), rule, &potential);
                (integral + Lanes::load(simd, &near.values, i)).store(&mut near.values, i);
            }
        }
        for (&i, &sum) in near.index.iter().zip(&near.values) {
            values[i as usize] = sum;
        }
    }
}

/// Ψ of `constant / r - height exp(-r²/2 width²)`.
struct Potential {
    constant: f64,
    height: f64,
    width: f64,
    cutoff: Option<f64>,
}

impl<S: Simd> EdgePotential<S> for Potential {
    #[inline(always)]
    fn at(&self, squared: Lanes<S>) -> Lanes<S> {
        let square = self.width * self.width;
        let gaussian = exp_negative(squared * squared.all(-0.5 / square)) * squared.all(self.height * square);
        squared.sqrt().mul_add(squared.all(self.constant), gaussian)
    }

    #[inline(always)]
    fn cutoff_squared(&self) -> Option<f64> {
        self.cutoff.map(|cutoff| cutoff * cutoff)
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
