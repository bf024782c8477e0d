//! Gaps of the vertices around an edge of the obstacle that meets the skin between them.
//!
//! Where a sharp edge touches a triangle of the skin, the plane between them has the normal m of the skin, taken across
//! the edge and turned around, as long as that lies between the normals of the faces that meet at the edge. The triangle has
//! to go back along m as a whole, so each corner's gap is `g = -t (m . -N)`, with t the depth of the edge under the triangle
//! and N its normal. Of several gaps, that to the closest point of the obstacle among them, a vertex takes the least.

use nalgebra::Vector3;

use crate::contact::gap::measured::Measured;
use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::{face_tree, node_bounds};
use crate::obstacle::edges::SharpEdge;
use crate::obstacle::posed::Obstacle;

/// Triangles of the skin, as corners among some points.
pub(crate) struct SkinPart<'a> {
    /// Positions (k, m).
    pub points: &'a [Vector3<f64>],
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

/// A sharp edge over or under a triangle.
pub(crate) struct EdgeAtTriangle {
    /// Number of the triangle.
    pub triangle: usize,
    /// Depth of the edge under it (m), negative over it.
    pub depth: f64,
    /// Normal of the plane between them, out of the obstacle.
    pub normal: Vector3<f64>,
    /// Cosine between that and the inward normal of the triangle.
    pub cosine: f64,
}

impl SkinPart<'_> {
    /// The sharp edges of the obstacle over or under the triangles, no deeper than `deepest` (m) and no higher than the
    /// triangle is wide.
    pub fn edges_of(&self, obstacle: &Obstacle, deepest: f64) -> Vec<EdgeAtTriangle> {
        let mut found = Vec::new();
        let around = Bounds::around(self.triangles.iter().flatten().map(|&k| &self.points[k as usize]));
        if self.triangles.is_empty() {
            return found;
        }
        let edges = obstacle.sharp_edges_near(&around.grown(deepest));
        if edges.is_empty() {
            return found;
        }
        let tree = face_tree(self.points, self.triangles);
        for edge in &edges {
            let reach = Bounds::around(&edge.ends).grown(deepest);
            for triangle in tree.leaves(|node| node_bounds(node).meets(&reach)) {
                let corners = self.triangles[triangle as usize].map(|k| self.points[k as usize]);
                found.extend(meeting(edge, &corners, deepest).map(|(depth, normal, cosine)| {
                    EdgeAtTriangle { triangle: triangle as usize, depth, normal, cosine }
                }));
            }
        }
        found
    }

    /// Gives the corners the gap to the plane between triangle and edge where that is the lesser one.
    pub fn take_edges(&self, obstacle: &Obstacle, deepest: f64, gaps: &mut Measured) {
        for edge in self.edges_of(obstacle, deepest) {
            let gap = -edge.depth * edge.cosine;
            for corner in self.triangles[edge.triangle].map(|corner| corner as usize) {
                if gap < gaps.distance[corner] {
                    gaps.distance[corner] = gap;
                    gaps.normal[corner] = edge.normal;
                }
            }
        }
    }
}

/// Depth (m) of an edge under a triangle, the normal of the plane between them, its cosine with the inward normal.
fn meeting(edge: &SharpEdge, triangle: &[Vector3<f64>; 3], deepest: f64) -> Option<(f64, Vector3<f64>, f64)> {
    let [a, b, c] = triangle;
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0)?;
    let between = edge.between(&-normal)?;
    let depth = depth_under(&edge.ends, triangle, &normal)?;
    let width = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    (depth > -width && depth <= deepest).then(|| (depth, between, -normal.dot(&between)))
}

/// Largest depth (m) of the part of a segment in the prism over a triangle, negative above.
fn depth_under(
    [p, q]: &[Vector3<f64>; 2],
    [a, b, c]: &[Vector3<f64>; 3],
    normal: &Vector3<f64>,
) -> Option<f64> {
    let (mut from, mut to) = (0.0, 1.0);
    for (start, end) in [(a, b), (b, c), (c, a)] {
        let inward = normal.cross(&(end - start));
        let (at_p, at_q) = ((p - start).dot(&inward), (q - start).dot(&inward));
        if at_p < 0.0 && at_q < 0.0 {
            return None;
        }
        let crossing = at_p / (at_p - at_q);
        if at_p < 0.0 {
            from = f64::max(from, crossing);
        } else if at_q < 0.0 {
            to = f64::min(to, crossing);
        }
    }
    if from > to {
        return None;
    }
    let depth = |t: f64| (a - p.lerp(q, t)).dot(normal);
    Some(depth(from).max(depth(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_depth_of_an_edge_is_that_of_its_part_under_the_triangle() {
        let triangle = [Vector3::zeros(), Vector3::x(), Vector3::y()];
        for (p, q, expected) in [
            ([0.2, 0.2, -0.1], [0.3, 0.2, -0.1], Some(0.1)),
            // deepest where it leaves the prism at x = 0
            ([-1.0, 0.2, -2.0], [1.0, 0.2, 0.0], Some(1.0)),
            ([-1.0, -0.1, -1.0], [1.0, -0.1, -1.0], None),
            ([0.2, 0.2, 0.1], [0.3, 0.2, 0.2], Some(-0.1)),
            ([2.0, 2.0, -1.0], [3.0, 2.0, -1.0], None),
        ] {
            let found = depth_under(&[p.into(), q.into()], &triangle, &Vector3::z());
            match (found, expected) {
                (Some(found), Some(expected)) => assert!((found - expected).abs() < 1e-15, "{found}"),
                _ => assert_eq!(found, expected),
            }
        }
    }

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
        part.take_edges(&roof, 0.2, &mut gaps);
        for corner in 0..3 {
            assert!((gaps.distance[corner] + 0.1).abs() < 1e-12, "{}", gaps.distance[corner]);
            assert!((gaps.normal[corner] - Vector3::z()).norm() < 1e-12);
        }
    }
}
