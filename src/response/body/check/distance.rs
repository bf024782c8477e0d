//! Distances and crossings between the faces of two surfaces.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::surface::checked::Surface;

/// Two faces and their distance (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FacePair {
    pub first: usize,
    pub second: usize,
    pub distance: f64,
}

type Corners = [Vector3<f64>; 3];

/// Faces with bounding balls.
struct Balls {
    corners: Vec<Corners>,
    centers: Vec<Vector3<f64>>,
    radii: Vec<f64>,
}

impl Balls {
    fn new(surface: &Surface) -> Self {
        let corners: Vec<Corners> =
            surface.faces().iter().map(|face| face.map(|v| surface.vertices()[v as usize])).collect();
        let centers: Vec<_> = corners.iter().map(|[a, b, c]| (a + b + c) / 3.0).collect();
        let radii = corners
            .iter()
            .zip(&centers)
            .map(|(corners, center)| corners.iter().map(|c| (c - center).norm()).fold(0.0, f64::max))
            .collect();
        Balls { corners, centers, radii }
    }

    /// Lower bound on the distance between two faces (m), at least 0.
    fn bound(&self, face: usize, other: &Balls, other_face: usize) -> f64 {
        let apart = (self.centers[face] - other.centers[other_face]).norm();
        (apart - self.radii[face] - other.radii[other_face]).max(0.0)
    }
}

/// For every face of `first` the closest face of `second`, provided that they do not cross.
pub(crate) fn closest_faces(first: &Surface, second: &Surface) -> Vec<FacePair> {
    let (a, b) = (Balls::new(first), Balls::new(second));
    (0..a.corners.len())
        .into_par_iter()
        .map(|face| {
            closest_among(&a, face, &b, |_| true, f64::INFINITY).expect("the other surface has faces")
        })
        .collect()
}

/// Two faces of different components that are within `limit` (m) of one another or cross.
pub(crate) fn closest_between_components(
    surface: &Surface,
    component: &(dyn Fn(usize) -> usize + Sync),
    limit: f64,
) -> Option<FacePair> {
    let balls = Balls::new(surface);
    let pairs: Vec<FacePair> = (0..balls.corners.len())
        .into_par_iter()
        .filter_map(|face| {
            let is_later = |other: usize| component(other) > component(face);
            closest_among(&balls, face, &balls, is_later, limit)
        })
        .collect();
    pairs.into_iter().min_by(|a, b| a.distance.total_cmp(&b.distance))
}

fn closest_among(
    a: &Balls,
    face: usize,
    b: &Balls,
    is_wanted: impl Fn(usize) -> bool,
    limit: f64,
) -> Option<FacePair> {
    let mut best: Option<FacePair> = None;
    for other in (0..b.corners.len()).filter(|&other| is_wanted(other)) {
        let reach = best.map_or(limit, |pair| pair.distance);
        let bound = a.bound(face, b, other);
        if bound > reach || (best.is_some() && bound == reach) {
            continue;
        }
        let crosses = is_crossing(&a.corners[face], &b.corners[other]);
        let distance = if crosses { 0.0 } else { face_distance(&a.corners[face], &b.corners[other]) };
        if distance < reach || (best.is_none() && distance <= reach) {
            best = Some(FacePair { first: face, second: other, distance });
        }
    }
    best
}

/// Number of crossing pairs of faces and the first of them.
pub(crate) fn count_crossings(first: &Surface, second: &Surface) -> Option<(usize, usize, usize)> {
    let (a, b) = (Balls::new(first), Balls::new(second));
    let found: Vec<(usize, usize, usize)> = (0..a.corners.len())
        .into_par_iter()
        .filter_map(|face| {
            let mut crossing = (0..b.corners.len()).filter(|&other| {
                a.bound(face, &b, other) == 0.0 && is_crossing(&a.corners[face], &b.corners[other])
            });
            crossing.next().map(|other| (1 + crossing.count(), face, other))
        })
        .collect();
    let &(_, face, other) = found.first()?;
    Some((found.iter().map(|(count, ..)| count).sum(), face, other))
}

/// Whether an edge of one triangle goes through the other.
fn is_crossing(a: &Corners, b: &Corners) -> bool {
    let through = |edges: &Corners, face: &Corners| {
        (0..3).any(|i| is_segment_through(&edges[i], &edges[(i + 1) % 3], face))
    };
    through(a, b) || through(b, a)
}

/// Volume of a tetrahedron by the sign alone: positive if `d` is below the counter-clockwise face abc.
fn side(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, d: &Vector3<f64>) -> f64 {
    let coord = |v: &Vector3<f64>| robust::Coord3D { x: v.x, y: v.y, z: v.z };
    robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

fn is_segment_through(p: &Vector3<f64>, q: &Vector3<f64>, [a, b, c]: &Corners) -> bool {
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if above * below >= 0.0 {
        return false; // on one side or touching: then the distance tells
    }
    let turns = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    turns.iter().all(|&turn| turn >= 0.0) || turns.iter().all(|&turn| turn <= 0.0)
}

/// Distance (m) of two triangles that do not cross.
fn face_distance(a: &Corners, b: &Corners) -> f64 {
    let mut least = f64::INFINITY;
    for i in 0..3 {
        least = least.min(point_distance(&a[i], b)).min(point_distance(&b[i], a));
        for j in 0..3 {
            least = least.min(segment_distance(&a[i], &a[(i + 1) % 3], &b[j], &b[(j + 1) % 3]));
        }
    }
    least
}

/// Distance (m) of a point from a triangle's inside or corners; its edges are left to [`segment_distance`].
fn point_distance(point: &Vector3<f64>, [a, b, c]: &Corners) -> f64 {
    let normal = (b - a).cross(&(c - a));
    let is_above = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|(from, to)| (*to - *from).cross(&(point - *from)).dot(&normal) >= 0.0);
    if is_above { (point - a).dot(&normal).abs() / normal.norm() } else { f64::INFINITY }
}

/// Distance (m) of two segments (Ericson 2005, §5.1.9).
fn segment_distance(p: &Vector3<f64>, q: &Vector3<f64>, r: &Vector3<f64>, s: &Vector3<f64>) -> f64 {
    let (u, v, w) = (q - p, s - r, p - r);
    let (uu, vv, uv, uw, vw) = (u.dot(&u), v.dot(&v), u.dot(&v), u.dot(&w), v.dot(&w));
    let determinant = uu * vv - uv * uv;
    let mut along_u =
        if determinant > 0.0 { ((uv * vw - uw * vv) / determinant).clamp(0.0, 1.0) } else { 0.0 };
    let mut along_v = (uv * along_u + vw) / vv;
    if !(0.0..=1.0).contains(&along_v) {
        along_v = along_v.clamp(0.0, 1.0);
        along_u = ((uv * along_v - uw) / uu).clamp(0.0, 1.0);
    }
    (w + u * along_u - v * along_v).norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
        Vector3::new(x, y, z)
    }

    const FLAT: fn() -> Corners = || [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];

    #[test]
    fn the_nearest_features_may_be_a_corner_over_a_face_two_edges_or_two_corners() {
        let over = [v(0.2, 0.2, 0.3), v(0.4, 0.2, 1.0), v(0.2, 0.5, 1.0)];
        assert!((face_distance(&FLAT(), &over) - 0.3).abs() < 1e-15);
        let beside = [v(0.5, -0.25, -1.0), v(0.5, -0.25, 1.0), v(0.5, -1.0, 0.0)];
        assert!((face_distance(&FLAT(), &beside) - 0.25).abs() < 1e-15);
        let away = [v(1.3, 0.0, 0.4), v(2.0, 0.0, 0.4), v(2.0, 1.0, 2.0)];
        assert!((face_distance(&FLAT(), &away) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn an_edge_through_a_face_crosses_and_one_beside_it_does_not() {
        let through = [v(0.2, 0.2, -1.0), v(0.2, 0.3, 1.0), v(3.0, 3.0, 1.0)];
        let beside = [v(0.8, 0.8, -1.0), v(0.8, 0.9, 1.0), v(3.0, 3.0, 1.0)];
        let above = FLAT().map(|corner| corner + v(0.0, 0.0, 1e-9));
        assert!(is_crossing(&FLAT(), &through) && is_crossing(&through, &FLAT()));
        assert!(!is_crossing(&FLAT(), &beside));
        assert!(!is_crossing(&FLAT(), &above));
    }
}
