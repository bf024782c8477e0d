//! Where the undeformed skin is pressed in deepest.

use nalgebra::Vector3;

/// The vertex of the undeformed skin that is pressed in deepest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DeepestVertex {
    pub vertex: usize,
    /// Depth (m).
    pub overlap: f64,
    /// Outward unit normal of the obstacle there.
    pub normal: Vector3<f64>,
}
