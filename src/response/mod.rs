//! Displacement of the skin per unit contact force.
//!
//! A unit force at node j, spread over the triangles around it as a pressure p_j (1/m²), moves the surface
//! at x by
//!
//! ```text
//! u(x) = ∫ k(|x - y|) p_j(y) dA(y)  (m/N),    half-space: k(r) = K / r,  K = (1 - ν) / (2 π G)  (m²/N)
//! ```
//!
//! and the response matrix collects it at the candidate nodes: `R[i, j] = u(x_i)` (m/N). The triangle
//! integrals are exact near the point, so the singularity of 1/r costs no accuracy; far from the load a multipole
//! series takes over, whose order follows from a bound on the relative error of each entry.
//!
//! Which discretization to take: [`Discretization::Collocation`] leaves no penetration at vertices and is cheapest;
//! on finger pads the symmetric part of R is positive definite, with a condition number of some 30. Where [`spectrum`]
//! says that it is not (badly shaped triangles), [`Discretization::Galerkin`] makes it so, on any surface (a layer: on
//! any flat one), with a condition number of some 90 and at some 10 times the time.
//!
//! Sources: Xie, Kanai, Date 2011, eq. 3 and 6-8; Johnson 1985, §3.2-3.3; Wilton et al. 1984.

pub mod body;
pub(crate) mod column;
pub(crate) mod error;
pub(crate) mod integral;
pub(crate) mod kernel;
pub(crate) mod matrix;
pub(crate) mod rows;
pub(crate) mod series;
pub(crate) mod simd;
pub(crate) mod skin;

pub use crate::linalg::definiteness::{Definiteness, Spectrum, spectrum};
pub use crate::linalg::threads::ThreadsError;
pub use error::ResponseError;
pub use integral::gaussian::gaussian_hat_integrals;
pub use integral::hat::hat_integrals;
pub use kernel::basis::{Discretization, PressureBasis};
pub use kernel::layer::LayerKernel;
pub use kernel::skin::{Kernel, KernelSkin};
pub use kernel::thickness::Thickness;
pub use matrix::average::{initial_gaps, pressure_average};
pub use matrix::collocation::{assemble, assemble_block};
pub use matrix::net_volume::{NetVolume, balanced_height, net_volume};
pub use matrix::options::AssemblyOptions;
pub use rows::NodesError;
pub use skin::combined::{CombinedSkin, Part};
pub use skin::elastic::{ElasticSkin, Request, Traits};
pub use skin::given_blocks::GivenBlocks;
pub use skin::given_matrix::GivenMatrix;
pub use skin::levels::Levels;
pub use skin::nodes::PreparedNodes;
pub use skin::prepared_body::PreparedBody;
pub use skin::prepared_kernel::PreparedKernel;
