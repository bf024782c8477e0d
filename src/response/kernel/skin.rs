//! The skin's material and the kernel by which it answers a force.

use std::f64::consts::TAU;

use crate::response::error::ResponseError;
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::thickness::Thickness;
use crate::surface::checked::Surface;

/// How the force of a node is spread over the surface around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pressure {
    /// Hat functions: the pressure is linear over each triangle and equals f / S at the node. Accurate and
    /// well conditioned (condition number some 50 in a Hertz contact): the one to take.
    #[default]
    Linear,
    /// The force spread evenly over the one-ring (eq. 8 of Xie, Kanai, Date 2011). Kept to reproduce that
    /// paper: on regular meshes the matrix is close to singular and the pressure oscillates.
    OneRing,
}

/// How the gap of a node is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Gap {
    /// At the node (collocation). No penetration is left at vertices; R is not symmetric and, on badly shaped
    /// meshes, not always positive definite.
    #[default]
    Node,
    /// Averaged against the node's pressure (Galerkin), `R_ij = ∫∫ p_i(x) k(|x - y|) p_j(y) dA dA`. R is
    /// symmetric; positive definite on any surface for the half-space, as 1/r is an energy, and on any flat one
    /// for the layer. It costs some 30 times as much (a layer's more, up to 100 times where it is thinner than the mesh); a
    /// vertex may keep a penetration of the order of the mesh error. Initial gaps are to be averaged likewise:
    /// [`pressure_average`](crate::response::pressure_average). At 4 cells per contact radius Hertz's force is then right
    /// to 0.2 % (gaps at nodes: 0.7 %), at 8 to 0.03 % (0.2 %); a contact recovers peak pressure and contact area
    /// to match.
    Weighted,
}

/// Displacement of the skin at distance r from a unit force; r is the straight-line distance and
/// K = (1-ν)/(2πG) (m²/N).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Response {
    /// Elastic half-space, `u(r) = K / r` (Boussinesq; Johnson 1985, §3.2).
    HalfSpace {
        /// How a node's force is spread.
        pressure: Pressure,
        /// How the gap is measured.
        gap: Gap,
    },
    /// The kernel of Xie, Kanai, Date 2011 (eq. 6), which keeps volume by a Gaussian taken off:
    /// `u(r) = K / r - a exp(-r²/2c²)` for r < cutoff, 0 beyond.
    ///
    /// It bulges, so entries can be negative, and it is well posed only for some constants: without a cutoff
    /// for a <= K √e / c; balanced (no net volume) and cut off at L from about c >= L/2. The paper's
    /// constants (a = 0.8 mm/N, c = 5 mm, cutoff 3 c) are not: a patch wider than some 6 mm can push itself in
    /// without end, and the contact problem then has no solution.
    GaussianCorrected {
        /// a (m/N), >= 0.
        height: f64,
        /// c (m), > 0.
        width: f64,
        /// Distance beyond which the kernel is 0 (m), > 0; may be infinite.
        cutoff: f64,
        /// How a node's force is spread.
        pressure: Pressure,
    },
    /// Elastic layer bonded to rigid bone: [`LayerKernel`](crate::response::LayerKernel). Wide flat tissue such as the
    /// palm; on a fingertip it is too stiff, up to twice the true force.
    ///
    /// A sphere on a flat layer (`d/R = 0.0025`, 16 cells per √(R d), ν = 0.5) needs the known force to 0.13, 0.18
    /// and 0.21 % at χ = √(R d)/h = 0.3, 0.5 and 0.7.
    ///
    /// On flat meshes the node form is positive definite for any ν and thickness (tried from 0.1 to 100 mesh
    /// sizes, borders included), but for irregular meshes of a thousand nodes and more under an incompressible layer
    /// of a tenth of the mesh size: -3e-5 of the largest eigenvalue with vertices moved by 0.3 cells, where the
    /// weighted form is definite. On the open border of a mesh that is coarser than the layer is thick, it looks at
    /// the displacement up to 0.3 thicknesses inside, as right at the jump of the pressure there is none. Where the
    /// surface bends within the layer's reach the straight-line distance goes through the body and neither form
    /// has to be definite: 800 nodes around a fingertip under 1 mm, ν = 0.5, have -0.1 % (node) and -0.3 % (weighted).
    Layer {
        /// Thickness h (m), > 0; an assembly refuses less than 1/1000 of the mesh's mean edge.
        thickness: Thickness,
        /// How a node's force is spread.
        pressure: Pressure,
        /// How the gap is measured.
        gap: Gap,
    },
}

/// Elastic skin: material and response.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Skin {
    /// Shear modulus G (Pa), > 0.
    pub shear_modulus: f64,
    /// Poisson's ratio ν, in 0 ..= 0.5.
    pub poisson_ratio: f64,
    /// How the skin answers a force.
    pub response: Response,
}

/// A layer is refused where it is thinner than this share of the mesh's mean edge, as its entries would take ever longer.
const THINNEST: f64 = 1e-3;
/// A layer's kernel below this times K/h is not felt.
const LAYER_SILENCE: f64 = 1e-8;

fn require(ok: bool, name: &'static str, value: f64, expected: &'static str) -> Result<(), ResponseError> {
    if ok { Ok(()) } else { Err(ResponseError::Constant { name, value, expected }) }
}

impl Skin {
    /// A skin with checked constants.
    ///
    /// * `shear_modulus`: G (Pa), finite, > 0
    /// * `poisson_ratio`: ν, 0 ..= 0.5
    /// * `response`: the kernel and its constants
    ///
    /// # Errors
    /// [`ResponseError::Constant`] names the constant that is out of range.
    pub fn new(shear_modulus: f64, poisson_ratio: f64, response: Response) -> Result<Self, ResponseError> {
        let skin = Self { shear_modulus, poisson_ratio, response };
        skin.validate()?;
        Ok(skin)
    }

    /// Checks all constants again; the fields are open.
    pub(crate) fn validate(&self) -> Result<(), ResponseError> {
        let (g, nu) = (self.shear_modulus, self.poisson_ratio);
        require(g > 0.0 && g.is_finite(), "shear_modulus", g, "finite and positive (Pa)")?;
        require((0.0..=0.5).contains(&nu), "poisson_ratio", nu, "from 0 to 0.5")?;
        match &self.response {
            Response::HalfSpace { .. } => Ok(()),
            &Response::GaussianCorrected { height, width, cutoff, .. } => {
                let height_ok = height >= 0.0 && height.is_finite();
                require(height_ok, "height", height, "finite and not negative (m/N)")?;
                require(width > 0.0 && width.is_finite(), "width", width, "finite and positive (m)")?;
                require(cutoff > 0.0, "cutoff", cutoff, "positive (m)")
            }
            Response::Layer { thickness, .. } => {
                let bad = thickness.first_bad();
                require(bad.is_none(), "thickness", bad.unwrap_or(0.0), "finite and positive (m)")
            }
        }
    }

    /// Checks what depends on the surface.
    pub(crate) fn check_against(&self, surface: &Surface) -> Result<(), ResponseError> {
        let vertex_count = surface.vertices().len();
        match &self.response {
            Response::Layer { thickness: Thickness::PerVertex(list), .. } if list.len() != vertex_count => {
                Err(ResponseError::ThicknessCount { thicknesses: list.len(), vertex_count })
            }
            Response::Layer { thickness, .. } => {
                let edge_length = surface.mean_edge_length();
                let vertices = match thickness {
                    Thickness::Uniform(_) => 0..1,
                    Thickness::PerVertex(_) => 0..vertex_count,
                };
                match vertices.into_iter().find(|&vertex| thickness.at(vertex) < THINNEST * edge_length) {
                    Some(vertex) => {
                        let thickness = thickness.at(vertex);
                        Err(ResponseError::TooThin { vertex, thickness, edge_length })
                    }
                    None => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    /// K = (1-ν)/(2πG) (m²/N): the half-space moves by K / r at distance r per newton.
    pub fn kernel_constant(&self) -> f64 {
        (1.0 - self.poisson_ratio) / (TAU * self.shear_modulus)
    }

    /// How the gap of a node is measured.
    pub fn gap(&self) -> Gap {
        match self.response {
            Response::HalfSpace { gap, .. } | Response::Layer { gap, .. } => gap,
            Response::GaussianCorrected { .. } => Gap::Node,
        }
    }

    /// The same skin with the gap of a node measured otherwise, where its response offers that.
    pub(crate) fn with_gap(&self, gap: Gap) -> Self {
        let mut skin = self.clone();
        match &mut skin.response {
            Response::HalfSpace { gap: measured, .. } | Response::Layer { gap: measured, .. } => {
                *measured = gap;
            }
            Response::GaussianCorrected { .. } => {}
        }
        skin
    }

    /// How a node's force is spread.
    pub fn pressure(&self) -> Pressure {
        match self.response {
            Response::HalfSpace { pressure, .. }
            | Response::GaussianCorrected { pressure, .. }
            | Response::Layer { pressure, .. } => pressure,
        }
    }

    /// Distance beyond which a force is not felt (m); `None` where it is felt everywhere.
    pub fn reach(&self) -> Option<f64> {
        match self.response {
            Response::GaussianCorrected { cutoff, .. } => cutoff.is_finite().then_some(cutoff),
            Response::HalfSpace { .. } => None,
            Response::Layer { ref thickness, .. } => {
                let kernel = LayerKernel::new(self.poisson_ratio).ok()?;
                Some(kernel.reach(LAYER_SILENCE) * thickness.largest())
            }
        }
    }

    /// Whether the response matrix can have negative entries, so that a force can press nodes into contact
    /// that lie outside the obstacle. Where it cannot, the candidates are exactly the penetrating nodes.
    pub fn has_negative_entries(&self) -> bool {
        match self.response {
            Response::HalfSpace { .. } => false,
            Response::GaussianCorrected { height, .. } => height > 0.0,
            Response::Layer { .. } => true,
        }
    }
}
