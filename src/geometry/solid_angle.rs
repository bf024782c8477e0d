//! Solid angles, winding numbers and volumes of triangle sets.

use std::f64::consts::PI;

use nalgebra::Vector3;

/// Solid angle of a triangle seen from a point, in (-2π, 2π); positive if the point is behind it.
///
/// `tan(Ω/2) = a·(b × c) / (abc + (a·b) c + (b·c) a + (c·a) b)` with the corners relative to the point (Van
/// Oosterom and Strackee 1983).
///
/// * `point`, `corners`: positions (m); the corners counter-clockwise seen from the front
///
/// Returns Ω (sr); 0 at a corner.
pub fn solid_angle(point: &Vector3<f64>, corners: [&Vector3<f64>; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| corner - point);
    let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
    let numerator = a.dot(&b.cross(&c));
    let denominator = la * lb * lc + a.dot(&b) * lc + b.dot(&c) * la + c.dot(&a) * lb;
    2.0 * numerator.atan2(denominator)
}

/// How often a set of faces goes around a point: their solid angle over 4π.
///
/// For a closed, outward surface 1 inside and 0 outside, for any set a smooth measure between (Jacobson, Kavan,
/// Sorkine-Hornung 2013); not defined on the surface itself.
///
/// * `point`: position (m)
/// * `vertices`: positions (m)
/// * `faces`: vertex indices, in range
pub fn winding_number(
    point: &Vector3<f64>,
    vertices: &[Vector3<f64>],
    faces: impl IntoIterator<Item = [u32; 3]>,
) -> f64 {
    let angle: f64 =
        faces.into_iter().map(|face| solid_angle(point, face.map(|vertex| &vertices[vertex as usize]))).sum();
    angle / (4.0 * PI)
}

/// Volume (m³) under a set of faces by the divergence theorem, `Σ a·(b × c) / 6` about `origin`.
///
/// For closed surfaces the origin does not matter but for rounding: choose one nearby.
pub(crate) fn signed_volume(
    origin: &Vector3<f64>,
    vertices: &[Vector3<f64>],
    faces: impl IntoIterator<Item = [u32; 3]>,
) -> f64 {
    let six_volumes: f64 = faces
        .into_iter()
        .map(|face| {
            let [a, b, c] = face.map(|vertex| vertices[vertex as usize] - origin);
            a.dot(&b.cross(&c))
        })
        .sum();
    six_volumes / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octant_has_an_eighth_of_the_full_angle() {
        let corners = [&Vector3::x(), &Vector3::y(), &Vector3::z()];
        let angle = solid_angle(&Vector3::zeros(), corners);
        assert!((angle - PI / 2.0).abs() < 1e-15, "seen from behind: positive");
        let turned = solid_angle(&Vector3::zeros(), [corners[0], corners[2], corners[1]]);
        assert!((turned + PI / 2.0).abs() < 1e-15);
        assert_eq!(solid_angle(&Vector3::x(), corners), 0.0);
    }

    #[test]
    fn the_volume_of_a_tetrahedron_does_not_depend_on_the_origin() {
        let vertices = [Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        for origin in [Vector3::zeros(), Vector3::new(0.3, 0.2, 0.1), Vector3::new(-2.0, 5.0, 1.0)] {
            assert!((signed_volume(&origin, &vertices, faces) - 1.0 / 6.0).abs() < 1e-14);
        }
    }
}
