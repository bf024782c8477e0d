//! Distance of a point from a triangle.

use nalgebra::Vector3;

/// Squared distance of a point from a triangle (m²) (regions after Ericson 2005, §5.1.5).
pub(crate) fn triangle_distance_squared(point: &Vector3<f64>, [a, b, c]: [&Vector3<f64>; 3]) -> f64 {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    // nearest to corner A
    if d1 <= 0.0 && d2 <= 0.0 {
        return ap.norm_squared();
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    // nearest to corner B
    if d3 >= 0.0 && d4 <= d3 {
        return bp.norm_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    // nearest to edge AB
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (ap - ab * (d1 / (d1 - d3))).norm_squared();
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    // nearest to corner C
    if d6 >= 0.0 && d5 <= d6 {
        return cp.norm_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    // nearest to edge AC
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (ap - ac * (d2 / (d2 - d6))).norm_squared();
    }
    let va = d3 * d6 - d5 * d4;
    // nearest to edge BC
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (bp - (c - b) * s).norm_squared();
    }
    // nearest to the inside
    let sum = va + vb + vc;
    (ap - ab * (vb / sum) - ac * (vc / sum)).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_a_chosen_nearest_point_of_each_region() {
        let [a, b, c] =
            [Vector3::new(0.0, 0.0, 0.0), Vector3::new(4.0, 0.0, 0.0), Vector3::new(1.0, 3.0, 0.0)];
        let out = |x: f64, y: f64| Vector3::new(x, y, 0.0).normalize();
        // nearest point, directions that keep it nearest
        let regions = [
            (a, vec![out(-1.0, -1.0), out(-1.0, 0.2), out(0.0, -1.0)]),
            (b, vec![out(1.0, 0.0), out(1.0, 1.0), out(0.0, -1.0)]),
            (c, vec![out(0.0, 1.0), out(-1.0, 0.5)]),
            (a + (b - a) * 0.3, vec![out(0.0, -1.0)]),
            (a + (c - a) * 0.6, vec![out(-3.0, 1.0)]),
            (b + (c - b) * 0.8, vec![out(1.0, 1.0)]),
            ((a + b + c) / 3.0, vec![Vector3::zeros()]),
        ];
        for (nearest, directions) in regions {
            for direction in directions {
                for (aside, height) in
                    [(0.0, 0.0), (1e-12, 0.0), (0.5, 0.0), (0.7, 2.0), (0.0, -1.5), (3.0, 1e-12)]
                {
                    let point = nearest + direction * aside + Vector3::z() * height;
                    let expected = (point - nearest).norm();
                    let found = triangle_distance_squared(&point, [&a, &b, &c]).sqrt();
                    assert!((found - expected).abs() < 1e-15 * 16.0, "{point}: {found}, expected {expected}");
                }
            }
        }
    }
}
