//! Gauss quadrature over an interval and over a triangle.

use std::sync::OnceLock;

use crate::response::integral::symmetric_rule::DEGREE_5;

/// The largest number of points in each direction that [`triangle_rule`] offers.
pub(crate) const MAX_TRIANGLE_POINTS: usize = 24;

/// A point of a triangle rule: weights of the three corners, which sum to 1, and the share of the area.
pub(crate) type RulePoint = ([f64; 3], f64);

/// Gauss rule over a triangle, exact for polynomials of degree 2n - 1: n × n points, collapsed at corner 0 (Stroud 1971,
/// conical product), or the seven of [`DEGREE_5`] for n = 3. The weights are positive and sum to 1.
pub(crate) fn triangle_rule(n: usize) -> &'static [RulePoint] {
    static RULES: [OnceLock<Vec<RulePoint>>; MAX_TRIANGLE_POINTS + 1] =
        [const { OnceLock::new() }; MAX_TRIANGLE_POINTS + 1];
    let n = n.clamp(1, MAX_TRIANGLE_POINTS);
    if n == 3 {
        return &DEGREE_5;
    }
    RULES[n].get_or_init(|| product(&gauss(n, 1.0), &gauss(n, 0.0), |u, v| [1.0 - u, u * (1.0 - v), u * v]))
}

/// All pairs of the points of two intervals, each at a place of the triangle.
fn product(across: &[(f64, f64)], along: &[(f64, f64)], place: fn(f64, f64) -> [f64; 3]) -> Vec<RulePoint> {
    let pairs = across.iter().flat_map(|&one| along.iter().map(move |&other| (one, other)));
    pairs.map(|((u, wu), (v, wv))| (place(u, v), wu * wv)).collect()
}

/// A rule with n × n points drawn to the edges of the triangle, for integrands with weak singularities there.
///
/// Both directions of the collapsed triangle run through [`graded_interval`]. The weights are positive and sum to 1.
pub(crate) fn graded_triangle_rule(n: usize) -> Vec<RulePoint> {
    let bent = graded_interval(n);
    let weighted: Vec<(f64, f64)> = bent.iter().map(|&(u, w)| (u, 2.0 * u * w)).collect();
    product(&weighted, &bent, |u, v| [1.0 - u, u * (1.0 - v), u * v])
}

/// A rule on [0, 1] with n points drawn to both ends, for integrands with weak singularities there.
///
/// It runs through t²(3 - 2t), which turns a term d log d at the distance d from an end into t³ log t: the error then
/// falls with n⁻⁸.
pub(crate) fn graded_interval(n: usize) -> Vec<(f64, f64)> {
    let bent = |&(t, w): &(f64, f64)| (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t) * w);
    gauss_interval(n).iter().map(bent).collect()
}

/// The largest number of points that [`gauss_interval`] offers.
const MAX_INTERVAL_POINTS: usize = 40;

/// Gauss rule on [0, 1], made once.
pub(crate) fn gauss_interval(n: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; MAX_INTERVAL_POINTS + 1] =
        [const { OnceLock::new() }; MAX_INTERVAL_POINTS + 1];
    let n = n.clamp(1, MAX_INTERVAL_POINTS);
    RULES[n].get_or_init(|| gauss(n, 0.0))
}

/// Nodes and weights on [0, 1] for the weight function `(1 + power) t^power`, power >= 0; the weights sum
/// to 1. Roots of the orthogonal polynomials by bisection of their sign changes and Newton steps.
pub(crate) fn gauss(n: usize, power: f64) -> Vec<(f64, f64)> {
    // Monic three-term recurrence on [-1, 1]: p_(k+1) = (x - a_k) p_k - b_k p_(k-1), Jacobi (0, power).
    let twice = |k: f64| 2.0 * k + power;
    let a = |k: f64| if power == 0.0 { 0.0 } else { power * power / (twice(k) * (twice(k) + 2.0)) };
    let b = |k: f64| (2.0 * k * (k + power) / twice(k)).powi(2) / (twice(k) * twice(k) - 1.0);
    // p_n, its derivative and p_(n-1)
    let polynomial = |x: f64| {
        let (mut before, mut p) = (0.0, 1.0);
        let (mut slope_before, mut slope) = (0.0, 0.0);
        for k in 0..n {
            let (ak, bk) = (a(k as f64), if k == 0 { 0.0 } else { b(k as f64) });
            (before, p, slope_before, slope) =
                (p, (x - ak) * p - bk * before, slope, p + (x - ak) * slope - bk * slope_before);
        }
        (p, slope, before)
    };
    let norm: f64 = (1..n).map(|k| b(k as f64)).product();
    let cells = 40 * n;
    let at = |i: usize| -(std::f64::consts::PI * i as f64 / cells as f64).cos();
    let mut points = Vec::with_capacity(n);
    for i in 0..cells {
        let (mut low, mut high) = (at(i), at(i + 1));
        let rising = polynomial(low).0 < 0.0;
        if rising == (polynomial(high).0 < 0.0) {
            continue;
        }
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if (polynomial(middle).0 < 0.0) == rising { low = middle } else { high = middle }
        }
        let mut x = 0.5 * (low + high);
        for _ in 0..3 {
            let (p, slope, _) = polynomial(x);
            x -= p / slope;
        }
        let (_, slope, before) = polynomial(x);
        points.push((0.5 * (1.0 + x), norm / (slope * before)));
    }
    debug_assert_eq!(points.len(), n);
    points
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn interval_rules_integrate_their_degree() {
        for n in 1..=MAX_TRIANGLE_POINTS {
            for power in [0.0, 1.0, 2.0] {
                let rule = gauss(n, power);
                for degree in 0..2 * n {
                    let sum: f64 = rule.iter().map(|(t, w)| w * t.powi(degree as i32)).sum();
                    let exact = (1.0 + power) / (degree as f64 + 1.0 + power);
                    assert_relative_eq!(sum, exact, max_relative = 1e-13);
                }
            }
        }
    }

    #[test]
    fn graded_rule_integrates_polynomials_and_logarithms_at_edges() {
        let rule = graded_triangle_rule(12);
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| rule.iter().map(|(l, w)| w * f(l)).sum::<f64>();
        assert_relative_eq!(sum(&|_| 1.0), 1.0, max_relative = 1e-13);
        assert_relative_eq!(sum(&|l| l[1] * l[2]), 1.0 / 12.0, max_relative = 1e-13);
        // the mean of l log l: 2 ∫ (1 - l) l ln l dl = -5/18
        for k in 0..3 {
            assert_relative_eq!(sum(&|l| l[k] * l[k].ln()), -5.0 / 18.0, max_relative = 1e-6);
        }
    }

    #[test]
    fn triangle_rules_integrate_their_degree() {
        // int l0^p l1^q l2^r dA / A = 2 p! q! r! / (p + q + r + 2)!
        let factorial = |k: usize| (1..=k).map(|v| v as f64).product::<f64>();
        for n in 1..=8 {
            for p in 0..2 * n {
                for q in 0..2 * n - p {
                    let r = 2 * n - 1 - p - q;
                    let sum: f64 = triangle_rule(n)
                        .iter()
                        .map(|(l, w)| w * l[0].powi(p as i32) * l[1].powi(q as i32) * l[2].powi(r as i32))
                        .sum();
                    let exact = 2.0 * factorial(p) * factorial(q) * factorial(r) / factorial(p + q + r + 2);
                    assert_relative_eq!(sum, exact, max_relative = 1e-12);
                }
            }
        }
    }
}
