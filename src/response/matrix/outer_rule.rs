//! The rules by which a potential is averaged over a triangle: Gauss rules whose order falls with the distance of its load.

use crate::response::integral::gauss::{MAX_GRADED_POINTS, RulePoint, graded_triangle_rule, triangle_rule};
use crate::response::simd::points::POINTS_PER_BLOCK;

/// Fewest and most points in each direction of the rules on triangles that do not touch the load.
const APART_POINTS: std::ops::RangeInclusive<usize> = 2..=10;

/// A rule over a triangle, laid out for vector code.
#[derive(Debug)]
pub(crate) struct OuterRule {
    /// Share of each corner in the place of a point.
    pub(crate) shares: [Vec<f64>; 3],
    /// Share of the area; 0 of the points beyond `count` that fill the last vector.
    pub(crate) weights: Vec<f64>,
    pub(crate) count: usize,
}

impl OuterRule {
    fn new(points: &[RulePoint]) -> Self {
        let padded = points.len().next_multiple_of(POINTS_PER_BLOCK);
        let list = |of: &dyn Fn(&RulePoint) -> f64, rest: f64| {
            let mut list: Vec<f64> = points.iter().map(of).collect();
            list.resize(padded, rest);
            list
        };
        Self {
            shares: std::array::from_fn(|k| list(&|(shares, _)| shares[k], 1.0 / 3.0)),
            weights: list(&|(_, weight)| *weight, 0.0),
            count: points.len(),
        }
    }
}

/// The rules that keep a tolerance.
#[derive(Debug)]
pub(crate) struct OuterRules {
    /// On triangles that touch the load, where the inner potential behaves like d log d at the distance d from edges.
    pub(crate) touching: OuterRule,
    /// On all others, each with the distance over the triangle's radius from which on it keeps the tolerance; the last one
    /// from 0.
    apart: Vec<(f64, OuterRule)>,
}

impl OuterRules {
    pub(crate) fn new(tolerance: f64) -> Self {
        // The error of the graded rule falls with n⁻⁸.
        let graded = (7.0 * (1e-3 / tolerance).powf(0.125)).ceil();
        let graded = graded.clamp(5.0, MAX_GRADED_POINTS as f64) as usize;
        // The best polynomial of degree 2n - 1 errs by some `(radius / 2 distance)^2n`.
        let farther = |n: usize| match n {
            n if n == *APART_POINTS.end() => 0.0,
            n => 0.5 * (0.25 * tolerance.max(1e-12)).powf(-0.5 / n as f64),
        };
        Self {
            touching: OuterRule::new(graded_triangle_rule(graded)),
            apart: APART_POINTS.map(|n| (farther(n), OuterRule::new(triangle_rule(n)))).collect(),
        }
    }

    /// The rule for a triangle of such a radius (m) whose center is at such a distance (m) from the load.
    pub(crate) fn apart(&self, radius: f64, distance: f64) -> &OuterRule {
        let ratio = (distance / radius).max(1.0);
        let keeps = |(farther, _): &&(f64, OuterRule)| ratio >= *farther;
        &self.apart.iter().find(keeps).expect("the last rule holds everywhere").1
    }
}
