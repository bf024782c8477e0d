//! The far field of a node's load as a multipole series.
//!
//! With solid harmonics about the load's centre, `∫ p(y) / |x - y| dA = Σ_l Σ_m M_lm I_lm(x)` for x outside the
//! load (Greengard, Rokhlin 1987). One real recurrence serves both kinds: with `q_mm = 1`, `q_(m+1)m = z` and
//!
//! ```text
//! q_lm = z q_(l-1)m - β_lm r² q_(l-2)m,   β_lm = ((l-1)² - m²) / ((2l-1)(2l-3))
//! ```
//!
//! `q_lm(y) (x + iy)^m` is the regular harmonic, and by Kelvin's inversion the irregular one is the same
//! polynomial at x / r², over r. Lengths are scaled by the load's radius, so nothing over- or underflows.

use std::sync::OnceLock;

use nalgebra::Vector3;
use pulp::Simd;

/// Highest order of a series.
pub(crate) const MAX_ORDER: usize = 30;
const ROW: usize = MAX_ORDER + 1;
/// Orders that a series can end at; between them little is gained.
const LADDER: [usize; 10] = [1, 2, 3, 4, 6, 8, 10, 12, 20, 30];
/// Vectors that one call of [`Expansion::evaluate`] takes at a time, to hide the latency of the recurrence.
pub(crate) const TOGETHER: usize = 2;

/// Point forces that stand for a load: places (m) and shares of the unit force, as many as fill whole vectors.
#[derive(Debug, Default)]
pub(crate) struct PointLoads {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
    pub(crate) share: Vec<f64>,
}

impl PointLoads {
    pub(crate) fn clear(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z, &mut self.share] {
            list.clear();
        }
    }

    pub(crate) fn push(&mut self, place: &Vector3<f64>, share: f64) {
        self.x.push(place.x);
        self.y.push(place.y);
        self.z.push(place.z);
        self.share.push(share);
    }

    /// Fills up to a multiple of `lanes` with loads of no share.
    pub(crate) fn pad(&mut self, lanes: usize) {
        while let (Some(&x), Some(&y), Some(&z)) = (self.x.last(), self.y.last(), self.z.last()) {
            if self.x.len().is_multiple_of(lanes) {
                break;
            }
            self.push(&Vector3::new(x, y, z), 0.0);
        }
    }
}

/// β_lm and the product of both kinds' normalisations, at `m * ROW + l`.
struct Tables {
    beta: Vec<f64>,
    scale: Vec<f64>,
}

fn tables() -> &'static Tables {
    static TABLES: OnceLock<Tables> = OnceLock::new();
    TABLES.get_or_init(|| {
        let mut tables = Tables { beta: vec![0.0; ROW * ROW], scale: vec![0.0; ROW * ROW] };
        // 1 / (2^m m!), from step to step
        let mut start = 1.0;
        for m in 0..ROW {
            if m > 0 {
                start /= 2.0 * m as f64;
            }
            let mut regular = if m == 0 { 1.0 } else { 2.0 * start };
            for l in m..ROW {
                let (lf, mf) = (l as f64, m as f64);
                if l > m {
                    regular *= (2.0 * lf - 1.0) / (lf * lf - mf * mf);
                }
                let odd_factorial: f64 = (1..=l).map(|k| 2.0 * k as f64 - 1.0).product();
                tables.scale[m * ROW + l] = regular * odd_factorial;
                if l >= m + 2 {
                    let square = (lf - 1.0).powi(2) - mf * mf;
                    tables.beta[m * ROW + l] = square / ((2.0 * lf - 1.0) * (2.0 * lf - 3.0));
                }
            }
        }
        tables
    })
}

/// Highest order that a tolerance asks for: a compromise between long series and many exact near pairs.
pub(crate) fn order_for(tolerance: f64) -> usize {
    match tolerance {
        t if t >= 1e-4 => 4,
        t if t >= 1e-7 => 8,
        t if t >= 1e-10 => 12,
        _ => MAX_ORDER,
    }
}

/// Multipole series of one node's load.
#[derive(Debug)]
pub(crate) struct Expansion {
    /// Centre of the load (m).
    pub(crate) center: Vector3<f64>,
    /// Distance of the farthest point of the load from it (m).
    pub(crate) radius: f64,
    /// `(order, squared distance from the centre (m²) from which it keeps the tolerance)`, orders falling.
    reach: Vec<(usize, f64)>,
    cosine: Vec<f64>,
    sine: Vec<f64>,
    /// One vector for each sum over the load.
    sums: Vec<f64>,
}

impl Expansion {
    pub(crate) fn new() -> Self {
        Self {
            center: Vector3::zeros(),
            radius: 0.0,
            reach: Vec::with_capacity(LADDER.len()),
            cosine: vec![0.0; ROW * ROW],
            sine: vec![0.0; ROW * ROW],
            sums: vec![0.0; 8 * (2 * ROW * ROW + ROW)],
        }
    }

    /// Squared distance (m²) from the centre below which the series is not accurate enough.
    pub(crate) fn near_squared(&self) -> f64 {
        self.reach[0].1
    }

    /// Moments of the loads, which the caller has padded to whole vectors, up to the order for `tolerance`.
    ///
    /// `amplitude` multiplies the series. `center` and `radius` describe a ball around the load.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(
        &mut self,
        simd: S,
        loads: &PointLoads,
        (center, radius): (Vector3<f64>, f64),
        amplitude: f64,
        tolerance: f64,
    ) {
        self.center = center;
        self.radius = radius;
        let order = order_for(tolerance);
        let used = 2 * ((order + 1) * (order + 2) / 2) + order / 2 + 1;
        let lanes = S::F64_LANES;
        self.sums[..used * lanes].fill(0.0);
        let sums = S::as_mut_simd_f64s(&mut self.sums[..used * lanes]).0;
        let beta = &tables().beta;
        let inverse = simd.splat_f64s(1.0 / radius);
        let (cx, cy, cz) = (simd.splat_f64s(center.x), simd.splat_f64s(center.y), simd.splat_f64s(center.z));
        let vectors = [&loads.x, &loads.y, &loads.z, &loads.share].map(|list| S::as_simd_f64s(list).0);
        for (((&x, &y), &z), &share) in vectors[0].iter().zip(vectors[1]).zip(vectors[2]).zip(vectors[3]) {
            let x = simd.mul_f64s(simd.sub_f64s(x, cx), inverse);
            let y = simd.mul_f64s(simd.sub_f64s(y, cy), inverse);
            let z = simd.mul_f64s(simd.sub_f64s(z, cz), inverse);
            let r2 = simd.mul_add_f64s(x, x, simd.mul_add_f64s(y, y, simd.mul_f64s(z, z)));
            // share (x + iy)^m
            let (mut re, mut im) = (share, simd.splat_f64s(0.0));
            let mut at = 0;
            for m in 0..=order {
                let (mut before, mut q) = (simd.splat_f64s(0.0), simd.splat_f64s(1.0));
                for l in m..=order {
                    sums[at] = simd.mul_add_f64s(re, q, sums[at]);
                    sums[at + 1] = simd.mul_add_f64s(im, q, sums[at + 1]);
                    at += 2;
                    let next = if l < order { beta[m * ROW + l + 1] } else { 0.0 };
                    let pull = simd.mul_f64s(simd.mul_f64s(simd.splat_f64s(next), r2), before);
                    (before, q) = (q, simd.sub_f64s(simd.mul_f64s(z, q), pull));
                }
                (re, im) = (
                    simd.sub_f64s(simd.mul_f64s(re, x), simd.mul_f64s(im, y)),
                    simd.add_f64s(simd.mul_f64s(re, y), simd.mul_f64s(im, x)),
                );
            }
            // share r^2k, k = 1 ..
            let mut power = share;
            for sum in &mut sums[at..at + order / 2 + 1] {
                power = simd.mul_f64s(power, r2);
                *sum = simd.add_f64s(*sum, power);
            }
        }
        let mut totals = [0.0; 2 * ROW * ROW + ROW];
        for (total, sum) in totals.iter_mut().zip(sums.iter()) {
            *total = simd.reduce_sum_f64s(*sum);
        }
        let mut at = 0;
        for m in 0..=order {
            for l in m..=order {
                let scale = tables().scale[m * ROW + l] * amplitude / radius;
                self.cosine[m * ROW + l] = scale * totals[at];
                self.sine[m * ROW + l] = scale * totals[at + 1];
                at += 2;
            }
        }
        self.find_reach(order, totals[0], &totals[at..used], tolerance);
    }

    /// From where on each order keeps the tolerance.
    ///
    /// With positive loads of sum 1 and μ_n the mean of (|y| / radius)^n, the terms of degree l are at most
    /// μ_l / R^l of 1/|x|, R = |x| / radius, and μ_(l+1) <= μ_l; the true value is at least
    /// 1 / √(|x|² + mean |y|²) by convexity. So the relative error of order p is at most
    /// `√(1 + μ_2/R²) μ_(p+1) / R^(p+1) / (1 - 1/R)`.
    fn find_reach(&mut self, order: usize, total: f64, even: &[f64], tolerance: f64) {
        let mean = |n: usize| match n {
            0 => 1.0,
            n if n % 2 == 0 => even[n / 2 - 1] / total,
            // log-convex in n
            1 => (even[0] / total).sqrt(),
            n => (even[n / 2 - 1] * even[n.div_ceil(2) - 1]).sqrt() / total,
        };
        let tolerance = tolerance.max(f64::EPSILON);
        self.reach.clear();
        for &p in LADDER.iter().rev().filter(|&&p| p <= order) {
            let n = p + 1;
            let power = 1.0 / n as f64;
            let moment = (mean(n) / tolerance).powf(power);
            let least = |ratio: f64| {
                let factor = (1.0 + mean(2) / (ratio * ratio)).sqrt() / (1.0 - 1.0 / ratio);
                moment * factor.powf(power)
            };
            // The bound holds where ratio >= least(ratio), which falls: from a ratio that is surely large
            // enough one step leads below the smallest such ratio and the next above it again.
            let safe = (moment * 4f64.powf(power)).max(1.5);
            let below = least(safe).max(1.1);
            let ratio = least(below).max(below).min(safe);
            let distance = ratio * self.radius;
            self.reach.push((p, distance * distance));
        }
        // A lower order that reaches no farther than a higher one is the better choice there.
        for k in (0..self.reach.len().saturating_sub(1)).rev() {
            self.reach[k].1 = self.reach[k].1.min(self.reach[k + 1].1);
        }
    }

    /// The lowest order that keeps the tolerance at this squared distance (m²) from the centre.
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

    /// The series up to `order` at points relative to the centre (m).
    #[inline(always)]
    pub(crate) fn evaluate<S: Simd>(
        &self,
        simd: S,
        order: usize,
        x: [S::f64s; TOGETHER],
        y: [S::f64s; TOGETHER],
        z: [S::f64s; TOGETHER],
    ) -> [S::f64s; TOGETHER] {
        let one = simd.splat_f64s(1.0);
        let zero = simd.splat_f64s(0.0);
        let inverse_radius = simd.splat_f64s(1.0 / self.radius);
        // w = (x + iy) / r², u = z / r², v = 1 / r², all scaled by the radius
        let (mut wx, mut wy, mut u, mut v) =
            ([zero; TOGETHER], [zero; TOGETHER], [zero; TOGETHER], [zero; TOGETHER]);
        for k in 0..TOGETHER {
            let x = simd.mul_f64s(x[k], inverse_radius);
            let y = simd.mul_f64s(y[k], inverse_radius);
            let z = simd.mul_f64s(z[k], inverse_radius);
            let r2 = simd.mul_add_f64s(x, x, simd.mul_add_f64s(y, y, simd.mul_f64s(z, z)));
            v[k] = simd.div_f64s(one, r2);
            wx[k] = simd.mul_f64s(x, v[k]);
            wy[k] = simd.mul_f64s(y, v[k]);
            u[k] = simd.mul_f64s(z, v[k]);
        }
        let beta = &tables().beta;
        // Horner in w over m of Σ_l (C_lm - i S_lm) q_lm
        let (mut re, mut im) = ([zero; TOGETHER], [zero; TOGETHER]);
        for m in (0..=order).rev() {
            let row = m * ROW + m..m * ROW + order + 1;
            let (cosine, sine, beta) = (&self.cosine[row.clone()], &self.sine[row.clone()], &beta[row]);
            let (mut a, mut b) =
                ([simd.splat_f64s(cosine[0]); TOGETHER], [simd.splat_f64s(sine[0]); TOGETHER]);
            let (mut before, mut q) = ([one; TOGETHER], u);
            for l in 1..cosine.len() {
                let (c, s) = (simd.splat_f64s(cosine[l]), simd.splat_f64s(sine[l]));
                if l > 1 {
                    let pull = simd.splat_f64s(beta[l]);
                    for k in 0..TOGETHER {
                        let t = simd.mul_f64s(simd.mul_f64s(pull, v[k]), before[k]);
                        (before[k], q[k]) = (q[k], simd.sub_f64s(simd.mul_f64s(u[k], q[k]), t));
                    }
                }
                for k in 0..TOGETHER {
                    a[k] = simd.mul_add_f64s(c, q[k], a[k]);
                    b[k] = simd.mul_add_f64s(s, q[k], b[k]);
                }
            }
            for k in 0..TOGETHER {
                let next = simd.sub_f64s(simd.mul_add_f64s(re[k], wx[k], a[k]), simd.mul_f64s(im[k], wy[k]));
                im[k] = simd.mul_add_f64s(re[k], wy[k], simd.sub_f64s(simd.mul_f64s(im[k], wx[k]), b[k]));
                re[k] = next;
            }
        }
        let mut value = [zero; TOGETHER];
        for k in 0..TOGETHER {
            value[k] = simd.mul_f64s(re[k], simd.sqrt_f64s(v[k]));
        }
        value
    }
}
