//! What an elastic product is made of.

use faer::Mat;

use crate::response::error::ResponseError;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::kernel::thickness::Thickness;
use crate::response::skin::elastic::{ElasticSkin, Traits};
use crate::response::skin::given_matrix::GivenMatrix;
use crate::surface::checked::Surface;

/// How a product answers a force.
#[derive(Debug, Clone)]
pub enum ProductResponse {
    /// By a kernel, taken at the contact's nodes with the skin's pressure basis and discretization.
    Kernel(Kernel),
    /// By a matrix that somebody else computed or measured, linear over the triangles in between.
    Matrix {
        /// Vertices (k,) of the product's mesh, in the order of the rows.
        nodes: Vec<usize>,
        /// Displacement along the force per newton (k × k, m/N).
        matrix: Mat<f64>,
    },
}

/// Elastic constants of a product and its response, checked.
#[derive(Debug, Clone)]
pub struct Material {
    shear_modulus: f64,
    poisson_ratio: f64,
    pub(crate) response: CheckedResponse,
}

/// [`ProductResponse`], checked.
#[derive(Debug, Clone)]
pub(crate) enum CheckedResponse {
    Kernel(KernelSkin),
    /// Its nodes lie on the product's mesh.
    Matrix(GivenMatrix),
}

impl Material {
    /// Checks constants and response.
    ///
    /// * `mesh`: of the product; `None` of a primitive
    ///
    /// # Errors
    /// As [`Obstacle::with_material`](crate::obstacle::Obstacle::with_material).
    pub(super) fn new(
        [shear_modulus, poisson_ratio]: [f64; 2],
        response: ProductResponse,
        mesh: impl FnOnce() -> Option<Surface>,
    ) -> Result<Self, ResponseError> {
        let of_kernel = |kernel| KernelSkin::new(shear_modulus, poisson_ratio, kernel);
        let response = match response {
            ProductResponse::Kernel(Kernel::Layer { thickness: Thickness::PerVertex(_) }) => {
                let what = "a layer of the product has one thickness everywhere";
                return Err(ResponseError::Product { what });
            }
            ProductResponse::Kernel(kernel) => CheckedResponse::Kernel(of_kernel(kernel)?),
            ProductResponse::Matrix { nodes, matrix } => {
                of_kernel(Kernel::HalfSpace)?;
                let Some(mesh) = mesh() else {
                    let what = "a given matrix is known at the vertices of the product's mesh, and a primitive has none: take a kernel, or a mesh";
                    return Err(ResponseError::Product { what });
                };
                CheckedResponse::Matrix(GivenMatrix::new(&mesh, &nodes, matrix)?)
            }
        };
        Ok(Self { shear_modulus, poisson_ratio, response })
    }

    /// Shear modulus G (Pa).
    pub fn shear_modulus(&self) -> f64 {
        self.shear_modulus
    }

    /// Poisson's ratio ν.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// The kernel with its constants; `None` of a given matrix.
    pub fn kernel(&self) -> Option<&KernelSkin> {
        match &self.response {
            CheckedResponse::Kernel(kernel) => Some(kernel),
            CheckedResponse::Matrix(_) => None,
        }
    }

    /// What speaks against a given matrix, in words that follow its name.
    pub(crate) fn misfit(&self) -> Option<&str> {
        match &self.response {
            CheckedResponse::Kernel(_) => None,
            CheckedResponse::Matrix(given) => given.misfit(),
        }
    }
}

impl Traits {
    /// Of a skin together with the product that it meets.
    pub(crate) fn with_product(self, material: Option<&Material>) -> Self {
        let Some(material) = material else { return self };
        let (negative_entries, reach) = match &material.response {
            CheckedResponse::Kernel(kernel) => (kernel.has_negative_entries(), kernel.reach()),
            CheckedResponse::Matrix(given) => (given.has_negative_entries(), None),
        };
        Self {
            negative_entries: self.negative_entries || negative_entries,
            reach: self.reach.zip(reach).map(|(skin, product)| skin.max(product)),
            ..self
        }
    }
}
