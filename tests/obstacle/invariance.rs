//! What reach, threads, units and poses leave as it is.

use nalgebra::{Matrix3, Rotation3, Vector3};
use quasirigid::geometry::Bounds;
use quasirigid::obstacle::{Obstacle, SignedDistances};

use crate::common::{Random, icosphere};
use crate::{ask, assert_near, box_mesh, mesh_obstacle, primitives, random_points, v};

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
