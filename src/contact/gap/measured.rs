//! Signed distances of points from the obstacle, measured no further than needed.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::obstacle::posed::Obstacle;

/// Signed distance and normal per point; infinite and NaN where the search found none.
#[derive(Debug, Clone)]
pub(crate) struct Measured {
    /// g0 (n, m).
    pub distance: Vec<f64>,
    /// Outward unit normal of the obstacle at its closest point (n).
    pub normal: Vec<Vector3<f64>>,
}

impl Measured {
    /// Measures every point nearer to the obstacle than `reach` (m) and every point inside it.
    ///
    /// `depth_bound` (m), where known, is a penetration that no point exceeds; without it the points within the
    /// obstacle's bounding box are measured without limit, as any of them may lie deep inside.
    pub fn near(
        points: &[Vector3<f64>],
        obstacle: &Obstacle,
        reach: f64,
        depth_bound: Option<f64>,
    ) -> Result<Self, ContactError> {
        let mut measured = Self {
            distance: vec![f64::INFINITY; points.len()],
            normal: vec![Vector3::repeat(f64::NAN); points.len()],
        };
        let all = 0..points.len();
        if reach.is_infinite() {
            measured.fill(points, obstacle, &all.collect::<Vec<_>>(), None)?;
            return Ok(measured);
        }
        let near = within_box(points, obstacle, reach, all);
        measured.fill(points, obstacle, &near, Some(reach))?;
        if depth_bound.is_none() {
            let unanswered = near.into_iter().filter(|&point| measured.distance[point].is_infinite());
            let maybe_inside = within_box(points, obstacle, 0.0, unanswered);
            measured.fill(points, obstacle, &maybe_inside, None)?;
            for point in maybe_inside {
                if measured.distance[point] > reach {
                    measured.distance[point] = f64::INFINITY;
                    measured.normal[point].fill(f64::NAN);
                }
            }
        }
        Ok(measured)
    }

    /// Some of the points, in that order.
    pub fn rows(&self, points: &[usize]) -> Self {
        Self {
            distance: points.iter().map(|&point| self.distance[point]).collect(),
            normal: points.iter().map(|&point| self.normal[point]).collect(),
        }
    }

    /// Of some points the one with the lowest gap.
    pub fn deepest_of(&self, points: &[usize]) -> Option<usize> {
        points.iter().copied().min_by(|&a, &b| self.distance[a].total_cmp(&self.distance[b]))
    }

    /// Those of some points that have not been measured yet.
    pub fn missing(&self, points: &[usize]) -> Vec<usize> {
        points.iter().copied().filter(|&point| self.distance[point].is_infinite()).collect()
    }

    /// Measures some of the points.
    ///
    /// * `max_distance`: (m); `None`: without limit
    pub fn fill(
        &mut self,
        points: &[Vector3<f64>],
        obstacle: &Obstacle,
        wanted: &[usize],
        max_distance: Option<f64>,
    ) -> Result<(), ContactError> {
        if wanted.is_empty() {
            return Ok(());
        }
        let queried: Vec<Vector3<f64>> = wanted.iter().map(|&point| points[point]).collect();
        let answer = obstacle.signed_distance(&queried, max_distance)?;
        for (row, &point) in wanted.iter().enumerate() {
            self.distance[point] = answer.distance[row];
            self.normal[point] = answer.normal[row];
        }
        Ok(())
    }
}

/// Those of `wanted` that lie within the obstacle's bounding box grown by `margin` (m).
fn within_box(
    points: &[Vector3<f64>],
    obstacle: &Obstacle,
    margin: f64,
    wanted: impl Iterator<Item = usize>,
) -> Vec<usize> {
    let Some(bounds) = obstacle.bounding_box() else {
        return wanted.collect();
    };
    let bounds = bounds.grown(margin);
    wanted.filter(|&point| bounds.contains(&points[point])).collect()
}
