//! One column of any kernel: the load of a node, and what it moves.

use crate::response::column::gaussian::Corrected;
use crate::response::column::half_space::{ColumnScratch, half_space_values, moment_points};
use crate::response::column::layer::PreparedLayer;
use crate::response::column::load::loaded_faces;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::kernel::thickness::Thickness;
use crate::response::simd::points::Targets;
use crate::surface::checked::Surface;

/// What all columns of a matrix share.
pub(crate) struct KernelColumns<'a> {
    surface: &'a Surface,
    skin: &'a KernelSkin,
    tolerance: f64,
    pub(crate) layer: Option<(PreparedLayer, &'a Thickness)>,
}

impl<'a> KernelColumns<'a> {
    pub(crate) fn new(surface: &'a Surface, skin: &'a KernelSkin, tolerance: f64) -> Self {
        let layer = match skin.kernel() {
            Kernel::Layer { thickness } => Some((PreparedLayer::new(skin, tolerance), thickness)),
            _ => None,
        };
        Self { surface, skin, tolerance, layer }
    }

    /// Sets `scratch.values` to the displacement (m) of the targets per newton at `vertex`.
    pub(crate) fn fill(&self, scratch: &mut ColumnScratch, targets: &Targets, vertex: usize) {
        let (constant, tolerance) = (self.skin.kernel_constant(), self.tolerance);
        scratch.faces.clear();
        loaded_faces(self.surface, vertex, self.skin.basis(), &mut scratch.faces);
        match (&self.layer, self.skin.kernel()) {
            (Some((layer, thickness)), _) => {
                layer.values(targets, scratch, thickness.at(vertex));
            }
            (None, &Kernel::GaussianCorrected { height, width, cutoff }) => {
                Corrected { constant, height, cutoff, width }.values(targets, scratch, tolerance);
            }
            _ => {
                let points = moment_points(tolerance);
                half_space_values(targets, scratch, constant, tolerance, f64::INFINITY, points);
            }
        }
    }

    /// [`fill`](Self::fill) of the smooth part of a layer's kernel alone, after that for the same vertex.
    pub(crate) fn fill_smooth(&self, scratch: &mut ColumnScratch, targets: &Targets, vertex: usize) {
        let (layer, thickness) = self.layer.as_ref().expect("a layer");
        scratch.values.clear();
        scratch.values.resize(targets.points.len(), 0.0);
        layer.take_off_smooth(targets, scratch, thickness.at(vertex));
    }
}
