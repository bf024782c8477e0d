//! The travel at which an obstacle first meets a skin vertex.

use nalgebra::{Rotation3, Vector3};
use quasirigid::obstacle::{FirstTouch, Obstacle, ObstacleError};

use crate::common::{Mesh, Random, data_dir, flipped, icosphere, joined, read_ply};
use crate::{box_mesh, mesh_obstacle, primitives, v};

fn touch(obstacle: &Obstacle, points: &[Vector3<f64>], direction: Vector3<f64>) -> Option<FirstTouch> {
    obstacle.first_touch(points, &direction).expect("a sound question")
}

/// The octahedron with corners at `radius` on the axes.
fn octahedron(radius: f64) -> Mesh {
    let vertices =
        [v(1., 0., 0.), v(-1., 0., 0.), v(0., 1., 0.), v(0., -1., 0.), v(0., 0., 1.), v(0., 0., -1.)];
    #[rustfmt::skip]
    let faces = vec![
        [0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5],
    ];
    (vertices.map(|vertex| vertex * radius).to_vec(), faces)
}

/// At the travel found the point lies on the surface, none lies deeper than rounding, and shortly before all
/// are outside. `None` asks for a scene in which no point is met wherever the obstacle stands.
fn check_by_distance(
    obstacle: &Obstacle,
    points: &[Vector3<f64>],
    direction: Vector3<f64>,
    size: f64,
) -> bool {
    let distances = |travel: f64| {
        let there = obstacle.translated(&(direction.normalize() * travel));
        there.signed_distance(points, None).unwrap().distance
    };
    let least = |travel: f64| distances(travel).into_iter().fold(f64::INFINITY, f64::min);
    let steps = [1e-9, 1e-6, 1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2, 2.0, 4.0, 8.0];
    match touch(obstacle, points, direction) {
        Some(FirstTouch { travel, point }) => {
            let found = distances(travel);
            let on = found[point];
            assert!(on.abs() <= 1e-14 * size, "{}: the point is met at {on}", obstacle.kind());
            assert!(least(travel) >= -1e-14 * size, "{}: {}", obstacle.kind(), least(travel));
            for step in steps {
                assert!(least(travel - step * size) > -1e-14 * size, "{} at {step}", obstacle.kind());
            }
            true
        }
        None => {
            for step in steps.into_iter().flat_map(|step| [-step, step]) {
                assert!(least(step * size) > 0.0, "{} at {step}", obstacle.kind());
            }
            false
        }
    }
}

#[test]
fn a_sphere_meets_the_point_in_its_way() {
    let sphere = Obstacle::sphere(v(0.0, 0.0, -5.0), 0.5).unwrap();
    let points = [v(9.0, 0.0, 0.0), v(0.3, 0.0, 1.0), v(0.0, 0.0, 1.2)];
    // (0.3, ., 1) is met when the sphere's top there, at 0.4 over its center, comes to z = 1: after 5.6.
    let found = touch(&sphere, &points, v(0.0, 0.0, 3.0)).unwrap();
    assert_eq!(found.point, 1);
    assert!((found.travel - 5.6).abs() < 1e-14, "{found:?}");
    // Coming from above instead, it meets the higher point first.
    let found = touch(&sphere, &points, v(0.0, 0.0, -1.0)).unwrap();
    assert_eq!(found.point, 2);
    assert!((found.travel + 6.7).abs() < 1e-14, "{found:?}");
    assert_eq!(touch(&sphere, &points[..1], Vector3::z()), None);
    assert_eq!(touch(&sphere, &[], Vector3::z()), None);
}

#[test]
fn a_line_that_grazes_is_met() {
    let sphere = Obstacle::sphere(Vector3::zeros(), 0.5).unwrap();
    let found = touch(&sphere, &[v(0.5, 0.0, 2.0)], Vector3::z()).unwrap();
    assert_eq!(found, FirstTouch { travel: 2.0, point: 0 });
    assert_eq!(touch(&sphere, &[v(0.5 + 1e-15, 0.0, 2.0)], Vector3::z()), None);
    let cuboid = Obstacle::cuboid(v(0.5, 0.5, 0.5)).unwrap();
    for corner in [v(0.5, 0.5, 2.0), v(0.5, -0.5, 2.0), v(0.5, 0.1, 2.0)] {
        assert_eq!(touch(&cuboid, &[corner], Vector3::z()).unwrap().travel, 1.5);
    }
    let cylinder = Obstacle::cylinder(0.25, 0.5).unwrap();
    assert_eq!(touch(&cylinder, &[v(0.5, 0.0, 2.0)], Vector3::z()).unwrap().travel, 1.75);
}

#[test]
fn a_half_space_arrives_along_its_normal_only() {
    let plane = Obstacle::half_space(v(0.0, 0.0, 1.0), Vector3::z()).unwrap();
    let points = [v(5.0, 0.0, 3.0), v(-5.0, 0.0, 2.0)];
    let found = touch(&plane, &points, v(0.6, 0.0, 0.8)).unwrap();
    assert_eq!(found.point, 1);
    assert!((found.travel - 1.25).abs() < 1e-15);
    for (direction, expected) in [(-Vector3::z(), -1.0), (Vector3::x(), 0.0)] {
        let error = plane.first_touch(&points, &direction).unwrap_err();
        let ObstacleError::HalfSpaceDirection { cosine, tolerance } = error else { panic!("{error}") };
        assert_eq!((cosine, tolerance), (expected, 1e-12));
        // From where it stands it moves off, which is no error.
        assert_eq!(plane.first_touch_from_current(&points, &direction).unwrap(), None);
    }
}

#[test]
fn lines_through_edges_and_vertices_of_a_mesh_do_not_slip_through() {
    let obstacle = mesh_obstacle(octahedron(1.0));
    let points = [
        (v(0.0, 0.0, 5.0), 4.0),     // through the vertices (0, 0, ±1)
        (v(0.5, 0.0, 5.0), 4.5),     // through an edge
        (v(0.25, 0.25, 5.0), 4.5),   // through a face
        (v(1.0, 0.0, 5.0), 5.0),     // grazing a vertex
        (v(0.5, 0.5, 5.0), 5.0),     // grazing an edge
        (v(-0.25, -0.75, 5.0), 5.0), // the same, off its middle
    ];
    for (point, travel) in points {
        assert_eq!(touch(&obstacle, &[point], Vector3::z()).map(|t| t.travel), Some(travel), "{point:?}");
    }
    assert_eq!(touch(&obstacle, &[v(0.5, 0.5 + 1e-15, 5.0)], Vector3::z()), None);
    // Faces seen edge on: the sides of a box, met by lines within them.
    let (vertices, faces) = box_mesh(v(0.5, 0.5, 0.5));
    let cube = mesh_obstacle((vertices.iter().map(|vertex| vertex + v(0.5, 0.5, 0.5)).collect(), faces));
    for (x, y) in [(0.0, 0.0), (1.0, 1.0), (0.0, 0.3), (0.7, 1.0), (0.5, 0.5), (0.25, 0.25)] {
        assert_eq!(touch(&cube, &[v(x, y, 3.0)], Vector3::z()).map(|t| t.travel), Some(2.0), "{x} {y}");
        assert_eq!(touch(&cube, &[v(x, y, 3.0)], -Vector3::z()).map(|t| t.travel), Some(-3.0), "{x} {y}");
    }
}

#[test]
fn of_points_met_together_the_first_is_named() {
    let points = [v(0.9, 0.0, 2.0), v(0.2, 0.1, 1.0), v(-0.1, 0.2, 1.0), v(0.2, 0.1, 1.0)];
    let cuboid = Obstacle::cuboid(v(0.5, 0.5, 0.5)).unwrap();
    assert_eq!(touch(&cuboid, &points, Vector3::z()), Some(FirstTouch { travel: 0.5, point: 1 }));
    let many = vec![v(0.25, 0.25, 3.0); 3000];
    let found = touch(&mesh_obstacle(octahedron(1.0)), &many, Vector3::z());
    assert_eq!(found, Some(FirstTouch { travel: 2.5, point: 0 }));
}

#[test]
fn at_the_travel_found_nothing_is_inside() {
    let mut random = Random(1);
    let meshes = [octahedron(0.4), icosphere(0.4, 3)].map(mesh_obstacle);
    // A half-space is met along its normal alone.
    let bounded = primitives().into_iter().filter(|primitive| primitive.kind() != "half_space");
    let mut met = 0;
    for obstacle in bounded.chain(meshes) {
        for _ in 0..60 {
            let mut any = || Vector3::from_fn(|_, _| 2.0 * random.next() - 1.0);
            let turn = Rotation3::new(any() * 3.0);
            let obstacle = obstacle.moved(turn.matrix(), &any()).unwrap();
            let points: Vec<_> = (0..20).map(|_| any() * 1.5).collect();
            met += usize::from(check_by_distance(&obstacle, &points, any(), 1.0));
        }
    }
    assert!(met > 200 && met < 360, "{met} of 360 scenes met a point");
}

#[test]
fn a_finger_is_met_by_products_without_overlap() {
    let Some(data) = data_dir() else { return };
    let read = |name: &str| read_ply(&data.join(name).with_extension("ply"));
    let (finger, _) = read("hands/libhand_right_middle_1500");
    let mut random = Random(2);
    for name in ["products/tbm_mug", "products/gen_phone_slab", "products/ycb_soup_can"] {
        let product = mesh_obstacle(read(name));
        for direction in [Vector3::z(), Vector3::x(), v(0.3, -0.5, 0.9)] {
            let shift = Vector3::from_fn(|_, _| 0.004 * random.next());
            assert!(check_by_distance(&product.translated(&shift), &finger, direction, 0.1), "{name}");
        }
    }
}

#[test]
fn the_start_changes_the_travel_by_as_much_and_nothing_else() {
    let mut random = Random(3);
    let points: Vec<_> = (0..500).map(|_| Vector3::from_fn(|_, _| random.next() - 0.5)).collect();
    let obstacle = mesh_obstacle(icosphere(0.2, 2));
    let direction = v(0.36, 0.48, 0.8);
    let here = touch(&obstacle, &points, direction).unwrap();
    assert!(here.travel < 0.0, "the scene starts in overlap");
    let there = touch(&obstacle.translated(&(direction * 0.25)), &points, direction).unwrap();
    assert_eq!(here.point, there.point);
    assert!((here.travel - 0.25 - there.travel).abs() < 1e-14);
}

#[test]
fn the_outcome_is_equal_to_the_bit_for_any_number_of_threads() {
    let mut random = Random(4);
    let points: Vec<_> = (0..5000).map(|_| Vector3::from_fn(|_, _| random.next() - 0.5)).collect();
    let obstacle = mesh_obstacle(icosphere(0.2, 3));
    let ask = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| touch(&obstacle, &points, v(1.0, 2.0, 3.0)))
    };
    assert_eq!(ask(1), ask(2));
    assert_eq!(ask(1), ask(7));
}

#[test]
fn from_the_current_place_the_inner_wall_of_a_shell_is_met() {
    let (outer, inner) = (octahedron(1.0), octahedron(0.5));
    let shell = mesh_obstacle(joined(&outer, &(inner.0, flipped(&inner.1))));
    let points = [Vector3::zeros(), v(0.1, 0.0, 0.0)];
    let touch_now = |obstacle: &Obstacle, points: &[Vector3<f64>], direction: Vector3<f64>| {
        obstacle.first_touch_from_current(points, &direction).unwrap()
    };
    let from_infinity = touch(&shell, &points, Vector3::z()).unwrap();
    assert_eq!(from_infinity, FirstTouch { travel: -1.0, point: 0 });
    let now = touch_now(&shell, &points, Vector3::z()).unwrap();
    assert_eq!(now.point, 1);
    assert!((now.travel - 0.4).abs() < 1e-15);
    // On the surface, up to rounding: met at once.
    assert_eq!(touch_now(&shell, &[v(0.0, 0.0, 1.0 - 1e-14)], Vector3::z()).unwrap().travel, 0.0);
    let sphere = Obstacle::sphere(Vector3::zeros(), 0.5).unwrap();
    assert_eq!(touch_now(&sphere, &[v(0.0, 0.0, 0.5)], Vector3::z()).unwrap().travel, 0.0);
    assert_eq!(touch_now(&sphere, &[v(0.0, 0.0, 2.0)], Vector3::z()).unwrap().travel, 1.5);
    assert_eq!(touch_now(&sphere, &[v(0.0, 0.0, -2.0)], Vector3::z()), None);
}

#[test]
fn a_question_without_direction_or_finite_points_is_refused() {
    let sphere = Obstacle::sphere(Vector3::zeros(), 0.5).unwrap();
    let error = sphere.first_touch(&[], &Vector3::zeros()).unwrap_err();
    assert_eq!(error, ObstacleError::Direction { direction: [0.0; 3] });
    let infinite = v(0.0, f64::INFINITY, 0.0);
    assert!(matches!(sphere.first_touch(&[], &infinite), Err(ObstacleError::Direction { .. })));
    let error = sphere.first_touch(&[Vector3::zeros(), infinite], &Vector3::z()).unwrap_err();
    let value = [0.0, f64::INFINITY, 0.0];
    assert_eq!(error, ObstacleError::NonFinitePoint { point: 1, value, count: 1 });
    // A direction's length does not matter, however small.
    let found = touch(&sphere, &[v(0.0, 0.0, 2.0)], v(0.0, 0.0, 1e-200));
    assert_eq!(found.unwrap().travel, 1.5);
}
