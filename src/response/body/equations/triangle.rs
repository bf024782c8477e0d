//! A flat triangle that Kelvin's kernels are integrated over.

use nalgebra::Vector3;

use crate::response::integral::frame::ball_around;

/// A flat triangle with what the integrals need of it.
#[derive(Debug, Clone)]
pub(crate) struct Triangle {
    pub corners: [Vector3<f64>; 3],
    pub normal: Vector3<f64>,
    pub area: f64,
    pub centroid: Vector3<f64>,
    /// Largest distance of a corner from the centroid (m).
    pub radius: f64,
}

impl Triangle {
    pub fn new(corners: [Vector3<f64>; 3]) -> Self {
        let cross = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
        let twice_area = cross.norm();
        let (centroid, radius) = ball_around(&corners);
        Triangle { corners, normal: cross / twice_area, area: 0.5 * twice_area, centroid, radius }
    }
}
