//! Closest point on one triangle, with the feature that carries it, and the distance of two triangles.

use nalgebra::Vector3;

/// The part of a triangle on which its closest point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
    /// The interior.
    Face,
    /// Edge from corner `i` to corner `i + 1`.
    Edge(usize),
    /// Corner `i`.
    Corner(usize),
}

/// Closest point of a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closest {
    /// Square of the distance (m²).
    pub distance_squared: f64,
    /// The closest point (m).
    pub point: Vector3<f64>,
    /// Where on the triangle it lies.
    pub feature: Feature,
}

/// Point of the triangle `corners` closest to `p`.
///
/// The interior is decided by the side of `p` to each edge, seen along the unit `normal`. Elsewhere the best of
/// the three edges is taken, so a thin triangle costs no accuracy: whichever region rounding picks near a
/// border, the distance is right to a few units in the last place of the coordinates.
///
/// * `corners`: a, b, c (m), counter-clockwise seen against `normal`
/// * `normal`: unit normal of the triangle
#[inline]
pub(crate) fn closest_on_triangle(
    p: &Vector3<f64>,
    corners: [&Vector3<f64>; 3],
    normal: &Vector3<f64>,
) -> Closest {
    let [a, b, c] = corners;
    let [ab, bc, ca] = [b - a, c - b, a - c];
    let [ap, bp, cp] = [p - a, p - b, p - c];

    let inside = |edge: &Vector3<f64>, to_point: &Vector3<f64>| edge.cross(to_point).dot(normal) > 0.0;
    if inside(&ab, &ap) && inside(&bc, &bp) && inside(&ca, &cp) {
        let height = ap.dot(normal);
        let point = p - normal * height;
        return Closest { distance_squared: height * height, point, feature: Feature::Face };
    }

    let mut best = closest_on_edge(0, a, &ab, &ap, p);
    for candidate in [closest_on_edge(1, b, &bc, &bp, p), closest_on_edge(2, c, &ca, &cp, p)] {
        if candidate.distance_squared < best.distance_squared {
            best = candidate;
        }
    }
    best
}

#[inline]
fn closest_on_edge(
    index: usize,
    start: &Vector3<f64>,
    edge: &Vector3<f64>,
    from_start: &Vector3<f64>,
    p: &Vector3<f64>,
) -> Closest {
    let along = from_start.dot(edge);
    let length_squared = edge.norm_squared();
    let (point, feature) = if along <= 0.0 {
        (*start, Feature::Corner(index))
    } else if along >= length_squared {
        (start + edge, Feature::Corner((index + 1) % 3))
    } else {
        (start + edge * (along / length_squared), Feature::Edge(index))
    };
    Closest { distance_squared: (p - point).norm_squared(), point, feature }
}

/// Square of the distance (m²) of two triangles that do not cross: a corner of one from the other, or two edges.
///
/// * `triangles`: a, b, c of each (m), counter-clockwise seen against its normal
/// * `normals`: unit normal of each
pub(crate) fn triangle_distance_squared(
    triangles: [[&Vector3<f64>; 3]; 2],
    normals: [&Vector3<f64>; 2],
) -> f64 {
    let [first, second] = triangles;
    let from_second = first.map(|p| closest_on_triangle(p, second, normals[1]).distance_squared);
    let from_first = second.map(|p| closest_on_triangle(p, first, normals[0]).distance_squared);
    let edges = (0..9).map(|k| (k / 3, k % 3)).map(|(i, j)| {
        edge_distance_squared([first[i], first[(i + 1) % 3]], [second[j], second[(j + 1) % 3]])
    });
    from_second.into_iter().chain(from_first).chain(edges).fold(f64::INFINITY, f64::min)
}

/// Square of the distance (m²) of two segments where both ends of their common perpendicular lie on them, else an upper
/// bound; infinite for parallel segments.
fn edge_distance_squared([p, q]: [&Vector3<f64>; 2], [r, s]: [&Vector3<f64>; 2]) -> f64 {
    let (u, v, w) = (q - p, s - r, r - p);
    let normal = u.cross(&v);
    let length_squared = normal.norm_squared();
    if length_squared == 0.0 {
        return f64::INFINITY;
    }
    let along = |other: &Vector3<f64>| (w.cross(other).dot(&normal) / length_squared).clamp(0.0, 1.0);
    (u * along(&v) - v * along(&u) - w).norm_squared()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_normal([a, b, c]: [&Vector3<f64>; 3]) -> Vector3<f64> {
        (b - a).cross(&(c - a)).normalize()
    }

    #[test]
    fn the_nearest_features_may_be_a_corner_over_a_face_two_edges_or_two_corners() {
        let v = Vector3::new;
        let flat = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
        let corner_over_face = [v(0.2, 0.2, 0.3), v(0.4, 0.2, 1.0), v(0.2, 0.5, 1.0)];
        let edge_beside_edge = [v(0.5, -0.25, -1.0), v(0.5, -0.25, 1.0), v(0.5, -1.0, 0.0)];
        let parallel_edges = [v(-1.0, -0.25, 0.0), v(2.0, -0.25, 0.0), v(0.5, -1.0, 0.0)];
        let corner_to_corner = [v(1.3, 0.0, 0.4), v(2.0, 0.0, 0.4), v(2.0, 1.0, 2.0)];
        for (other, distance) in [
            (corner_over_face, 0.3),
            (edge_beside_edge, 0.25),
            (parallel_edges, 0.25),
            (corner_to_corner, 0.5),
        ] {
            for turn in 0..3 {
                let triangles = [flat.each_ref(), [0, 1, 2].map(|i| &other[(i + turn) % 3])];
                let normals = triangles.map(unit_normal);
                let found = triangle_distance_squared(triangles, normals.each_ref()).sqrt();
                assert!((found - distance).abs() < 1e-15, "{found}, expected {distance}");
                let [first, second] = triangles;
                let swapped = triangle_distance_squared([second, first], [&normals[1], &normals[0]]).sqrt();
                assert!((swapped - distance).abs() < 1e-15, "{swapped}, expected {distance}");
            }
        }
    }

    fn corners() -> [Vector3<f64>; 3] {
        [Vector3::new(0.0, 0.0, 0.0), Vector3::new(4.0, 0.0, 0.0), Vector3::new(1.0, 2.0, 0.0)]
    }

    fn closest(p: Vector3<f64>) -> Closest {
        let [a, b, c] = corners();
        closest_on_triangle(&p, [&a, &b, &c], &Vector3::z())
    }

    /// `base` is a chosen closest point, `out` a unit direction of its region, in which it stays closest.
    fn stays_closest(base: Vector3<f64>, out: Vector3<f64>, feature: Feature) {
        for distance in [1e-12, 1e-6, 0.3, 50.0] {
            for height in [-0.7, -1e-12, 0.0, 1e-12, 0.7] {
                let found = closest(base + out * distance + Vector3::z() * height);
                assert_eq!(found.feature, feature, "base {base:?} distance {distance} height {height}");
                assert!((found.point - base).norm() <= 1e-14 * (1.0 + distance), "{found:?}");
                let expected = f64::hypot(distance, height);
                assert!((found.distance_squared.sqrt() - expected).abs() <= 2e-15 * (1.0 + expected));
            }
        }
    }

    #[test]
    fn points_off_an_edge_are_closest_to_that_edge() {
        let [a, b, c] = corners();
        for (i, (s, e)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            let out = (e - s).cross(&Vector3::z()).normalize();
            for t in [0.01, 0.5, 0.99] {
                stays_closest(s + (e - s) * t, out, Feature::Edge(i));
            }
        }
    }

    #[test]
    fn points_in_the_normal_cone_of_a_corner_are_closest_to_it() {
        let [a, b, c] = corners();
        for (i, (before, corner, after)) in [(c, a, b), (a, b, c), (b, c, a)].into_iter().enumerate() {
            let incoming = (corner - before).cross(&Vector3::z()).normalize();
            let outgoing = (after - corner).cross(&Vector3::z()).normalize();
            for t in [0.1, 0.5, 0.9] {
                stays_closest(corner, (incoming * (1.0 - t) + outgoing * t).normalize(), Feature::Corner(i));
            }
        }
    }

    #[test]
    fn points_over_the_face_are_closest_to_their_foot() {
        for foot in [Vector3::new(1.0, 1.0, 0.0), Vector3::new(1.0, 1e-9, 0.0), Vector3::new(3.9, 0.05, 0.0)]
        {
            for height in [-30.0, -1e-12, 0.0, 1e-12, 30.0] {
                let found = closest(foot + Vector3::z() * height);
                assert_eq!(found.feature, Feature::Face);
                assert_eq!(found.distance_squared, height * height);
                assert_eq!(found.point, foot);
            }
        }
    }

    #[test]
    fn one_step_across_a_border_changes_the_distance_by_no_more_than_the_step() {
        let [a, b, c] = corners();
        for (s, e) in [(a, b), (b, c), (c, a)] {
            let out = (e - s).cross(&Vector3::z()).normalize();
            let border = s + (e - s) * 0.37;
            for height in [1e-12, 1e-3, 1.0] {
                for step in [-1e-12, 0.0, 1e-12] {
                    let found = closest(border + out * step + Vector3::z() * height);
                    assert!((found.distance_squared.sqrt() - height).abs() <= 1e-12, "{found:?}");
                }
            }
        }
    }

    #[test]
    fn an_obtuse_needle_takes_the_right_edge() {
        // The obtuse corner is c; a point beyond a, below the line of the long edge.
        let [a, b, c] = [Vector3::zeros(), Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.5, 1e-9, 0.0)];
        let found = closest_on_triangle(&Vector3::new(-0.3, 0.4, 0.0), [&a, &b, &c], &Vector3::z());
        assert_eq!(found.feature, Feature::Corner(0));
        assert!((found.distance_squared.sqrt() - 0.5).abs() < 1e-15);
    }
}
