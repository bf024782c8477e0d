//! A body solved on the skin's own mesh.

use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;

use crate::response::body::compliance::BodyCompliance;
use crate::response::body::levels::coarseness::Coarseness;
use crate::response::body::levels::gathered::Gathered;
use crate::response::body::levels::near::NearKernel;
use crate::response::body::levels::on_mesh::{BodyOnMesh, NearAndFar, joined};
use crate::response::body::levels::remainder::Remainder;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::matrix::kept_block::KeptBlock;
use crate::response::skin::elastic::Request;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// A body solved on the skin's own mesh, and what a refinement of that mesh needs beside it.
#[derive(Debug, Clone)]
pub struct OneLevel {
    /// Displacement of the whole skin per unit force at the nodes.
    pub compliance: BodyCompliance,
    /// Thickness of the tissue at each vertex of the skin (n, m); `None` without bone.
    pub thickness: Option<Arc<[f64]>>,
}

impl OneLevel {
    /// Whether a vertex does not move with the body: what one force does not move is held.
    pub(crate) fn is_still(&self, vertex: usize) -> bool {
        let moved = self.compliance.parts().displacement.subcols(0, 3);
        (0..9).all(|k| moved[(3 * vertex + k % 3, k / 3)] == 0.0)
    }

    fn near(&self) -> Result<NearKernel, ResponseError> {
        let parts = self.compliance.parts();
        NearKernel::new(parts.shear_modulus, parts.poisson_ratio, self.thickness.clone())
    }

    /// What averaging its near kernel against the nodes' pressures adds to R over the nodes along `directions` (k × k, m/N).
    pub(crate) fn averaging(
        &self,
        asked: &Request,
        directions: &[Vector3<f64>],
    ) -> Result<Mat<f64>, ResponseError> {
        let near = self.near()?;
        let along = |discretization| near.along(asked, directions, discretization, &KeptBlock::default());
        Ok(along(Discretization::Galerkin)? - along(Discretization::Collocation)?)
    }

    /// On a refinement of the skin, or of a skin that this one is a part of: the skin itself is the coarse mesh.
    ///
    /// * `skin`: the skin where it stands now
    /// * `own`: its vertex for a given vertex
    pub(crate) fn on_refined(
        &self,
        skin: &Surface,
        mesh: &RefinedSurface,
        own: impl Fn(usize) -> Option<usize>,
        discretization: Discretization,
        coarseness: Coarseness,
    ) -> Result<BodyOnMesh, ResponseError> {
        let near = self.near()?;
        let weights = |vertex| own(vertex).map(|own| vec![(own as u32, 1.0)]);
        let response = NearAndFar {
            weights: mesh.inherit(weights, joined).into(),
            fixed: mesh
                .inherit(|vertex| own(vertex).is_none_or(|own| self.is_still(own)), |a, b| *a && *b)
                .into(),
            near: near.on_refined(mesh, own)?,
            discretization,
            kept: KeptBlock::default(),
            averaged: KeptBlock::default(),
            remainder: Remainder::new(&self.compliance, Some((skin.clone(), near)), Gathered::default()),
        };
        Ok(BodyOnMesh { response, coarseness })
    }
}
