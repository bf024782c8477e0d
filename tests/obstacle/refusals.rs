//! What an obstacle refuses, and why.

use nalgebra::{Matrix3, Vector3};
use quasirigid::geometry::RigidMotionError;
use quasirigid::mesh::MeshError;
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle, ObstacleError, SignedDistances};

use crate::common::{data_dir, flipped, icosphere, joined, read_ply};
use crate::{box_mesh, mesh_obstacle, v};

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
    assert_eq!(
        error.to_string(),
        "sphere: the center must be finite and at most 1e60, found [NaN, 0.0, 1.0]"
    );
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

#[test]
fn lengths_that_overflow_when_squared_are_refused() {
    assert!(matches!(Obstacle::sphere(v(0.0, 1e61, 0.0), 1.0), Err(ObstacleError::NotFinite { .. })));
    assert!(matches!(Obstacle::sphere(v(0.0, 0.0, 0.0), 1e200), Err(ObstacleError::NotPositive { .. })));
    assert!(matches!(Obstacle::cuboid(v(1.0, 1e200, 1.0)), Err(ObstacleError::NotPositive { .. })));
    let ball = Obstacle::sphere(v(0.0, 0.0, 0.0), 1.0).expect("a ball");
    let far = ball.signed_distance(&[v(1.0, 0.0, 0.0), v(0.0, -1e200, 0.0)], None);
    assert!(matches!(far, Err(ObstacleError::NonFinitePoint { point: 1, count: 1, .. })));
    assert!(matches!(ball.moved(&Matrix3::identity(), &v(0.0, 0.0, 1e200)), Err(ObstacleError::Motion(_))));
}
