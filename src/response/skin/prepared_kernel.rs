//! A kernel's matrix, computed once.

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::error::ResponseError;
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::collocation::assemble;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::given_matrix::GivenMatrix;
use crate::response::skin::nodes::PreparedNodes;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// R of a kernel over chosen nodes; it moves with the surface and serves every product.
#[derive(Debug, Clone)]
pub struct PreparedKernel {
    skin: KernelSkin,
    given: GivenMatrix,
}

impl PreparedKernel {
    /// Computes the response matrix over `nodes`.
    ///
    /// # Errors
    /// As [`assemble`].
    pub fn new(
        surface: &Surface,
        skin: &KernelSkin,
        nodes: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let matrix = assemble(surface, skin, nodes, options)?;
        Self::from_matrix(surface, skin.clone(), nodes, matrix)
    }

    /// Takes a response matrix (k × k, m/N) that was computed before.
    ///
    /// # Errors
    /// As [`GivenMatrix::new`].
    pub fn from_matrix(
        surface: &Surface,
        skin: KernelSkin,
        nodes: &[usize],
        matrix: Mat<f64>,
    ) -> Result<Self, ResponseError> {
        Ok(Self { skin, given: GivenMatrix::new(surface, nodes, matrix)? })
    }

    /// The kernel that it was computed from.
    pub fn kernel(&self) -> &KernelSkin {
        &self.skin
    }

    /// R (k × k, m/N).
    pub fn response_matrix(&self) -> &Mat<f64> {
        self.given.response_matrix()
    }

    /// Vertices whose response is known.
    pub fn nodes(&self) -> &PreparedNodes {
        self.given.nodes()
    }

    /// The same after a rigid motion of the surface.
    pub fn moved(&self, motion: &Isometry3<f64>) -> Self {
        Self { given: self.given.moved(motion), ..self.clone() }
    }
}

impl ElasticSkin for PreparedKernel {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.nodes().check_surface(surface)?;
        self.skin.traits(surface)
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.given.is_prepared(vertex)
    }

    fn kernel_at(&self, _: usize) -> Option<&KernelSkin> {
        Some(&self.skin)
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        self.skin.refined(mesh)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        self.given.matrix(asked, directions)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        self.nodes().rows(asked.nodes)?;
        self.skin.displace(asked, forces, vertices)
    }
}
