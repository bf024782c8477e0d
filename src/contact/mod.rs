//! The pipeline: gaps, candidates, response, complementarity, deformed skin, outcome.
//!
//! At the candidates, the skin vertices that start inside the obstacle,
//!
//! ```text
//! g = g0 + R f,    g >= 0,    f >= 0,    g·f = 0
//! ```
//!
//! with g, g0 (m) along the obstacle's outward normal, R (m/N) the response matrix and f (N) the node forces (Xie,
//! Kanai, Date 2011, eq. 9). A kernel w moves the skin along each force, `u_i = Σ_j w_ij f_j n_j`, so that `R_ij = w_ij
//! n_i·n_j`: within 3 % of a half-space's response in all directions beside a ridge of 90 degrees, where w alone lets
//! the skin run away from the flanks and leaves little more than half of the force. An elastic product adds its
//! response to the skin's, `R = R_H + R_P`: what is measured at the deformed skin is measured after `u_H - u_P`,
//! against the product at rest. Where R has no negative entry, a vertex outside the obstacle can never touch and the
//! problem on the penetrating vertices is exact. Otherwise their rings are added, and the set grows while a vertex
//! outside gets pressed or the rim carries force. Gaps and normals are then taken anew at the deformed skin.

pub(crate) mod candidate;
pub(crate) mod clues;
pub(crate) mod cuts;
pub(crate) mod discretization;
pub(crate) mod equilibrium;
pub(crate) mod error;
pub(crate) mod figures;
pub(crate) mod finish;
pub(crate) mod first_touch;
pub(crate) mod gap;
pub(crate) mod in_place;
pub(crate) mod options;
pub(crate) mod outcome;
pub(crate) mod overlap;
pub(crate) mod press;
pub(crate) mod reach;
pub(crate) mod refine;
pub(crate) mod report;
pub(crate) mod scene;
pub(crate) mod setup;
pub(crate) mod solve;
pub(crate) mod tilt;
pub(crate) mod warm;

pub use error::{ContactError, PressedContact};
pub use figures::accuracy::Accuracy;
pub use figures::motion::drawn::DrawnSkin;
pub use first_touch::touching;
pub use options::ContactOptions;
pub use outcome::{
    Contact, ContactPart, ContactStatus, LeftOut, Patch, Refinement, RefinementEnd, RefinementKind,
    Resultant, Timing,
};
pub use overlap::overlaps;
pub use press::press;
pub use report::warning::{Warning, WarningKind};
pub use scene::{Goal, Press, Start};
pub use solve::solve_contact;
pub use tilt::axes::{Balance, Tilt, TiltAxes};
pub use warm::presses::{WarmStart, press_after};
