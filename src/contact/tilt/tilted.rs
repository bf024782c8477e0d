//! What turns about which point and axes, and the moments that are left about them.

use nalgebra::{UnitQuaternion, Vector3};

use crate::contact::outcome::Contact;
use crate::contact::reach::target::{Aim, Quantity, Target};
use crate::contact::setup::Setup;
use crate::contact::tilt::axes::{LARGEST_ANGLE, Turn};

/// A press whose obstacle turns.
pub(crate) struct Tilted<'a> {
    pub setup: Setup<'a>,
    pub aim: Aim,
    /// Unit axes, one or two.
    pub axes: Vec<Vector3<f64>>,
    /// Point that they go through, before any travel (m).
    pub point: Vector3<f64>,
}

impl Tilted<'_> {
    /// The force to be reached along the direction (N).
    pub fn force(&self) -> Option<f64> {
        match self.aim {
            Aim::Value(Target { quantity: Quantity::Force, value }) => Some(value),
            _ => None,
        }
    }

    /// Moments on the skin about the axes (N m).
    pub fn moments(&self, contact: &Contact) -> Vec<f64> {
        let point = self.point_at(contact);
        let total = contact.resultant.moment - point.cross(&contact.resultant.force);
        self.axes.iter().map(|axis| axis.dot(&total)).collect()
    }

    /// The point where it stands (m).
    pub fn point_at(&self, contact: &Contact) -> Vector3<f64> {
        self.point + contact.travel * self.setup.approach.direction
    }

    /// Largest distance of a vertex under force from the point, or from the axis where that is one (m); the size of the skin
    /// without any.
    pub fn lever(&self, contact: &Contact) -> f64 {
        let point = self.point_at(contact);
        let surface = contact.surface();
        let distance = |&vertex: &usize| {
            let arm = surface.vertices()[vertex] - point;
            match &self.axes[..] {
                [axis] => axis.cross(&arm).norm(),
                _ => arm.norm(),
            }
        };
        let largest = contact.active.iter().map(distance).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { surface.bounding_box().diagonal() }
    }

    pub fn turned_by(&self, angles: &[f64]) -> Turn {
        Turn { rotation: UnitQuaternion::from_scaled_axis(self.rotation(angles)), point: self.point }
    }

    /// The axis of a turn, as long as its angle (rad).
    fn rotation(&self, angles: &[f64]) -> Vector3<f64> {
        self.axes.iter().zip(angles).map(|(axis, &angle)| angle * axis).sum()
    }

    /// Share of a step between angles (rad) that stays within the largest angle.
    pub fn room(&self, from: &[f64], to: &[f64]) -> f64 {
        let (from, to) = (self.rotation(from), self.rotation(to));
        if to.norm() <= LARGEST_ANGLE {
            return 1.0;
        }
        // |from + s way| = largest
        let way = to - from;
        let (a, b) = (way.norm_squared(), from.dot(&way));
        let c = from.norm_squared() - LARGEST_ANGLE * LARGEST_ANGLE;
        ((b * b - a * c).max(0.0).sqrt() - b) / a
    }
}
