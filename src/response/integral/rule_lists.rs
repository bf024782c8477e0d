//! A triangle rule as lists.

use std::sync::OnceLock;

use crate::response::integral::gauss::{MAX_TRIANGLE_POINTS, RulePoint, triangle_rule};
use crate::response::simd::points::POINTS_PER_BLOCK;

/// A rule over a triangle, laid out for vector code.
#[derive(Debug)]
pub(crate) struct RuleLists {
    /// Share of each corner in the place of a point.
    pub(crate) shares: [Vec<f64>; 3],
    /// Share of the area; 0 of the points beyond `count` that fill the last vector.
    pub(crate) weights: Vec<f64>,
    pub(crate) count: usize,
}

impl RuleLists {
    pub(crate) fn new(points: &[RulePoint]) -> Self {
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

    /// [`triangle_rule`], made once.
    pub(crate) fn gauss(n: usize) -> &'static Self {
        static RULES: [OnceLock<RuleLists>; MAX_TRIANGLE_POINTS + 1] =
            [const { OnceLock::new() }; MAX_TRIANGLE_POINTS + 1];
        let n = n.clamp(1, MAX_TRIANGLE_POINTS);
        RULES[n].get_or_init(|| Self::new(triangle_rule(n)))
    }
}
