//! 3 × 3 blocks that somebody else computed or measured.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Matrix3, Vector3};

use crate::response::body::check::parts::check_counts;
use crate::response::body::compliance::{BodyCompliance, BodyParts};
use crate::response::error::ResponseError;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::misfit::{misfit, misfit_of_axes};
use crate::response::skin::nodes::PreparedNodes;
use crate::surface::checked::Surface;

/// Displacements of some vertices per force on them in any direction, which turn with the surface. Other vertices stay where
/// they are.
#[derive(Debug, Clone)]
pub struct GivenBlocks {
    /// Among the nodes alone, by their rows.
    compliance: BodyCompliance,
    nodes: PreparedNodes,
    misfit: Option<Arc<str>>,
}

impl GivenBlocks {
    /// * `nodes`: (k,) vertices, in the order of the blocks
    /// * `blocks`: (3 k × 3 k, m/N), finite: entry (3 i + a, 3 j + b) is the displacement of node i along a per newton at
    ///   node j along b, before the rotation
    /// * `rotation`: how the surface has turned since
    /// * `shear_modulus`, `poisson_ratio`: of the skin (Pa, 1)
    ///
    /// # Errors
    /// [`ResponseError::Nodes`]; [`ResponseError::Body`] of blocks that do not fit the nodes or are not finite, and of what
    /// is no rotation.
    pub fn new(
        surface: &Surface,
        nodes: &[usize],
        blocks: Mat<f64>,
        rotation: Matrix3<f64>,
        [shear_modulus, poisson_ratio]: [f64; 2],
    ) -> Result<Self, ResponseError> {
        let nodes = PreparedNodes::new(surface, nodes)?;
        let count = nodes.list().len();
        check_counts(&[("displacement rows", blocks.nrows(), 3 * count)])?;
        let compliance = BodyCompliance::from_parts(BodyParts {
            nodes: (0..count).collect(),
            displacement: blocks,
            bone_pressure: None,
            rotation,
            shear_modulus,
            poisson_ratio,
        })?;
        let in_the_mean = |i: usize, j: usize| compliance.block(i, j).trace() / 3.0;
        let of_axes = || misfit_of_axes(&nodes, |i, j| compliance.block(i, j));
        let misfit = misfit(&nodes, in_the_mean).or_else(of_axes).map(Arc::from);
        Ok(Self { compliance, nodes, misfit })
    }

    /// The blocks by the rows of the nodes, as they were given, and how they have turned since.
    pub fn compliance(&self) -> &BodyCompliance {
        &self.compliance
    }

    /// Vertices whose response is known.
    pub fn nodes(&self) -> &PreparedNodes {
        &self.nodes
    }

    /// The same after a rigid motion of the surface.
    ///
    /// # Errors
    /// [`ResponseError::Body`] if the blocks refuse the rotation.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let rotation = motion.rotation.to_rotation_matrix();
        let compliance = self.compliance.moved(rotation.matrix())?;
        Ok(Self { compliance, nodes: self.nodes.moved(motion), misfit: self.misfit.clone() })
    }
}

impl ElasticSkin for GivenBlocks {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.nodes.check_surface(surface)?;
        Ok(Traits::of_matrix(true, false))
    }

    fn misfit(&self) -> Option<&str> {
        self.misfit.as_deref()
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.nodes.row(vertex).is_some()
    }

    fn shear_modulus_at(&self, _: usize) -> Option<f64> {
        Some(self.compliance.parts().shear_modulus)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let rows = self.nodes.checked_rows(asked.nodes, directions)?;
        Ok(self.compliance.response_among(&rows, directions))
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let loaded = self.nodes.rows(asked.nodes)?;
        let of_rows = |rows: &[usize]| self.compliance.displacements_among(rows, &loaded, forces);
        Ok(self.nodes.moved_alone(vertices, of_rows))
    }
}
