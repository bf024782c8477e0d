//! Kelvin's kernels over triangles well away from the point, many triangles at a time.
//!
//! Symmetric rules of degree 2, 5 and 8 (Dunavant 1985); [`RuleReach`] says from which distance each keeps a
//! stated tolerance. Closer than that, [`exact_moments`] takes over.

use std::ops::Range;

use nalgebra::Vector3;

use crate::linalg::vectorized::vectorized;
use crate::response::body::equations::moments::exact_moments;
use crate::response::body::equations::triangle::Triangle;
use crate::response::integral::gauss::RulePoint;
use crate::response::integral::symmetric_rule::{DEGREE_5, symmetric_rule};

/// The rules in rising order, as [`RuleReach`] counts them.
pub(crate) const RULES: [&[RulePoint]; 3] = [
    &symmetric_rule::<3>(0.0, &[(1.0 / 6.0, 1.0 / 3.0)], &[]),
    &DEGREE_5,
    &symmetric_rule::<16>(
        0.144315607677787,
        &[
            (0.459292588292723, 0.095091634267285),
            (0.170569307751760, 0.103217370534718),
            (0.050547228317031, 0.032458497623198),
        ],
        &[(0.263112829634638, 0.728492392955404, 0.027230314174435)],
    ),
];

/// From which distance, in radii of the triangle, each of [`RULES`] keeps the stated relative tolerance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RuleReach {
    squared: [f64; 3],
}

impl RuleReach {
    /// `tolerance`: relative error of a triangle's hat moments, between 1e-9 and 1e-2.
    ///
    /// A hat is linear, so a rule of degree `m` sees the kernel's Taylor terms up to `m - 1` and errs by
    /// `(constant · radius / distance)^m`; the constants cover every direction and triangle of the test.
    pub fn new(tolerance: f64) -> Self {
        const CONSTANTS: [(f64, f64); 3] = [(2.0, 0.3), (5.0, 0.65), (8.0, 0.75)];
        let tolerance = tolerance.clamp(1e-9, 1e-2);
        RuleReach {
            squared: CONSTANTS
                .map(|(degree, constant)| (constant * tolerance.powf(-1.0 / degree)).max(2.0).powi(2)),
        }
    }

    /// The cheapest rule for a triangle at `distance_squared` (in squared radii); `None`: the closed form.
    #[inline(always)]
    fn rule(&self, distance_squared: f64) -> Option<usize> {
        (0..3).find(|&rule| distance_squared >= self.squared[rule])
    }

    /// Hands the moments of triangles, as seen from a point, to `sums`: of near ones one by one, of others together with those
    /// that share their rule.
    ///
    /// `TRACTION` asks for `D` and `E` too.
    #[inline(always)]
    pub fn integrate<'a, const TRACTION: bool>(
        &self,
        point: &Vector3<f64>,
        triangles: Range<u32>,
        triangle: impl Fn(u32) -> &'a Triangle,
        scratch: &mut TriangleScratch,
        sums: &mut impl AddMoments,
    ) {
        let TriangleScratch { lanes, moments } = scratch;
        let mut add_together = |rule: usize, numbers: &[u32], sums: &mut _| {
            lanes.set_all(numbers, &triangle, point);
            far_moments::<TRACTION>(lanes, RULES[rule], moments);
            AddMoments::add(sums, numbers, &lanes.normal, moments);
        };
        let mut waiting = [[0; LANES]; RULES.len()];
        let mut counts = [0; RULES.len()];
        for number in triangles {
            let triangle = triangle(number);
            let radius_squared = triangle.radius * triangle.radius;
            let distance_squared = (triangle.centroid - point).norm_squared() / radius_squared;
            let Some(rule) = self.rule(distance_squared) else {
                let normal = [triangle.normal.x, triangle.normal.y, triangle.normal.z].map(|n| [n]);
                sums.add(&[number], &normal, &exact_moments(triangle, point));
                continue;
            };
            waiting[rule][counts[rule]] = number;
            counts[rule] += 1;
            if counts[rule] == LANES {
                counts[rule] = 0;
                add_together(rule, &waiting[rule], sums);
            }
        }
        for rule in (0..RULES.len()).filter(|&rule| counts[rule] > 0) {
            add_together(rule, &waiting[rule][..counts[rule]], sums);
        }
    }
}

/// Moments of the hats of some triangles: `[corner][component][lane]`, components `B` (6), `D` (6), `E` (3), symmetric ones as
/// xx, xy, xz, yy, yz, zz.
pub(crate) type HatMoments<const L: usize> = [[[f64; L]; 15]; 3];

/// What moments are added to.
pub(crate) trait AddMoments {
    /// Adds those of some triangles, by their numbers, a lane each.
    fn add<const L: usize>(&mut self, numbers: &[u32], normal: &[[f64; L]; 3], moments: &HatMoments<L>);
}

/// Working space for triangles seen from a point.
#[derive(Default)]
pub(crate) struct TriangleScratch {
    lanes: TriangleLanes,
    moments: HatMoments<LANES>,
}

/// Number of triangles that [`far_moments`] takes at once.
const LANES: usize = 8;
/// One number for each of them.
type LaneValues = [f64; LANES];

/// Corners relative to the point, normal and area of up to [`LANES`] triangles, lane by lane.
#[derive(Clone, Copy, Default)]
struct TriangleLanes {
    pub corners: [[LaneValues; 3]; 3],
    pub normal: [LaneValues; 3],
    pub area: LaneValues,
}

impl TriangleLanes {
    /// Puts the triangles of some numbers, seen from `point`, into as many lanes; the others repeat the last one, without area.
    #[inline(always)]
    pub fn set_all<'a>(
        &mut self,
        numbers: &[u32],
        triangle: impl Fn(u32) -> &'a Triangle,
        point: &Vector3<f64>,
    ) {
        for lane in 0..LANES {
            self.set(lane, triangle(numbers[lane.min(numbers.len() - 1)]), point);
        }
        self.area[numbers.len()..].fill(0.0);
    }

    /// Puts `triangle`, seen from `point`, into a lane.
    #[inline(always)]
    fn set(&mut self, lane: usize, triangle: &Triangle, point: &Vector3<f64>) {
        for corner in 0..3 {
            for axis in 0..3 {
                self.corners[corner][axis][lane] = triangle.corners[corner][axis] - point[axis];
            }
        }
        for axis in 0..3 {
            self.normal[axis][lane] = triangle.normal[axis];
        }
        self.area[lane] = triangle.area;
    }
}

/// Moments by a quadrature rule, for triangles well away from the point.
///
/// `TRACTION` asks for `D` and `E` too.
fn far_moments<const TRACTION: bool>(
    lanes: &TriangleLanes,
    rule: &[RulePoint],
    moments: &mut HatMoments<LANES>,
) {
    // Lanes alone: around them, where entries lie scattered, wide vectors would gather and scatter.
    vectorized(
        #[inline(always)]
        || add_moments::<TRACTION>(lanes, rule, moments),
    );
}

/// [`far_moments`], written lane by lane for the compiler to vectorise.
#[inline(always)]
fn add_moments<const TRACTION: bool>(
    lanes: &TriangleLanes,
    rule: &[RulePoint],
    moments: &mut HatMoments<LANES>,
) {
    let components = if TRACTION { 15 } else { 6 };
    for corner in moments.iter_mut() {
        for component in corner.iter_mut().take(components) {
            *component = [0.0; LANES];
        }
    }
    let corners = &lanes.corners;
    for (bary, weight) in rule {
        let mut values = [[0.0; LANES]; 15];
        for l in 0..LANES {
            let x = bary[0] * corners[0][0][l] + bary[1] * corners[1][0][l] + bary[2] * corners[2][0][l];
            let y = bary[0] * corners[0][1][l] + bary[1] * corners[1][1][l] + bary[2] * corners[2][1][l];
            let z = bary[0] * corners[0][2][l] + bary[1] * corners[1][2][l] + bary[2] * corners[2][2][l];
            let over_r2 = 1.0 / (x * x + y * y + z * z);
            let w = weight * lanes.area[l] * over_r2 * over_r2.sqrt();
            values[0][l] = x * x * w;
            values[1][l] = x * y * w;
            values[2][l] = x * z * w;
            values[3][l] = y * y * w;
            values[4][l] = y * z * w;
            values[5][l] = z * z * w;
            if TRACTION {
                let slope =
                    (x * lanes.normal[0][l] + y * lanes.normal[1][l] + z * lanes.normal[2][l]) * over_r2;
                for c in 0..6 {
                    values[6 + c][l] = values[c][l] * slope;
                }
                values[12][l] = x * w;
                values[13][l] = y * w;
                values[14][l] = z * w;
            }
        }
        // One run each: of two loops the outer one would be vectorised, by gathering.
        let values = values[..components].as_flattened();
        for (moments, bary) in moments.iter_mut().zip(bary) {
            let moments = moments[..components].as_flattened_mut();
            moments.iter_mut().zip(values).for_each(|(sum, value)| *sum += bary * value);
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Moments as `b`, `d` and `e` of each hat, by splitting the triangle evenly into `4^levels` and a rule of degree 8 on each.
    pub fn by_subdivision(triangle: &Triangle, point: &Vector3<f64>, levels: usize) -> [[f64; 15]; 3] {
        let mix = |piece: &[[f64; 3]; 3], l: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|c| l[0] * piece[0][c] + l[1] * piece[1][c] + l[2] * piece[2][c])
        };
        let at = |l: [f64; 3]| {
            triangle.corners[0] * l[0] + triangle.corners[1] * l[1] + triangle.corners[2] * l[2]
        };
        let mut sum = [[0.0; 15]; 3];
        let mut pieces = vec![([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], levels)];
        while let Some((piece, levels)) = pieces.pop() {
            let here = Triangle::new(piece.map(at));
            if levels > 0 && (here.centroid - point).norm() <= 12.0 * here.radius {
                let [a, b, c] = piece;
                let middles = [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]];
                let [ab, bc, ca] = middles.map(|l| mix(&piece, &l));
                let quarters = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
                pieces.extend(quarters.map(|quarter| (quarter, levels - 1)));
                continue;
            }
            for (l, weight) in RULES[2] {
                let lambda = mix(&piece, l);
                let r = at(lambda) - point;
                let d = r.norm();
                let slope = r.dot(&triangle.normal) / (d * d);
                let w = weight * here.area / (d * d * d);
                let b = [r.x * r.x, r.x * r.y, r.x * r.z, r.y * r.y, r.y * r.z, r.z * r.z];
                for k in 0..3 {
                    for c in 0..6 {
                        sum[k][c] += lambda[k] * b[c] * w;
                        sum[k][6 + c] += lambda[k] * b[c] * w * slope;
                    }
                    (0..3).for_each(|c| sum[k][12 + c] += lambda[k] * r[c] * w);
                }
            }
        }
        sum
    }

    pub fn triangles() -> Vec<Triangle> {
        let v = Vector3::new;
        vec![
            Triangle::new([v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.4, 0.9, 0.0)]),
            Triangle::new([v(0.1, -0.2, 0.3), v(1.3, 0.4, -0.2), v(0.3, 0.8, 0.9)]),
            Triangle::new([v(0.0, 0.0, 0.0), v(1.0, 0.1, 0.0), v(0.5, 0.15, 0.1)]),
        ]
    }

    #[test]
    fn rules_integrate_polynomials_of_their_degree() {
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        for (rule, degree) in RULES.iter().zip([2u32, 5, 8]) {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let found: f64 =
                        rule.iter().map(|(p, w)| w * p[0].powi(i as i32) * p[1].powi(j as i32)).sum();
                    let expected = 2.0 * factorial(i) * factorial(j) / factorial(i + j + 2);
                    assert!((found - expected).abs() < 2e-15, "degree {degree}, {i} {j}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn far_rules_keep_the_stated_tolerance_where_they_take_over() {
        let directions: Vec<Vector3<f64>> = (0..60)
            .map(|i| {
                let z = 1.0 - 2.0 * (i as f64 + 0.5) / 60.0;
                let angle = 2.399963 * i as f64;
                let rho = (1.0 - z * z).sqrt();
                Vector3::new(rho * angle.cos(), rho * angle.sin(), z)
            })
            .collect();
        for tolerance in [1e-3, 1e-4, 1e-5, 1e-6] {
            let reach = RuleReach::new(tolerance);
            for (number, rule) in RULES.iter().enumerate() {
                let ratio = reach.squared[number].sqrt();
                let mut worst = 0.0_f64;
                for triangle in triangles() {
                    for direction in &directions {
                        let point = triangle.centroid + direction * (ratio * triangle.radius);
                        let exact = by_subdivision(&triangle, &point, 4);
                        let mut lanes = TriangleLanes::default();
                        (0..LANES).for_each(|lane| lanes.set(lane, &triangle, &point));
                        let mut moments = [[[0.0; LANES]; 15]; 3];
                        far_moments::<true>(&lanes, rule, &mut moments);
                        let distance = ratio * triangle.radius;
                        let sizes = [triangle.area / 3.0 / distance, triangle.area / 3.0 / distance.powi(2)];
                        for k in 0..3 {
                            for c in 0..15 {
                                let error = (moments[k][c][0] - exact[k][c]).abs();
                                worst = worst.max(error / sizes[usize::from(c >= 6)]);
                            }
                        }
                    }
                }
                assert!(
                    worst < tolerance,
                    "tolerance {tolerance:e}, rule {number}: {worst:e} at {ratio} radii"
                );
            }
        }
    }
}
