//! Where a ray meets triangles.

use nalgebra::Vector3;

/// How far along a ray the first of some triangles is, in lengths of `direction`; `None` where it meets none.
///
/// Möller, Trumbore 1997, J. Graphics Tools 2(1), 21-28.
pub(crate) fn first_hit(
    start: &Vector3<f64>,
    direction: &Vector3<f64>,
    triangles: impl IntoIterator<Item = [Vector3<f64>; 3]>,
) -> Option<f64> {
    let way_to = |corners: [Vector3<f64>; 3]| {
        let [a, b, c] = corners.map(|corner| corner - start);
        // The ray t d meets a + u (b - a) + v (c - a): Cramer's rule.
        let (ab, ac) = (b - a, c - a);
        let across = direction.cross(&ac);
        let determinant = ab.dot(&across);
        let u = -a.dot(&across) / determinant;
        let way = -a.cross(&ab);
        let v = direction.dot(&way) / determinant;
        let t = ac.dot(&way) / determinant;
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
    };
    triangles.into_iter().filter_map(way_to).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::icosphere;

    #[test]
    fn a_ray_from_within_leaves_by_triangles_far_larger_than_the_others() {
        let (vertices, faces) = icosphere(1.0, 3);
        // A small ball inside a tetrahedron: rays from the middle meet the ball first, and the tetrahedron from outside it.
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]]
            .map(|corner| 9.0 * Vector3::from(corner));
        let sides =
            [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]].map(|side| side.map(|at: usize| corners[at]));
        let ball = faces.iter().map(|face| face.map(|v| vertices[v as usize]));
        let all: Vec<[Vector3<f64>; 3]> = ball.chain(sides).collect();
        let direction = Vector3::new(0.3, -0.5, -0.8).normalize();
        let first = first_hit(&Vector3::zeros(), &direction, all.iter().copied()).expect("the ball");
        assert!(first > 0.98 && first <= 1.0, "{first}");
        let beyond = first_hit(&(1.5 * direction), &direction, all.iter().copied()).expect("the tetrahedron");
        // Its sides are 9 / √3 from the middle.
        let outward = sides.map(|[a, b, c]| (a + b + c).normalize());
        let steepest = outward.iter().map(|normal| normal.dot(&direction)).fold(0.0, f64::max);
        approx::assert_relative_eq!(beyond + 1.5, 9.0 / 3.0_f64.sqrt() / steepest, max_relative = 1e-12);
        assert!(first_hit(&(30.0 * direction), &direction, all).is_none());
    }
}
