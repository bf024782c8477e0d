//! Known answers of primitives.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Rotation3, Vector3};
use quasirigid::obstacle::Obstacle;

use crate::common::{Random, icosphere};
use crate::{ask, assert_near, box_mesh, mesh_obstacle, primitives, random_points, v};

#[test]
fn the_half_space_answers_with_the_height_over_its_plane() {
    let obstacle = Obstacle::half_space(v(0.0, 0.0, 2.0), v(0.0, 3.0, 4.0)).unwrap();
    let normal = v(0.0, 0.6, 0.8);
    let foot = v(5.0, 4.0, -1.0); // (foot - point) · normal = 2.4 - 2.4
    for height in [-3.0, -1e-12, 0.0, 1e-12, 2.0] {
        let (distance, closest, found) = ask(&obstacle, foot + normal * height);
        assert!((distance - height).abs() <= 4e-15, "{distance}");
        assert_near(closest, foot, 1e-14);
        assert_near(found, normal, 1e-15);
    }
}

#[test]
fn the_sphere_answers_along_its_radius_and_with_z_at_its_center() {
    let center = v(0.1, 0.2, 0.3);
    let obstacle = Obstacle::sphere(center, 0.05).unwrap();
    for direction in [v(1.0, 0.0, 0.0), v(0.0, -0.6, 0.8), v(2.0, 3.0, 6.0) / 7.0] {
        for radius in [1e-9, 0.02, 0.05 - 1e-12, 0.05, 0.05 + 1e-12, 7.0] {
            let (distance, closest, normal) = ask(&obstacle, center + direction * radius);
            assert!((distance - (radius - 0.05)).abs() <= 1e-15 * (1.0 + radius), "{distance}");
            assert_near(normal, direction, 1e-16 / radius + 1e-15);
            assert_near(closest, center + direction * 0.05, 1e-17 / radius + 1e-15);
        }
    }
    assert_eq!(ask(&obstacle, center), (-0.05, center + v(0.0, 0.0, 0.05), Vector3::z()));
}

#[test]
fn the_box_answers_from_faces_edges_and_corners() {
    let h = v(0.3, 0.2, 0.5);
    let obstacle = Obstacle::cuboid(h).unwrap();
    // A chosen closest point, a direction of its normal cone, and the mean normal on the surface itself.
    let cases = [
        (v(0.3, 0.1, -0.2), v(1.0, 0.0, 0.0), v(1.0, 0.0, 0.0)),
        (v(-0.1, -0.2, 0.4), v(0.0, -1.0, 0.0), v(0.0, -1.0, 0.0)),
        (v(0.3, 0.2, 0.1), v(0.6, 0.8, 0.0), v(FRAC_1_SQRT_2, FRAC_1_SQRT_2, 0.0)),
        (v(-0.3, 0.0, -0.5), v(-0.8, 0.0, -0.6), v(-FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2)),
        (v(0.3, -0.2, 0.5), v(2.0, -3.0, 6.0) / 7.0, v(1.0, -1.0, 1.0) / 3f64.sqrt()),
    ];
    for (base, out, mean) in cases {
        for distance in [0.0, 1e-12, 1e-9, 0.1, 10.0] {
            let (found, closest, normal) = ask(&obstacle, base + out * distance);
            assert!(
                (found - distance).abs() <= 2e-16 * (1.0 + 10.0 * distance),
                "{base:?} {distance}: {found}"
            );
            assert_near(closest, base, 1e-14);
            if distance > 1e-10 {
                assert_near(normal, out, 1e-16 / distance + 1e-15);
            } else {
                assert_near(normal, mean, 1e-15);
            }
        }
    }
    // Inside: the nearest face, +x among equals.
    assert_eq!(ask(&obstacle, v(0.1, -0.15, 0.3)), (0.15 - 0.2, v(0.1, -0.2, 0.3), v(0.0, -1.0, 0.0)));
    let cube = Obstacle::cuboid(v(0.5, 0.5, 0.5)).unwrap();
    assert_eq!(ask(&cube, Vector3::zeros()), (-0.5, v(0.5, 0.0, 0.0), Vector3::x()));
}

#[test]
fn the_capsule_answers_from_its_tube_and_both_ends() {
    let obstacle = Obstacle::capsule(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), 0.5).unwrap();
    let cases = [
        (v(0.0, 0.0, 0.3), v(0.6, -0.8, 0.0)),
        (v(0.0, 0.0, 1.0), v(0.6, 0.0, 0.8)),
        (v(0.0, 0.0, -1.0), v(0.0, 0.6, -0.8)),
    ];
    for (base, out) in cases {
        for radius in [0.1, 0.5 - 1e-12, 0.5 + 1e-12, 3.0] {
            let (distance, closest, normal) = ask(&obstacle, base + out * radius);
            assert!((distance - (radius - 0.5)).abs() <= 1e-15, "{distance}");
            assert_near(normal, out, 3e-15);
            assert_near(closest, base + out * 0.5, 3e-15);
        }
    }
    let (distance, _, normal) = ask(&obstacle, v(0.0, 0.0, 0.25));
    assert_eq!((distance, normal.z, normal.norm()), (-0.5, 0.0, 1.0));
}

#[test]
fn the_cylinder_answers_from_side_caps_and_rims() {
    let obstacle = Obstacle::cylinder(1.0, 0.5).unwrap();
    let radial = v(0.6, 0.8, 0.0);
    let cases = [
        (radial * 0.5 + v(0.0, 0.0, 0.7), radial, radial),
        (v(0.1, 0.2, -1.0), v(0.0, 0.0, -1.0), v(0.0, 0.0, -1.0)),
        (
            radial * 0.5 + v(0.0, 0.0, 1.0),
            radial * 0.8 + v(0.0, 0.0, 0.6),
            (radial + Vector3::z()).normalize(),
        ),
    ];
    for (base, out, mean) in cases {
        for distance in [0.0, 1e-12, 1e-9, 0.1, 10.0] {
            let (found, closest, normal) = ask(&obstacle, base + out * distance);
            assert!(
                (found - distance).abs() <= 4e-16 * (1.0 + 10.0 * distance),
                "{base:?} {distance}: {found}"
            );
            assert_near(closest, base, 1e-14);
            let expected = if distance > 1e-10 { out } else { mean };
            assert_near(normal, expected, 1e-15 + if distance > 1e-10 { 3e-16 / distance } else { 0.0 });
        }
    }
    // Inside: the nearer of side and cap; the axis looks to +x, the center's z to +z.
    assert_eq!(ask(&obstacle, v(0.0, 0.3, 0.1)), (0.3 - 0.5, v(0.0, 0.5, 0.1), Vector3::y()));
    assert_eq!(ask(&obstacle, v(0.0, 0.3, 0.9)), (0.9 - 1.0, v(0.0, 0.3, 1.0), Vector3::z()));
    assert_eq!(ask(&obstacle, Vector3::zeros()), (-0.5, v(0.5, 0.0, 0.0), Vector3::x()));
    let flat = Obstacle::cylinder(0.1, 0.5).unwrap();
    assert_eq!(ask(&flat, Vector3::zeros()), (-0.1, v(0.0, 0.0, 0.1), Vector3::z()));
}

#[test]
fn every_answer_leads_from_the_surface_along_a_unit_normal() {
    let mut random = Random(1);
    let points = random_points(&mut random, 2000, 1.0);
    let meshes = [box_mesh(v(0.3, 0.2, 0.5)), icosphere(0.5, 2)].map(mesh_obstacle);
    for obstacle in primitives().into_iter().chain(meshes) {
        let turn = Rotation3::from_euler_angles(0.3, -1.2, 2.0);
        let obstacle = obstacle.moved(turn.matrix(), &v(0.1, 0.05, -0.2)).unwrap();
        let found = obstacle.signed_distance(&points, None).unwrap();
        for (i, point) in points.iter().enumerate() {
            let (distance, closest, normal) = (found.distance[i], found.closest[i], found.normal[i]);
            assert!((normal.norm() - 1.0).abs() <= 1e-15, "{} {point:?}", obstacle.kind());
            assert_near(closest + normal * distance, *point, 1e-14);
            assert!(ask(&obstacle, closest).0.abs() <= 1e-15, "{} {point:?}", obstacle.kind());
            // A step outward from the surface stays outside for convex bodies.
            assert!(ask(&obstacle, closest + normal * 1e-6).0 > 0.0, "{} {point:?}", obstacle.kind());
        }
    }
}
