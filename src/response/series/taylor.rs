//! The field of a load under a radial kernel, as a Taylor series about the load's centre.
//!
//! With D = x - c, δ = y - c and the kernel as a function G of the squared distance,
//! `|x - y|² = |D|² + (|δ|² - 2 D·δ)`, so that the terms of degree n + 2j in δ add up to
//!
//! ```text
//! ∫ p(y) G(|x - y|²) dA = Σ_nj  G^(n+j)(|D|²) / (n+j)!  (n+j choose j) (-2)^n  ∫ p (D·δ)^n |δ|^2j dA
//! ```
//!
//! Lengths are scaled by the load's radius. One set of moments serves every target and every kernel, which is
//! asked only for its derivatives at one distance.

use std::sync::OnceLock;

use nalgebra::Vector3;
use pulp::Simd;

use crate::response::series::multipole::PointLoads;
use crate::response::simd::lanes::Lanes;
use crate::response::simd::points::Targets;

/// Highest degree of a series.
pub(crate) const MAX_DEGREE: usize = 9;
/// Degrees that a series can end at; between them little is gained.
pub(crate) const DEGREES: [usize; 6] = [1, 2, 3, 5, 7, MAX_DEGREE];
/// Monomials of the highest degree in three variables.
const MOST_MONOMIALS: usize = monomials(MAX_DEGREE);
/// Vectors that one call of [`RadialSeries::evaluate`] takes at a time, to hide the latency of its sums.
pub(crate) const TOGETHER: usize = 2;

const fn monomials(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Pairs (n, j) with n + 2j <= [`MAX_DEGREE`], n outermost; where the moments of each start, and the end.
fn layout() -> &'static [(usize, usize, usize)] {
    static LAYOUT: OnceLock<Vec<(usize, usize, usize)>> = OnceLock::new();
    LAYOUT.get_or_init(|| {
        let mut start = 0;
        let mut list = Vec::new();
        for n in 0..=MAX_DEGREE {
            for j in 0..=(MAX_DEGREE - n) / 2 {
                list.push((n, j, start));
                start += monomials(n);
            }
        }
        list.push((MAX_DEGREE + 1, 0, start));
        list
    })
}

/// What multiplies each moment: (n+j choose j) (-2)^n n! / α!.
fn factors() -> &'static [f64] {
    static FACTORS: OnceLock<Vec<f64>> = OnceLock::new();
    FACTORS.get_or_init(|| {
        let factorial = |k: usize| (1..=k).map(|v| v as f64).product::<f64>();
        let pairs = &layout()[..layout().len() - 1];
        let mut list = Vec::new();
        for &(n, j, _) in pairs {
            let pair = factorial(n + j) / factorial(j) * (-2f64).powi(n as i32);
            for x in (0..=n).rev() {
                for y in (0..=n - x).rev() {
                    list.push(pair / (factorial(x) * factorial(y) * factorial(n - x - y)));
                }
            }
        }
        list
    })
}

/// From the monomials of degree `n` to those of the next: all times x, those without x times y, z^n times z.
#[inline(always)]
fn raise<T: Copy>(list: &mut [T; MOST_MONOMIALS], n: usize, times: impl Fn(T, usize) -> T) {
    let (count, rest) = (monomials(n), n + 1);
    for i in 0..rest {
        list[count + i] = times(list[count - rest + i], 1);
    }
    list[count + rest] = times(list[count - 1], 2);
    for entry in &mut list[..count] {
        *entry = times(*entry, 0);
    }
}

/// Moments of one node's load.
#[derive(Debug)]
pub(crate) struct RadialSeries {
    /// Centre of the load (m).
    pub(crate) center: Vector3<f64>,
    /// Distance of the farthest point of the load from it (m).
    pub(crate) radius: f64,
    /// Means of (|δ| / radius)^2k over the load, k = 0 ..
    even_means: [f64; MAX_DEGREE / 2 + 3],
    moments: Vec<f64>,
    /// One vector for each sum over the load.
    sums: Vec<f64>,
}

impl RadialSeries {
    pub(crate) fn new() -> Self {
        let count = factors().len();
        Self {
            center: Vector3::zeros(),
            radius: 1.0,
            even_means: [0.0; MAX_DEGREE / 2 + 3],
            moments: vec![0.0; count],
            sums: vec![0.0; 8 * count],
        }
    }

    /// Moments up to `degree` of positive loads of sum 1, which the caller has padded to whole vectors.
    #[inline(always)]
    pub(crate) fn fill<S: Simd>(
        &mut self,
        simd: S,
        loads: &PointLoads,
        (center, radius): (Vector3<f64>, f64),
        degree: usize,
    ) {
        (self.center, self.radius) = (center, radius);
        let lanes = S::F64_LANES;
        self.sums[..self.moments.len() * lanes].fill(0.0);
        let sums = S::as_mut_simd_f64s(&mut self.sums[..self.moments.len() * lanes]).0;
        let zero = Lanes::splat(simd, 0.0);
        let mut means = [zero; MAX_DEGREE / 2 + 3];
        let inverse = zero.all(1.0 / radius);
        let [xs, ys, zs, shares] =
            [&loads.x, &loads.y, &loads.z, &loads.share].map(|list| S::as_simd_f64s(list).0);
        for (((&x, &y), &z), &share) in xs.iter().zip(ys).zip(zs).zip(shares) {
            let place = [
                (Lanes::new(simd, x) - zero.all(center.x)) * inverse,
                (Lanes::new(simd, y) - zero.all(center.y)) * inverse,
                (Lanes::new(simd, z) - zero.all(center.z)) * inverse,
            ];
            let squared = place[0].mul_add(place[0], place[1].mul_add(place[1], place[2] * place[2]));
            let mut powers = [Lanes::new(simd, share); MAX_DEGREE / 2 + 3];
            for k in 1..powers.len() {
                powers[k] = powers[k - 1] * squared;
            }
            for (mean, power) in means.iter_mut().zip(powers) {
                *mean = *mean + power;
            }
            let mut list = [zero.all(1.0); MOST_MONOMIALS];
            let mut done = 0;
            for &(n, j, start) in &layout()[..layout().len() - 1] {
                if n + 2 * j > degree {
                    continue;
                }
                while done < n {
                    raise(&mut list, done, |entry, axis| entry * place[axis]);
                    done += 1;
                }
                for (sum, entry) in sums[start..start + monomials(n)].iter_mut().zip(&list) {
                    *sum = entry.mul_add(powers[j], Lanes::new(simd, *sum)).v;
                }
            }
        }
        for ((moment, sum), factor) in self.moments.iter_mut().zip(sums.iter()).zip(factors()) {
            *moment = factor * simd.reduce_sum_f64s(*sum);
        }
        for (to, mean) in self.even_means.iter_mut().zip(means) {
            *to = simd.reduce_sum_f64s(mean.v);
        }
    }

    /// Bound of the mean of (|δ| / radius)^n over the load, n <= [`MAX_DEGREE`] + 2 (it is log-convex in n).
    pub(crate) fn mean(&self, n: usize) -> f64 {
        (self.even_means[n / 2] * self.even_means[n.div_ceil(2)]).sqrt()
    }

    /// Targets from `first` on, relative to the centre, in radii.
    #[inline(always)]
    pub(crate) fn place<S: Simd>(
        &self,
        simd: S,
        targets: &Targets,
        first: usize,
    ) -> [[Lanes<S>; TOGETHER]; 3] {
        let scale = Lanes::splat(simd, 1.0 / self.radius);
        let mut place = [[scale; TOGETHER]; 3];
        let lists = [&targets.x, &targets.y, &targets.z];
        for (axis, place) in place.iter_mut().enumerate() {
            for (k, place) in place.iter_mut().enumerate() {
                let list = Lanes::load(simd, lists[axis], first + k * S::F64_LANES);
                *place = (list - scale.all(self.center[axis])) * scale;
            }
        }
        place
    }

    /// The series up to `degree` at points relative to the centre, in radii.
    ///
    /// * `slopes`: G^(k) / k! for k = 0 ..= `degree`, as derivatives by the squared distance in squared radii
    #[inline(always)]
    pub(crate) fn evaluate<S: Simd>(
        &self,
        degree: usize,
        place: &[[Lanes<S>; TOGETHER]; 3],
        slopes: &[[Lanes<S>; TOGETHER]],
    ) -> [Lanes<S>; TOGETHER] {
        let any = place[0][0];
        let mut value = [any.all(0.0); TOGETHER];
        let mut list = [[any.all(1.0); TOGETHER]; MOST_MONOMIALS];
        let mut done = 0;
        for &(n, j, start) in &layout()[..layout().len() - 1] {
            if n + 2 * j > degree {
                continue;
            }
            while done < n {
                raise(&mut list, done, |mut entry, axis| {
                    for (entry, &place) in entry.iter_mut().zip(&place[axis]) {
                        *entry = *entry * place;
                    }
                    entry
                });
                done += 1;
            }
            let mut sum = [any.all(0.0); TOGETHER];
            for (&moment, entry) in self.moments[start..start + monomials(n)].iter().zip(&list) {
                let moment = any.all(moment);
                for k in 0..TOGETHER {
                    sum[k] = moment.mul_add(entry[k], sum[k]);
                }
            }
            for k in 0..TOGETHER {
                value[k] = slopes[n + j][k].mul_add(sum[k], value[k]);
            }
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::simd::points::BLOCK;

    #[test]
    fn the_series_of_a_gaussian_converges_to_the_sum_over_the_loads() {
        let mut loads = PointLoads::default();
        for k in 0..BLOCK {
            let angle = 2.4 * k as f64;
            let place = Vector3::new(0.3 * angle.cos(), 0.2 * angle.sin(), 0.02 * k as f64 - 0.1);
            loads.push(&place, (1.0 + (k % 3) as f64) / 31.0);
        }
        let point = Vector3::new(0.7, -0.4, 0.3);
        let gaussian = |squared: f64| (-0.5 * squared).exp();
        let exact: f64 = (0..BLOCK)
            .map(|k| {
                let y = Vector3::new(loads.x[k], loads.y[k], loads.z[k]);
                loads.share[k] * gaussian((point - y).norm_squared())
            })
            .sum();
        let mut series = RadialSeries::new();
        let radius = 0.5;
        series.fill(pulp::Scalar, &loads, (Vector3::zeros(), radius), MAX_DEGREE);
        let lanes = |value: f64| [Lanes::splat(pulp::Scalar, value); TOGETHER];
        let place = [point.x, point.y, point.z].map(|c| lanes(c / radius));
        let mut slopes = [lanes(0.0); MAX_DEGREE + 1];
        let mut slope = gaussian(point.norm_squared());
        for (k, slot) in slopes.iter_mut().enumerate() {
            *slot = lanes(slope);
            slope *= -0.5 * radius * radius / (k as f64 + 1.0);
        }
        for degree in DEGREES {
            let found = series.evaluate(degree, &place, &slopes)[0].v;
            // Cramér's bound of the first term left out, and the next ones
            let first: f64 = (1..=degree + 1).map(|m| radius / (m as f64).sqrt()).product();
            let bound = 1.5 * 1.09 * first * series.mean(degree + 1);
            assert!((found - exact).abs() < bound, "degree {degree}: {:e}, {bound:e}", found - exact);
        }
    }

    #[test]
    fn means_bound_those_between_even_powers() {
        let mut loads = PointLoads::default();
        for k in 0..BLOCK {
            loads.push(&Vector3::new(k as f64 / BLOCK as f64, 0.0, 0.0), 1.0 / BLOCK as f64);
        }
        let mut series = RadialSeries::new();
        series.fill(pulp::Scalar, &loads, (Vector3::zeros(), 1.0), MAX_DEGREE);
        for n in 0..=MAX_DEGREE + 2 {
            let mean: f64 = loads.x.iter().map(|x| x.powi(n as i32) / BLOCK as f64).sum();
            assert!(series.mean(n) >= mean * (1.0 - 1e-14) && series.mean(n) < 1.25 * mean, "{n}");
        }
    }
}
