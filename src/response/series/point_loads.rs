//! Point forces that stand for a load, the ball around them and their radial means: what both series start from.

use nalgebra::Vector3;
use pulp::Simd;

use crate::response::integral::rule_lists::RuleLists;
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::Points;

/// Vectors that one evaluation of a series takes at a time, to hide the latency of its sums.
pub(crate) const VECTORS_AT_ONCE: usize = 2;
/// Even powers of which means are kept.
const MOST_EVEN_POWERS: usize = 18;

/// A ball around a load.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LoadBall {
    /// Center of the load, about which it has no dipole (m).
    pub(crate) center: Vector3<f64>,
    /// Distance of the farthest point of the load from it (m).
    pub(crate) radius: f64,
}

/// Point forces: places (m) and shares of the unit force, as many as fill whole vectors.
#[derive(Debug, Default)]
pub(crate) struct PointLoads {
    pub(crate) points: Points,
    pub(crate) share: Vec<f64>,
}

impl PointLoads {
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.share.clear();
    }

    pub(crate) fn push(&mut self, place: &Vector3<f64>, share: f64) {
        self.points.push(place);
        self.share.push(share);
    }

    /// Adds a load on a triangle by a rule.
    ///
    /// * `forces`: at each corner, those (N) that an even load of its density would have
    #[inline(always)]
    pub(crate) fn spread(&mut self, corners: &[Vector3<f64>; 3], forces: &[f64; 3], rule: &RuleLists) {
        let (first, count) = (self.share.len(), rule.count);
        let [l0, l1, l2] = rule.shares.each_ref().map(|list| &list[..count]);
        self.points.push_on_triangle(corners, [l0, l1, l2]);
        self.share.resize(first + count, 0.0);
        let weights = &rule.weights[..count];
        for (k, share) in self.share[first..].iter_mut().enumerate() {
            *share = weights[k] * (forces[0] * l0[k] + forces[1] * l1[k] + forces[2] * l2[k]);
        }
    }

    /// Fills up to a multiple of `lanes` with loads of no share.
    pub(crate) fn pad(&mut self, lanes: usize) {
        self.points.pad(lanes);
        self.share.resize(self.points.len(), 0.0);
    }

    /// The ball about the center of the loads that holds all `corners` (m).
    #[inline(always)]
    pub(crate) fn ball<'a>(&self, corners: impl Iterator<Item = &'a Vector3<f64>>) -> LoadBall {
        let (mut sum, mut total) = (Vector3::zeros(), 0.0);
        for k in 0..self.share.len() {
            sum += self.points.at(k) * self.share[k];
            total += self.share[k];
        }
        let center = sum / total;
        let radius_squared = corners.map(|corner| (corner - center).norm_squared()).fold(0.0, f64::max);
        LoadBall { center, radius: radius_squared.sqrt() }
    }

    /// Places relative to the ball, in its radii, and shares of the loads from `first` on.
    #[inline(always)]
    pub(crate) fn vector<S: Simd>(
        &self,
        simd: S,
        ball: &LoadBall,
        first: usize,
    ) -> ([Lanes<S>; 3], Lanes<S>) {
        let share = Lanes::load(simd, &self.share, first);
        let inverse = share.all(1.0 / ball.radius);
        let [x, y, z] = self.points.load(simd, first);
        let place = [
            (x - share.all(ball.center.x)) * inverse,
            (y - share.all(ball.center.y)) * inverse,
            (z - share.all(ball.center.z)) * inverse,
        ];
        (place, share)
    }

    /// Means of `(|y| / radius)^2k`, y from the center of the ball, for k = 0 ..= `highest`.
    #[inline(always)]
    pub(crate) fn radial_means<S: Simd>(&self, simd: S, ball: &LoadBall, highest: usize) -> RadialMeans {
        let mut sums = [Lanes::splat(simd, 0.0); MOST_EVEN_POWERS];
        for first in (0..self.points.len()).step_by(S::F64_LANES) {
            let (place, mut power) = self.vector(simd, ball, first);
            let squared = dot(&place, &place);
            for sum in &mut sums[..=highest] {
                *sum = *sum + power;
                power = power * squared;
            }
        }
        let mut means = RadialMeans::default();
        for (mean, sum) in means.0.iter_mut().zip(sums) {
            *mean = sum.total();
        }
        means
    }
}

/// Sums of `share (|y| / radius)^2k` over positive loads, k = 0 ..
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RadialMeans([f64; MOST_EVEN_POWERS]);

impl RadialMeans {
    /// Mean of (|y| / radius)^n; a bound of it for odd n, as it is log-convex in n.
    pub(crate) fn at(&self, n: usize) -> f64 {
        (self.0[n / 2] * self.0[n.div_ceil(2)]).sqrt() / self.0[0]
    }
}
