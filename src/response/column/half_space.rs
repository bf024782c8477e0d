//! One column of the half-space part: a multipole series far away, exact integrals near.

use pulp::{Simd, WithSimd};

use crate::response::column::load::{LoadedFace, weighted};
use crate::response::integral::edge_quadrature::EdgeRule;
use crate::response::integral::hat::hat_integrals_within;
use crate::response::integral::hat_simd::NearFace;
use crate::response::integral::rule_lists::RuleLists;
use crate::response::series::multipole::{MultipoleSeries, order_for};
use crate::response::series::point_loads::{LoadBall, PointLoads, VECTORS_AT_ONCE};
use crate::response::series::taylor::TaylorSeries;
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::{POINTS_PER_BLOCK, Selection, Targets};

/// Points in each direction that give all moments of the shortest series exactly.
const FEWEST_POINTS: usize = 4;

/// Memory that one thread uses again for every column.
#[derive(Debug, Default)]
pub(crate) struct ColumnScratch {
    /// The loaded triangles of the column's node.
    pub(crate) faces: Vec<LoadedFace>,
    /// Values in the order of [`Targets`].
    pub(crate) values: Vec<f64>,
    /// Point forces that stand for the load.
    pub(crate) loads: PointLoads,
    pub(crate) multipoles: MultipoleSeries,
    /// Targets at which the series does not hold.
    pub(crate) near: Selection,
    /// Series of the layer's kernel.
    pub(crate) series: TaylorSeries,
    /// Quadrature along edges.
    pub(crate) rule: EdgeRule,
    /// 1/thickness of the targets in `near` (1/m).
    pub(crate) thicknesses: Vec<f64>,
    /// Sums of Gaussians, in the order of [`Targets`].
    pub(crate) sums: Vec<f64>,
}

impl ColumnScratch {
    /// Moments up to degree D for the layer's series, of the load on `faces`.
    #[inline(always)]
    pub(crate) fn fill_series<S: Simd, const D: usize, const M: usize>(&mut self, simd: S) {
        let ball = self.spread_load(D / 2 + 2);
        self.series.fill::<S, D, M>(simd, &self.loads, ball);
    }

    /// Sets `loads` to point forces by an n × n rule on each triangle; returns the ball around the load.
    #[inline(always)]
    fn spread_load(&mut self, n: usize) -> LoadBall {
        self.loads.clear();
        let rule = RuleLists::gauss(n);
        for face in &self.faces {
            self.loads.spread(
                &face.frame.vertices,
                &face.density.map(|density| density * face.frame.area),
                rule,
            );
        }
        self.loads.pad(POINTS_PER_BLOCK);
        self.loads.ball(self.faces.iter().flat_map(|face| &face.frame.vertices))
    }

    /// Half of the longest edge of the loaded triangles (m).
    pub(crate) fn half_edge(&self) -> f64 {
        let shortest = |heights: &[f64; 3]| heights.iter().copied().fold(f64::INFINITY, f64::min);
        self.faces.iter().map(|f| f.frame.area / shortest(&f.frame.heights)).fold(0.0, f64::max)
    }
}

/// Points in each direction of a triangle that give the moments of a half-space's column: exactly but for the last two of
/// a long series, which are small.
pub(crate) fn moment_points(tolerance: f64) -> usize {
    (order_for(tolerance) / 2).max(FEWEST_POINTS)
}

/// Sets `scratch.values` to `amplitude ∫ p(y) / |x - y| dA` for the load on `scratch.faces`, at all targets
/// closer than `reach` (m) to some point of it; 0 beyond.
///
/// * `points`: in each direction of a triangle for `scratch.loads`, at least [`moment_points`]
pub(crate) fn half_space_values(
    targets: &Targets,
    scratch: &mut ColumnScratch,
    amplitude: f64,
    tolerance: f64,
    reach: f64,
    points: usize,
) {
    scratch.values.resize(targets.points.len(), 0.0);
    pulp::Arch::new().dispatch(HalfSpaceColumn { targets, scratch, amplitude, tolerance, reach, points });
}

struct HalfSpaceColumn<'a> {
    targets: &'a Targets,
    scratch: &'a mut ColumnScratch,
    amplitude: f64,
    tolerance: f64,
    reach: f64,
    points: usize,
}

impl WithSimd for HalfSpaceColumn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let ball = self.scratch.spread_load(self.points);
        let ColumnScratch { loads, multipoles, .. } = self.scratch;
        let farthest = self.targets.farthest(&ball.center);
        multipoles.fill(simd, loads, ball, self.amplitude, self.tolerance, farthest);
        self.far_values(simd);
        self.near_values(simd);
    }
}

impl HalfSpaceColumn<'_> {
    /// The series at all targets; those too close for it are listed in `scratch.near`.
    #[inline(always)]
    fn far_values<S: Simd>(&mut self, simd: S) {
        let Self { targets, scratch, reach, .. } = self;
        let multipoles = &scratch.multipoles;
        let LoadBall { center, radius } = multipoles.ball;
        let near_squared = multipoles.near_squared();
        let far_squared = (*reach + radius).powi(2);
        let infinity = Lanes::splat(simd, f64::INFINITY);
        let values = &mut scratch.values;
        scratch.near.index.clear();
        let step = VECTORS_AT_ONCE * S::F64_LANES;
        for start in (0..values.len()).step_by(step) {
            let mut points = [[infinity; 3]; VECTORS_AT_ONCE];
            let (mut nearest, mut nearest_far) = (infinity, infinity);
            for (k, point) in points.iter_mut().enumerate() {
                let [x, y, z] = targets.points.load(simd, start + k * S::F64_LANES);
                *point = [x - infinity.all(center.x), y - infinity.all(center.y), z - infinity.all(center.z)];
                let squared = dot(point, point);
                let is_near = squared.less(infinity.all(near_squared));
                nearest = nearest.min(squared);
                nearest_far = nearest_far.min(is_near.pick(infinity, squared));
            }
            let nearest = nearest.least();
            if nearest < near_squared {
                for i in start..targets.rows.len().min(start + step) {
                    if (targets.points.at(i) - center).norm_squared() < near_squared * (1.0 + 1e-12) {
                        scratch.near.index.push(i as u32);
                    }
                }
            } else if nearest >= far_squared {
                values[start..start + step].fill(0.0);
                continue;
            }
            let found = multipoles.evaluate(multipoles.order_at(nearest_far.least()), &points);
            for (k, value) in found.into_iter().enumerate() {
                value.store(values, start + k * S::F64_LANES);
            }
        }
    }

    /// The exact integral at the listed targets.
    #[inline(always)]
    fn near_values<S: Simd>(&mut self, simd: S) {
        let Self { targets, scratch, amplitude, tolerance, .. } = self;
        let (amplitude, tolerance) = (*amplitude, *tolerance);
        let near = &mut scratch.near;
        near.gather(targets);
        let reach = scratch.multipoles.near_squared().sqrt() + scratch.multipoles.ball.radius;
        for face in &scratch.faces {
            if let Some(allowed) = face.error_beyond_closed_form(reach, tolerance) {
                for k in 0..near.index.len() {
                    let hats = hat_integrals_within(&near.points.at(k), &face.frame.vertices, allowed);
                    near.values[k] += amplitude * weighted(&face.density, &hats);
                }
            } else {
                NearFace::new(&face.frame, face.density).add(simd, amplitude, near);
            }
        }
        for (&i, &value) in near.index.iter().zip(&near.values) {
            scratch.values[i as usize] = value;
        }
    }
}
