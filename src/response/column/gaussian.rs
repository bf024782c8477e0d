//! One column of the paper's kernel: half-space less a Gaussian, cut off.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::half_space::{ColumnScratch, half_space_values, moment_points};
use crate::response::column::load::{LoadedFace, weighted};
use crate::response::integral::cutoff::{Inverse, hats_within};
use crate::response::integral::gauss::{RulePoint, triangle_rule};
use crate::response::integral::gaussian::Gaussian;
use crate::response::integral::hat::hat_integrals;
use crate::response::series::point_loads::PointLoads;
use crate::response::simd::functions::exp;
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::Targets;

/// Widths beyond which the Gaussian is below 1e-17.
pub(crate) const SILENT_WIDTHS: f64 = 9.0;
/// Share of the cutoff from which on a triangle that it leaves whole is far enough for a rule.
const FAR_SHARE: f64 = 0.5;
/// Most points of a rule in each direction; beyond, the closed form costs less.
const MOST_RULE_POINTS: usize = 12;
/// The closed form's own error.
const CLOSED_FORM_ERROR: f64 = 1e-13;

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
    pub(crate) fn values(&self, targets: &Targets, scratch: &mut ColumnScratch, tolerance: f64) {
        let points = moment_points(tolerance);
        half_space_values(targets, scratch, self.constant, tolerance, self.cutoff, points);
        let ColumnScratch { faces, values, loads, sums, .. } = scratch;
        let load: Vec<_> = faces.iter().map(|face| (face, self.point_forces(face, tolerance))).collect();
        loads.clear();
        load.iter()
            .filter_map(|(_, forces)| forces.as_ref())
            .flatten()
            .for_each(|(y, share)| loads.push(y, *share));
        sums.clear();
        sums.resize(targets.points.len(), 0.0);
        pulp::Arch::new().dispatch(GaussianSums { targets, loads, falloff: self.falloff(), sums });
        for (i, value) in values[..targets.rows.len()].iter_mut().enumerate() {
            let x = targets.points.at(i);
            if faces.iter().all(|face| (x - face.frame.center).norm() + face.frame.radius <= self.cutoff) {
                let exact = load.iter().filter(|(_, forces)| forces.is_none());
                let taken = sums[i] + exact.map(|(face, _)| self.exact_gaussian(face, &x)).sum::<f64>();
                *value -= self.height * taken;
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
        let closest = FAR_SHARE * self.cutoff - face.frame.radius;
        let inverse_ratio = 0.5 * face.frame.radius / closest;
        let gaussian_ratio = 0.5 * face.frame.radius / self.width;
        // the Gaussian as a multiple of K/r
        let share = self.height * self.cutoff.min(SILENT_WIDTHS * self.width) / self.constant;
        let keeps = |n: &usize| {
            let order = 2 * n - 1;
            let inverse = inverse_ratio.powi(order as i32) * (1.0 + 2.0 * inverse_ratio);
            let gaussian: f64 = (1..=order).map(|m| gaussian_ratio / (m as f64).sqrt()).product();
            8.0 * (inverse + 1.09 * share * gaussian) <= tolerance.max(CLOSED_FORM_ERROR)
        };
        let n = (1..=MOST_RULE_POINTS).find(|n| closest > 0.0 && keeps(n))?;
        let [a, b, c] = face.frame.vertices;
        let force = |(l, weight): &RulePoint| {
            (a * l[0] + b * l[1] + c * l[2], weight * face.frame.area * weighted(&face.density, l))
        };
        Some(triangle_rule(n).iter().map(force).collect())
    }

    /// -1/2c² (1/m²).
    fn falloff(&self) -> f64 {
        -0.5 / (self.width * self.width)
    }

    /// `∫ p(y) exp(-r²/2c²) dA` over one face that lies within the cutoff, in closed form.
    fn exact_gaussian(&self, face: &LoadedFace, x: &Vector3<f64>) -> f64 {
        if (x - face.frame.center).norm() > face.frame.radius + SILENT_WIDTHS * self.width {
            return 0.0;
        }
        weighted(&face.density, &hats_within(&face.frame, x, &Gaussian { width: self.width }, self.cutoff))
    }

    /// One face's share of the displacement at x.
    fn share(&self, face: &LoadedFace, forces: Option<&[(Vector3<f64>, f64)]>, x: &Vector3<f64>) -> f64 {
        let distance = (x - face.frame.center).norm();
        let is_far = distance >= FAR_SHARE * self.cutoff && distance + face.frame.radius <= self.cutoff;
        match forces {
            Some(forces) if is_far => {
                let kernel = |squared: f64| {
                    self.constant / squared.sqrt() - self.height * (squared * self.falloff()).exp()
                };
                forces.iter().map(|(y, share)| share * kernel((x - y).norm_squared())).sum()
            }
            _ => self.exact(face, x),
        }
    }

    /// One face's share of the displacement at x, in closed form.
    fn exact(&self, face: &LoadedFace, x: &Vector3<f64>) -> f64 {
        let distance = (x - face.frame.center).norm();
        if distance - face.frame.radius >= self.cutoff {
            return 0.0;
        }
        let inverse = if distance + face.frame.radius > self.cutoff {
            hats_within(&face.frame, x, &Inverse, self.cutoff)
        } else {
            hat_integrals(x, &face.frame.vertices)
        };
        let smooth = hats_within(&face.frame, x, &Gaussian { width: self.width }, self.cutoff);
        self.constant * weighted(&face.density, &inverse) - self.height * weighted(&face.density, &smooth)
    }
}

/// Adds `Σ share exp(falloff r²)` over point forces to the sum of each target.
struct GaussianSums<'a> {
    targets: &'a Targets,
    loads: &'a PointLoads,
    falloff: f64,
    sums: &'a mut [f64],
}

impl WithSimd for GaussianSums<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { targets, loads, falloff, sums } = self;
        for first in (0..sums.len()).step_by(S::F64_LANES) {
            let x = targets.points.load(simd, first);
            let mut sum = Lanes::splat(simd, 0.0);
            for k in 0..loads.share.len() {
                let y = loads.points.at(k);
                let r = [x[0] - sum.all(y.x), x[1] - sum.all(y.y), x[2] - sum.all(y.z)];
                sum = exp(dot(&r, &r) * sum.all(falloff)).mul_add(sum.all(loads.share[k]), sum);
            }
            sum.store(sums, first);
        }
    }
}
