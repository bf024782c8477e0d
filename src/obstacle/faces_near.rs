//! Flat faces of an obstacle near a place.

use nalgebra::Vector3;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::{Cuboid, Cylinder};

use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::node_bounds;
use crate::obstacle::convex_edge::RIM_SIDES;
use crate::obstacle::posed::{Obstacle, Shape};
use crate::obstacle::primitive::Primitive;

/// Corners (m).
pub(crate) type Triangle = [Vector3<f64>; 3];

impl Obstacle {
    /// The faces of a mesh, a box or a cylinder that may meet a box; none of a primitive without flat faces.
    ///
    /// Round sides of a cylinder are those of the prism with [`RIM_SIDES`] sides in it, up to 0.5 % of the radius within them.
    pub(crate) fn faces_near(&self, bounds: &Bounds) -> Vec<Triangle> {
        let pose = self.pose_matrix();
        let own: Vec<Triangle> = match self.shape() {
            Shape::Mesh(mesh) => {
                let own = bounds.translated(&-pose.translation).turned(&pose.rotation.transpose());
                let near = mesh.tree().bvh().leaves(|node| node_bounds(node).meets(&own));
                let vertices = mesh.vertices();
                near.map(|face| mesh.search().corners[face as usize].map(|v| vertices[v as usize])).collect()
            }
            Shape::Primitive(Primitive::Cuboid { half_extents }) => {
                let half_extents = Vector::new(half_extents.x, half_extents.y, half_extents.z);
                of_mesh(Cuboid::new(half_extents).to_trimesh(), |v| Vector3::new(v.x, v.y, v.z))
            }
            Shape::Primitive(Primitive::Cylinder { half_height, radius }) => {
                let sides = Cylinder::new(*half_height, *radius).to_trimesh(RIM_SIDES as u32);
                // From its axis to ours.
                of_mesh(sides, |v| Vector3::new(v.z, v.x, v.y))
            }
            Shape::Primitive(_) => Vec::new(),
        };
        let placed = own.into_iter().map(|face| face.map(|corner| pose.to_world(&corner)));
        placed.filter(|face| Bounds::around(face).meets(bounds)).collect()
    }
}

fn of_mesh(
    (vertices, faces): (Vec<Vector>, Vec<[u32; 3]>),
    place: impl Fn(Vector) -> Vector3<f64>,
) -> Vec<Triangle> {
    faces.iter().map(|face| face.map(|vertex| place(vertices[vertex as usize]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::closest_point::closest_on_triangle;

    const EXTENTS: Vector3<f64> = Vector3::new(3.0, 2.0, 0.05);

    #[test]
    fn faces_near_hold_every_place_of_the_surface_there_and_lie_on_it() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.4, 0.7);
        let shift = Vector3::new(5.0, -2.0, 1.0);
        let bounds = Bounds::around(&[shift, shift + Vector3::new(1.0, 0.7, 0.8)]);
        let (corners, faces) = Cuboid::new(Vector::new(EXTENTS.x, EXTENTS.y, EXTENTS.z)).to_trimesh();
        let corners = corners.into_iter().map(|v| Vector3::new(v.x, v.y, v.z)).collect();
        let mesh = Obstacle::mesh(corners, faces, &Default::default()).expect("a closed mesh");
        for obstacle in [Obstacle::cuboid(EXTENTS), Obstacle::cylinder(0.05, 3.0), Ok(mesh)] {
            let obstacle = obstacle.and_then(|rest| rest.moved(turn.matrix(), &shift)).expect("an obstacle");
            let near = obstacle.faces_near(&bounds);
            let corners: Vec<_> = near.iter().flatten().copied().collect();
            let found = obstacle.signed_distance(&corners, None).expect("distances");
            assert!(found.distance.iter().all(|distance| distance.abs() < 1e-12));
            let distance = |place: &Vector3<f64>| {
                let of_face = |[a, b, c]: &Triangle| {
                    let normal = (b - a).cross(&(c - a)).normalize();
                    (closest_on_triangle(place, [a, b, c], &normal).point - place).norm()
                };
                near.iter().map(of_face).fold(f64::INFINITY, f64::min)
            };
            let places = (0..400).map(|k| {
                shift + turn * Vector3::new(0.1 * (k % 20) as f64 - 1.0, 0.1 * (k / 20) as f64 - 1.0, 0.05)
            });
            let places: Vec<_> = places.filter(|place| bounds.contains(place)).collect();
            assert!(places.len() > 20);
            assert!(places.iter().all(|place| distance(place) < 1e-12));
        }
        let ball = Obstacle::sphere(shift, 0.5).expect("a ball");
        assert!(ball.faces_near(&bounds).is_empty());
    }
}
