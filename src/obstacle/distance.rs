//! Signed distances of many points at once.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::geometry::bounds::is_within_range;
use crate::linalg::factor::Interrupt;
use crate::obstacle::error::ObstacleError;
use crate::obstacle::nearest::Nearest;
use crate::obstacle::posed::{Obstacle, Shape};

/// Fewest points that are worth a task of their own: of a mesh, and of a primitive.
const POINTS_PER_TASK: [usize; 2] = [64, 1024];

/// What [`Obstacle::signed_distance`] found, one entry a point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SignedDistances {
    /// Signed distance (m), positive outside; infinite beyond the maximum distance.
    pub distance: Vec<f64>,
    /// Closest point of the surface (m); nan beyond the maximum distance.
    pub closest: Vec<Vector3<f64>>,
    /// Outward unit normal: `(p - closest) / distance`, and on the surface itself the normal of the face, or
    /// the mean of the faces that meet there; nan beyond the maximum distance.
    pub normal: Vec<Vector3<f64>>,
}

impl Obstacle {
    /// Signed distance, closest point and outward normal of every point, in parallel.
    ///
    /// Distances are right to rounding, about 1e-16 of the coordinates. They are equal to the bit
    /// for any number of threads.
    ///
    /// * `points`: (n) points (m), finite
    /// * `max_distance`: farthest distance of interest (m), >= 0; a point farther from the surface, outside or
    ///   inside, gets `inf`, `nan`, `nan`, which saves most of the time
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NonFinitePoint`] and [`ObstacleError::MaxDistance`].
    pub fn signed_distance(
        &self,
        points: &[Vector3<f64>],
        max_distance: Option<f64>,
    ) -> Result<SignedDistances, ObstacleError> {
        self.signed_distance_until(points, max_distance, &|| false)
    }

    /// The same; once it is interrupted, points that it has not come to are as if they were beyond.
    pub(crate) fn signed_distance_until(
        &self,
        points: &[Vector3<f64>],
        max_distance: Option<f64>,
        interrupted: Interrupt,
    ) -> Result<SignedDistances, ObstacleError> {
        check_points(points)?;
        let reach = max_distance.unwrap_or(f64::INFINITY);
        if reach.is_nan() || reach < 0.0 {
            return Err(ObstacleError::MaxDistance { max_distance: reach });
        }
        let pose = self.pose_matrix();
        let answer = |point: &Vector3<f64>| {
            let found = self.shape().nearest(&pose.to_local(point), reach)?;
            (found.distance.abs() <= reach).then(|| Nearest {
                distance: found.distance,
                closest: pose.to_world(&found.closest),
                normal: pose.turn(&found.normal),
            })
        };
        let [of_mesh, of_primitive] = POINTS_PER_TASK;
        let at_once = if matches!(self.shape(), Shape::Mesh(_)) { of_mesh } else { of_primitive };
        let mut answers = vec![Nearest::BEYOND; points.len()];
        answers.par_chunks_mut(at_once).zip(points.par_chunks(at_once)).for_each(|(answers, points)| {
            if !interrupted() {
                let found = points.iter().map(|point| answer(point).unwrap_or(Nearest::BEYOND));
                answers.iter_mut().zip(found).for_each(|(answer, found)| *answer = found);
            }
        });
        Ok(SignedDistances {
            distance: answers.iter().map(|answer| answer.distance).collect(),
            closest: answers.iter().map(|answer| answer.closest).collect(),
            normal: answers.iter().map(|answer| answer.normal).collect(),
        })
    }
}

/// Every coordinate is finite and in range.
pub(super) fn check_points(points: &[Vector3<f64>]) -> Result<(), ObstacleError> {
    let is_bad = |point: &Vector3<f64>| !is_within_range(point);
    match points.iter().position(is_bad) {
        None => Ok(()),
        Some(point) => Err(ObstacleError::NonFinitePoint {
            point,
            value: points[point].into(),
            count: points.iter().filter(|point| is_bad(point)).count(),
        }),
    }
}
