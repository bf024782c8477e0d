//! The skin's material and the kernel by which it answers a force.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::thickness::Thickness;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Displacement of the skin at distance r from a unit force; r is the straight-line distance and
/// K = (1-ν)/(2πG) (m²/N).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Kernel {
    /// Elastic half-space, `u(r) = K / r` (Boussinesq; Johnson 1985, §3.2).
    HalfSpace,
    /// The kernel of Xie, Kanai, Date 2011 (eq. 6), which keeps volume by a Gaussian taken off:
    /// `u(r) = K / r - a exp(-r²/2c²)` for r < cutoff, 0 beyond.
    ///
    /// It bulges, so entries can be negative, and it is well posed for some constants alone: without a cutoff for
    /// a <= K √e / c; balanced (no net volume) and cut off at L from about c >= L/2. The paper's constants (a = 0.8 mm/N,
    /// c = 5 mm, cutoff 3 c) are not: a patch wider than some 6 mm can push itself in without end, and the contact
    /// problem then has no solution.
    GaussianCorrected {
        /// a (m/N), >= 0.
        height: f64,
        /// c (m), > 0.
        width: f64,
        /// Distance beyond which the kernel is 0 (m), > 0; may be infinite.
        cutoff: f64,
    },
    /// Elastic layer bonded to rigid bone: [`LayerKernel`](crate::response::LayerKernel). Wide flat tissue such as the
    /// palm; on a fingertip it is too stiff.
    ///
    /// On the open border of a mesh that is coarser than the layer is thick, collocation takes the displacement up to 0.3
    /// thicknesses inside, as there is none right at the jump of the pressure. Where the surface bends within the
    /// layer's reach the straight-line distance goes through the body, and R need not be definite in either
    /// discretization.
    Layer {
        /// Thickness h (m), > 0; an assembly refuses less than 1/1000 of the mesh's mean edge.
        thickness: Thickness,
    },
}

impl Kernel {
    /// For messages.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::HalfSpace => "half-space",
            Self::GaussianCorrected { .. } => "Gaussian-corrected",
            Self::Layer { .. } => "layer",
        }
    }

    fn check(&self) -> Result<(), ResponseError> {
        match self {
            Self::HalfSpace => Ok(()),
            &Self::GaussianCorrected { height, width, cutoff } => {
                let height_ok = height >= 0.0 && height.is_finite();
                require(height_ok, "height", height, "finite and not negative (m/N)")?;
                require(width > 0.0 && width.is_finite(), "width", width, "finite and positive (m)")?;
                require(cutoff > 0.0, "cutoff", cutoff, "positive (m)")
            }
            Self::Layer { thickness } => {
                let bad = thickness.first_bad();
                require(bad.is_none(), "thickness", bad.unwrap_or(0.0), "finite and positive (m)")
            }
        }
    }
}

/// Elastic skin that answers with a kernel: material, kernel, pressure basis and discretization, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct KernelSkin {
    shear_modulus: f64,
    poisson_ratio: f64,
    kernel: Kernel,
    basis: PressureBasis,
    discretization: Discretization,
}

/// A layer is refused where it is thinner than this share of the mesh's mean edge, as its entries would take ever longer.
const THINNEST_LAYER: f64 = 1e-3;
/// A layer's kernel below this times K/h is not felt.
const LAYER_SILENCE: f64 = 1e-8;
/// Shear moduli (Pa) whose compliances, forces and displacements stay numbers.
pub(crate) const SHEAR_MODULI: RangeInclusive<f64> = 1e-60..=1e60;

fn require(ok: bool, name: &'static str, value: f64, expected: &'static str) -> Result<(), ResponseError> {
    if ok { Ok(()) } else { Err(ResponseError::Constant { name, value, expected }) }
}

impl KernelSkin {
    /// A skin with a linear pressure basis and collocation.
    ///
    /// * `shear_modulus`: G (Pa), 1e-60 ..= 1e60
    /// * `poisson_ratio`: ν, 0 ..= 0.5
    /// * `kernel`: the kernel and its constants
    ///
    /// # Errors
    /// [`ResponseError::Constant`] names the constant that is out of range.
    pub fn new(shear_modulus: f64, poisson_ratio: f64, kernel: Kernel) -> Result<Self, ResponseError> {
        let modulus_ok = SHEAR_MODULI.contains(&shear_modulus);
        require(modulus_ok, "shear_modulus", shear_modulus, "finite and positive, from 1e-60 to 1e60 (Pa)")?;
        require((0.0..=0.5).contains(&poisson_ratio), "poisson_ratio", poisson_ratio, "from 0 to 0.5")?;
        kernel.check()?;
        let (basis, discretization) = (PressureBasis::default(), Discretization::default());
        Ok(Self { shear_modulus, poisson_ratio, kernel, basis, discretization })
    }

    /// The same skin with another pressure basis.
    pub fn with_basis(self, basis: PressureBasis) -> Self {
        Self { basis, ..self }
    }

    /// The same skin with another discretization.
    ///
    /// # Errors
    /// [`ResponseError::CollocationOnly`] for the Gaussian-corrected kernel in Galerkin form.
    pub fn with_discretization(self, discretization: Discretization) -> Result<Self, ResponseError> {
        match (&self.kernel, discretization) {
            (Kernel::GaussianCorrected { .. }, Discretization::Galerkin) => {
                Err(ResponseError::CollocationOnly { response: self.kernel.name() })
            }
            _ => Ok(Self { discretization, ..self }),
        }
    }

    /// The same skin on a refinement of its surface; `None` where forces are spread over one-rings, which a finer mesh makes
    /// worse.
    pub(crate) fn on_refined(&self, mesh: &RefinedSurface) -> Option<Self> {
        let kernel = match &self.kernel {
            Kernel::Layer { thickness } => Kernel::Layer { thickness: thickness.on_refined(mesh) },
            other => other.clone(),
        };
        (self.basis == PressureBasis::Linear).then(|| Self { kernel, ..self.clone() })
    }

    /// Thickness of the layer at a vertex (m); `None` of other kernels.
    pub(crate) fn layer_at(&self, vertex: usize) -> Option<f64> {
        match &self.kernel {
            Kernel::Layer { thickness } => Some(thickness.at(vertex)),
            _ => None,
        }
    }

    /// Shear modulus G (Pa).
    pub fn shear_modulus(&self) -> f64 {
        self.shear_modulus
    }

    /// Poisson's ratio ν.
    pub fn poisson_ratio(&self) -> f64 {
        self.poisson_ratio
    }

    /// How the skin answers a force.
    pub fn kernel(&self) -> &Kernel {
        &self.kernel
    }

    /// How a node's force is spread.
    pub fn basis(&self) -> PressureBasis {
        self.basis
    }

    /// How the gap of a node is taken.
    pub fn discretization(&self) -> Discretization {
        self.discretization
    }

    /// Checks what depends on the surface.
    pub(crate) fn check_against(&self, surface: &Surface) -> Result<(), ResponseError> {
        let Kernel::Layer { thickness } = &self.kernel else { return Ok(()) };
        let vertex_count = surface.vertices().len();
        let vertices = match thickness {
            Thickness::Uniform(_) => 0..1,
            Thickness::PerVertex(list) if list.len() != vertex_count => {
                return Err(ResponseError::ThicknessCount { thicknesses: list.len(), vertex_count });
            }
            Thickness::PerVertex(_) => 0..vertex_count,
        };
        let edge_length = surface.mean_edge_length();
        match vertices.into_iter().find(|&vertex| thickness.at(vertex) < THINNEST_LAYER * edge_length) {
            Some(vertex) => {
                let thickness = thickness.at(vertex);
                Err(ResponseError::TooThin { vertex, thickness, edge_length })
            }
            None => Ok(()),
        }
    }

    /// K = (1-ν)/(2πG) (m²/N): the half-space moves by K / r at distance r per newton.
    pub fn kernel_constant(&self) -> f64 {
        (1.0 - self.poisson_ratio) / (TAU * self.shear_modulus)
    }

    /// Distance beyond which a force is not felt (m); `None` where it is felt everywhere.
    pub fn reach(&self) -> Option<f64> {
        match self.kernel {
            Kernel::GaussianCorrected { cutoff, .. } => cutoff.is_finite().then_some(cutoff),
            Kernel::HalfSpace => None,
            Kernel::Layer { ref thickness } => {
                let kernel = LayerKernel::new(self.poisson_ratio).ok()?;
                Some(kernel.reach(LAYER_SILENCE) * thickness.largest())
            }
        }
    }

    /// Whether the response matrix can have negative entries, so that a force can press nodes into contact
    /// that lie outside the obstacle. Where it cannot, the candidates are exactly the penetrating nodes.
    pub fn has_negative_entries(&self) -> bool {
        match self.kernel {
            Kernel::HalfSpace => false,
            Kernel::GaussianCorrected { height, .. } => height > 0.0,
            Kernel::Layer { .. } => true,
        }
    }
}
