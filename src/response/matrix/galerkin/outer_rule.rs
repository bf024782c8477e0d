//! The rules by which a potential is averaged over a triangle: Gauss rules whose order falls with the distance of its load.

use crate::response::integral::gauss::{RulePoint, graded_interval, graded_triangle_rule, triangle_rule};
use crate::response::integral::rule_lists::RuleLists;
use crate::response::simd::points::POINTS_PER_BLOCK;

/// Fewest and most points in each direction of the rules on triangles apart from the load.
const APART_POINTS: std::ops::RangeInclusive<usize> = 2..=10;
/// Fewest and most points in each direction of the rules on triangles at the load.
const GRADED_POINTS: [usize; 2] = [5, 12];
/// Longest edge of a triangle over the height on it up to which a rule on an edge keeps the tolerance that its points are
/// for, as measured: 16 err by 1e-6 there, and by 1e-8 at half of it.
pub(crate) const SLENDER: f64 = 6.0;
/// Points of the rules on edges beside more slender ones: 1e-6 at 25, 1e-5 at 80.
const SLENDER_POINTS: usize = 40;

/// The rules that keep a tolerance.
#[derive(Debug)]
pub(crate) struct OuterRules {
    /// On triangles at the load, where the inner potential behaves like d log d at the distance d from edges.
    pub(crate) touching: RuleLists,
    /// The finest of these, for pairs that do not touch and are closer than their size.
    pub(crate) close: RuleLists,
    /// On an edge of a triangle that touches the load, by the corner opposite to it; the second ones beside slender triangles.
    edges: [[RuleLists; 3]; 2],
    /// On all others, each with the distances over the triangle's radius from which on it keeps the tolerance for 1/r and for
    /// a smooth kernel; the last one from 0.
    apart: Vec<([f64; 2], RuleLists)>,
}

impl OuterRules {
    pub(crate) fn new(tolerance: f64) -> Self {
        // The errors of graded rules fall with n⁻⁸.
        let graded = |n: f64, error: f64| (n * (error / tolerance.max(1e-12)).powf(0.125)).ceil() as usize;
        let [fewest, most] = GRADED_POINTS;
        let along = graded(12.0, 1e-6).next_multiple_of(POINTS_PER_BLOCK).min(SLENDER_POINTS);
        // The best polynomial of degree 2n - 1 errs by some `(radius / 2 distance)^2n`, and one that a hat multiplies by one
        // power less, which shows where all of a kernel is smooth.
        let allowed = 0.5 * tolerance.max(1e-12);
        let farther = |n: usize| match n {
            n if n == *APART_POINTS.end() => [0.0; 2],
            n => [2 * n, 2 * n - 1].map(|power| 0.5 * allowed.powf(-1.0 / power as f64)),
        };
        Self {
            touching: RuleLists::new(&graded_triangle_rule(graded(7.0, 1e-3).clamp(fewest, most))),
            close: RuleLists::new(&graded_triangle_rule(most)),
            edges: [along, SLENDER_POINTS].map(|n| [0, 1, 2].map(|corner| edge_rule(corner, n))),
            apart: APART_POINTS.map(|n| (farther(n), RuleLists::new(triangle_rule(n)))).collect(),
        }
    }

    /// The rule on the edge opposite to a corner of a triangle that touches the load.
    pub(crate) fn edge(&self, corner: usize, is_slender: bool) -> &RuleLists {
        &self.edges[usize::from(is_slender)][corner]
    }

    /// The rule for a triangle of such a radius (m) whose center is at such a distance (m) from the load.
    pub(crate) fn apart(&self, radius: f64, distance: f64) -> &RuleLists {
        self.from((distance / radius).max(1.0), 0)
    }

    /// The rule for a kernel that is smooth up to such a distance (m) out of the skin.
    pub(crate) fn smooth(&self, radius: f64, distance: f64) -> &RuleLists {
        self.from((distance / radius).max(1.0), 1)
    }

    fn from(&self, ratio: f64, kind: usize) -> &RuleLists {
        let keeps = |(farther, _): &&([f64; 2], RuleLists)| ratio >= farther[kind];
        &self.apart.iter().find(keeps).expect("the last rule holds everywhere").1
    }
}

/// n points on the edge opposite to a corner.
fn edge_rule(corner: usize, n: usize) -> RuleLists {
    let at = |(t, weight): (f64, f64)| {
        let mut shares = [1.0 - t, t, 0.0];
        shares.rotate_right((corner + 1) % 3);
        (shares, weight)
    };
    let points: Vec<RulePoint> = graded_interval(n).into_iter().map(at).collect();
    RuleLists::new(&points)
}
