//! Signed distance of one point.

use nalgebra::Vector3;

/// Closest point of the surface to one point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Nearest {
    /// Signed distance (m).
    pub distance: f64,
    /// Closest point (m).
    pub closest: Vector3<f64>,
    /// Outward unit normal.
    pub normal: Vector3<f64>,
}

impl Nearest {
    /// Beyond the maximum distance.
    pub const BEYOND: Nearest = Nearest {
        distance: f64::INFINITY,
        closest: Vector3::new(f64::NAN, f64::NAN, f64::NAN),
        normal: Vector3::new(f64::NAN, f64::NAN, f64::NAN),
    };
}
