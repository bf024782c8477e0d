//! Where the obstacle stands.

use nalgebra::Vector3;

use crate::obstacle::posed::Obstacle;

/// The obstacle in place, and what is known from bringing it there.
pub(crate) struct Scene {
    pub obstacle: Obstacle,
    /// Way of the obstacle (m).
    pub travel: f64,
    /// The press that brought it there, where one did.
    pub press: Option<Travel>,
    /// A penetration that no skin vertex exceeds (m), where known.
    pub depth_bound: Option<f64>,
}

/// A press that ends where the obstacle stands, which nothing penetrated at its start.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Travel {
    /// Unit direction of the obstacle.
    pub direction: Vector3<f64>,
    /// Its length (m).
    pub depth: f64,
}
