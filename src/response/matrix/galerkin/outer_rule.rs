//! The rules by which a potential is averaged over a triangle: Gauss rules whose order falls with the distance of its load.

use crate::response::integral::gauss::{MAX_GRADED_POINTS, graded_triangle_rule, triangle_rule};
use crate::response::integral::rule_lists::RuleLists;

/// Fewest and most points in each direction of the rules on triangles that do not touch the load.
const APART_POINTS: std::ops::RangeInclusive<usize> = 2..=10;

/// The rules that keep a tolerance.
#[derive(Debug)]
pub(crate) struct OuterRules {
    /// On triangles that touch the load, where the inner potential behaves like d log d at the distance d from edges.
    pub(crate) touching: RuleLists,
    /// On all others, each with the distance over the triangle's radius from which on it keeps the tolerance; the last one
    /// from 0.
    apart: Vec<(f64, RuleLists)>,
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
            touching: RuleLists::new(graded_triangle_rule(graded)),
            apart: APART_POINTS.map(|n| (farther(n), RuleLists::new(triangle_rule(n)))).collect(),
        }
    }

    /// The rule for a triangle of such a radius (m) whose center is at such a distance (m) from the load.
    pub(crate) fn apart(&self, radius: f64, distance: f64) -> &RuleLists {
        let ratio = (distance / radius).max(1.0);
        let keeps = |(farther, _): &&(f64, RuleLists)| ratio >= *farther;
        &self.apart.iter().find(keeps).expect("the last rule holds everywhere").1
    }
}
