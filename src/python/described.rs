//! An obstacle in words.

use nalgebra::{Point3, Vector3};

use crate::obstacle::{Obstacle, Primitive};

/// Kind, place and size in the world, to the micrometre.
pub(super) fn described(obstacle: &Obstacle) -> String {
    let pose = obstacle.pose();
    let short = |v: Vector3<f64>| {
        // No negative zero.
        let [x, y, z] = v.map(|number| (1e6 * number).round() / 1e6 + 0.0).into();
        format!("({x}, {y}, {z})")
    };
    let at = |point: &Vector3<f64>| short((pose * Point3::from(*point)).coords);
    let along = |direction: &Vector3<f64>| short(pose.rotation * direction);
    let center = short(pose.translation.vector);
    let shape = match obstacle.primitive() {
        None => {
            let bounds = obstacle.bounding_box().expect("a mesh has one");
            let faces = obstacle.own_triangles().map_or(0, |(_, faces)| faces.len());
            let (middle, extents) = ((bounds.low + bounds.high) / 2.0, bounds.high - bounds.low);
            format!("around {} m, extents {} m, {faces} faces", short(middle), short(extents))
        }
        Some(Primitive::HalfSpace { point, normal }) => {
            format!("at {} m, normal {}", at(point), along(normal))
        }
        Some(Primitive::Sphere { center, radius }) => format!("at {} m, radius {radius} m", at(center)),
        Some(Primitive::Cuboid { half_extents: half }) => {
            let turned = short(pose.rotation.scaled_axis());
            format!(
                "at {center} m, half extents ({}, {}, {}) m, turned by {turned} rad",
                half.x, half.y, half.z
            )
        }
        Some(Primitive::Capsule { a, b, radius }) => {
            format!("from {} to {} m, radius {radius} m", at(a), at(b))
        }
        Some(Primitive::Cylinder { half_height, radius }) => {
            let axis = along(&Vector3::z());
            format!("at {center} m, axis {axis}, half height {half_height} m, radius {radius} m")
        }
    };
    format!("{} {shape}", obstacle.kind())
}
