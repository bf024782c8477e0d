//! The body response: the true linear answer of this body, with its bone.
//!
//! The skin's response depends on the body alone: its shape, its bone, what holds it. So it is solved once,
//! by boundary elements on the closed skin and the bone, and pressing costs no more than with any other
//! response. With Kelvin's solution `U`, `T` ([`kelvin`]), normals out of the tissue and the bone at rest,
//! Somigliana's identity at every vertex `x` of skin and bone reads
//!
//! ```text
//! c u(x) + ∫_skin T u dS = ∫_skin U t dS + ∫_bone U t dS
//! ```
//!
//! With hat functions for displacement and traction it becomes
//!
//! ```text
//! | T_ss + c   -U_sb | | u_s |   | U_ss |
//! | T_bs       -U_bb | | t_b | = | U_bs | t_s
//! ```
//!
//! (direct collocation: Brebbia, Telles, Wrobel 1984, ch. 5; Pozrikidis 1992, ch. 4 for the incompressible case). One LU
//! and right-hand sides for the loaded nodes only give `C_ij` (3 × 3, m/N), the displacement of vertex `i`
//! per newton at node `j`. Contact forces act along the obstacle's normals `n`, so `R_ij = n_i · C_ij n_j`
//! ([`BodyCompliance::response_along`]).
//!
//! Steps, one file each: checks of skin and bone, integrals over a triangle, assembly, identities that keep
//! the equations right up to `nu = 0.5`, factorization, and the stored compliance. All is solved in units of the
//! mean edge length and of `G`, so the answer does not depend on the unit system.

pub(crate) mod check;
pub(crate) mod compliance;
pub(crate) mod cost;
pub(crate) mod equations;
pub(crate) mod error;
pub(crate) mod levels;
pub(crate) mod options;
pub(crate) mod progress;
pub(crate) mod solve;
pub(crate) mod watch;

pub use compliance::{BodyCompliance, BodyParts};
pub use cost::BodyCost;
pub use equations::kelvin;
pub use error::BodyError;
pub use levels::coarseness::BodyDoubt;
pub use levels::one_level::OneLevel;
pub use levels::two_levels::TwoLevels;
pub use options::BodyOptions;
pub use progress::BodyProgress;
pub use solve::Body;
