//! How deep a segment lies under a triangle of the skin.

use nalgebra::Vector3;

/// The part of a segment that lies over or under a triangle.
pub(crate) struct Under {
    /// How deep it lies behind the triangle at the most (m), negative before it.
    pub depth: f64,
    /// Its largest barycentric coordinates there.
    pub shares: [f64; 3],
    /// The deepest point (m).
    pub deepest: Vector3<f64>,
}

/// The part of a segment that lies over or under a triangle, seen along a direction into the skin; `None` where none does.
pub(crate) fn depth_along(
    [p, q]: &[Vector3<f64>; 2],
    [a, b, c]: &[Vector3<f64>; 3],
    direction: &Vector3<f64>,
) -> Option<Under> {
    let outward = (b - a).cross(&(c - a));
    let area = -outward.dot(direction);
    if area <= 0.0 {
        return None;
    }
    // Barycentric coordinates of both ends, seen along the direction.
    let share = |from: &Vector3<f64>, to: &Vector3<f64>, x: &Vector3<f64>| {
        direction.dot(&(x - from).cross(&(to - from))) / area
    };
    let of = |x: &Vector3<f64>| [share(b, c, x), share(c, a, x), share(a, b, x)];
    let (at_p, at_q) = (of(p), of(q));
    let (mut from, mut to) = (0.0, 1.0);
    for (p, q) in at_p.into_iter().zip(at_q) {
        if p < 0.0 && q < 0.0 {
            return None;
        }
        let crossing = p / (p - q);
        if p < 0.0 {
            from = f64::max(from, crossing);
        } else if q < 0.0 {
            to = f64::min(to, crossing);
        }
    }
    if from > to {
        return None;
    }
    let depth = |t: f64| (a - p.lerp(q, t)).dot(&outward) / area;
    let shares = std::array::from_fn(|corner| {
        let at = |t: f64| at_p[corner] + t * (at_q[corner] - at_p[corner]);
        at(from).max(at(to))
    });
    let at = if depth(from) > depth(to) { from } else { to };
    Some(Under { depth: depth(at), shares, deepest: p.lerp(q, at) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_of_an_edge_is_that_of_its_part_under_the_triangle() {
        let triangle = [Vector3::zeros(), Vector3::x(), Vector3::y()];
        for (p, q, expected) in [
            ([0.2, 0.2, -0.1], [0.3, 0.2, -0.1], Some((0.1, [0.6, 0.3, 0.2]))),
            // Deepest where it leaves the prism at x = 0.
            ([-1.0, 0.2, -2.0], [1.0, 0.2, 0.0], Some((1.0, [0.8, 0.8, 0.2]))),
            ([-1.0, -0.1, -1.0], [1.0, -0.1, -1.0], None),
            ([0.2, 0.2, 0.1], [0.3, 0.2, 0.2], Some((-0.1, [0.6, 0.3, 0.2]))),
            ([2.0, 2.0, -1.0], [3.0, 2.0, -1.0], None),
        ] {
            match (depth_along(&p, &q, &triangle), expected) {
                (Some((depth, shares)), Some((expected, of))) => {
                    assert!((depth - expected).abs() < 1e-15, "{depth}");
                    assert!(
                        shares.iter().zip(of).all(|(share, of)| (share - of).abs() < 1e-15),
                        "{shares:?}"
                    );
                }
                (found, expected) => assert_eq!(found, expected),
            }
        }
        // Slanting by 45 degrees: a point 0.1 under the triangle lies √2 as deep along the way.
        let slant = Vector3::new(0.0, 1.0, -1.0).normalize();
        let ends = [Vector3::new(0.2, 0.4, -0.1); 2];
        let Under { depth, .. } = super::depth_along(&ends, &triangle, &slant).expect("under it");
        assert!((depth - 0.1 * 2f64.sqrt()).abs() < 1e-15, "{depth}");
    }

    fn depth_along(p: &[f64; 3], q: &[f64; 3], triangle: &[Vector3<f64>; 3]) -> Option<(f64, [f64; 3])> {
        let under = super::depth_along(&[(*p).into(), (*q).into()], triangle, &-Vector3::z())?;
        Some((under.depth, under.shares))
    }
}
