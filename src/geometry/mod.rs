//! Points and triangles: bounds, closest point, crossing, segment, direction, ray, solid angle, rigid motion. No mesh, no
//! physics.

pub(crate) mod bounds;
pub(crate) mod closest_point;
pub(crate) mod crossing;
pub(crate) mod direction;
pub(crate) mod face_tree;
pub(crate) mod ray;
pub(crate) mod rigid_motion;
pub(crate) mod segment;
pub(crate) mod solid_angle;

pub use bounds::Bounds;
pub use face_tree::find_crossings;
pub use rigid_motion::{RigidMotionError, rigid_motion};
pub use solid_angle::{solid_angle, winding_number};
