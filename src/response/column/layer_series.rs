//! The layer's kernel far from a load, as a series.

use pulp::Simd;

use crate::response::column::layer::LayerColumn;
use crate::response::kernel::layer_table::{INVERSE_SLOPES, LayerTable, SLOPES};
use crate::response::series::point_loads::VECTORS_AT_ONCE;
use crate::response::series::taylor::{DEGREES, MAX_DEGREE, TaylorSeries};
use crate::response::simd::lanes::Lanes;
use crate::response::simd::points::{BLOCK, Targets};

/// Distance (m) from the load's centre at which a series of each of [`DEGREES`] keeps the tolerance, falling.
pub(crate) type Ladder = [f64; DEGREES.len()];

/// A block of targets.
pub(crate) struct Block {
    /// The first of them.
    pub(crate) start: usize,
    /// Distances from the load's centre (m).
    pub(crate) distance: [f64; BLOCK],
    /// 1/thickness of the pairs with the loaded node (1/m).
    pub(crate) inverse: [f64; BLOCK],
}

impl LayerColumn<'_> {
    /// The terms of a series from degree p + 1 on add up to at most `roughness μ_(p+1) q^(p+1) / (1 - q)` of K/r
    /// with q = radius / distance.
    pub(crate) fn ladder(&self, series: &TaylorSeries) -> Ladder {
        let mut ladder = [0.0; DEGREES.len()];
        for level in 0..DEGREES.len() {
            let degree = DEGREES[level];
            let mean = series.means.at(degree + 1);
            let mut ratio = 1.25;
            let keeps = |ratio: f64| {
                let rho = ratio * series.ball.radius * self.own_inverse;
                let rough = self.layer.kernel.table().roughness(level, rho);
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
    pub(crate) fn far<S: Simd>(
        &self,
        simd: S,
        series: &TaylorSeries,
        level: usize,
        targets: &Targets,
        block: &Block,
    ) -> [f64; BLOCK] {
        let degree = DEGREES[level];
        let table = self.layer.kernel.table();
        let mut smooth = [[0.0; BLOCK]; SLOPES];
        match degree + 1 {
            0..=2 => look_up::<2>(table, block, &mut smooth),
            3..=4 => look_up::<4>(table, block, &mut smooth),
            5..=8 => look_up::<8>(table, block, &mut smooth),
            _ => look_up::<SLOPES>(table, block, &mut smooth),
        }
        let zero = Lanes::splat(simd, 0.0);
        let mut result = [0.0; BLOCK];
        let step = VECTORS_AT_ONCE * S::F64_LANES;
        for first in (0..BLOCK).step_by(step) {
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

/// φ_k at every target of a block.
#[inline(always)]
fn look_up<const N: usize>(table: &LayerTable, block: &Block, smooth: &mut [[f64; BLOCK]; SLOPES]) {
    for (i, (distance, inverse)) in block.distance.iter().zip(&block.inverse).enumerate() {
        let slopes = table.smooth_slopes::<N>(distance * inverse);
        for (list, slope) in smooth.iter_mut().zip(slopes) {
            list[i] = slope;
        }
    }
}
