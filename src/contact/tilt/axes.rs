//! What may turn, and how far.

use nalgebra::{UnitQuaternion, Vector3};

use crate::contact::error::ContactError;
use crate::geometry::direction::{tangents, unit};
use crate::obstacle::posed::Obstacle;

/// Largest angle that an obstacle turns by (rad): 30 degrees.
pub(crate) const LARGEST_ANGLE: f64 = std::f64::consts::FRAC_PI_6;
/// Least sine of the angle between two axes.
const LEAST_SINE: f64 = 1e-3;

/// Whether the obstacle of a press turns as well.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Balance {
    /// It moves along the direction and nothing else.
    #[default]
    None,
    /// It turns until the moment about a point vanishes, by 30 degrees at the most.
    Tilt(Tilt),
}

/// What the obstacle of a press turns about.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tilt {
    /// The point (m) where the obstacle is held; it travels with the obstacle.
    pub point: Vector3<f64>,
    /// The axes that it may turn about.
    pub axes: TiltAxes,
}

/// Axes through the point of a [`Tilt`]; their lengths do not matter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TiltAxes {
    /// Two at right angles to the direction of the press.
    Across,
    /// One.
    One(Vector3<f64>),
    /// Two, not parallel.
    Two([Vector3<f64>; 2]),
}

impl Tilt {
    /// The point.
    ///
    /// # Errors
    /// [`ContactError::TiltPoint`].
    pub(crate) fn checked_point(&self) -> Result<Vector3<f64>, ContactError> {
        let point = self.point;
        if point.iter().all(|coordinate| coordinate.is_finite()) {
            return Ok(point);
        }
        Err(ContactError::TiltPoint { point: point.into() })
    }
}

impl TiltAxes {
    /// Unit axes.
    ///
    /// * `direction`: of the press, a unit vector
    ///
    /// # Errors
    /// [`ContactError::TiltAxis`], [`ContactError::ParallelAxes`].
    pub(crate) fn units(&self, direction: &Vector3<f64>) -> Result<Vec<Vector3<f64>>, ContactError> {
        let unit_of = |number, axis: &Vector3<f64>| {
            unit(axis).ok_or(ContactError::TiltAxis { number, axis: (*axis).into() })
        };
        let units = match self {
            Self::Across => tangents(direction).to_vec(),
            Self::One(axis) => vec![unit_of(0, axis)?],
            Self::Two([a, b]) => vec![unit_of(0, a)?, unit_of(1, b)?],
        };
        match units[..] {
            [a, b] if a.cross(&b).norm() < LEAST_SINE => Err(ContactError::ParallelAxes),
            _ => Ok(units),
        }
    }
}

/// A turn about a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub rotation: UnitQuaternion<f64>,
    /// The point (m); of a press, before any travel.
    pub point: Vector3<f64>,
}

impl Turn {
    /// The obstacle turned where it stands.
    pub fn of(&self, obstacle: &Obstacle) -> Obstacle {
        obstacle.turned(&self.rotation, &self.point)
    }

    /// Way by which it brought the obstacle to a place (m).
    pub fn way_to(&self, place: &Vector3<f64>) -> Vector3<f64> {
        let arm = place - self.point;
        arm - self.rotation.inverse_transform_vector(&arm)
    }

    /// How far a point of the obstacle moves at the most (m), within a distance (m) of the point.
    pub fn farthest(&self, distance: f64) -> f64 {
        2.0 * (0.5 * self.rotation.angle()).sin() * distance
    }
}
