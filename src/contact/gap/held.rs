//! The gaps that vertices take from the lines of the obstacle that their triangles meet.
//!
//! A triangle has to go back along the normal m of the plane between it and a line as a whole, so each corner's gap is
//! `g = -t (m . -N)`, with t the depth of the line under the triangle and N its normal. A corner that is in the obstacle as deep
//! as the edge holds it alone: the face of a flat punch does not lend the depth of its rim to the skin beside it. Of several
//! gaps, that to the closest point of the obstacle among them, a vertex takes the least.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::contact::gap::edge::{Line, SkinPart};
use crate::contact::gap::measured::Measured;
use crate::obstacle::posed::Obstacle;

/// Least barycentric coordinate that an edge reaches in the triangle of a corner that feels it.
const LEAST_SHARE: f64 = 0.02;

/// A corner that is less deep than the edge by this share of its depth leaves the edge to be felt by all corners, one as deep
/// holds it alone.
const SHALLOWER_SHARE: f64 = 0.1;

/// Length of the mean of normals below which they are opposed, as in a fold over a thin wall: no plane is between them.
const OPPOSED_MEAN: f64 = 0.1;

/// A vertex on an edge of the obstacle.
struct OnEdge {
    line: Line,
    /// The least gap that it has there, by itself and in its triangles (m).
    gap: f64,
    /// Sum of the normals that its triangles have there, and how many.
    normals: Vector3<f64>,
    count: f64,
}

impl OnEdge {
    /// * `gap`: by itself (m)
    fn new(line: Line, gap: f64) -> Self {
        Self { line, gap, normals: Vector3::zeros(), count: 0.0 }
    }
}

impl SkinPart<'_> {
    /// Gives the corners the gap to the plane between triangle and obstacle where that is the lesser one.
    ///
    /// Returns these corners, with the line that each is held by.
    ///
    /// * `deepest`: under a corner (k, m)
    pub fn take_edges(
        &self,
        obstacle: &Obstacle,
        deepest: &[f64],
        gaps: &mut Measured,
    ) -> BTreeMap<usize, Line> {
        let mut taken = BTreeMap::new();
        let mut on_edges: BTreeMap<usize, OnEdge> = BTreeMap::new();
        let under = |triangle: usize| {
            let corners = self.triangles[triangle].iter();
            corners.map(|&corner| deepest[corner as usize]).fold(0.0, f64::max)
        };
        let edges = self.edges_of(obstacle, under, |triangle| self.is_unmet(triangle, &gaps.distance));
        let lines = self.lines_of(obstacle, under, &gaps.distance);
        // As the vertices alone were measured.
        let measured = gaps.distance.clone();
        for met in edges.iter().chain(&lines) {
            let gap = -met.depth * met.cosine;
            let corners = self.triangles[met.triangle].map(|corner| corner as usize);
            let deepest = corners.map(|corner| measured[corner]).into_iter().fold(f64::INFINITY, f64::min);
            let part = ((deepest - gap) / (SHALLOWER_SHARE * gap.abs())).clamp(0.0, 1.0);
            for (corner, share) in corners.into_iter().zip(met.shares) {
                let lent = measured[corner] + part * (gap - measured[corner]);
                if met.line.faces.is_some() && share > 1.0 - LEAST_SHARE && met.depth > 0.0 {
                    let on_edge = on_edges.entry(corner).or_insert(OnEdge::new(met.line, measured[corner]));
                    on_edge.gap = on_edge.gap.min(lent);
                    on_edge.normals += met.normal;
                    on_edge.count += 1.0;
                } else if share > LEAST_SHARE && lent < gaps.distance[corner] {
                    gaps.distance[corner] = lent;
                    gaps.normal[corner] = met.normal;
                    taken.insert(corner, met.line);
                }
            }
        }
        // A vertex on an edge is held by it, as deep as that may be by itself.
        for (corner, OnEdge { line, gap, normals, count }) in on_edges {
            let normal = normals.try_normalize(OPPOSED_MEAN * count);
            if let Some(normal) = normal.filter(|_| gap <= gaps.distance[corner]) {
                gaps.distance[corner] = gap;
                gaps.normal[corner] = normal;
                taken.insert(corner, line);
            }
        }
        taken
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_corners_keep_out_of_the_plane_through_an_edge_that_no_vertex_has_met() {
        // A roof along x, its ridge 0.1 inside the triangle, whose corners are all outside the roof.
        let points =
            [Vector3::new(-1.0, -1.0, 0.0), Vector3::new(0.0, 2.0, 0.0), Vector3::new(1.0, -1.0, 0.0)];
        let part = SkinPart { points: &points, triangles: &[[0, 1, 2]] };
        let roof = Obstacle::cuboid(Vector3::repeat(1.0)).expect("a box");
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_4);
        let shift = Vector3::new(0.0, 0.0, 0.1 - 2f64.sqrt());
        let roof = roof.moved(turn.matrix(), &shift).expect("a rotation");
        // The skin faces down on the roof.
        let mut gaps = Measured { distance: vec![0.5; 3], normal: vec![Vector3::y(); 3] };
        assert_eq!(part.take_edges(&roof, &[0.2; 3], &mut gaps).len(), 3);
        for corner in 0..3 {
            assert!((gaps.distance[corner] + 0.1).abs() < 1e-12, "{}", gaps.distance[corner]);
            assert!((gaps.normal[corner] - Vector3::z()).norm() < 1e-12);
        }
        // Along a side it is none of the far corner's.
        let aside = roof.translated(&-Vector3::y());
        let mut gaps = Measured { distance: vec![0.5; 3], normal: vec![Vector3::y(); 3] };
        assert_eq!(Vec::from_iter(part.take_edges(&aside, &[0.2; 3], &mut gaps).into_keys()), [0, 2]);
    }

    #[test]
    fn a_ball_within_a_triangle_pushes_its_corners_until_one_meets_it() {
        let points =
            [Vector3::new(-1.0, -1.0, 0.0), Vector3::new(0.0, 2.0, 0.0), Vector3::new(1.0, -1.0, 0.0)];
        let part = SkinPart { points: &points, triangles: &[[0, 1, 2]] };
        let ball = Obstacle::sphere(Vector3::new(0.0, 0.0, -0.05), 0.15).expect("a ball");
        let mut gaps = Measured { distance: vec![0.5; 3], normal: vec![Vector3::y(); 3] };
        assert_eq!(part.take_edges(&ball, &[0.2; 3], &mut gaps).len(), 3);
        assert!(gaps.distance.iter().all(|gap| (gap + 0.1).abs() < 1e-15), "{:?}", gaps.distance);
        let mut met = Measured { distance: vec![0.5, -0.01, 0.5], normal: vec![Vector3::y(); 3] };
        assert!(part.take_edges(&ball, &[0.2; 3], &mut met).is_empty());
    }
}
