//! Obstacles through the public interface: distances, signs, normals, poses, refusals.

mod common;

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use common::{Mesh, Random, data_dir, flipped, icosphere, joined, read_ply};
use nalgebra::{Matrix3, Rotation3, Vector3};
use quasirigid::geometry::{Bounds, RigidMotionError, winding_number};
use quasirigid::mesh::MeshError;
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle, ObstacleError, SignedDistances};
use rayon::prelude::*;

fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

fn mesh_obstacle((vertices, faces): Mesh) -> Obstacle {
    Obstacle::mesh(vertices, faces, &MeshObstacleOptions::default()).expect("a good mesh")
}

/// Distance, closest point, normal.
fn ask(obstacle: &Obstacle, point: Vector3<f64>) -> (f64, Vector3<f64>, Vector3<f64>) {
    let found = obstacle.signed_distance(&[point], None).expect("a finite point");
    (found.distance[0], found.closest[0], found.normal[0])
}

#[track_caller]
fn assert_near(found: Vector3<f64>, expected: Vector3<f64>, tolerance: f64) {
    assert!((found - expected).norm() <= tolerance, "found {found:?}, expected {expected:?}");
}

/// The box with these half extents as 12 triangles.
fn box_mesh(h: Vector3<f64>) -> Mesh {
    let corner = |i: usize| {
        let side = |bit: usize, h: f64| if i & bit == 0 { -h } else { h };
        v(side(1, h.x), side(2, h.y), side(4, h.z))
    };
    #[rustfmt::skip]
    let faces = vec![
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ];
    ((0..8).map(corner).collect(), faces)
}

fn random_points(random: &mut Random, count: usize, reach: f64) -> Vec<Vector3<f64>> {
    (0..count).map(|_| Vector3::from_fn(|_, _| (2.0 * random.next() - 1.0) * reach)).collect()
}

fn random_direction(random: &mut Random) -> Vector3<f64> {
    loop {
        let direction = random_points(random, 1, 1.0)[0];
        if (0.1..1.0).contains(&direction.norm()) {
            return direction.normalize();
        }
    }
}

fn primitives() -> Vec<Obstacle> {
    vec![
        Obstacle::half_space(v(0.1, 0.0, -0.2), v(1.0, 2.0, -0.5)).unwrap(),
        Obstacle::sphere(v(0.1, -0.2, 0.3), 0.4).unwrap(),
        Obstacle::cuboid(v(0.3, 0.2, 0.5)).unwrap(),
        Obstacle::capsule(v(-0.3, 0.1, 0.0), v(0.4, 0.2, 0.2), 0.2).unwrap(),
        Obstacle::cylinder(0.4, 0.3).unwrap(),
    ]
}

// Known answers: primitives.

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

// Meshes: reference, twins, signs.

#[test]
fn a_box_of_triangles_answers_as_the_box_primitive() {
    let h = v(0.3, 0.2, 0.5);
    let (mesh, exact) = (mesh_obstacle(box_mesh(h)), Obstacle::cuboid(h).unwrap());
    let mut random = Random(2);
    let mut points = random_points(&mut random, 3000, 0.8);
    // Around faces, edges and corners, at the distance of rounding and above.
    for step in [1e-14, 1e-12, 1e-9, 1e-6] {
        for _ in 0..500 {
            let keep = |random: &mut Random, h: f64| match random.next() {
                r if r < 0.4 => h,
                r if r < 0.8 => -h,
                _ => h * (2.0 * random.next() - 1.0),
            };
            let base = h.map(|h| keep(&mut random, h));
            points.push(base + random_direction(&mut random) * step);
        }
    }
    let (found, expected) =
        (mesh.signed_distance(&points, None).unwrap(), exact.signed_distance(&points, None).unwrap());
    for (i, point) in points.iter().enumerate() {
        assert!((found.distance[i] - expected.distance[i]).abs() <= 3e-16, "{point:?}");
        if expected.distance[i] > 1e-9 {
            assert_near(found.normal[i], expected.normal[i], 1e-15 + 3e-16 / expected.distance[i]);
        }
    }
}

/// Smallest distance to any triangle, each taken apart as corners, edges and plane on its own.
fn distance_to_all(point: &Vector3<f64>, (vertices, faces): &Mesh) -> f64 {
    let to_segment = |s: &Vector3<f64>, e: &Vector3<f64>| {
        let share = ((point - s).dot(&(e - s)) / (e - s).norm_squared()).clamp(0.0, 1.0);
        (point - s - (e - s) * share).norm()
    };
    faces
        .iter()
        .map(|face| {
            let [a, b, c] = face.map(|corner| &vertices[corner as usize]);
            let normal = (b - a).cross(&(c - a));
            let over = |s: &Vector3<f64>, e: &Vector3<f64>| normal.cross(&(e - s)).dot(&(point - s)) >= 0.0;
            if over(a, b) && over(b, c) && over(c, a) {
                ((point - a).dot(&normal) / normal.norm()).abs()
            } else {
                to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
            }
        })
        .fold(f64::INFINITY, f64::min)
}

/// Points around a mesh, half of them within 10 µm of a face, an edge or a vertex.
fn points_around((vertices, faces): &Mesh, count: usize, random: &mut Random) -> Vec<Vector3<f64>> {
    let reach = vertices.iter().map(|vertex| vertex.amax()).fold(0.0, f64::max) * 1.2;
    let mut points = random_points(random, count / 2, reach);
    for i in 0..count / 2 {
        let face = faces[(random.next() * faces.len() as f64) as usize];
        let [a, b, c] = face.map(|vertex| vertices[vertex as usize]);
        let (s, t) = (random.next(), random.next());
        let base = match i % 3 {
            0 => a + (b - a) * s * (1.0 - t) + (c - a) * s * t,
            1 => a + (b - a) * s,
            _ => a,
        };
        points.push(base + random_direction(random) * 10f64.powf(-5.0 - 4.0 * random.next()));
    }
    points
}

/// Largest error in distance against all triangles; panics on a wrong sign beyond 1e-9 m.
fn check_against_all_triangles(mesh: &Mesh, points: &[Vector3<f64>], name: &str) -> f64 {
    let found = mesh_obstacle(mesh.clone()).signed_distance(points, None).unwrap();
    points
        .par_iter()
        .zip(&found.distance)
        .map(|(point, found)| {
            let distance = distance_to_all(point, mesh);
            let is_inside = winding_number(point, &mesh.0, mesh.1.iter().copied()) > 0.5;
            assert!(distance <= 1e-9 || is_inside == (*found < 0.0), "{name}: sign at {point:?}, {found}");
            (found.abs() - distance).abs()
        })
        .reduce(|| 0.0, f64::max)
}

#[test]
fn built_meshes_answer_as_all_their_triangles_do() {
    let mut random = Random(3);
    let sphere = icosphere(0.05, 3);
    let cavity = icosphere(0.03, 2);
    let hollow = joined(&sphere, &(cavity.0, flipped(&cavity.1)));
    // A star: every other vertex drawn in, so edges and vertices of both kinds.
    let mut star = icosphere(0.05, 2);
    for (i, vertex) in star.0.iter_mut().enumerate() {
        *vertex *= if i % 3 == 0 { 0.4 } else { 1.0 };
    }
    for (mesh, name) in [(sphere, "sphere"), (hollow, "hollow sphere"), (star, "star")] {
        let points = points_around(&mesh, 1000, &mut random);
        let error = check_against_all_triangles(&mesh, &points, name);
        assert!(error <= 1e-16, "{name}: {error}");
    }
}

#[test]
fn scanned_and_drawn_meshes_answer_as_all_their_triangles_do() {
    let Some(data) = data_dir() else { return };
    let mut random = Random(4);
    for name in ["hands/libhand_right_middle_1500", "products/ycb_mug", "products/tbm_screwdriver"] {
        let mesh = read_ply(&data.join(name).with_extension("ply"));
        let points = points_around(&mesh, 600, &mut random);
        let error = check_against_all_triangles(&mesh, &points, name);
        assert!(error <= 1e-12, "{name}: {error}");
    }
}

#[test]
fn a_knife_edge_has_the_right_sign_on_both_sides() {
    // Two faces that meet at 2e-7 rad: near the plane of the blade the pseudo-normal sees points edge on.
    let thin = 1e-7;
    let vertices = vec![v(0.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(-1.0, 0.5, thin), v(-1.0, 0.5, -thin)];
    let mesh = (vertices, vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]);
    let mut random = Random(5);
    let mut points = Vec::new();
    for _ in 0..2000 {
        let angle = (random.next() - 0.5) * 1.2 * PI;
        let out = v(angle.cos(), 0.0, angle.sin()) * 10f64.powf(-8.0 * random.next());
        points.push(v(0.0, random.next(), 0.0) + out);
        points.push(v(-random.next(), 0.5, (random.next() - 0.5) * 4.0 * thin));
    }
    check_against_all_triangles(&mesh, &points, "blade");
}

#[test]
fn normals_close_to_the_surface_are_those_of_the_feature() {
    let obstacle = mesh_obstacle(box_mesh(v(0.03, 0.02, 0.05)));
    let edge = v(1.0, 1.0, 0.0).normalize();
    for distance in [-1e-9, -1e-10, -1e-11, -1e-12, -1e-15, 0.0, 1e-15, 1e-12, 1e-11, 1e-10, 1e-9] {
        let (_, _, normal) = ask(&obstacle, v(0.03 + distance, 0.0071, 0.011));
        assert_near(normal, Vector3::x(), 1e-15);
        if distance >= 0.0 {
            // Near the edge the direction p - c takes over from the mean of both faces, here the same.
            let (_, _, normal) = ask(&obstacle, v(0.03, 0.02, 0.011) + edge * distance);
            assert_near(normal, edge, 1e-6);
        }
    }
    let (distance, _, normal) = ask(&obstacle, v(0.03, 0.02, 0.05));
    assert_eq!(distance, 0.0);
    assert_near(normal, v(1.0, 1.0, 1.0).normalize(), 1e-7);
}

// Properties.

/// Equal to the bit, nan included.
fn bits(found: &SignedDistances) -> Vec<u64> {
    let vectors = found.closest.iter().chain(&found.normal).flat_map(|vector| vector.iter());
    found.distance.iter().chain(vectors).map(|x| x.to_bits()).collect()
}

#[test]
fn the_maximum_distance_only_leaves_far_points_out() {
    let obstacle = mesh_obstacle(icosphere(0.05, 3));
    let points = random_points(&mut Random(6), 3000, 0.08);
    let all = obstacle.signed_distance(&points, None).unwrap();
    for max_distance in [0.0, 1e-3, 0.02, 1.0, f64::INFINITY] {
        let near = obstacle.signed_distance(&points, Some(max_distance)).unwrap();
        for i in 0..points.len() {
            if all.distance[i].abs() <= max_distance {
                assert_eq!(near.distance[i], all.distance[i]);
                assert_eq!((near.closest[i], near.normal[i]), (all.closest[i], all.normal[i]));
            } else {
                assert_eq!(near.distance[i], f64::INFINITY);
                assert!(near.closest[i].iter().chain(near.normal[i].iter()).all(|x| x.is_nan()));
            }
        }
    }
    let sphere = Obstacle::sphere(Vector3::zeros(), 0.5).unwrap();
    let found = sphere.signed_distance(&[v(0.75, 0.0, 0.0), v(0.76, 0.0, 0.0)], Some(0.25)).unwrap();
    assert_eq!(found.distance, [0.25, f64::INFINITY]);
}

#[test]
fn answers_are_equal_to_the_bit_for_any_threads_and_order_of_points() {
    let obstacle = mesh_obstacle(icosphere(0.05, 3));
    let mut random = Random(7);
    let points = random_points(&mut random, 2000, 0.08);
    let ask = |points: &[Vector3<f64>], threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| obstacle.signed_distance(points, None)).unwrap()
    };
    let one = ask(&points, 1);
    for threads in [2, 5] {
        assert_eq!(bits(&one), bits(&ask(&points, threads)));
    }
    let order = random.permutation(points.len());
    let shuffled: Vec<_> = order.iter().map(|&i| points[i]).collect();
    let found = ask(&shuffled, 2);
    for (to, &from) in order.iter().enumerate() {
        assert_eq!((found.distance[to], found.closest[to]), (one.distance[from], one.closest[from]));
    }
}

#[test]
fn the_unit_of_length_changes_nothing() {
    let (vertices, faces) = icosphere(0.05, 2);
    let points = random_points(&mut Random(8), 1000, 0.08);
    // A power of two, so that scaling itself does not round.
    let scale = 1024.0;
    let scaled = |points: &[Vector3<f64>]| points.iter().map(|point| point * scale).collect::<Vec<_>>();
    let large = mesh_obstacle((scaled(&vertices), faces.clone()));
    let small = mesh_obstacle((vertices, faces));
    let (small, large) = (
        small.signed_distance(&points, Some(0.02)).unwrap(),
        large.signed_distance(&scaled(&points), Some(0.02 * scale)).unwrap(),
    );
    assert!(small.distance.iter().zip(&large.distance).all(|(small, large)| small * scale == *large));
}

#[test]
fn rigid_motion_carries_the_answers_along_even_a_metre_away() {
    let mut random = Random(9);
    let points = random_points(&mut random, 1000, 0.1);
    let primitives = primitives();
    let meshes = [box_mesh(v(0.03, 0.02, 0.05)), icosphere(0.05, 3)].map(mesh_obstacle);
    for obstacle in primitives.into_iter().chain(meshes) {
        let here = obstacle.signed_distance(&points, None).unwrap();
        let turn = Rotation3::from_euler_angles(1.0, 0.4, -2.5);
        let shift = v(0.7, -0.6, 0.4);
        let there = obstacle.moved(turn.matrix(), &shift).unwrap();
        let moved: Vec<_> = points.iter().map(|point| turn * point + shift).collect();
        let there = there.signed_distance(&moved, None).unwrap();
        for i in 0..points.len() {
            assert!((here.distance[i] - there.distance[i]).abs() <= 1e-15, "{}", obstacle.kind());
            // Ties between closest points and directions at vanishing distance may go either way.
            if here.distance[i] > 1e-3 {
                assert_near(there.normal[i], turn * here.normal[i], 1e-12);
                assert_near(there.closest[i], turn * here.closest[i] + shift, 1e-14);
            }
        }
    }
}

// Poses.

#[test]
fn motions_follow_one_another_in_the_order_of_the_calls() {
    let quarter = Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0); // x to y
    let sphere = Obstacle::sphere(v(1.0, 0.0, 0.0), 0.5).unwrap();
    let shifted_then_turned =
        sphere.translated(&v(2.0, 0.0, 0.0)).moved(&quarter, &Vector3::zeros()).unwrap();
    assert!((ask(&shifted_then_turned, v(0.0, 3.0, 0.0)).0 + 0.5).abs() < 1e-15);
    let turned_then_shifted =
        sphere.moved(&quarter, &v(2.0, 0.0, 0.0)).unwrap().translated(&v(0.0, 0.0, 1.0));
    assert!((ask(&turned_then_shifted, v(2.0, 1.0, 1.0)).0 + 0.5).abs() < 1e-15);
    assert_near(turned_then_shifted.pose().translation.vector, v(2.0, 0.0, 1.0), 0.0);
    assert_eq!(ask(&sphere, v(1.0, 0.0, 0.0)).0, -0.5, "the original stays");
}

#[test]
fn bounding_boxes_are_tight_in_the_world() {
    // z to y, so a cylinder about z lies along y.
    let quarter = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    let shift = v(1.0, 2.0, 3.0);
    let bounds = |obstacle: &Obstacle| obstacle.moved(&quarter, &shift).unwrap().bounding_box();
    let expect = |obstacle: Obstacle, low: Vector3<f64>, high: Vector3<f64>| {
        let found = bounds(&obstacle).unwrap();
        assert_near(found.low, shift + low, 1e-15);
        assert_near(found.high, shift + high, 1e-15);
    };
    expect(Obstacle::cylinder(0.4, 0.3).unwrap(), v(-0.3, -0.4, -0.3), v(0.3, 0.4, 0.3));
    expect(Obstacle::cuboid(v(0.1, 0.2, 0.3)).unwrap(), v(-0.1, -0.3, -0.2), v(0.1, 0.3, 0.2));
    expect(mesh_obstacle(box_mesh(v(0.1, 0.2, 0.3))), v(-0.1, -0.3, -0.2), v(0.1, 0.3, 0.2));
    expect(Obstacle::sphere(v(0.0, 0.0, 1.0), 0.5).unwrap(), v(-0.5, 0.5, -0.5), v(0.5, 1.5, 0.5));
    let capsule = Obstacle::capsule(Vector3::zeros(), v(0.0, 0.5, 1.0), 0.1).unwrap();
    expect(capsule, v(-0.1, -0.1, -0.6), v(0.1, 1.1, 0.1));
    assert_eq!(bounds(&Obstacle::half_space(shift, Vector3::x()).unwrap()), None);

    // At any turn every closest point is within, and each side is reached: a thin slab there holds some.
    let far = random_points(&mut Random(10), 20_000, 1.0).into_iter().map(|point| point.normalize() * 1e3);
    let far: Vec<_> = far.collect();
    for obstacle in primitives().iter().skip(1) {
        let turn = Rotation3::from_euler_angles(0.4, 1.0, -0.7);
        let obstacle = obstacle.moved(turn.matrix(), &shift).unwrap();
        let Bounds { low, high } = obstacle.bounding_box().unwrap();
        let found = obstacle.signed_distance(&far, None).unwrap();
        for axis in 0..3 {
            let (least, most) =
                found.closest.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |bounds, point| {
                    (bounds.0.min(point[axis]), bounds.1.max(point[axis]))
                });
            assert!(least >= low[axis] - 1e-12 && least <= low[axis] + 0.01, "{}", obstacle.kind());
            assert!(most <= high[axis] + 1e-12 && most >= high[axis] - 0.01, "{}", obstacle.kind());
        }
    }
}

#[test]
fn a_mesh_gives_its_triangles_in_the_world_and_a_primitive_none() {
    let (vertices, faces) = box_mesh(v(1.0, 2.0, 3.0));
    let shift = v(0.0, 0.0, 10.0);
    let obstacle = mesh_obstacle((vertices.clone(), faces.clone())).translated(&shift);
    let (found, found_faces) = obstacle.triangles().unwrap();
    assert_eq!(found_faces, faces);
    assert!(found.iter().zip(&vertices).all(|(found, vertex)| *found == vertex + shift));
    assert_eq!(obstacle.kind(), "mesh");
    let kinds: Vec<_> = primitives().iter().map(|obstacle| obstacle.kind()).collect();
    assert_eq!(kinds, ["half_space", "sphere", "box", "capsule", "cylinder"]);
    assert!(primitives().iter().all(|obstacle| obstacle.triangles().is_none()));
}

// Refusals.

#[test]
fn primitives_refuse_lengths_and_points_that_make_no_shape() {
    use ObstacleError::*;
    let o = Vector3::zeros();
    let not_positive = |kind, what, value| NotPositive { kind, what, value };
    assert_eq!(Obstacle::half_space(o, o).unwrap_err(), ZeroNormal);
    assert_eq!(Obstacle::sphere(o, 0.0).unwrap_err(), not_positive("sphere", "the radius", 0.0));
    assert_eq!(
        Obstacle::sphere(o, f64::INFINITY).unwrap_err(),
        not_positive("sphere", "the radius", f64::INFINITY)
    );
    assert_eq!(
        Obstacle::cuboid(v(1.0, -2.0, 1.0)).unwrap_err(),
        not_positive("box", "every half extent", -2.0)
    );
    assert_eq!(Obstacle::capsule(o, o, 1.0).unwrap_err(), CoincidentEnds { end: [0.0; 3] });
    assert_eq!(
        Obstacle::capsule(o, Vector3::x(), -1.0).unwrap_err(),
        not_positive("capsule", "the radius", -1.0)
    );
    assert_eq!(Obstacle::cylinder(0.0, 1.0).unwrap_err(), not_positive("cylinder", "the half height", 0.0));
    let error = Obstacle::sphere(v(f64::NAN, 0.0, 1.0), 1.0).unwrap_err();
    assert!(matches!(&error, NotFinite { kind: "sphere", what: "the center", value } if value[0].is_nan()));
    assert_eq!(error.to_string(), "sphere: the center must be finite, found [NaN, 0.0, 1.0]");
    assert!(matches!(Obstacle::cylinder(1.0, f64::NAN), Err(NotPositive { what: "the radius", .. })));
}

#[test]
fn a_motion_that_is_not_rigid_is_refused() {
    let sphere = Obstacle::sphere(Vector3::zeros(), 1.0).unwrap();
    let scaled = sphere.moved(&(Matrix3::identity() * 1.001), &Vector3::zeros()).unwrap_err();
    let ObstacleError::Motion(RigidMotionError::NotOrthonormal { deviation, .. }) = scaled else {
        panic!("{scaled}")
    };
    assert!((deviation - 0.002001).abs() < 1e-12);
    // A rotation typed with twelve digits passes.
    let (s, c) = (0.479425538604, 0.877582561890);
    let typed = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    assert!(sphere.moved(&typed, &Vector3::zeros()).is_ok());
}

#[test]
fn a_point_that_is_not_finite_is_named() {
    let points = [v(0.0, 0.0, 1.0), v(0.0, f64::INFINITY, 1.0), v(f64::NAN, 0.0, 0.0)];
    for obstacle in [Obstacle::sphere(Vector3::zeros(), 1.0).unwrap(), mesh_obstacle(icosphere(1.0, 0))] {
        let error = obstacle.signed_distance(&points, None).unwrap_err();
        let value = [0.0, f64::INFINITY, 1.0];
        assert_eq!(error, ObstacleError::NonFinitePoint { point: 1, value, count: 2 });
        assert_eq!(obstacle.signed_distance(&[], None).unwrap(), SignedDistances::default());
    }
}

#[test]
fn a_negative_or_missing_maximum_distance_is_refused() {
    let sphere = Obstacle::sphere(Vector3::zeros(), 1.0).unwrap();
    let error = sphere.signed_distance(&[], Some(-0.5)).unwrap_err();
    assert_eq!(error, ObstacleError::MaxDistance { max_distance: -0.5 });
    assert!(matches!(sphere.signed_distance(&[], Some(f64::NAN)), Err(ObstacleError::MaxDistance { .. })));
}

#[test]
fn an_open_mesh_is_refused_with_its_border() {
    let (vertices, mut faces) = icosphere(1.0, 1);
    faces.pop();
    let error = Obstacle::mesh(vertices, faces, &MeshObstacleOptions::default()).unwrap_err();
    assert!(matches!(error, ObstacleError::NotClosed { loops: 1, edges: 3, .. }), "{error}");
}

#[test]
fn a_defective_mesh_is_refused_as_a_skin_would_be() {
    let options = MeshObstacleOptions::default();
    let (mut vertices, faces) = icosphere(1.0, 1);
    vertices[7].y = f64::NAN;
    let error = Obstacle::mesh(vertices, faces, &options).unwrap_err();
    assert!(
        matches!(error, ObstacleError::Mesh(MeshError::NonFinite { vertex: 7, count: 1, .. })),
        "{error}"
    );

    let (outer, inner) = (icosphere(1.0, 2), icosphere(0.5, 2));
    let (vertices, faces) = joined(&outer, &inner);
    let error = Obstacle::mesh(vertices, faces, &options).unwrap_err();
    assert!(matches!(error, ObstacleError::Mesh(MeshError::NestedShell { .. })), "{error}");

    let error = Obstacle::mesh(outer.0.clone(), flipped(&outer.1), &options).unwrap_err();
    assert!(matches!(error, ObstacleError::Mesh(MeshError::InsideOut { .. })), "{error}");
}

#[test]
fn crossing_faces_are_refused_by_number_and_place_unless_the_check_is_left_out() {
    let near = box_mesh(v(1.0, 1.0, 1.0));
    let mut far = near.clone();
    far.0.iter_mut().for_each(|vertex| *vertex += v(1.5, 0.25, 0.125));
    let (vertices, faces) = joined(&near, &far);
    let error = Obstacle::mesh(vertices.clone(), faces.clone(), &MeshObstacleOptions::default()).unwrap_err();
    let ObstacleError::CrossingFaces { count, first, second, location } = error else { panic!("{error}") };
    assert!(count > 0 && first < 12 && second >= 12, "{count} {first} {second}");
    // The boxes overlap in [0.5, 1] x [-0.75, 1] x [-0.875, 1].
    let inside = |x: f64, low: f64| (low..=1.0).contains(&x);
    assert!(inside(location[0], 0.5) && inside(location[1], -0.75) && inside(location[2], -0.875));
    assert!(Obstacle::mesh(vertices, faces, &MeshObstacleOptions { check_crossings: false }).is_ok());
}

#[test]
fn defective_products_are_refused_for_what_is_wrong_with_them() {
    let Some(data) = data_dir() else { return };
    let refuse = |name: &str| {
        let (vertices, faces) = read_ply(&data.join("bad").join(name).with_extension("ply"));
        Obstacle::mesh(vertices, faces, &MeshObstacleOptions::default()).expect_err(name)
    };
    assert!(matches!(refuse("hand_fist_self_crossing"), ObstacleError::CrossingFaces { count: 964, .. }));
    assert!(matches!(refuse("mug_inverted"), ObstacleError::Mesh(MeshError::InsideOut { .. })));
    assert!(matches!(refuse("ball_nested_same_winding"), ObstacleError::Mesh(MeshError::NestedShell { .. })));
    assert!(matches!(refuse("finger_double_shell"), ObstacleError::Mesh(MeshError::CoincidentShell { .. })));
}
