//! Thickness of the soft layer over the bone.

use std::sync::Arc;

use crate::surface::refined::RefinedSurface;

/// Thickness of the elastic layer (m).
///
/// Where it varies, a pair of nodes answers as on a layer of the *smaller* of their two thicknesses. Because
/// the layer's symbol W grows with the thickness at every wave length, that kernel is a sum over thicknesses
/// h' of positive definite kernels, each seen only by nodes with h >= h', and so stays positive definite for
/// any thickness field on a flat surface; a mean of the two would not. Around a whole thin finger it can be
/// indefinite, as the flat kernel then reaches through the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Thickness {
    /// The same everywhere (m), > 0.
    Uniform(f64),
    /// One for each vertex of the surface (m), all > 0.
    PerVertex(Arc<[f64]>),
}

impl Thickness {
    /// Thickness at a vertex (m).
    pub fn at(&self, vertex: usize) -> f64 {
        match self {
            Self::Uniform(h) => *h,
            Self::PerVertex(list) => list[vertex],
        }
    }

    /// The largest thickness (m); 0 of an empty list.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Uniform(h) => *h,
            Self::PerVertex(list) => list.iter().copied().fold(0.0, f64::max),
        }
    }

    /// The same on a refinement of the surface, linear along its edges.
    pub(crate) fn on_refined(&self, mesh: &RefinedSurface) -> Self {
        match self {
            Self::Uniform(h) => Self::Uniform(*h),
            Self::PerVertex(list) => {
                Self::PerVertex(mesh.inherit(|vertex| list[vertex], |a, b| 0.5 * (a + b)).into())
            }
        }
    }

    /// The first value that is not finite and positive.
    pub(crate) fn first_bad(&self) -> Option<f64> {
        let bad = |h: &f64| !(*h > 0.0 && h.is_finite());
        match self {
            Self::Uniform(h) => Some(*h).filter(bad),
            Self::PerVertex(list) => list.iter().copied().find(bad),
        }
    }
}

impl From<f64> for Thickness {
    fn from(thickness: f64) -> Self {
        Self::Uniform(thickness)
    }
}
