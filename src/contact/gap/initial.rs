//! Initial gaps: signed distance of the skin's vertices from the obstacle, measured no further than needed.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::obstacle::posed::Obstacle;

/// Initial gap and obstacle normal per vertex; infinite and NaN beyond the search distance.
#[derive(Debug, Clone)]
pub(crate) struct InitialGaps {
    /// g0 (n, m).
    pub distance: Vec<f64>,
    /// Outward unit normal of the obstacle at its closest point (n).
    pub normal: Vec<Vector3<f64>>,
    /// Every vertex not measured is at least this far from the obstacle, outside it (m).
    pub search_distance: f64,
}

impl InitialGaps {
    /// Measures every vertex nearer to the obstacle than `search_distance` (m) and every vertex inside it.
    ///
    /// `depth_bound` (m), where known, is a penetration that no vertex exceeds; without it the vertices within
    /// the obstacle's bounding box are measured without limit, as any of them may lie deep inside.
    pub fn measure(
        points: &[Vector3<f64>],
        obstacle: &Obstacle,
        search_distance: f64,
        depth_bound: Option<f64>,
    ) -> Result<Self, ContactError> {
        let reach = search_distance.max(depth_bound.unwrap_or(0.0));
        let mut gaps = Self {
            distance: vec![f64::INFINITY; points.len()],
            normal: vec![Vector3::repeat(f64::NAN); points.len()],
            search_distance: reach,
        };
        let near = within_box(points, obstacle, reach, 0..points.len());
        gaps.fill(points, obstacle, &near, Some(reach))?;
        if depth_bound.is_none() {
            let unanswered = near.into_iter().filter(|&vertex| gaps.distance[vertex].is_infinite());
            let maybe_inside = within_box(points, obstacle, 0.0, unanswered);
            gaps.fill(points, obstacle, &maybe_inside, None)?;
            for vertex in maybe_inside {
                if gaps.distance[vertex] > reach {
                    gaps.distance[vertex] = f64::INFINITY;
                    gaps.normal[vertex].fill(f64::NAN);
                }
            }
        }
        Ok(gaps)
    }

    /// Measures `vertices` without limit where they have not been measured yet.
    pub fn complete(
        &mut self,
        points: &[Vector3<f64>],
        obstacle: &Obstacle,
        vertices: &[usize],
    ) -> Result<(), ContactError> {
        let missing: Vec<usize> =
            vertices.iter().copied().filter(|&vertex| self.distance[vertex].is_infinite()).collect();
        self.fill(points, obstacle, &missing, None)
    }

    fn fill(
        &mut self,
        points: &[Vector3<f64>],
        obstacle: &Obstacle,
        vertices: &[usize],
        max_distance: Option<f64>,
    ) -> Result<(), ContactError> {
        if vertices.is_empty() {
            return Ok(());
        }
        let queried: Vec<Vector3<f64>> = vertices.iter().map(|&vertex| points[vertex]).collect();
        let answer = obstacle.signed_distance(&queried, max_distance)?;
        for (row, &vertex) in vertices.iter().enumerate() {
            self.distance[vertex] = answer.distance[row];
            self.normal[vertex] = answer.normal[row];
        }
        Ok(())
    }
}

/// Those of `vertices` that lie within the obstacle's bounding box grown by `margin` (m).
fn within_box(
    points: &[Vector3<f64>],
    obstacle: &Obstacle,
    margin: f64,
    vertices: impl Iterator<Item = usize>,
) -> Vec<usize> {
    let Some((low, high)) = obstacle.bounding_box() else {
        return vertices.collect();
    };
    let (low, high) = (low.add_scalar(-margin), high.add_scalar(margin));
    vertices
        .filter(|&vertex| {
            let point = &points[vertex];
            (0..3).all(|axis| low[axis] <= point[axis] && point[axis] <= high[axis])
        })
        .collect()
}
