//! One column of the paper's kernel: half-space less a Gaussian, cut off.

use super::column::{Scratch, half_space_values, spread_load};
use super::cut::{Inverse, hats_within};
use super::elementary::exp_negative;
use super::gaussian::Gaussian;
use super::lanes::Lanes;
use super::multipole::PointLoads;
use super::source::{LoadedFace, weighted};
use super::subdivide::subdivided_hat_integrals;
use super::targets::{BLOCK, Targets};
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

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
        let radius = scratch.faces.iter().map(|f| f.radius).fold(0.0, f64::max);
        let points = self.rule_points(radius, tolerance);
        if let Some(n) = points {
            spread_load(scratch, n, 1);
            pulp::Arch::new().dispatch(Subtract { kernel: self, targets, scratch });
        }
        // What the cutoff cuts, and everything where the Gaussian is too narrow for a rule, is exact.
        let ball = scratch.ball();
        for i in 0..targets.rows.len() {
            let x = Vector3::new(targets.x[i], targets.y[i], targets.z[i]);
            let distance = (x - ball.0).norm();
            if distance - ball.1 >= self.cutoff {
                scratch.values[i] = 0.0;
            } else if points.is_none() || distance + ball.1 > self.cutoff {
                scratch.values[i] = scratch.faces.iter().map(|face| self.exact(face, &x)).sum();
            }
        }
    }

    /// Points in each direction of the rule that integrates the Gaussian over a triangle with an error under
    /// `tolerance` times the 1/r part; `None` where Owen's T is the better way.
    ///
    /// The derivatives of order n of exp(-t²/2c²) are at most 1.09 √n! / cⁿ (Cramér's bound of the Hermite
    /// functions), so the rule of degree 2n - 1 errs by at most 2.2 (ρ/c)²ⁿ / √(2n)! of the area.
    fn rule_points(&self, radius: f64, tolerance: f64) -> Option<usize> {
        let reach = self.cutoff.min(10.0 * self.width);
        let allowed = tolerance.max(1e-15) * self.constant / (self.height * reach);
        let ratio = radius / self.width;
        let mut bound = 2.2;
        for n in 1..=8 {
            let k = 2.0 * n as f64;
            bound *= ratio * ratio / (k * (k - 1.0)).sqrt();
            if bound <= allowed {
                return Some(n);
            }
        }
        None
    }

    /// One face's share of the displacement at x, in closed form.
    fn exact(&self, face: &LoadedFace, x: &Vector3<f64>) -> f64 {
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

/// Takes the Gaussian of the point loads off the values.
struct Subtract<'a> {
    kernel: &'a Corrected,
    targets: &'a Targets,
    scratch: &'a mut Scratch,
}

impl WithSimd for Subtract<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, targets, scratch } = self;
        let (center, radius) = scratch.ball();
        let far = kernel.cutoff + radius;
        let (loads, values) = scratch.loads_and_values();
        for start in (0..values.len()).step_by(BLOCK) {
            let block = start..start + BLOCK;
            let (x, y, z) = (&targets.x[block.clone()], &targets.y[block.clone()], &targets.z[block.clone()]);
            let nearest = (0..BLOCK)
                .map(|i| (Vector3::new(x[i], y[i], z[i]) - center).norm_squared())
                .fold(f64::INFINITY, f64::min);
            if nearest < far * far {
                kernel.subtract(simd, loads, [x, y, z], &mut values[block]);
            }
        }
    }
}

impl Corrected {
    #[inline(always)]
    fn subtract<S: Simd>(&self, simd: S, loads: &PointLoads, at: [&[f64]; 3], values: &mut [f64]) {
        let falloff = Lanes::splat(simd, -0.5 / (self.width * self.width));
        let (x, y, z) = (S::as_simd_f64s(at[0]).0, S::as_simd_f64s(at[1]).0, S::as_simd_f64s(at[2]).0);
        let values = S::as_mut_simd_f64s(values).0;
        for (((&x, &y), &z), value) in x.iter().zip(y).zip(z).zip(values) {
            let place = [Lanes::new(simd, x), Lanes::new(simd, y), Lanes::new(simd, z)];
            let mut sum = Lanes::splat(simd, 0.0);
            for (k, &share) in loads.share.iter().enumerate() {
                let [dx, dy, dz] = [
                    place[0] - sum.all(loads.x[k]),
                    place[1] - sum.all(loads.y[k]),
                    place[2] - sum.all(loads.z[k]),
                ];
                let squared = dx.mul_add(dx, dy.mul_add(dy, dz * dz));
                sum = exp_negative(squared * falloff).mul_add(sum.all(share), sum);
            }
            *value = simd.mul_add_f64s(simd.splat_f64s(-self.height), sum.v, *value);
        }
    }
}
