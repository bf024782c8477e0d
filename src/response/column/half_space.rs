//! One column of the half-space part: a multipole series far away, exact integrals near.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::load::{LoadedFace, weighted};
use crate::response::integral::edge_quadrature::EdgeRule;
use crate::response::integral::gauss::triangle_rule;
use crate::response::integral::hat_simd::NearFace;
use crate::response::integral::subdivide::subdivided_hat_integrals;
use crate::response::series::multipole::{Expansion, PointLoads, TOGETHER, order_for};
use crate::response::series::taylor::RadialSeries;
use crate::response::simd::points::{BLOCK, Selection, Targets};

/// Memory that one thread uses again for every column.
#[derive(Debug)]
pub(crate) struct Scratch {
    /// The loaded triangles of the column's node.
    pub(crate) faces: Vec<LoadedFace>,
    /// Values in the order of [`Targets`].
    pub(crate) values: Vec<f64>,
    loads: PointLoads,
    expansion: Expansion,
    /// Targets at which the series does not hold.
    pub(crate) near: Selection,
    /// Series for other radial kernels.
    pub(crate) series: RadialSeries,
    /// Quadrature along edges.
    pub(crate) rule: EdgeRule,
    /// 1/thickness of the targets in `near` (1/m).
    pub(crate) thicknesses: Vec<f64>,
}

impl Scratch {
    pub(crate) fn new(targets: &Targets) -> Self {
        Self {
            faces: Vec::new(),
            values: vec![0.0; targets.x.len()],
            loads: PointLoads::default(),
            expansion: Expansion::new(),
            near: Selection::default(),
            series: RadialSeries::new(),
            rule: EdgeRule::default(),
            thicknesses: Vec::new(),
        }
    }

    /// Moments for the series of other kernels, of the load on `faces`.
    #[inline(always)]
    pub(crate) fn fill_series<S: Simd>(&mut self, simd: S, degree: usize) {
        spread_load(self, degree / 2 + 1, BLOCK);
        let ball = ball_around(&self.faces, &self.loads);
        self.series.fill(simd, &self.loads, ball, degree);
    }

    /// Half of the longest edge of the loaded triangles (m).
    pub(crate) fn half_edge(&self) -> f64 {
        let shortest = |heights: &[f64; 3]| heights.iter().copied().fold(f64::INFINITY, f64::min);
        self.faces.iter().map(|f| f.frame.area / shortest(&f.frame.heights)).fold(0.0, f64::max)
    }
}

/// Sets `scratch.values` to `amplitude ∫ p(y) / |x - y| dA` for the load on `scratch.faces`, at all targets
/// closer than `reach` (m) to some point of it; 0 beyond.
pub(crate) fn half_space_values(
    targets: &Targets,
    scratch: &mut Scratch,
    amplitude: f64,
    tolerance: f64,
    reach: f64,
) {
    scratch.values.resize(targets.x.len(), 0.0);
    pulp::Arch::new().dispatch(HalfSpaceColumn { targets, scratch, amplitude, tolerance, reach });
}

struct HalfSpaceColumn<'a> {
    targets: &'a Targets,
    scratch: &'a mut Scratch,
    amplitude: f64,
    tolerance: f64,
    reach: f64,
}

impl WithSimd for HalfSpaceColumn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { targets, scratch, amplitude, tolerance, reach } = self;
        spread_load(scratch, order_for(tolerance) / 2 + 2, BLOCK);
        let ball = ball_around(&scratch.faces, &scratch.loads);
        scratch.expansion.fill(simd, &scratch.loads, ball, amplitude, tolerance);
        far_values(simd, targets, scratch, reach);
        near_values(simd, targets, scratch, amplitude, tolerance);
    }
}

/// The load as point forces by an n × n rule on each triangle.
#[inline(always)]
pub(crate) fn spread_load(scratch: &mut Scratch, n: usize, lanes: usize) {
    scratch.loads.clear();
    for face in &scratch.faces {
        let [a, b, c] = face.frame.vertices;
        for (l, weight) in triangle_rule(n) {
            let place = a * l[0] + b * l[1] + c * l[2];
            scratch.loads.push(&place, weight * face.frame.area * weighted(&face.density, l));
        }
    }
    scratch.loads.pad(lanes);
}

/// The load's centre, about which it has no dipole, and the farthest corner from it.
#[inline(always)]
fn ball_around(faces: &[LoadedFace], loads: &PointLoads) -> (Vector3<f64>, f64) {
    let (mut sum, mut total) = (Vector3::zeros(), 0.0);
    for k in 0..loads.share.len() {
        sum += Vector3::new(loads.x[k], loads.y[k], loads.z[k]) * loads.share[k];
        total += loads.share[k];
    }
    let center = sum / total;
    let corners = faces.iter().flat_map(|f| &f.frame.vertices);
    let radius_squared = corners.map(|v| (v - center).norm_squared()).fold(0.0, f64::max);
    (center, radius_squared.sqrt())
}

/// The series at all targets; those too close for it are listed in `scratch.near`.
#[inline(always)]
fn far_values<S: Simd>(simd: S, targets: &Targets, scratch: &mut Scratch, reach: f64) {
    let expansion = &scratch.expansion;
    let near_squared = expansion.near_squared();
    let far = reach + expansion.radius;
    let far_squared = far * far;
    let [cx, cy, cz] = [expansion.center.x, expansion.center.y, expansion.center.z];
    let center = [simd.splat_f64s(cx), simd.splat_f64s(cy), simd.splat_f64s(cz)];
    let limit = simd.splat_f64s(near_squared);
    let infinity = simd.splat_f64s(f64::INFINITY);
    let coordinates = [&targets.x, &targets.y, &targets.z].map(|list| S::as_simd_f64s(list).0);
    let values = S::as_mut_simd_f64s(&mut scratch.values).0;
    scratch.near.index.clear();
    for start in (0..values.len()).step_by(TOGETHER) {
        let (mut x, mut y, mut z, mut squared) =
            ([infinity; TOGETHER], [infinity; TOGETHER], [infinity; TOGETHER], [infinity; TOGETHER]);
        for k in 0..TOGETHER {
            x[k] = simd.sub_f64s(coordinates[0][start + k], center[0]);
            y[k] = simd.sub_f64s(coordinates[1][start + k], center[1]);
            z[k] = simd.sub_f64s(coordinates[2][start + k], center[2]);
            squared[k] =
                simd.mul_add_f64s(x[k], x[k], simd.mul_add_f64s(y[k], y[k], simd.mul_f64s(z[k], z[k])));
        }
        let mut nearest = infinity;
        let mut nearest_far = infinity;
        for s in squared {
            nearest = simd.min_f64s(nearest, s);
            let is_near = simd.less_than_f64s(s, limit);
            let bits = simd.transmute_u64s_f64s(s);
            let kept = simd.select_u64s(is_near, simd.transmute_u64s_f64s(infinity), bits);
            nearest_far = simd.min_f64s(nearest_far, simd.transmute_f64s_u64s(kept));
        }
        let nearest = simd.reduce_min_f64s(nearest);
        if nearest < near_squared {
            for i in start * S::F64_LANES..(start + TOGETHER) * S::F64_LANES {
                let place = Vector3::new(targets.x[i] - cx, targets.y[i] - cy, targets.z[i] - cz);
                if i < targets.rows.len() && place.norm_squared() < near_squared * (1.0 + 1e-12) {
                    scratch.near.index.push(i as u32);
                }
            }
        } else if nearest >= far_squared {
            values[start..start + TOGETHER].fill(simd.splat_f64s(0.0));
            continue;
        }
        let order = expansion.order_at(simd.reduce_min_f64s(nearest_far));
        values[start..start + TOGETHER].copy_from_slice(&expansion.evaluate(simd, order, x, y, z));
    }
}

/// The exact integral at the listed targets.
#[inline(always)]
fn near_values<S: Simd>(simd: S, targets: &Targets, scratch: &mut Scratch, amplitude: f64, tolerance: f64) {
    let near = &mut scratch.near;
    near.gather(targets);
    let reach = scratch.expansion.near_squared().sqrt() + scratch.expansion.radius;
    for face in &scratch.faces {
        if face.loses_digits(reach, tolerance) {
            for k in 0..near.index.len() {
                let point = Vector3::new(near.x[k], near.y[k], near.z[k]);
                let hats = subdivided_hat_integrals(&face.frame.vertices, &point);
                near.values[k] += amplitude * weighted(&face.density, &hats);
            }
        } else {
            NearFace::new(face).add(simd, amplitude, &near.x, &near.y, &near.z, &mut near.values);
        }
    }
    for (&i, &value) in near.index.iter().zip(&near.values) {
        scratch.values[i as usize] = value;
    }
}
