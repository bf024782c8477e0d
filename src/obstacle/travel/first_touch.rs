//! The travel at which an obstacle first meets one of many points.

use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::geometry::direction::unit;
use crate::obstacle::distance::check_points;
use crate::obstacle::error::ObstacleError;
use crate::obstacle::posed::Obstacle;
use crate::obstacle::travel::sweep::SweptShape;

/// A point that rounding puts this share of the obstacle's size inside still counts as not yet met.
const START_TOLERANCE: f64 = 1e-12;

/// Fewest points that are worth a task of their own, to be met and to be moved alone.
const POINTS_PER_TASK: usize = 256;
const MOVED_PER_TASK: usize = 8192;

/// One point in so many is looked at first: what they find spares most of the others a search.
const LOOK_AHEAD: usize = 64;

/// Where a moving obstacle first meets a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstTouch {
    /// Way of the obstacle along the direction from where it stands now (m); negative if it would have met the
    /// point before.
    pub travel: f64,
    /// The point that it meets; of several, the one with the smallest index.
    pub point: usize,
}

impl Obstacle {
    /// The travel along `direction` at which the obstacle, coming from infinity, first has one of the points on
    /// its surface; `None` if it passes all of them by.
    ///
    /// Each point looks along its line to the side that the obstacle comes from for the farthest point of the
    /// surface. A mesh is met at its edges and vertices as surely as at its faces, since sides are decided by
    /// exact predicates in the plane across the line. So at the travel found no point is deeper inside the
    /// obstacle than rounding, about 1e-15 of its size.
    ///
    /// * `points`: (n) points (m), finite
    /// * `direction`: of the obstacle's travel, of any length but 0
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NonFinitePoint`], [`ObstacleError::Direction`] and, for a half-space that does not
    /// travel along its outward normal, [`ObstacleError::HalfSpaceDirection`].
    pub fn first_touch(
        &self,
        points: &[Vector3<f64>],
        direction: &Vector3<f64>,
    ) -> Result<Option<FirstTouch>, ObstacleError> {
        let sweep = self.sweep(points, direction)?;
        sweep.check_arrival()?;
        Ok(earliest(points.len(), |point, latest| sweep.meeting(point, f64::NEG_INFINITY, latest)))
    }

    /// As [`Obstacle::first_touch`], but the obstacle starts where it stands, so `travel >= 0`.
    ///
    /// No point may be inside to begin with: the surface that such a point meets first is the far side.
    /// A point on the surface, up to 1e-12 of the obstacle's size, is met at 0.
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NonFinitePoint`] and [`ObstacleError::Direction`].
    pub fn first_touch_from_current(
        &self,
        points: &[Vector3<f64>],
        direction: &Vector3<f64>,
    ) -> Result<Option<FirstTouch>, ObstacleError> {
        let sweep = self.sweep(points, direction)?;
        let start = -START_TOLERANCE * sweep.size();
        let met = earliest(points.len(), |point, latest| sweep.meeting(point, start, latest));
        Ok(met.map(|touch| FirstTouch { travel: touch.travel.max(0.0), ..touch }))
    }

    /// Way of the obstacle (m) since it first met each point, on a travel of length `reach` that ends where it stands
    /// now; `None` for points that it did not meet.
    ///
    /// * `points`: (n) points (m), finite
    /// * `direction`: of the obstacle's travel, of any length but 0
    /// * `reach`: length of the travel (m), >= 0
    ///
    /// # Errors
    ///
    /// [`ObstacleError::NonFinitePoint`] and [`ObstacleError::Direction`].
    pub fn entry_distances(
        &self,
        points: &[Vector3<f64>],
        direction: &Vector3<f64>,
        reach: f64,
    ) -> Result<Vec<Option<f64>>, ObstacleError> {
        let sweep = self.sweep(points, direction)?;
        let start = -reach - START_TOLERANCE * sweep.size();
        let back = |point| {
            let travel = sweep.meeting(point, start, 0.0).filter(|travel| *travel <= 0.0)?;
            Some((-travel).min(reach))
        };
        Ok((0..points.len()).into_par_iter().with_min_len(POINTS_PER_TASK).map(back).collect())
    }

    fn sweep(
        &self,
        points: &[Vector3<f64>],
        direction: &Vector3<f64>,
    ) -> Result<SweptShape<'_>, ObstacleError> {
        check_points(points)?;
        let direction = unit(direction).ok_or(ObstacleError::Direction { direction: (*direction).into() })?;
        let pose = self.pose_matrix();
        let local =
            points.par_iter().with_min_len(MOVED_PER_TASK).map(|point| pose.to_local(point)).collect();
        Ok(SweptShape::new(self.shape(), local, pose.turn_back(&direction)))
    }
}

/// The smallest of `meeting(point, latest)` over all points; the smallest index among equals.
///
/// `latest` is the best travel so far. It may only spare the search for what is later, never for what is equal,
/// so the outcome is the same whichever thread comes first.
fn earliest(count: usize, meeting: impl Fn(usize, f64) -> Option<f64> + Sync) -> Option<FirstTouch> {
    let ahead = (0..count).step_by(LOOK_AHEAD);
    let best =
        ahead.fold(f64::INFINITY, |best, point| meeting(point, best).map_or(best, |met| met.min(best)));
    let best = AtomicU64::new(best.to_bits());
    (0..count)
        .into_par_iter()
        .with_min_len(POINTS_PER_TASK)
        .filter_map(|point| {
            let travel = meeting(point, f64::from_bits(best.load(Ordering::Relaxed)))?;
            let lower = |bits: u64| (travel < f64::from_bits(bits)).then(|| travel.to_bits());
            // A failed update means that another point did better already.
            let _ = best.fetch_update(Ordering::Relaxed, Ordering::Relaxed, lower);
            Some(FirstTouch { travel, point })
        })
        .reduce_with(|a, b| {
            let b_first = b.travel < a.travel || (b.travel == a.travel && b.point < a.point);
            if b_first { b } else { a }
        })
}
