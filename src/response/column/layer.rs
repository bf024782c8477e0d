//! One column of the layer's matrix.

use std::sync::Arc;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::half_space::{Scratch, half_space_values};
use crate::response::column::layer_series::{Block, Ladder};
use crate::response::error::ResponseError;
use crate::response::integral::edge_quadrature::EdgePotential;
use crate::response::integral::hat_simd::NearFace;
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::layer_table::{LARGEST, LayerTable};
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::series::taylor::DEGREES;
use crate::response::simd::lanes::Lanes;
use crate::response::simd::points::{BLOCK, Targets, gather};

/// Kernel values below this times the tolerance, relative to K/h, are taken as 0.
pub(crate) const SKIPPED: f64 = 1e-2;
/// The tabulated kernel's own error.
const LEAST_TOLERANCE: f64 = 1e-12;
/// Within this many thicknesses of the real axis the smooth part, singular at ±2i, stays below the bound.
const ROOM: f64 = 1.6;
const BOUND: f64 = 40.0;

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
    pub(crate) fn new(skin: &KernelSkin, options: &AssemblyOptions) -> Result<Self, ResponseError> {
        let kernel = LayerKernel::new(skin.poisson_ratio())?;
        Ok(Self {
            reach: kernel.reach(SKIPPED * options.tolerance),
            constant: skin.kernel_constant(),
            tolerance: options.tolerance.max(LEAST_TOLERANCE),
            kernel,
        })
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
        scratch: &mut Scratch,
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
        scratch.rule.set(half_edge * thinnest, ROOM, BOUND, allowed);
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
    scratch: &'a mut Scratch,
}

impl WithSimd for Prepare<'_> {
    type Output = Ladder;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Ladder {
        self.scratch.fill_series(simd);
        self.column.ladder(&self.scratch.series)
    }
}

struct Sweep<'a> {
    column: LayerColumn<'a>,
    targets: &'a Targets,
    scratch: &'a mut Scratch,
    near: f64,
    ladder: Ladder,
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { column, targets, scratch, near, ladder } = self;
        let layer = column.layer;
        let Scratch { series, values, near: close, .. } = &mut *scratch;
        let (center, radius) = (series.ball.center, series.ball.radius);
        close.index.clear();
        for start in (0..values.len()).step_by(BLOCK) {
            let mut block = Block { start, distance: [0.0; BLOCK], inverse: [0.0; BLOCK] };
            for i in 0..BLOCK {
                let x = Vector3::new(targets.x[start + i], targets.y[start + i], targets.z[start + i]);
                block.distance[i] = (x - center).norm();
                // a pair answers as the thinner of its two
                block.inverse[i] = column.inverse_thickness[start + i].max(column.own_inverse);
            }
            let Block { distance, inverse, .. } = &block;
            let felt = |i: usize| {
                let rho = distance[i] * inverse[i];
                rho - radius * inverse[i] < layer.reach && (rho < LARGEST as f64 || distance[i] < near)
            };
            let mut nearest = f64::INFINITY;
            for i in 0..BLOCK {
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
                for i in (0..BLOCK).filter(|&i| felt(i) && distance[i] >= near) {
                    values[start + i] = far[i];
                }
            }
        }
        column.take_off_smooth(simd, targets, scratch);
    }
}

impl LayerColumn<'_> {
    /// Takes the smooth part off the values of the targets in `scratch.near`.
    #[inline(always)]
    fn take_off_smooth<S: Simd>(&self, simd: S, targets: &Targets, scratch: &mut Scratch) {
        let Scratch { near, values, faces, rule, thicknesses, .. } = scratch;
        near.gather(targets);
        gather(&near.index, self.inverse_thickness, thicknesses);
        let table = self.layer.kernel.table();
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
