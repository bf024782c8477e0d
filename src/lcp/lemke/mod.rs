//! Lemke's complementary pivoting on a factor of the active block.
//!
//! The path keeps `w = q + M z + d z0` with all variables >= 0 and `w·z = 0`, and drives the covering variable
//! z0 to zero. Let A be the unknowns whose z is basic and B = A plus the one unknown that has neither z nor w
//! basic. Then `[M_BA d_B] [z_A; z0] = -q_B`, so the basis is no larger than the active set: a pivot costs one
//! product with M's active columns and O(|A|²) for the factor, and no tableau exists.
//!
//! Ties in the ratio test are broken lexicographically over (q, p), p a perturbation carried along as a second
//! right-hand side. Every basis is remembered by a hash; should rounding bring one back, p is drawn anew.

mod basic_columns;
pub(super) mod path;
mod pivot;
pub(super) mod run;
mod start;
