//! A body solved on the skin's own mesh.

use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;

use crate::response::body::compliance::BodyCompliance;
use crate::response::body::levels::gathered::Gathered;
use crate::response::body::levels::near::NearKernel;
use crate::response::body::levels::on_mesh::NearAndFar;
use crate::response::body::levels::remainder::Remainder;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::matrix::kept_block::KeptBlock;
use crate::response::skin::elastic::Request;
use crate::surface::checked::Surface;

/// A body solved on the skin's own mesh, and what a refinement of that mesh needs beside it.
#[derive(Debug, Clone)]
pub struct OneLevel {
    /// Displacement of the whole skin per unit force at the nodes.
    pub compliance: BodyCompliance,
    /// Thickness of the tissue at each vertex of the skin (n, m); `None` where nothing is behind it.
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

    /// On the skin's own mesh, which is the coarse mesh as well.
    ///
    /// * `skin`: the skin where it stands now
    pub(crate) fn near_and_far(
        &self,
        skin: &Surface,
        discretization: Discretization,
    ) -> Result<NearAndFar, ResponseError> {
        let near = self.near()?;
        let vertices = 0..skin.vertices().len();
        let weights = vertices.clone().map(|vertex| Some(vec![(vertex as u32, 1.0)])).collect();
        let fixed = vertices.map(|vertex| self.is_still(vertex)).collect();
        let to_take_off = Some((skin.clone(), near.clone()));
        let remainder = Remainder::new(&self.compliance, to_take_off, Gathered::default());
        Ok(NearAndFar::new(remainder, weights, fixed, near, discretization))
    }
}
