//! The far field of a node's load as a multipole series.
//!
//! With solid harmonics about the load's center, `∫ p(y) / |x - y| dA = Σ_l Σ_m M_lm I_lm(x)` for x outside the
//! load (Greengard, Rokhlin 1987). One real recurrence serves both kinds: with `q_mm = 1`, `q_(m+1)m = z` and
//!
//! ```text
//! q_lm = z q_(l-1)m - β_lm r² q_(l-2)m,   β_lm = ((l-1)² - m²) / ((2l-1)(2l-3))
//! ```
//!
//! `q_lm(y) (x + iy)^m` is the regular harmonic, and by Kelvin's inversion the irregular one is the same
//! polynomial at x / r², over r. Lengths are scaled by the load's radius, so nothing over- or underflows.

use std::sync::OnceLock;

use pulp::Simd;

use crate::response::series::point_loads::{LoadBall, PointLoads, RadialMeans, VECTORS_AT_ONCE};
use crate::response::simd::lanes::{Lanes, dot};

/// Highest order of a series.
pub(crate) const MAX_ORDER: usize = 30;
const ROW_LENGTH: usize = MAX_ORDER + 1;
/// Orders that a series can end at; between them little is gained.
const ORDER_LADDER: [usize; 10] = [1, 2, 3, 4, 6, 8, 10, 12, 20, 30];

struct Tables {
    /// -β_lm and the product of both kinds' normalisations, at `m * ROW_LENGTH + l`.
    minus_beta: Vec<f64>,
    scale: Vec<f64>,
    /// `4^(1/n)`.
    roots_of_four: Vec<f64>,
}

fn tables() -> &'static Tables {
    static TABLES: OnceLock<Tables> = OnceLock::new();
    TABLES.get_or_init(|| {
        let mut tables = Tables {
            minus_beta: vec![0.0; ROW_LENGTH * ROW_LENGTH],
            scale: vec![0.0; ROW_LENGTH * ROW_LENGTH],
            roots_of_four: (0..MAX_ORDER + 2).map(|n| 4f64.powf(1.0 / n as f64)).collect(),
        };
        // 1 / (2^m m!), from step to step
        let mut start = 1.0;
        for m in 0..ROW_LENGTH {
            if m > 0 {
                start /= 2.0 * m as f64;
            }
            let mut regular = if m == 0 { 1.0 } else { 2.0 * start };
            for l in m..ROW_LENGTH {
                let (lf, mf) = (l as f64, m as f64);
                if l > m {
                    regular *= (2.0 * lf - 1.0) / (lf * lf - mf * mf);
                }
                let odd_factorial: f64 = (1..=l).map(|k| 2.0 * k as f64 - 1.0).product();
                tables.scale[m * ROW_LENGTH + l] = regular * odd_factorial;
                if l >= m + 2 {
                    let square = (lf - 1.0).powi(2) - mf * mf;
                    tables.minus_beta[m * ROW_LENGTH + l] = -square / ((2.0 * lf - 1.0) * (2.0 * lf - 3.0));
                }
            }
        }
        tables
    })
}

/// Highest order that a tolerance asks for: a compromise between long series and many exact near pairs.
pub(crate) fn order_for(tolerance: f64) -> usize {
    match tolerance {
        t if t >= 3e-5 => 6,
        t if t >= 1e-7 => 8,
        t if t >= 1e-10 => 12,
        _ => MAX_ORDER,
    }
}

/// Multipole series of one node's load.
#[derive(Debug)]
pub(crate) struct MultipoleSeries {
    /// Around the load.
    pub(crate) ball: LoadBall,
    /// `(order, squared distance from the center (m²) from which it keeps the tolerance)`, orders falling.
    reach: Vec<(usize, f64)>,
    cosine: Vec<f64>,
    sine: Vec<f64>,
    /// One vector for each sum over the load.
    sums: Vec<f64>,
}

impl Default for MultipoleSeries {
    fn default() -> Self {
        Self {
            ball: LoadBall::default(),
            reach: Vec::with_capacity(ORDER_LADDER.len()),
            cosine: vec![0.0; ROW_LENGTH * ROW_LENGTH],
            sine: vec![0.0; ROW_LENGTH * ROW_LENGTH],
            sums: vec![0.0; 8 * 2 * ROW_LENGTH * ROW_LENGTH],
        }
    }
}

impl MultipoleSeries {
    /// Squared distance (m²) from the center below which the series is not accurate enough.
    pub(crate) fn near_squared(&self) -> f64 {
        self.reach[0].1
    }

    /// Moments of the loads, which the caller has padded to whole vectors, up to the order for `tolerance`.
    ///
    /// `amplitude` multiplies the series; no point is farther than `farthest` (m) from the center.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(
        &mut self,
        simd: S,
        loads: &PointLoads,
        ball: LoadBall,
        amplitude: f64,
        tolerance: f64,
        farthest: f64,
    ) {
        self.ball = ball;
        let order = order_for(tolerance);
        let used = (order + 1) * (order + 2) * S::F64_LANES;
        self.sums[..used].fill(0.0);
        let sums = S::as_mut_simd_f64s(&mut self.sums[..used]).0;
        let minus_beta = &tables().minus_beta;
        for first in (0..loads.points.len()).step_by(VECTORS_AT_ONCE * S::F64_LANES) {
            let zeros = [Lanes::splat(simd, 0.0); VECTORS_AT_ONCE];
            let (mut x, mut y, mut z, mut r2, mut re) = (zeros, zeros, zeros, zeros, zeros);
            for k in 0..VECTORS_AT_ONCE {
                let (place, share) = loads.vector(simd, &ball, first + k * S::F64_LANES);
                ([x[k], y[k], z[k]], r2[k], re[k]) = (place, dot(&place, &place), share);
            }
            // share (x + iy)^m
            let mut im = zeros;
            let mut at = 0;
            for m in 0..=order {
                let (mut before, mut q) = (zeros, [zeros[0].all(1.0); VECTORS_AT_ONCE]);
                for l in m..=order {
                    let (mut cosine, mut sine) = (Lanes::new(simd, sums[at]), Lanes::new(simd, sums[at + 1]));
                    let next = zeros[0].all(if l < order { minus_beta[m * ROW_LENGTH + l + 1] } else { 0.0 });
                    for k in 0..VECTORS_AT_ONCE {
                        cosine = re[k].mul_add(q[k], cosine);
                        sine = im[k].mul_add(q[k], sine);
                        (before[k], q[k]) = (q[k], next.mul_add(r2[k] * before[k], z[k] * q[k]));
                    }
                    (sums[at], sums[at + 1]) = (cosine.v, sine.v);
                    at += 2;
                }
                for k in 0..VECTORS_AT_ONCE {
                    (re[k], im[k]) = (re[k] * x[k] - im[k] * y[k], re[k] * y[k] + im[k] * x[k]);
                }
            }
        }
        let mut at = 0;
        for m in 0..=order {
            for l in m..=order {
                let scale = tables().scale[m * ROW_LENGTH + l] * amplitude / ball.radius;
                self.cosine[m * ROW_LENGTH + l] = scale * Lanes::new(simd, sums[at]).total();
                self.sine[m * ROW_LENGTH + l] = scale * Lanes::new(simd, sums[at + 1]).total();
                at += 2;
            }
        }
        self.find_reach(order, &loads.radial_means(simd, &ball, order / 2 + 1), tolerance, farthest);
    }

    /// From where on each order keeps the tolerance.
    ///
    /// With positive loads of sum 1 and μ_n the mean of (|y| / radius)^n, the terms of degree l are at most
    /// μ_l / R^l of 1/|x|, R = |x| / radius, and μ_(l+1) <= μ_l; the true value is at least
    /// 1 / √(|x|² + mean |y|²) by convexity. So the relative error of order p is at most
    /// `√(1 + μ_2/R²) μ_(p+1) / R^(p+1) / (1 - 1/R)`.
    ///
    /// * `farthest`: no point is farther from the center (m)
    fn find_reach(&mut self, order: usize, means: &RadialMeans, tolerance: f64, farthest: f64) {
        let tolerance = tolerance.max(f64::EPSILON);
        self.reach.clear();
        for &p in ORDER_LADDER.iter().rev().filter(|&&p| p <= order) {
            let n = p + 1;
            let power = 1.0 / n as f64;
            let moment = (means.at(n) / tolerance).powf(power);
            let least = |ratio: f64| {
                let factor = (1.0 + means.at(2) / (ratio * ratio)).sqrt() / (1.0 - 1.0 / ratio);
                // Above the root of a number above 1 (Bernoulli).
                moment * (1.0 + power * (factor - 1.0))
            };
            // The bound holds where ratio >= least(ratio), which falls: from a ratio that is surely large
            // enough one step leads below the smallest such ratio and the next above it again.
            let safe = (moment * tables().roots_of_four[n]).max(1.5);
            let below = least(safe).max(1.1);
            let ratio = least(below).max(below).min(safe);
            let distance = ratio * self.ball.radius;
            self.reach.push((p, distance * distance));
            // Lower ones reach farther.
            if distance > farthest {
                break;
            }
        }
        // A lower order that reaches no farther than a higher one is the better choice there.
        for k in (0..self.reach.len().saturating_sub(1)).rev() {
            self.reach[k].1 = self.reach[k].1.min(self.reach[k + 1].1);
        }
    }

    /// The lowest order that keeps the tolerance at this squared distance (m²) from the center.
    #[inline(always)]
    pub(crate) fn order_at(&self, distance_squared: f64) -> usize {
        let mut order = self.reach[0].0;
        for &(p, reach) in &self.reach[1..] {
            if distance_squared < reach {
                break;
            }
            order = p;
        }
        order
    }

    /// The series up to `order` at points relative to the center (m).
    #[inline(always)]
    pub(crate) fn evaluate<S: Simd>(
        &self,
        order: usize,
        points: &[[Lanes<S>; 3]; VECTORS_AT_ONCE],
    ) -> [Lanes<S>; VECTORS_AT_ONCE] {
        let any = points[0][0];
        let (one, inverse_radius) = (any.all(1.0), any.all(1.0 / self.ball.radius));
        // w = (x + iy) / r², u = z / r², v = 1 / r², all scaled by the radius
        let zeros = [any.all(0.0); VECTORS_AT_ONCE];
        let (mut wx, mut wy, mut u, mut v) = (zeros, zeros, zeros, zeros);
        for k in 0..VECTORS_AT_ONCE {
            let [x, y, z] = points[k];
            let place = [x * inverse_radius, y * inverse_radius, z * inverse_radius];
            v[k] = one / dot(&place, &place);
            wx[k] = place[0] * v[k];
            wy[k] = place[1] * v[k];
            u[k] = place[2] * v[k];
        }
        let minus_beta = &tables().minus_beta;
        // Horner in w over m of Σ_l (C_lm - i S_lm) q_lm
        let (mut re, mut im) = (zeros, zeros);
        for m in (0..=order).rev() {
            let row = m * ROW_LENGTH + m..m * ROW_LENGTH + order + 1;
            let (cosine, sine) = (&self.cosine[row.clone()], &self.sine[row.clone()]);
            let minus_beta = &minus_beta[row];
            let (mut a, mut b) = ([any.all(cosine[0]); VECTORS_AT_ONCE], [any.all(sine[0]); VECTORS_AT_ONCE]);
            let (mut before, mut q) = ([one; VECTORS_AT_ONCE], u);
            for l in 1..cosine.len() {
                let (c, s) = (any.all(cosine[l]), any.all(sine[l]));
                if l > 1 {
                    let pull = any.all(minus_beta[l]);
                    for k in 0..VECTORS_AT_ONCE {
                        (before[k], q[k]) = (q[k], pull.mul_add(v[k] * before[k], u[k] * q[k]));
                    }
                }
                for k in 0..VECTORS_AT_ONCE {
                    a[k] = c.mul_add(q[k], a[k]);
                    b[k] = s.mul_add(q[k], b[k]);
                }
            }
            for k in 0..VECTORS_AT_ONCE {
                let next = re[k].mul_add(wx[k], a[k]) - im[k] * wy[k];
                im[k] = re[k].mul_add(wy[k], im[k] * wx[k] - b[k]);
                re[k] = next;
            }
        }
        // no closure: it would not be compiled for the machine's vectors
        for k in 0..VECTORS_AT_ONCE {
            re[k] = re[k] * v[k].sqrt();
        }
        re
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::response::column::half_space::moment_points;
    use crate::response::integral::rule_lists::RuleLists;

    #[test]
    fn the_points_that_a_column_takes_keep_the_series_far_below_its_tolerance() {
        let corners =
            [Vector3::new(0.1, -0.2, 0.3), Vector3::new(1.0, 0.4, -0.1), Vector3::new(-0.3, 0.9, 0.5)];
        for tolerance in [1e-3, 1e-4, 3e-5, 1e-6, 1e-9, 0.0] {
            let series_by = |points: usize| {
                let mut loads = PointLoads::default();
                loads.spread(&corners, &[2.0, 0.5, 0.5], RuleLists::gauss(points));
                loads.pad(VECTORS_AT_ONCE);
                let mut series = MultipoleSeries::default();
                let ball = loads.ball(corners.iter());
                series.fill(pulp::Scalar, &loads, ball, 1.0, tolerance, f64::INFINITY);
                series
            };
            let exact = series_by(moment_points(tolerance) + 4);
            // In eight directions, where the series begins to hold.
            let side = (exact.near_squared() / 3.0).sqrt();
            let at_corner = |series: &MultipoleSeries, corner: usize| {
                let place = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { side } else { -side });
                let points = [place.map(|place| Lanes::splat(pulp::Scalar, place)); VECTORS_AT_ONCE];
                series.evaluate(order_for(tolerance), &points)[0].total()
            };
            let error = |points: usize| {
                let found = series_by(points);
                let off = |corner| (at_corner(&found, corner) / at_corner(&exact, corner) - 1.0).abs();
                (0..8).map(off).fold(0.0, f64::max)
            };
            assert!(error(moment_points(tolerance)) <= (0.05 * tolerance).max(16.0 * f64::EPSILON));
        }
    }
}
