//! One column of the layer's matrix.

use super::column::{Scratch, half_space_values, spread_load, spread_load_finely};
use super::error::ResponseError;
use super::layer::LayerKernel;
use super::multipole::PointLoads;
use super::options::AssemblyOptions;
use super::skin::Skin;
use super::targets::{BLOCK, Targets};
use super::thickness::Thickness;
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use std::sync::Arc;

/// Kernel values below this times the tolerance, relative to K/h, are taken as 0.
pub(crate) const SKIPPED: f64 = 1e-2;

/// Most pieces that an edge is divided into; enough for a layer of 1/50 of an edge at 1e-9.
const MOST_PIECES: usize = 64;

/// What all columns of a layer's matrix share.
#[derive(Debug)]
pub(crate) struct PreparedLayer {
    kernel: Arc<LayerKernel>,
    constant: f64,
    inverse_thickness: Vec<f64>,
    largest_inverse: f64,
    reach: f64,
    tolerance: f64,
}

impl PreparedLayer {
    pub(crate) fn new(
        skin: &Skin,
        thickness: &Thickness,
        rows: &[usize],
        targets: &Targets,
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let kernel = LayerKernel::new(skin.poisson_ratio)?;
        let mut inverse: Vec<f64> =
            targets.rows.iter().map(|&row| 1.0 / thickness.at(rows[row as usize])).collect();
        if let Some(&last) = inverse.last() {
            inverse.resize(targets.x.len(), last);
        }
        Ok(Self {
            reach: kernel.reach(SKIPPED * options.tolerance),
            constant: skin.kernel_constant(),
            largest_inverse: inverse.iter().copied().fold(0.0, f64::max),
            inverse_thickness: inverse,
            tolerance: options.tolerance,
            kernel,
        })
    }

    pub(crate) fn column(&self, own_thickness: f64) -> LayerColumn<'_> {
        LayerColumn {
            kernel: &self.kernel,
            constant: self.constant,
            inverse_thickness: &self.inverse_thickness,
            largest_inverse: self.largest_inverse,
            own_inverse: 1.0 / own_thickness,
            reach: self.reach,
            tolerance: self.tolerance,
        }
    }
}

/// A layer at the node of one column.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LayerColumn<'a> {
    pub(crate) kernel: &'a LayerKernel,
    /// K (m²/N).
    pub(crate) constant: f64,
    /// 1/thickness of each target, in the order of the targets (1/m).
    pub(crate) inverse_thickness: &'a [f64],
    /// Largest of them.
    pub(crate) largest_inverse: f64,
    /// 1/thickness at the loaded node (1/m).
    pub(crate) own_inverse: f64,
    /// r/h beyond which the kernel is taken as 0.
    pub(crate) reach: f64,
    /// Relative to the 1/r part.
    pub(crate) tolerance: f64,
}

/// Which targets a pass sets, by their distance from the load's centre, and how.
#[derive(Debug, Clone, Copy)]
struct Pass {
    from: f64,
    to: f64,
    /// Whether the exact 1/r part is already there and only the smooth part is taken off.
    split: bool,
}

impl LayerColumn<'_> {
    /// Sets `scratch.values` to the displacement of all targets by the load on `scratch.faces`.
    ///
    /// Near the load: the exact 1/r part less the smooth part by quadrature. From four radii on: the whole
    /// kernel by quadrature, which keeps its relative accuracy where the two parts cancel.
    pub(crate) fn values(&self, targets: &Targets, scratch: &mut Scratch) {
        let radius = scratch.load_radius();
        half_space_values(targets, scratch, self.constant, self.tolerance, 4.0 * radius);
        let face_radius = scratch.faces.iter().map(|f| f.radius).fold(0.0, f64::max);
        let farthest = self.reach / self.own_inverse + radius;
        let allowed = self.tolerance.max(1e-12);
        // No target's thickness exceeds the node's own in its pair, so the largest inverse rules the smooth part.
        let thinnest = self.own_inverse.max(self.largest_inverse);
        let (pieces, n) = self.smooth_rule(face_radius * thinnest, allowed);
        spread_load_finely(scratch, n, pieces);
        self.run(targets, scratch, Pass { from: 0.0, to: 4.0 * radius, split: true });
        for (from, to) in [(4.0, 8.0), (8.0, f64::INFINITY)] {
            let pass = Pass { from: from * radius, to: to * radius, split: false };
            if pass.from >= farthest {
                self.run(targets, scratch, pass); // sets zeros only
                continue;
            }
            // 1/r over a triangle of half-width s at distance D: the best polynomial errs by (s / 2D)^2n of it
            let ratio: f64 = 0.5 * face_radius / ((from - 1.0) * radius);
            let singular = ((0.25 * allowed).ln() / (2.0 * ratio.ln())).ceil().max(1.0) as usize;
            // The smooth part matters only where the layer is thick enough to feel the load there.
            let thinnest = thinnest.min(self.reach / ((from - 1.0) * radius)).max(self.own_inverse);
            let (pieces, smooth) = self.smooth_rule(face_radius * thinnest, allowed);
            spread_load_finely(scratch, smooth.max(singular), pieces);
            self.run(targets, scratch, pass);
        }
        spread_load(scratch, 1, 1);
    }

    /// Pieces along each edge and points in each direction with which the smooth part is within `allowed`.
    fn smooth_rule(&self, half_width: f64, allowed: f64) -> (usize, usize) {
        let relative = allowed / self.reach;
        let mut best = (MOST_PIECES, LayerKernel::MOST_POINTS);
        for pieces in (1..=4).chain((6..=MOST_PIECES).step_by(2)) {
            let fine = |n: &usize| self.kernel.rule_error(*n, half_width / pieces as f64) <= relative;
            if let Some(n) = (1..=LayerKernel::MOST_POINTS).find(fine)
                && pieces * n < best.0 * best.1
            {
                best = (pieces, n);
            }
        }
        best
    }

    fn run(&self, targets: &Targets, scratch: &mut Scratch, pass: Pass) {
        pulp::Arch::new().dispatch(Sweep { column: self, targets, scratch, pass });
    }

    /// The kernel (split: its smooth part alone) summed over the loads, for one block of targets.
    #[inline(always)]
    fn sum(&self, loads: &PointLoads, split: bool, at: [&[f64]; 3], inverse: &[f64; BLOCK]) -> [f64; BLOCK] {
        let [x, y, z] = at.map(|list| &list[..BLOCK]);
        let mut sum = [0.0; BLOCK];
        for (k, &share) in loads.share.iter().enumerate() {
            let (px, py, pz) = (loads.x[k], loads.y[k], loads.z[k]);
            // distances in vectors first, then the table lookups one by one
            let mut rho = [0.0; BLOCK];
            for i in 0..BLOCK {
                let (dx, dy, dz) = (x[i] - px, y[i] - py, z[i] - pz);
                rho[i] = (dx * dx + dy * dy + dz * dz).sqrt() * inverse[i];
            }
            for i in 0..BLOCK {
                let smooth = self.kernel.smooth_part(rho[i]);
                sum[i] += share * if split { smooth } else { 1.0 / rho[i] - smooth };
            }
        }
        sum
    }
}

struct Sweep<'a> {
    column: &'a LayerColumn<'a>,
    targets: &'a Targets,
    scratch: &'a mut Scratch,
    pass: Pass,
}

impl WithSimd for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) {
        let Self { column, targets, scratch, pass } = self;
        let (center, radius) = scratch.ball();
        let (loads, values) = scratch.loads_and_values();
        for start in (0..values.len()).step_by(BLOCK) {
            let block = start..start + BLOCK;
            let [x, y, z] = [&targets.x, &targets.y, &targets.z].map(|list| &list[block.clone()]);
            let distance: [f64; BLOCK] =
                std::array::from_fn(|i| (Vector3::new(x[i], y[i], z[i]) - center).norm());
            let inverse: [f64; BLOCK] =
                std::array::from_fn(|i| column.inverse_thickness[start + i].max(column.own_inverse));
            let felt = |i: usize| (distance[i] - radius) * inverse[i] < column.reach;
            let mine = |i: usize| distance[i] >= pass.from && distance[i] < pass.to;
            if !(0..BLOCK).any(mine) {
                continue;
            }
            let any_felt = (0..BLOCK).any(|i| mine(i) && felt(i));
            let sum =
                if any_felt { column.sum(loads, pass.split, [x, y, z], &inverse) } else { [0.0; BLOCK] };
            for i in (0..BLOCK).filter(|&i| mine(i)) {
                let value = &mut values[start + i];
                let kernel = column.constant * inverse[i] * sum[i];
                *value = match (felt(i), pass.split) {
                    (false, _) => 0.0,
                    (true, true) => *value - kernel,
                    (true, false) => kernel,
                };
            }
        }
    }
}
