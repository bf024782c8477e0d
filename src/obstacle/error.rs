//! What an obstacle refuses, and why.

use crate::geometry::rigid_motion::RigidMotionError;
use crate::mesh::error::MeshError;

/// Why an obstacle, a pose or a question to it was rejected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// The mesh itself is defective.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The mesh has a border, so it has no inside.
    #[error(
        "an obstacle must be closed, but the mesh has {loops} open border(s) with {edges} edges in all, \
         the first at vertex {vertex}; close its holes where it was made; `repair` welds seams, and closes no hole"
    )]
    NotClosed {
        /// Number of boundary loops.
        loops: usize,
        /// Number of edges on them.
        edges: usize,
        /// A vertex on the first of them.
        vertex: usize,
    },
    /// Faces cross, so the inside is not defined near them.
    #[error(
        "{count} pair(s) of faces cross or touch, the first is faces {first} and {second} near \
         ({:.6}, {:.6}, {:.6}) m; the inside is not defined there: mend the mesh, or leave the check out \
         (`check_crossings=False`) if the contact stays away from it",
        location[0], location[1], location[2]
    )]
    CrossingFaces {
        /// Number of pairs.
        count: usize,
        /// Smaller face index of the first pair.
        first: usize,
        /// Larger face index of the first pair.
        second: usize,
        /// Center of the overlap of the two faces' boxes (m).
        location: [f64; 3],
    },
    /// A coordinate of a primitive is not finite or too large.
    #[error("{kind}: {what} must be finite and at most 1e60, found {value:?}")]
    NotFinite {
        /// The primitive.
        kind: &'static str,
        /// The argument at fault.
        what: &'static str,
        /// Its value.
        value: [f64; 3],
    },
    /// A length of a primitive is not positive, not finite or too large.
    #[error("{kind}: {what} must be positive and at most 1e60 (m), found {value}")]
    NotPositive {
        /// The primitive.
        kind: &'static str,
        /// The argument at fault.
        what: &'static str,
        /// Its value (m).
        value: f64,
    },
    /// The half-space's normal has no length.
    #[error("half-space: the normal must not be zero")]
    ZeroNormal,
    /// The two ends of a capsule are the same point.
    #[error("capsule: both ends are at ({}, {}, {}) m, which makes it a sphere; use a sphere", end[0], end[1], end[2])]
    CoincidentEnds {
        /// That point (m).
        end: [f64; 3],
    },
    /// The matrix or the translation is no rigid motion.
    #[error(transparent)]
    Motion(#[from] RigidMotionError),
    /// A point is not finite or too far.
    #[error("point {point} is {value:?}, but points must be finite and within 1e60 m ({count} are not)")]
    NonFinitePoint {
        /// The first such point.
        point: usize,
        /// Its value (m).
        value: [f64; 3],
        /// Number of such points.
        count: usize,
    },
    /// The maximum distance is negative or nan.
    #[error("the maximum distance must be 0 or more (m), found {max_distance}")]
    MaxDistance {
        /// Its value (m).
        max_distance: f64,
    },
    /// The direction of travel has no direction.
    #[error("the direction of travel must be finite and not zero, found {direction:?}")]
    Direction {
        /// Its value.
        direction: [f64; 3],
    },
    /// A half-space that comes along its own plane or backwards fills the space that it comes from.
    #[error(
        "a half-space comes from infinity along its outward normal only: direction · normal is {cosine:e}, \
         and must be above {tolerance:e}"
    )]
    HalfSpaceDirection {
        /// Cosine between direction and normal.
        cosine: f64,
        /// The smallest that is accepted.
        tolerance: f64,
    },
    /// A half-space has neither a middle nor a longest axis.
    #[error("a half-space has no end, so it has no longest axis to be laid along a frame")]
    Endless,
}
