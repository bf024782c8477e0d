//! One column of the layer's matrix: the half-space's less that of the smooth part.
//!
//! The smooth part is a Taylor series about the load's center; near loads that are wide for the layer, where no
//! series holds, a quadrature along the edges of their triangles.

use std::ops::Range;
use std::sync::Arc;

use pulp::{Simd, WithSimd};

use crate::response::column::half_space::{ColumnScratch, half_space_values, moment_points};
use crate::response::integral::edge_quadrature::EdgePotential;
use crate::response::integral::hat_simd::NearFace;
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::layer_table::{LayerTable, SINGULARITY};
use crate::response::kernel::skin::KernelSkin;
use crate::response::series::point_loads::VECTORS_AT_ONCE;
use crate::response::series::taylor::{DEGREES, TaylorSeries};
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::{POINTS_PER_BLOCK, Selection, Targets, gather};

/// Kernel values below this times the tolerance, relative to K/h, are taken as 0.
pub(crate) const SKIPPED_KERNEL: f64 = 1e-2;
/// The tabulated kernel's own error.
const TABLE_ERROR: f64 = 1e-12;
/// What of the tolerance goes to the 1/r part; the rest goes to the smooth part.
const SINGULAR_SHARE: f64 = 0.75;
/// Within this share of the way to its singularities at ±2i the smooth part stays below the bound.
const SMOOTH_ROOM: f64 = 0.8;
const SMOOTH_BOUND: f64 = 40.0;

/// What all columns of a layer's matrix share.
#[derive(Debug)]
pub(crate) struct PreparedLayer {
    pub(crate) kernel: Arc<LayerKernel>,
    /// K (m²/N).
    pub(crate) constant: f64,
    /// r/h beyond which the kernel is taken as 0.
    pub(crate) reach: f64,
    pub(crate) tolerance: f64,
}

impl PreparedLayer {
    pub(crate) fn new(skin: &KernelSkin, tolerance: f64) -> Self {
        let kernel = LayerKernel::new(skin.poisson_ratio()).expect("a skin's ratio is checked");
        Self {
            reach: kernel.reach(SKIPPED_KERNEL * tolerance),
            constant: skin.kernel_constant(),
            tolerance: tolerance.max(TABLE_ERROR),
            kernel,
        }
    }

    /// Sets `scratch.values` to the displacement of all targets by the load on `scratch.faces`.
    ///
    /// * `own_thickness`: at the loaded node (m)
    pub(crate) fn values(&self, targets: &Targets, scratch: &mut ColumnScratch, own_thickness: f64) {
        let tolerance = SINGULAR_SHARE * self.tolerance;
        // The means that tell how far the layer's series reaches have higher degrees.
        let points = moment_points(tolerance) + 1;
        half_space_values(targets, scratch, self.constant, tolerance, self.reach * own_thickness, points);
        self.take_off_smooth(targets, scratch, own_thickness);
    }

    /// Takes the smooth part off `scratch.values`; the load is that of the half-space's values before.
    pub(crate) fn take_off_smooth(&self, targets: &Targets, scratch: &mut ColumnScratch, own_thickness: f64) {
        let own_inverse = 1.0 / own_thickness;
        pulp::Arch::new().dispatch(LayerColumn { layer: self, targets, own_inverse, scratch });
    }
}

/// The smooth part of one column.
struct LayerColumn<'a> {
    layer: &'a PreparedLayer,
    targets: &'a Targets,
    /// 1/thickness at the loaded node (1/m).
    own_inverse: f64,
    scratch: &'a mut ColumnScratch,
}

impl WithSimd for LayerColumn<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layer, targets, own_inverse, scratch } = self;
        let (ball, thinnest) = (scratch.multipoles.ball, targets.largest_inverse.max(own_inverse));
        let means = TaylorSeries::means(simd, &scratch.loads, &ball);
        let allowed = (1.0 - SINGULAR_SHARE) * layer.tolerance;
        let ladder = layer.kernel.table.ladder(&means, ball.radius * thinnest, allowed);
        let highest = ladder.iter().position(|&from| from <= SINGULARITY).unwrap_or(DEGREES.len() - 1);
        match highest {
            0 => scratch.fill_series::<S, 3, 10>(simd),
            1 => scratch.fill_series::<S, 5, 21>(simd),
            2 => scratch.fill_series::<S, 7, 36>(simd),
            _ => scratch.fill_series::<S, 9, 55>(simd),
        }
        let pairs = Pairs { layer, targets, own_inverse };
        pairs.take_off_series(simd, scratch, &ladder[..=highest]);
        if !scratch.near.index.is_empty() {
            pairs.take_off_near(simd, scratch, thinnest, allowed);
        }
    }
}

/// The targets of a layer, each with the loaded node.
struct Pairs<'a> {
    layer: &'a PreparedLayer,
    targets: &'a Targets,
    /// 1/thickness at the loaded node (1/m).
    own_inverse: f64,
}

impl Pairs<'_> {
    /// 1/thickness of targets from the given one on: a pair answers as the thinner of its two.
    #[inline(always)]
    fn inverse<S: Simd>(&self, simd: S, list: &[f64], first: usize) -> Lanes<S> {
        let target = Lanes::load(simd, list, first);
        let own = target.all(self.own_inverse);
        target.less(own).pick(own, target)
    }

    /// Takes the series off the values; the targets at which it does not hold are left in `scratch.near`.
    ///
    /// * `ladder`: the v from which on each of [`DEGREES`] holds
    #[inline(always)]
    fn take_off_series<S: Simd>(&self, simd: S, scratch: &mut ColumnScratch, ladder: &[f64]) {
        let targets = self.targets;
        let ColumnScratch { series, values, near, .. } = scratch;
        near.index.clear();
        let (zero, far_from) = (Lanes::splat(simd, 0.0), ladder[ladder.len() - 1]);
        let step = VECTORS_AT_ONCE * S::F64_LANES;
        for start in (0..values.len()).step_by(step) {
            let place = series.place(simd, targets, start);
            let blank = [zero; VECTORS_AT_ONCE];
            let (mut amplitude, mut thin, mut v, mut limit) = (blank, blank, blank, blank);
            let (mut nearest, mut nearest_far, mut beyond) =
                (zero.all(f64::INFINITY), zero.all(f64::INFINITY), zero.all(f64::INFINITY));
            for k in 0..VECTORS_AT_ONCE {
                let inverse = self.inverse(simd, &targets.inverse_thickness, start + k * S::F64_LANES);
                let thinness = inverse * zero.all(series.ball.radius);
                let reach = thinness + zero.all(self.layer.reach);
                amplitude[k] = inverse * zero.all(self.layer.constant);
                thin[k] = thinness * thinness;
                let at = [place[0][k], place[1][k], place[2][k]];
                v[k] = dot(&at, &at).mul_add(thin[k], zero.all(SINGULARITY));
                limit[k] = reach.mul_add(reach, zero.all(SINGULARITY));
                beyond = beyond.min(v[k] - limit[k]);
                nearest = nearest.min(v[k]);
                nearest_far = nearest_far.min(v[k].less(zero.all(far_from)).pick(nearest_far, v[k]));
            }
            if beyond.least() >= 0.0 {
                values[start..start + step].fill(0.0);
                continue;
            }
            let nearest_far = nearest_far.least();
            let mut smooth = blank;
            if nearest_far < f64::INFINITY {
                let level = ladder.iter().position(|&from| nearest_far >= from);
                smooth = match level {
                    Some(0) => self.smooth::<S, 4, 10, 6>(series, &place, &v, &thin),
                    Some(1) => self.smooth::<S, 6, 21, 7>(series, &place, &v, &thin),
                    Some(2) => self.smooth::<S, 8, 36, 9>(series, &place, &v, &thin),
                    _ => self.smooth::<S, 10, 55, 11>(series, &place, &v, &thin),
                };
            }
            for k in 0..VECTORS_AT_ONCE {
                let at = start + k * S::F64_LANES;
                let value = Lanes::load(simd, values, at);
                let far = v[k].less(zero.all(far_from)).pick(value, value - amplitude[k] * smooth[k]);
                v[k].less(limit[k]).pick(far, zero).store(values, at);
            }
            if nearest.least() < far_from {
                let count = targets.rows.len().saturating_sub(start).min(step);
                list_near(&v, &limit, far_from, start..start + count, near);
            }
        }
    }

    /// The series up to degree N - 1, out of T terms of the table.
    #[inline(always)]
    fn smooth<S: Simd, const N: usize, const M: usize, const T: usize>(
        &self,
        series: &TaylorSeries,
        place: &[[Lanes<S>; VECTORS_AT_ONCE]; 3],
        v: &[Lanes<S>; VECTORS_AT_ONCE],
        thin: &[Lanes<S>; VECTORS_AT_ONCE],
    ) -> [Lanes<S>; VECTORS_AT_ONCE] {
        let table = &self.layer.kernel.table;
        let slopes =
            [table.smooth_slopes::<S, N, T>(v[0], thin[0]), table.smooth_slopes::<S, N, T>(v[1], thin[1])];
        series.evaluate::<S, N, M>(place, &slopes)
    }

    /// Takes the smooth part off the values of the targets in `scratch.near`.
    ///
    /// * `thinnest`: the largest 1/thickness of all pairs (1/m)
    /// * `allowed`: error of φ relative to 1/ρ
    #[inline(always)]
    fn take_off_near<S: Simd>(&self, simd: S, scratch: &mut ColumnScratch, thinnest: f64, allowed: f64) {
        let (targets, half_edge) = (self.targets, scratch.half_edge());
        let ColumnScratch { near, values, faces, rule, thicknesses, series, .. } = scratch;
        let distance = |place: u32| (targets.points.at(place as usize) - series.ball.center).norm();
        near.index.sort_unstable_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        near.gather(targets);
        gather(&near.index, &targets.inverse_thickness, thicknesses);
        let faces: Vec<NearFace> =
            faces.iter().map(|face| NearFace::new(&face.frame, face.density)).collect();
        for i in (0..near.index.len()).step_by(S::F64_LANES) {
            let last = near.index[near.index.len().min(i + S::F64_LANES) - 1];
            // from the triangles, in thicknesses
            let clear = ((distance(near.index[i]) - series.ball.radius) * thinnest).max(0.0);
            let farthest =
                (distance(last) * thinnest).min(self.layer.reach + 2.0 * series.ball.radius * thinnest);
            let room = SMOOTH_ROOM * (clear * clear + SINGULARITY).sqrt();
            rule.set(half_edge * thinnest, room, SMOOTH_BOUND, allowed / farthest);
            let inverse = self.inverse(simd, thicknesses, i);
            let table = &self.layer.kernel.table;
            let potential = SmoothPart { table, squared_inverse: inverse * inverse };
            let mut sum = inverse.all(0.0);
            for face in &faces {
                sum = sum + face.along_edges(near.points.load(simd, i), rule, &potential);
            }
            // Ψ of r is h² times that of ρ
            (sum / inverse).store(&mut near.values, i);
        }
        for (&i, sum) in near.index.iter().zip(&near.values) {
            values[i as usize] -= self.layer.constant * sum;
        }
    }
}

/// Adds those of `places` to the near ones that are below both `far_from` and their limit.
#[inline(always)]
fn list_near<S: Simd>(
    v: &[Lanes<S>; VECTORS_AT_ONCE],
    limit: &[Lanes<S>; VECTORS_AT_ONCE],
    far_from: f64,
    places: Range<usize>,
    near: &mut Selection,
) {
    let (mut found, mut end) = ([0.0; POINTS_PER_BLOCK], [0.0; POINTS_PER_BLOCK]);
    for k in 0..VECTORS_AT_ONCE {
        v[k].store(&mut found, k * S::F64_LANES);
        limit[k].min(v[k].all(far_from)).store(&mut end, k * S::F64_LANES);
    }
    for (k, place) in places.enumerate() {
        if found[k] < end[k] {
            near.index.push(place as u32);
        }
    }
}

/// φ(r/h).
struct SmoothPart<'a, S: Simd> {
    table: &'a LayerTable,
    /// 1/h² (1/m²).
    squared_inverse: Lanes<S>,
}

impl<S: Simd> EdgePotential<S> for SmoothPart<'_, S> {
    #[inline(always)]
    fn at(&self, squared: Lanes<S>) -> Lanes<S> {
        self.table.primitive(squared.mul_add(self.squared_inverse, squared.all(SINGULARITY)))
    }
}
