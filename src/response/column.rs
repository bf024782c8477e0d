//! One column of the half-space part: a multipole series far away, exact integrals near.

use super::multipole::{Expansion, PointLoads, TOGETHER, order_for};
use super::near::NearFace;
use super::rule::triangle_rule;
use super::source::{LoadedFace, weighted};
use super::subdivide::subdivided_hat_integrals;
use super::targets::{BLOCK, Targets};
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

/// Memory that one thread uses again for every column.
#[derive(Debug)]
pub(crate) struct Scratch {
    /// The loaded triangles of the column's node.
    pub(crate) faces: Vec<LoadedFace>,
    /// Values in the order of [`Targets`].
    pub(crate) values: Vec<f64>,
    loads: PointLoads,
    expansion: Expansion,
    near: Vec<u32>,
    near_x: Vec<f64>,
    near_y: Vec<f64>,
    near_z: Vec<f64>,
    near_values: Vec<f64>,
}

impl Scratch {
    pub(crate) fn new(targets: &Targets) -> Self {
        Self {
            faces: Vec::new(),
            values: vec![0.0; targets.x.len()],
            loads: PointLoads::default(),
            expansion: Expansion::new(),
            near: Vec::new(),
            near_x: Vec::new(),
            near_y: Vec::new(),
            near_z: Vec::new(),
            near_values: Vec::new(),
        }
    }

    /// Centre and radius (m) of the load of the last column.
    pub(crate) fn ball(&self) -> (Vector3<f64>, f64) {
        (self.expansion.center, self.expansion.radius)
    }

    /// Distance of the farthest corner of the loaded triangles from their mean corner (m).
    pub(crate) fn load_radius(&self) -> f64 {
        let corners = || self.faces.iter().flat_map(|f| &f.frame.vertices);
        let center = corners().sum::<Vector3<f64>>() / (3 * self.faces.len()) as f64;
        corners().map(|v| (v - center).norm()).fold(0.0, f64::max)
    }

    /// The point loads that [`spread_load`] left, and the values.
    pub(crate) fn loads_and_values(&mut self) -> (&PointLoads, &mut [f64]) {
        (&self.loads, &mut self.values)
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

/// As [`spread_load`], with each triangle first divided into `pieces`² equal ones.
pub(crate) fn spread_load_finely(scratch: &mut Scratch, n: usize, pieces: usize) {
    if pieces == 1 {
        return spread_load(scratch, n, 1);
    }
    scratch.loads.clear();
    let step = 1.0 / pieces as f64;
    for face in &scratch.faces {
        let [a, b, c] = face.frame.vertices;
        let mut add = |u: f64, v: f64, size: f64| {
            for (l, weight) in triangle_rule(n) {
                let (u, v) = (u + size * l[1], v + size * l[2]);
                let hats = [1.0 - u - v, u, v];
                let place = a * hats[0] + b * hats[1] + c * hats[2];
                let share = weight * face.frame.area * step * step * weighted(&face.density, &hats);
                scratch.loads.push(&place, share);
            }
        };
        for i in 0..pieces {
            for j in 0..pieces - i {
                add(i as f64 * step, j as f64 * step, step);
                if i + j + 1 < pieces {
                    add((i + 1) as f64 * step, (j + 1) as f64 * step, -step);
                }
            }
        }
    }
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
    scratch.near.clear();
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
                    scratch.near.push(i as u32);
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
    let Scratch { near, near_x, near_y, near_z, near_values, .. } = scratch;
    for (list, from) in [(&mut *near_x, &targets.x), (&mut *near_y, &targets.y), (&mut *near_z, &targets.z)] {
        list.clear();
        list.extend(near.iter().map(|&i| from[i as usize]));
        if let Some(&last) = list.last() {
            list.resize(near.len().next_multiple_of(BLOCK), last);
        }
    }
    near_values.clear();
    near_values.resize(near_x.len(), 0.0);
    let reach = scratch.expansion.near_squared().sqrt() + scratch.expansion.radius;
    for face in &scratch.faces {
        if face.loses_digits(reach, tolerance) {
            for (k, value) in near_values.iter_mut().take(near.len()).enumerate() {
                let point = Vector3::new(near_x[k], near_y[k], near_z[k]);
                let hats = subdivided_hat_integrals(&face.frame.vertices, &point);
                *value += amplitude * weighted(&face.density, &hats);
            }
        } else {
            NearFace::new(face).add(simd, amplitude, near_x, near_y, near_z, near_values);
        }
    }
    for (&i, &value) in near.iter().zip(near_values.iter()) {
        scratch.values[i as usize] = value;
    }
}
