//! The pose of an obstacle as a matrix.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// The pose as a matrix, which is quicker to apply than a quaternion.
pub(super) struct PoseMatrix {
    pub rotation: Matrix3<f64>,
    pub translation: Vector3<f64>,
}

impl PoseMatrix {
    /// That of a pose.
    pub fn of(pose: &Isometry3<f64>) -> Self {
        Self {
            rotation: pose.rotation.to_rotation_matrix().into_inner(),
            translation: pose.translation.vector,
        }
    }

    /// A point of the world in the obstacle's frame.
    pub fn to_local(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&(point - self.translation))
    }

    /// A point of the obstacle's frame in the world.
    pub fn to_world(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * point + self.translation
    }

    /// A direction of the obstacle's frame in the world.
    pub fn turn(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * direction
    }

    /// A direction of the world in the obstacle's frame.
    pub fn turn_back(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(direction)
    }
}
