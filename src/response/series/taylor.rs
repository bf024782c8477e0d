//! The field of a load under a radial kernel, as a Taylor series about the load's center.
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

use pulp::Simd;

use crate::response::series::point_loads::{LoadBall, PointLoads, RadialMeans, VECTORS_AT_ONCE};
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::Targets;

/// Highest degree of a series.
pub(crate) const MAX_DEGREE: usize = 9;
/// Degrees that a series can end at; between them little is gained.
pub(crate) const DEGREES: [usize; 4] = [3, 5, 7, MAX_DEGREE];
/// Monomials of a degree in three variables.
pub(crate) const fn monomials(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Where the moments of each pair (n, j) with n + 2j <= [`MAX_DEGREE`] start, n outermost.
const STARTS: [[usize; MAX_DEGREE / 2 + 1]; MAX_DEGREE + 1] = {
    let mut starts = [[0; MAX_DEGREE / 2 + 1]; MAX_DEGREE + 1];
    let (mut n, mut next) = (0, 0);
    while n <= MAX_DEGREE {
        let mut j = 0;
        while n + 2 * j <= MAX_DEGREE {
            starts[n][j] = next;
            next += monomials(n);
            j += 1;
        }
        n += 1;
    }
    starts
};

/// The pairs (n, j) with n + 2j <= `degree`, n outermost.
fn pairs(degree: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..=degree).flat_map(move |n| (0..=(degree - n) / 2).map(move |j| (n, j)))
}

/// What multiplies each moment: (n+j choose j) (-2)^n n! / α!.
fn factors() -> &'static [f64] {
    static FACTORS: OnceLock<Vec<f64>> = OnceLock::new();
    FACTORS.get_or_init(|| {
        let factorial = |k: usize| (1..=k).map(|v| v as f64).product::<f64>();
        let mut list = Vec::new();
        for (n, j) in pairs(MAX_DEGREE) {
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
///
/// No closures here: they would not be compiled for the machine's vectors.
#[inline(always)]
fn raise<S: Simd, const K: usize>(list: &mut [[Lanes<S>; K]], n: usize, place: &[[Lanes<S>; K]; 3]) {
    let (count, rest) = (monomials(n), n + 1);
    for i in 0..rest {
        for k in 0..K {
            list[count + i][k] = list[count - rest + i][k] * place[1][k];
        }
    }
    for k in 0..K {
        list[count + rest][k] = list[count - 1][k] * place[2][k];
    }
    for entry in list.iter_mut().take(count) {
        for k in 0..K {
            entry[k] = entry[k] * place[0][k];
        }
    }
}

/// Moments of one node's load.
#[derive(Debug)]
pub(crate) struct TaylorSeries {
    /// Around the load.
    pub(crate) ball: LoadBall,
    moments: Vec<f64>,
    /// One vector for each sum over the load.
    sums: Vec<f64>,
}

impl Default for TaylorSeries {
    fn default() -> Self {
        let count = factors().len();
        Self { ball: LoadBall::default(), moments: vec![0.0; count], sums: vec![0.0; 8 * count] }
    }
}

impl TaylorSeries {
    /// The means of a load that say how far its series reaches.
    #[inline(always)]
    pub(crate) fn means<S: Simd>(simd: S, loads: &PointLoads, ball: &LoadBall) -> RadialMeans {
        loads.radial_means(simd, ball, MAX_DEGREE / 2 + 2)
    }

    /// Moments up to degree D of positive loads of sum 1, which the caller has padded to whole vectors.
    ///
    /// D and M = [`monomials`]`(D)` are constants, as the loops are short and run once for every pair of nodes.
    #[inline(always)]
    pub(crate) fn fill<S: Simd, const D: usize, const M: usize>(
        &mut self,
        simd: S,
        loads: &PointLoads,
        ball: LoadBall,
    ) {
        const { assert!(D <= MAX_DEGREE && M == monomials(D)) };
        self.ball = ball;
        let sums = S::as_mut_simd_f64s(&mut self.sums[..self.moments.len() * S::F64_LANES]).0;
        for (n, j) in pairs(D) {
            sums[STARTS[n][j]..][..monomials(n)].fill(simd.splat_f64s(0.0));
        }
        for first in (0..loads.points.len()).step_by(S::F64_LANES) {
            let (place, share) = loads.vector(simd, &ball, first);
            let place_alone = [[place[0]], [place[1]], [place[2]]];
            let squared = dot(&place, &place);
            let mut powers = [share; MAX_DEGREE / 2 + 1];
            for k in 1..powers.len() {
                powers[k] = powers[k - 1] * squared;
            }
            let mut list = [[share.all(1.0)]; M];
            for n in 0..D + 1 {
                if n > 0 {
                    raise(&mut list, n - 1, &place_alone);
                }
                for j in 0..(D - n) / 2 + 1 {
                    let sums = &mut sums[STARTS[n][j]..][..monomials(n)];
                    for (sum, [entry]) in sums.iter_mut().zip(&list) {
                        *sum = entry.mul_add(powers[j], Lanes::new(simd, *sum)).v;
                    }
                }
            }
        }
        let factors = factors();
        for (n, j) in pairs(D) {
            for at in STARTS[n][j]..STARTS[n][j] + monomials(n) {
                self.moments[at] = factors[at] * Lanes::new(simd, sums[at]).total();
            }
        }
    }

    /// Targets from `first` on, relative to the center, in radii.
    #[inline(always)]
    pub(crate) fn place<S: Simd>(
        &self,
        simd: S,
        targets: &Targets,
        first: usize,
    ) -> [[Lanes<S>; VECTORS_AT_ONCE]; 3] {
        let scale = Lanes::splat(simd, 1.0 / self.ball.radius);
        let mut place = [[scale; VECTORS_AT_ONCE]; 3];
        for (axis, place) in place.iter_mut().enumerate() {
            for (k, place) in place.iter_mut().enumerate() {
                let at = targets.points.load(simd, first + k * S::F64_LANES);
                *place = (at[axis] - scale.all(self.ball.center[axis])) * scale;
            }
        }
        place
    }

    /// The series up to degree N - 1 at points relative to the center, in radii; M = [`monomials`]`(N - 1)`.
    ///
    /// * `slopes`: G^(k) / k! for k = 0 .. N, as derivatives by the squared distance in squared radii
    #[inline(always)]
    pub(crate) fn evaluate<S: Simd, const N: usize, const M: usize>(
        &self,
        place: &[[Lanes<S>; VECTORS_AT_ONCE]; 3],
        slopes: &[[Lanes<S>; N]; VECTORS_AT_ONCE],
    ) -> [Lanes<S>; VECTORS_AT_ONCE] {
        const { assert!(N <= MAX_DEGREE + 1 && M == monomials(N - 1)) };
        let any = place[0][0];
        let mut value = [any.all(0.0); VECTORS_AT_ONCE];
        let mut list = [[any.all(1.0); VECTORS_AT_ONCE]; M];
        for n in 0..N {
            if n > 0 {
                raise(&mut list, n - 1, place);
            }
            for j in 0..(N - 1 - n) / 2 + 1 {
                let mut sum = [any.all(0.0); VECTORS_AT_ONCE];
                let moments = &self.moments[STARTS[n][j]..][..monomials(n)];
                for (&moment, entry) in moments.iter().zip(&list) {
                    let moment = any.all(moment);
                    for k in 0..VECTORS_AT_ONCE {
                        sum[k] = moment.mul_add(entry[k], sum[k]);
                    }
                }
                for k in 0..VECTORS_AT_ONCE {
                    value[k] = slopes[k][n + j].mul_add(sum[k], value[k]);
                }
            }
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::response::simd::points::POINTS_PER_BLOCK;

    #[test]
    fn the_series_of_a_gaussian_converges_to_the_sum_over_the_loads() {
        let mut loads = PointLoads::default();
        for k in 0..POINTS_PER_BLOCK {
            let angle = 2.4 * k as f64;
            let place = Vector3::new(0.3 * angle.cos(), 0.2 * angle.sin(), 0.02 * k as f64 - 0.1);
            loads.push(&place, (1.0 + (k % 3) as f64) / 31.0);
        }
        let point = Vector3::new(0.7, -0.4, 0.3);
        let gaussian = |squared: f64| (-0.5 * squared).exp();
        let exact: f64 = (0..POINTS_PER_BLOCK)
            .map(|k| loads.share[k] * gaussian((point - loads.points.at(k)).norm_squared()))
            .sum();
        let mut series = TaylorSeries::default();
        let radius = 0.5;
        let ball = LoadBall { center: Vector3::zeros(), radius };
        series.fill::<_, MAX_DEGREE, { monomials(MAX_DEGREE) }>(pulp::Scalar, &loads, ball);
        let means = TaylorSeries::means(pulp::Scalar, &loads, &ball);
        let lanes = |value: f64| [Lanes::splat(pulp::Scalar, value); VECTORS_AT_ONCE];
        let place = [point.x, point.y, point.z].map(|c| lanes(c / radius));
        let mut slope = gaussian(point.norm_squared());
        let mut slopes = [0.0; MAX_DEGREE + 1];
        for (k, slot) in slopes.iter_mut().enumerate() {
            *slot = slope;
            slope *= -0.5 * radius * radius / (k as f64 + 1.0);
        }
        let found = [
            at_degree::<4, 10>(&series, &place, &slopes),
            at_degree::<6, 21>(&series, &place, &slopes),
            at_degree::<8, 36>(&series, &place, &slopes),
            at_degree::<10, 55>(&series, &place, &slopes),
        ];
        for (degree, found) in DEGREES.into_iter().zip(found) {
            // Cramér's bound of the first term left out, and the next ones
            let first: f64 = (1..=degree + 1).map(|m| radius / (m as f64).sqrt()).product();
            let bound = 1.5 * 1.09 * first * means.at(degree + 1);
            assert!((found - exact).abs() < bound, "degree {degree}: {:e}, {bound:e}", found - exact);
        }
    }

    fn at_degree<const N: usize, const M: usize>(
        series: &TaylorSeries,
        place: &[[Lanes<pulp::Scalar>; VECTORS_AT_ONCE]; 3],
        slopes: &[f64],
    ) -> f64 {
        let slopes = std::array::from_fn(|k| Lanes::splat(pulp::Scalar, slopes[k]));
        series.evaluate::<_, N, M>(place, &[slopes; VECTORS_AT_ONCE])[0].v
    }

    #[test]
    fn means_bound_those_between_even_powers() {
        let mut loads = PointLoads::default();
        for k in 0..POINTS_PER_BLOCK {
            loads.push(
                &Vector3::new(k as f64 / POINTS_PER_BLOCK as f64, 0.0, 0.0),
                1.0 / POINTS_PER_BLOCK as f64,
            );
        }
        let ball = LoadBall { center: Vector3::zeros(), radius: 1.0 };
        let means = TaylorSeries::means(pulp::Scalar, &loads, &ball);
        for n in 0..=MAX_DEGREE + 2 {
            let power = |k: usize| loads.points.at(k).x.powi(n as i32) / POINTS_PER_BLOCK as f64;
            let mean: f64 = (0..POINTS_PER_BLOCK).map(power).sum();
            assert!(means.at(n) >= mean * (1.0 - 1e-14) && means.at(n) < 1.25 * mean, "{n}");
        }
    }
}
