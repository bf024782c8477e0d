//! Rules over a triangle that do not hang on the order of its corners.

use crate::response::integral::gauss::RulePoint;

/// Seven points of degree 5 (Radon 1948).
pub(crate) const DEGREE_5: [RulePoint; 7] = symmetric_rule(
    0.225,
    &[
        (0.470_142_064_105_115_1, 0.132_394_152_788_506_2),
        (0.101_286_507_323_456_34, 0.125_939_180_544_827_15),
    ],
    &[],
);

/// The points of a symmetric rule and their weights, which add up to 1.
///
/// * `central`: weight of the centroid, 0 for none
/// * `medians`: `(a, weight)` for each three points (1 - 2a, a, a)
/// * `general`: `(a, b, weight)` for each six points (a, b, 1 - a - b)
pub(crate) const fn symmetric_rule<const N: usize>(
    central: f64,
    medians: &[(f64, f64)],
    general: &[(f64, f64, f64)],
) -> [RulePoint; N] {
    let mut points = [([1.0 / 3.0; 3], central); N];
    let (mut at, mut orbit) = (if central > 0.0 { 1 } else { 0 }, 0);
    while orbit < medians.len() {
        let (a, weight) = medians[orbit];
        let b = 1.0 - 2.0 * a;
        points[at] = ([b, a, a], weight);
        points[at + 1] = ([a, b, a], weight);
        points[at + 2] = ([a, a, b], weight);
        (at, orbit) = (at + 3, orbit + 1);
    }
    orbit = 0;
    while orbit < general.len() {
        let (a, b, weight) = general[orbit];
        let c = 1.0 - a - b;
        let orders = [[a, b, c], [a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]];
        let mut order = 0;
        while order < 6 {
            points[at] = (orders[order], weight);
            (at, order) = (at + 1, order + 1);
        }
        orbit += 1;
    }
    points
}
