//! Directions: of any length, which are the same, and those across one.

use nalgebra::Vector3;

/// Lengths of unit vectors may be off 1 by this, as of normals in single precision.
const UNIT_TOLERANCE: f64 = 1e-6;
/// Two unit directions no farther apart are one.
const SAME_DIRECTION: f64 = 1e-10;

/// Whether two unit vectors are one direction.
pub(crate) fn is_same(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    (a - b).norm_squared() <= SAME_DIRECTION * SAME_DIRECTION
}

/// Whether unit vectors are all one direction.
pub(crate) fn are_one(directions: &[Vector3<f64>]) -> bool {
    directions.iter().all(|other| is_same(other, &directions[0]))
}

/// The unit vector along `direction`, of any length that a float can have; `None` if it is zero or not finite.
pub(crate) fn unit(direction: &Vector3<f64>) -> Option<Vector3<f64>> {
    // Scaling first keeps tiny and huge directions from under- and overflowing.
    let scaled = direction / direction.amax();
    let length = scaled.norm();
    (length > 0.0 && length.is_finite()).then(|| scaled / length)
}

/// The first that is no unit vector, and its length.
pub(crate) fn first_off_unit(directions: &[Vector3<f64>]) -> Option<(usize, f64)> {
    let mut lengths = directions.iter().map(Vector3::norm).enumerate();
    lengths.find(|&(_, length)| length.is_nan() || (length - 1.0).abs() > UNIT_TOLERANCE)
}

/// A unit vector perpendicular to `axis`, fixed by it: across the coordinate axis that `axis` is farthest from.
pub(crate) fn perpendicular(axis: &Vector3<f64>) -> Vector3<f64> {
    axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize()
}

/// Two unit vectors at right angles to a unit vector and to each other; with it they are right-handed.
pub(crate) fn tangents(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let first = perpendicular(normal);
    [first, normal.cross(&first)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_has_its_unit_vector_and_nothing_else_has_one() {
        for length in [5e-324, 1e-300, 1.0, 1e300] {
            assert_eq!(unit(&Vector3::new(0.0, -length, 0.0)), Some(-Vector3::y()));
        }
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(unit(&Vector3::new(0.0, bad, 0.0)), None);
        }
    }
}
