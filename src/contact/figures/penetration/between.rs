//! How deep triangles stand in an obstacle between their corners.
//!
//! A signed distance changes by no more than the way that a point is moved. So points near to others that are clear of
//! the obstacle, or less deep than the deepest so far, need not be measured.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::mesh::distinct::distinct;
use crate::obstacle::posed::Obstacle;

/// Parts that the edges of all triangles, and of those that penetrate, are cut into to look between their vertices.
const COARSE_PARTS: usize = 3;
const FINE_PARTS: usize = 6;
/// Share of the deepest penetration from which a triangle is looked at more finely.
const DEEP_SHARE: f64 = 0.5;

/// Triangles whose corners are measured, and points between these: on every edge once, and on every face.
pub(crate) struct PointsBetween<'a> {
    /// Places (m).
    corners: &'a [Vector3<f64>],
    /// How deep each corner stands in the obstacle at the most (m, negative outside).
    depths: &'a [f64],
    faces: &'a [[u32; 3]],
    edges: Vec<[u32; 2]>,
    /// The three of each face.
    edges_of: Vec<[usize; 3]>,
}

/// What is found between the corners.
pub(crate) struct Between {
    /// Deepest penetration (m, ≥ 0).
    pub deepest: f64,
    /// How far the middle of each face is from the obstacle at the least (m); none where that is flat.
    pub middles: Vec<f64>,
    /// Deepest penetration (m, ≥ 0) between the corners of each face, at a few points; none where the obstacle is flat.
    pub of_faces: Vec<f64>,
}

/// Points on edges (N = 2) or within faces (N = 3), each with what is known of its depth.
struct Samples<const N: usize> {
    shares: Vec<[f64; N]>,
    points: Vec<Vector3<f64>>,
    /// The depth (m), or what it cannot exceed where that was enough.
    most: Vec<f64>,
}

impl<'a> PointsBetween<'a> {
    /// * `corners`: places (m)
    /// * `depths`: how deep each stands in the obstacle at the most (m, negative outside)
    /// * `faces`: triangles of them
    pub fn new(corners: &'a [Vector3<f64>], depths: &'a [f64], faces: &'a [[u32; 3]]) -> Self {
        let mut number: HashMap<[u32; 2], usize> = HashMap::with_capacity(2 * faces.len());
        let mut edges = Vec::with_capacity(2 * faces.len());
        let mut edge = |a: u32, b: u32| {
            *number.entry([a.min(b), a.max(b)]).or_insert_with_key(|&ends| {
                edges.push(ends);
                edges.len() - 1
            })
        };
        let edges_of = faces.iter().map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]).collect();
        Self { corners, depths, edges, edges_of, faces }
    }

    /// Looks between the corners.
    ///
    /// * `least`: the deepest penetration (m, ≥ 0) where none there is deeper
    pub fn look(&self, obstacle: &Obstacle, least: f64) -> Result<Between, ContactError> {
        if obstacle.is_half_space() {
            let deepest = self.depths.iter().copied().fold(least, f64::max);
            return Ok(Between { deepest, middles: Vec::new(), of_faces: Vec::new() });
        }
        let on_edges = self.sampled(&self.edges, COARSE_PARTS, obstacle, 0.0, |_, _| f64::INFINITY)?;
        let on_faces = self.sampled(self.faces, COARSE_PARTS, obstacle, 0.0, |_, _| f64::INFINITY)?;
        let deepest = self.deepest(obstacle, least, &on_edges, &on_faces)?;
        // One point cuts the edges of a face in three.
        let middles = on_faces.most.iter().map(|depth| -depth).collect();
        let on_sides = |edge: &usize| on_edges.of(*edge).1.iter().copied();
        let of_face = |(edges, middle): (&[usize; 3], &f64)| {
            edges.iter().flat_map(on_sides).fold(middle.max(0.0), f64::max)
        };
        let of_faces = self.edges_of.iter().zip(&on_faces.most).map(of_face).collect();
        Ok(Between { deepest, middles, of_faces })
    }

    /// Deepest penetration of a point between the corners (m); `least` (m, ≥ 0) where none is deeper.
    fn deepest(
        &self,
        obstacle: &Obstacle,
        least: f64,
        on_edges: &Samples<2>,
        on_faces: &Samples<3>,
    ) -> Result<f64, ContactError> {
        let between = on_edges.deepest().max(on_faces.deepest());
        if between <= 0.0 {
            return Ok(least);
        }
        // Finer where it is deep.
        let is_deep = |most: &[f64]| most.iter().any(|&depth| depth > DEEP_SHARE * between);
        let deep: Vec<usize> = (0..self.faces.len())
            .filter(|&face| {
                let of_edges = self.edges_of[face].iter();
                is_deep(on_faces.of(face).1) || of_edges.clone().any(|&edge| is_deep(on_edges.of(edge).1))
            })
            .collect();
        let deep_edges = distinct(deep.iter().flat_map(|&face| self.edges_of[face]));
        let ends: Vec<[u32; 2]> = deep_edges.iter().map(|&edge| self.edges[edge]).collect();
        let faces: Vec<[u32; 3]> = deep.iter().map(|&face| self.faces[face]).collect();
        let deepest = least.max(between);
        let finer = self.sampled(&ends, FINE_PARTS, obstacle, deepest, |edge, point| {
            on_edges.bound(deep_edges[edge], point)
        })?;
        let deepest = deepest.max(finer.deepest());
        let finer = self.sampled(&faces, FINE_PARTS, obstacle, deepest, |face, point| {
            let edges = self.edges_of[deep[face]].iter().map(|&edge| on_edges.bound(edge, point));
            edges.fold(on_faces.bound(deep[face], point), f64::min)
        })?;
        Ok(deepest.max(finer.deepest()))
    }

    /// Points that cut the edges of `cells` into so many parts, measured where they may be deeper than `least` (m).
    ///
    /// * `bound`: a depth (m) that a point of a cell cannot exceed, beside what its corners say
    fn sampled<const N: usize>(
        &self,
        cells: &[[u32; N]],
        parts: usize,
        obstacle: &Obstacle,
        least: f64,
        bound: impl Fn(usize, &Vector3<f64>) -> f64,
    ) -> Result<Samples<N>, ContactError> {
        let shares = lattice(parts);
        let count = cells.len() * shares.len();
        let (mut points, mut most) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (cell, corners) in cells.iter().enumerate() {
            let corners = corners.map(|corner| (self.corners[corner as usize], self.depths[corner as usize]));
            for shares in &shares {
                let point: Vector3<f64> =
                    corners.iter().zip(shares).map(|((corner, _), share)| *share * corner).sum();
                let at_corners = bound_by(&point, corners);
                most.push(if at_corners > least { at_corners.min(bound(cell, &point)) } else { at_corners });
                points.push(point);
            }
        }
        let open: Vec<usize> = (0..count).filter(|&sample| most[sample] > least).collect();
        let wanted: Vec<Vector3<f64>> = open.iter().map(|&sample| points[sample]).collect();
        let reach = open.iter().map(|&sample| most[sample]).fold(0.0, f64::max);
        let found = obstacle.signed_distance(&wanted, Some(reach))?;
        for (sample, distance) in open.into_iter().zip(found.distance) {
            // None is deeper than the reach, so that what is beyond it is outside.
            most[sample] = -distance.min(reach);
        }
        Ok(Samples { shares, points, most })
    }
}

impl<const N: usize> Samples<N> {
    /// The points of a cell, and what is known of their depths.
    fn of(&self, cell: usize) -> (&[Vector3<f64>], &[f64]) {
        let own = cell * self.shares.len()..(cell + 1) * self.shares.len();
        (&self.points[own.clone()], &self.most[own])
    }

    /// A depth (m) that a point cannot exceed, by those of a cell.
    fn bound(&self, cell: usize, point: &Vector3<f64>) -> f64 {
        let (points, most) = self.of(cell);
        bound_by(point, points.iter().copied().zip(most.iter().copied()))
    }

    /// The largest (m).
    fn deepest(&self) -> f64 {
        self.most.iter().copied().fold(0.0, f64::max)
    }
}

/// The depth (m) that a point cannot exceed, by the places and depths of others.
fn bound_by(point: &Vector3<f64>, others: impl IntoIterator<Item = (Vector3<f64>, f64)>) -> f64 {
    others.into_iter().map(|(place, depth)| depth + (place - point).norm()).fold(f64::INFINITY, f64::min)
}

/// Barycentric coordinates of the points that cut the edges of a cell into so many parts, but for those on its border.
fn lattice<const N: usize>(parts: usize) -> Vec<[f64; N]> {
    let numbers = (0..parts.pow(N as u32 - 1)).map(|index| {
        let mut shares = [0; N];
        let mut rest = index;
        for share in &mut shares[1..] {
            (*share, rest) = (rest % parts, rest / parts);
        }
        shares
    });
    let inner = numbers.filter_map(|mut shares| {
        shares[0] = parts.checked_sub(shares.iter().sum())?;
        (!shares.contains(&0)).then(|| shares.map(|share| share as f64 / parts as f64))
    });
    inner.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::one_diagonal_grid;

    fn all_between(parts: usize, corners: &[Vector3<f64>], faces: &[[u32; 3]]) -> Vec<Vector3<f64>> {
        let step = |k: usize| k as f64 / parts as f64;
        let rows = (0..=parts).flat_map(|i| (0..=parts - i).map(move |j| [step(i), step(j)]));
        let places: Vec<[f64; 2]> =
            rows.filter(|share| !share.contains(&1.0) && *share != [0.0; 2]).collect();
        let at = |&[a, b, c]: &[u32; 3], &[s, t]: &[f64; 2]| {
            let [a, b, c] = [a, b, c].map(|corner| corners[corner as usize]);
            a + s * (b - a) + t * (c - a)
        };
        faces.iter().flat_map(|face| places.iter().map(move |place| at(face, place))).collect()
    }

    #[test]
    fn the_deepest_point_is_that_of_all_points_measured() {
        let ball = Obstacle::sphere(Vector3::new(3.3, 2.8, -5.0), 5.0).expect("a ball");
        let (mut corners, faces) = one_diagonal_grid(6);
        // Its top lies between the corners.
        for (height, meets) in [(-0.01, true), (-0.2, true), (0.5, false), (-6.0, true), (-0.08, true)] {
            corners.iter_mut().for_each(|corner| corner.z = height);
            let depth_of = |points: &[Vector3<f64>]| -> Vec<f64> {
                let found = ball.signed_distance(points, None).expect("points");
                found.distance.iter().map(|distance| -distance).collect()
            };
            let depths = depth_of(&corners);
            let at_corners = depths.iter().copied().fold(0.0, f64::max);
            let all: Vec<f64> = [COARSE_PARTS, FINE_PARTS]
                .iter()
                .flat_map(|&parts| depth_of(&all_between(parts, &corners, &faces)))
                .collect();
            let expected = all.into_iter().fold(at_corners, f64::max);
            let found = PointsBetween::new(&corners, &depths, &faces)
                .look(&ball, at_corners)
                .expect("points")
                .deepest;
            assert!((found - expected).abs() < 1e-14, "{found} of {expected}");
            assert_eq!(found > at_corners, meets);
        }
    }

    #[test]
    fn no_point_is_taken_twice() {
        for (parts, [on_edge, on_face]) in [(2, [1, 0]), (3, [2, 1]), (6, [5, 10])] {
            assert_eq!([lattice::<2>(parts).len(), lattice::<3>(parts).len()], [on_edge, on_face]);
            assert!(
                lattice::<3>(parts).iter().all(|shares| (shares.iter().sum::<f64>() - 1.0).abs() < 1e-15)
            );
        }
    }
}
