//! A body solved once for unit forces at chosen nodes.

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::body::compliance::BodyCompliance;
use crate::response::body::solve::{Body, BodyOptions};
use crate::response::error::ResponseError;
use crate::response::skin::elastic::{Displacements, ElasticSkin, Request, Traits};
use crate::response::skin::nodes::PreparedNodes;
use crate::surface::checked::Surface;

/// The compliance of a body, solved here or given as 3 × 3 blocks; it turns with the surface and serves every product.
#[derive(Debug, Clone)]
pub struct PreparedBody {
    compliance: BodyCompliance,
    nodes: PreparedNodes,
}

impl PreparedBody {
    /// Solves `body` for unit forces at `nodes`.
    ///
    /// # Errors
    /// [`ResponseError::Body`] as [`Body::prepare`].
    pub fn new(
        surface: &Surface,
        body: &Body,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<Self, ResponseError> {
        let compliance = body.prepare(surface, shear_modulus, poisson_ratio, nodes, options)?;
        Self::from_compliance(surface, nodes, compliance)
    }

    /// Takes a compliance that was computed or measured before; vertices that it keeps at rest stay.
    ///
    /// # Errors
    /// [`ResponseError::NodeOutOfRange`], [`ResponseError::RepeatedNode`].
    pub fn from_compliance(
        surface: &Surface,
        nodes: &[usize],
        compliance: BodyCompliance,
    ) -> Result<Self, ResponseError> {
        Ok(Self { compliance, nodes: PreparedNodes::new(surface, nodes)? })
    }

    /// Displacement of the whole skin per unit force at the nodes.
    pub fn compliance(&self) -> &BodyCompliance {
        &self.compliance
    }

    /// Vertices whose response is known.
    pub fn nodes(&self) -> &PreparedNodes {
        &self.nodes
    }

    /// The same body after a rigid motion of its surface.
    ///
    /// # Errors
    /// [`ResponseError::Body`] if the compliance refuses the rotation.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let compliance = self.compliance.moved(motion.rotation.to_rotation_matrix().matrix())?;
        Ok(Self { compliance, nodes: self.nodes.moved(motion) })
    }

    /// Pressure (Pa) on every vertex of the bone under a force (N) at every vertex of the surface; `None` if the
    /// body was not asked for it.
    ///
    /// # Errors
    /// [`ResponseError::ForceCount`]; [`ResponseError::NotPrepared`] for a force where the response is not known.
    pub fn bone_pressures(&self, forces: &[Vector3<f64>]) -> Result<Option<Vec<f64>>, ResponseError> {
        let (found, expected) = (forces.len(), self.nodes.vertices().len());
        if found != expected {
            return Err(ResponseError::ForceCount { found, expected });
        }
        let loaded: Vec<usize> = (0..found).filter(|&vertex| forces[vertex] != Vector3::zeros()).collect();
        self.nodes.rows(&loaded)?;
        let at_nodes: Vec<Vector3<f64>> = self.nodes.list().iter().map(|&vertex| forces[vertex]).collect();
        Ok(self.compliance.bone_pressures(&at_nodes)?)
    }
}

impl ElasticSkin for PreparedBody {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.nodes.check_surface(surface)?;
        Ok(Traits::of_matrix(true))
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.nodes.row(vertex).is_some()
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let rows = self.nodes.checked_rows(asked.nodes, directions)?;
        Ok(self.compliance.response_among(&rows, directions)?)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Displacements, ResponseError> {
        let rows = self.nodes.rows(asked.nodes)?;
        let mut at_nodes = vec![Vector3::zeros(); self.nodes.list().len()];
        rows.iter().zip(forces).for_each(|(&row, force)| at_nodes[row] = *force);
        let moved = self.compliance.displacements(&at_nodes)?;
        let vectors = vertices.iter().map(|&vertex| moved[vertex]).collect();
        Ok(Displacements { vectors, along_normal: vec![None; vertices.len()] })
    }
}
