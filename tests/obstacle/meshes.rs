//! Signed distances of meshes: reference, twins, signs.

use std::f64::consts::PI;

use nalgebra::{Rotation3, Vector3};
use quasirigid::geometry::winding_number;
use quasirigid::obstacle::Obstacle;
use rayon::prelude::*;

use crate::common::{Mesh, Random, data_dir, flipped, icosphere, joined, read_ply};
use crate::{ask, assert_near, box_mesh, mesh_obstacle, random_direction, random_points, v};

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
fn points_at_any_distance_outside_are_outside() {
    let (vertices, faces) = icosphere(0.05, 2);
    let mesh = mesh_obstacle((vertices, faces));
    let mut random = Random(8);
    for exponent in -1..40 {
        let points: Vec<_> =
            (0..100).map(|_| random_direction(&mut random) * 10.0_f64.powi(exponent)).collect();
        let found = mesh.signed_distance(&points, None).expect("finite points");
        for (point, (distance, normal)) in points.iter().zip(found.distance.iter().zip(&found.normal)) {
            assert!((distance - point.norm()).abs() <= 0.05 + 4.0 * f64::EPSILON * point.norm(), "{point:?}");
            assert!(normal.dot(&point.normalize()) > 0.9, "{point:?}");
        }
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

#[test]
fn no_point_beyond_the_tip_of_a_needle_is_inside_it() {
    let mut random = Random(11);
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let place = v(0.1, 0.2, 0.3);
    for apex in [1e-3, 1e-4, 1e-5] {
        let ring = (0..5).map(|k| {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / 5.0).sin_cos();
            v(apex * cosine, apex * sine, -1.0)
        });
        let vertices = ring.chain([v(0.0, 0.0, 0.0), v(0.0, 0.0, -1.0)]).map(|x| turn * (0.01 * x) + place);
        let faces = (0..5).flat_map(|k| [[k, (k + 1) % 5, 5], [(k + 1) % 5, k, 6]]).collect();
        let needle = mesh_obstacle((vertices.collect(), faces));
        let beyond: Vec<_> = random_points(&mut random, 2000, 1e-5)
            .into_iter()
            .map(|x| turn * v(x.x, x.y, x.z.abs()) + place)
            .collect();
        let found = needle.signed_distance(&beyond, None).expect("finite points");
        assert!(found.distance.iter().all(|&distance| distance > 0.0), "apex {apex}");
    }
}
