//! Closest point on a segment.

use nalgebra::Vector3;

/// Share of the way from `a` to `b` (m) at which the segment between them is closest to `p` (m); nan where they are one.
pub(crate) fn share_along(p: &Vector3<f64>, a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let way = b - a;
    ((p - a).dot(&way) / way.norm_squared()).clamp(0.0, 1.0)
}
