//! One column of the layer's matrix.

use std::sync::Arc;

use pulp::{Simd, WithSimd};

use crate::response::column::half_space::{ColumnScratch, half_space_values};
use crate::response::integral::edge_quadrature::EdgePotential;
use crate::response::integral::hat_simd::NearFace;
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::layer_table::{INVERSE_SLOPES, LARGEST_RHO, LayerTable, SLOPE_COUNT};
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::series::point_loads::VECTORS_AT_ONCE;
use crate::response::series::taylor::{DEGREES, MAX_DEGREE, TaylorSeries};
use crate::response::simd::lanes::Lanes;
use crate::response::simd::points::{POINTS_PER_BLOCK, Targets, gather};

/// Kernel values below this times the tolerance, relative to K/h, are taken as 0.
pub(crate) const SKIPPED_KERNEL: f64 = 1e-2;
/// The tabulated kernel's own error.
const LEAST_TOLERANCE: f64 = 1e-12;
/// Within this many thicknesses of the real axis the smooth part, singular at ±2i, stays below the bound.
const SMOOTH_ROOM: f64 = 1.6;
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
    pub(crate) fn new(skin: &KernelSkin, options: &AssemblyOptions) -> Self {
        let kernel = LayerKernel::new(skin.poisson_ratio()).expect("a skin's ratio is checked");
        Self {
            reach: kernel.reach(SKIPPED_KERNEL * options.tolerance),
            constant: skin.kernel_constant(),
            tolerance: options.tolerance.max(LEAST_TOLERANCE),
            kernel,
        }
    }

    /// Sets `scratch.values` to the displacement of all targets by the load on `scratch.faces`.
    ///
    /// Near the load: the exact 1/r part less the smooth part by quadrature. Beyond: the whole kernel as a
    /// series, which keeps its accuracy where the two parts cancel.
    ///
    /// * `inverse_thickness`: 1/thickness of each target, in their order, padded as they are (1/m)
    /// * `own_thickness`: at the loaded node (m)
    pub(crate) fn values(
        &self,
        targets: &Targets,
        inverse_thickness: &[f64],
        scratch: &mut ColumnScratch,
        own_thickness: f64,
    ) {
        let own_inverse = 1.0 / own_thickness;
        let column = LayerColumn { layer: self, inverse_thickness, own_inverse };
        let ladder = pulp::Arch::new().dispatch(Prepare { column, scratch });
        let farthest = self.reach * own_thickness + scratch.series.ball.radius;
        let near = ladder[DEGREES.len() - 1].min(farthest);
        half_space_values(targets, scratch, self.constant, self.tolerance, near);
        let thinnest = inverse_thickness.iter().copied().fold(own_inverse, f64::max);
        // the kernel ends where r reaches as many thicknesses of any pair
        let allowed =
            self.tolerance / (near * thinnest).min(self.reach + 2.0 * scratch.series.ball.radius * thinnest);
        let half_edge = scratch.half_edge();
        scratch.rule.set(half_edge * thinnest, SMOOTH_ROOM, SMOOTH_BOUND, allowed);
        pulp::Arch::new().dispatch(Sweep { column, targets, scratch, near, ladder });
    }
}

/// A layer at the node of one column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LayerColumn<'a> {
    pub(crate) layer: &'a PreparedLayer,
    /// 1/thickness of each target (1/m).
    inverse_thickness: &'a [f64],
    /// 1/thickness at the loaded node (1/m).
    pub(crate) own_inverse: f64,
}

/// Fills the series of the load and says from where on it holds.
struct Prepare<'a> {
    column: LayerColumn<'a>,
    scratch: &'a mut ColumnScratch,
}

impl WithSimd for Prepare<'_> {
    type Output = DegreeReach;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> DegreeReach {
        self.scratch.fill_series(simd);
        self.column.ladder(&self.scratch.series)
    }
}

struct Sweep<'a> {
    column: LayerColumn<'a>,
    targets: &'a Targets,
    scratch: &'a mut ColumnScratch,
    near: f64,
    ladder: DegreeReach,
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { column, targets, scratch, near, ladder } = self;
        let layer = column.layer;
        let ColumnScratch { series, values, near: close, .. } = &mut *scratch;
        let (center, radius) = (series.ball.center, series.ball.radius);
        close.index.clear();
        for start in (0..values.len()).step_by(POINTS_PER_BLOCK) {
            let mut block =
                Block { start, distance: [0.0; POINTS_PER_BLOCK], inverse: [0.0; POINTS_PER_BLOCK] };
            for i in 0..POINTS_PER_BLOCK {
                block.distance[i] = (targets.point(start + i) - center).norm();
                // a pair answers as the thinner of its two
                block.inverse[i] = column.inverse_thickness[start + i].max(column.own_inverse);
            }
            let Block { distance, inverse, .. } = &block;
            let felt = |i: usize| {
                let rho = distance[i] * inverse[i];
                rho - radius * inverse[i] < layer.reach && (rho < LARGEST_RHO as f64 || distance[i] < near)
            };
            let mut nearest = f64::INFINITY;
            for i in 0..POINTS_PER_BLOCK {
                if !felt(i) {
                    values[start + i] = 0.0;
                } else if distance[i] < near {
                    if start + i < targets.rows.len() {
                        close.index.push((start + i) as u32);
                    }
                } else {
                    nearest = nearest.min(distance[i]);
                }
            }
            if nearest < f64::INFINITY {
                let level = ladder.iter().position(|&from| nearest >= from).unwrap_or(DEGREES.len() - 1);
                let far = column.far(simd, series, level, targets, &block);
                for i in (0..POINTS_PER_BLOCK).filter(|&i| felt(i) && distance[i] >= near) {
                    values[start + i] = far[i];
                }
            }
        }
        column.take_off_smooth(simd, targets, scratch);
    }
}

/// Distance (m) from the load's center at which a series of each of [`DEGREES`] keeps the tolerance, falling.
type DegreeReach = [f64; DEGREES.len()];

/// A block of targets.
struct Block {
    /// The first of them.
    start: usize,
    /// Distances from the load's center (m).
    distance: [f64; POINTS_PER_BLOCK],
    /// 1/thickness of the pairs with the loaded node (1/m).
    inverse: [f64; POINTS_PER_BLOCK],
}

impl LayerColumn<'_> {
    /// Takes the smooth part off the values of the targets in `scratch.near`.
    #[inline(always)]
    fn take_off_smooth<S: Simd>(&self, simd: S, targets: &Targets, scratch: &mut ColumnScratch) {
        let ColumnScratch { near, values, faces, rule, thicknesses, .. } = scratch;
        near.gather(targets);
        gather(&near.index, self.inverse_thickness, thicknesses);
        let table = &self.layer.kernel.table;
        for face in faces.iter().map(NearFace::new) {
            for i in (0..near.values.len()).step_by(S::F64_LANES) {
                let own = Lanes::load(simd, thicknesses, i);
                let pair = own.all(self.own_inverse);
                let inverse = own.less(pair).pick(pair, own);
                let integral = face.along_edges(near.place(simd, i), rule, &SmoothPart { table, inverse });
                integral.mul_add(inverse, Lanes::load(simd, &near.values, i)).store(&mut near.values, i);
            }
        }
        for (&i, sum) in near.index.iter().zip(&near.values) {
            values[i as usize] -= self.layer.constant * sum;
        }
    }

    /// The terms of a series from degree p + 1 on add up to at most `roughness μ_(p+1) q^(p+1) / (1 - q)` of K/r
    /// with q = radius / distance.
    fn ladder(&self, series: &TaylorSeries) -> DegreeReach {
        let mut ladder = [0.0; DEGREES.len()];
        for level in 0..DEGREES.len() {
            let degree = DEGREES[level];
            let mean = series.means.at(degree + 1);
            let mut ratio = 1.25;
            let keeps = |ratio: f64| {
                let rho = ratio * series.ball.radius * self.own_inverse;
                let rough = self.layer.kernel.table.roughness(level, rho);
                rough * mean <= self.layer.tolerance * ratio.powi(degree as i32 + 1) * (1.0 - 1.0 / ratio)
            };
            while !keeps(ratio) && ratio < 1e12 {
                ratio *= 1.05;
            }
            ladder[level] = ratio * series.ball.radius;
        }
        for level in (1..DEGREES.len()).rev() {
            ladder[level - 1] = ladder[level - 1].max(ladder[level]);
        }
        ladder
    }

    /// The whole kernel as a series at one block of targets.
    #[inline(always)]
    fn far<S: Simd>(
        &self,
        simd: S,
        series: &TaylorSeries,
        level: usize,
        targets: &Targets,
        block: &Block,
    ) -> [f64; POINTS_PER_BLOCK] {
        let degree = DEGREES[level];
        let table = &self.layer.kernel.table;
        let mut smooth = [[0.0; POINTS_PER_BLOCK]; SLOPE_COUNT];
        match degree + 1 {
            0..=2 => look_up::<2>(table, block, &mut smooth),
            3..=4 => look_up::<4>(table, block, &mut smooth),
            5..=8 => look_up::<8>(table, block, &mut smooth),
            _ => look_up::<SLOPE_COUNT>(table, block, &mut smooth),
        }
        let zero = Lanes::splat(simd, 0.0);
        let mut result = [0.0; POINTS_PER_BLOCK];
        let step = VECTORS_AT_ONCE * S::F64_LANES;
        for first in (0..POINTS_PER_BLOCK).step_by(step) {
            let place = series.place(simd, targets, block.start + first);
            let (mut slopes, mut amplitude) =
                ([[zero; VECTORS_AT_ONCE]; MAX_DEGREE + 1], [zero; VECTORS_AT_ONCE]);
            for k in 0..VECTORS_AT_ONCE {
                let from = first + k * S::F64_LANES;
                let inverse = Lanes::load(simd, &block.inverse, from);
                amplitude[k] = inverse * zero.all(self.layer.constant);
                // by the squared distance in radii: powers of radius / distance and of radius / thickness
                let inverse_rho = zero.all(1.0) / (Lanes::load(simd, &block.distance, from) * inverse);
                let thin = inverse * zero.all(series.ball.radius) * inverse * zero.all(series.ball.radius);
                let far = thin * inverse_rho * inverse_rho;
                let (mut thin_power, mut far_power) = (zero.all(1.0), inverse_rho);
                for n in 0..=degree {
                    let singular = zero.all(INVERSE_SLOPES[n]) * far_power;
                    slopes[n][k] = singular - Lanes::load(simd, &smooth[n], from) * thin_power;
                    thin_power = thin_power * thin;
                    far_power = far_power * far;
                }
            }
            let value = series.evaluate(degree, &place, &slopes);
            for k in 0..VECTORS_AT_ONCE {
                (value[k] * amplitude[k]).store(&mut result, first + k * S::F64_LANES);
            }
        }
        result
    }
}

/// φ(r/h).
struct SmoothPart<'a, S: Simd> {
    table: &'a LayerTable,
    /// 1/h (1/m).
    inverse: Lanes<S>,
}

impl<S: Simd> EdgePotential<S> for SmoothPart<'_, S> {
    #[inline(always)]
    fn at(&self, squared: Lanes<S>) -> Lanes<S> {
        let rho = squared.sqrt() * self.inverse;
        squared.all(0.5) * squared * rho.map(|rho| self.table.mean(rho))
    }
}

/// φ_k at every target of a block.
#[inline(always)]
fn look_up<const N: usize>(
    table: &LayerTable,
    block: &Block,
    smooth: &mut [[f64; POINTS_PER_BLOCK]; SLOPE_COUNT],
) {
    for (i, (distance, inverse)) in block.distance.iter().zip(&block.inverse).enumerate() {
        let slopes = table.smooth_slopes::<N>(distance * inverse);
        for (list, slope) in smooth.iter_mut().zip(slopes) {
            list[i] = slope;
        }
    }
}
