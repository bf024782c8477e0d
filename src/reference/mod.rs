//! Closed-form and tabulated answers to check against: Hertz, flat punch, cone, bonded layer, sphere on a rigid core.
//!
//! All are frictionless indentations of an elastic body by a rigid indenter. The half-space enters through its contact
//! modulus `E* = E / (1 − ν²) = 2 G / (1 − ν)` (Pa).

mod cone;
mod cored_sphere;
mod flat_punch;
mod hertz;
mod layer;

pub use cone::Cone;
pub use cored_sphere::{CoredSphere, ball_on_cored_sphere, plate_on_cored_sphere};
pub use flat_punch::FlatPunch;
pub use hertz::Hertz;
pub use layer::{LayerIndentation, layer_correction_at_load, point_load_on_layer, sphere_on_layer};

/// Contact modulus of an isotropic elastic body, `E* = 2 G / (1 − ν)` (Johnson 1985, §4.1).
///
/// * `shear_modulus`: G (Pa), > 0
/// * `poisson_ratio`: ν, in [0, 0.5]
///
/// Returns E* (Pa).
pub fn contact_modulus(shear_modulus: f64, poisson_ratio: f64) -> f64 {
    2.0 * shear_modulus / (1.0 - poisson_ratio)
}
