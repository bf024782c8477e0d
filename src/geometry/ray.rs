//! Where a ray meets triangles.

use nalgebra::Vector3;
use robust::{Coord, orient2d};

/// How far along a ray the first of some triangles is, in lengths of `direction`; `None` where it meets none.
///
/// No ray slips between two triangles of a mesh: each corner is projected along it alike for all its triangles, and on
/// which side of an edge the ray passes is exact for corners so projected (Woop, Benthin, Wald 2013, J. Computer Graphics
/// Techniques 2(1), 65-82; Shewchuk 1997, doi:10.1007/PL00009321). Of a triangle seen edge on its neighbours are met.
pub(crate) fn first_hit(
    start: &Vector3<f64>,
    direction: &Vector3<f64>,
    triangles: impl IntoIterator<Item = [Vector3<f64>; 3]>,
) -> Option<f64> {
    let axis = direction.iamax();
    let along = Vector3::ith(axis, 1.0 / direction[axis]);
    // Coordinates across the ray, which passes their origin (m).
    let [x, y] =
        [1, 2].map(|k| (axis + k) % 3).map(|other| Vector3::ith(other, 1.0) - direction[other] * along);
    let way_to = |corners: [Vector3<f64>; 3]| {
        let corners = corners.map(|corner| corner - start);
        let places_x = corners.map(|corner| x.dot(&corner));
        if is_beside(places_x) {
            return None;
        }
        let places_y = corners.map(|corner| y.dot(&corner));
        if is_beside(places_y) {
            return None;
        }
        let [a, b, c] = [0, 1, 2].map(|i| Coord { x: places_x[i], y: places_y[i] });
        let ray = Coord { x: 0.0, y: 0.0 };
        let weights = [orient2d(b, c, ray), orient2d(c, a, ray), orient2d(a, b, ray)];
        let total: f64 = weights.iter().sum();
        if total == 0.0 || weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0) {
            return None;
        }
        let way = weights.iter().zip(&corners).map(|(w, corner)| w / total * along.dot(corner)).sum();
        (way > 0.0).then_some(way)
    };
    triangles.into_iter().filter_map(way_to).reduce(f64::min)
}

/// Whether all of some coordinates have the same sign.
fn is_beside(coordinates: [f64; 3]) -> bool {
    coordinates.iter().all(|x| *x > 0.0) || coordinates.iter().all(|x| *x < 0.0)
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

    #[test]
    fn no_ray_leaves_a_closed_mesh_between_its_triangles() {
        let (vertices, faces) = icosphere(1.0, 3);
        let all = || faces.iter().map(|face| face.map(|v| vertices[v as usize]));
        let start = Vector3::new(0.02, -0.01, 0.03);
        for [a, b, c] in all() {
            for target in [a, 0.5 * (a + b), 0.5 * (b + c), (a + b + c) / 3.0] {
                let way = first_hit(&start, &(target - start), all()).expect("it is closed");
                // The faces stand across the ray: what rounding does to their corners, it does to the way.
                approx::assert_relative_eq!(way, 1.0, max_relative = 1e-14);
            }
        }
    }

    #[test]
    fn a_ray_along_an_edge_or_in_the_plane_of_a_face_is_stopped_by_the_faces_beside_it() {
        let corner = |i: usize| Vector3::from_fn(|k, _| (i >> k & 1) as f64);
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let cube: Vec<[Vector3<f64>; 3]> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .map(|face| face.map(corner))
            .collect();
        for across in [[0.0, 0.0], [0.0, 0.5], [0.5, 0.5], [1.0, 0.3], [1.0, 1.0]] {
            let start = Vector3::new(-2.0, across[0], across[1]);
            let way = first_hit(&start, &Vector3::x(), cube.iter().copied()).expect("the near side");
            approx::assert_relative_eq!(way, 2.0, max_relative = 4.0 * f64::EPSILON);
        }
        assert_eq!(first_hit(&Vector3::repeat(0.5), &Vector3::zeros(), cube), None);
    }
}
