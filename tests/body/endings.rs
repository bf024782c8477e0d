//! Every way in which a body response is refused, warned about or stopped.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Matrix3, Rotation3, Vector3};
use quasirigid::geometry::RigidMotionError;
use quasirigid::response::body::{Body, BodyCompliance, BodyCost, BodyError, BodyOptions, BodyProgress};
use quasirigid::response::{NodesError, PreparedBody, ThreadsError};
use quasirigid::surface::Surface;

use crate::common::{icosphere, joined};
use crate::{SHEAR_MODULUS, surface, with_bone};

fn sphere(radius: f64, center: Vector3<f64>) -> Surface {
    let (vertices, faces) = icosphere(radius, 1);
    surface((vertices.into_iter().map(|v| v + center).collect(), faces))
}

fn skin() -> Surface {
    sphere(8e-3, Vector3::zeros())
}

fn with_core() -> Body {
    with_bone(sphere(3e-3, Vector3::zeros()))
}

fn with_fixed(is_fixed: impl Fn(usize, &Vector3<f64>) -> bool) -> Body {
    let skin = skin();
    let fixed = skin.vertices().iter().enumerate().map(|(i, v)| is_fixed(i, v)).collect();
    Body { bone: None, fixed: Some(fixed), coarse_edge_length: None }
}

fn prepare(body: &Body, nodes: &[usize], options: &BodyOptions) -> Result<BodyCompliance, BodyError> {
    body.prepare(&skin(), SHEAR_MODULUS, 0.5, nodes, options)
}

fn refusal(body: &Body) -> BodyError {
    let error = body.held_vertices(&skin()).expect_err("it cannot be prepared");
    let same = prepare(body, &[0], &BodyOptions::default()).expect_err("it cannot be prepared");
    assert_eq!(same, error);
    error
}

#[test]
fn a_body_that_nothing_holds_is_refused() {
    assert_eq!(refusal(&Body::default()), BodyError::Unsupported);
}

#[test]
fn material_and_tolerance_must_be_in_range() {
    let with = |modulus: f64, nu: f64, tolerance: f64| {
        let options = BodyOptions { tolerance, ..BodyOptions::default() };
        with_core().prepare(&skin(), modulus, nu, &[0], &options).expect_err("out of range")
    };
    for modulus in [0.0, -1.0, f64::INFINITY, 1e200, 1e-61] {
        assert_eq!(with(modulus, 0.5, 1e-6), BodyError::ShearModulus { value: modulus });
    }
    for nu in [-0.1, 0.5000001] {
        assert_eq!(with(SHEAR_MODULUS, nu, 1e-6), BodyError::PoissonRatio { value: nu });
    }
    assert!(
        matches!(with(SHEAR_MODULUS, f64::NAN, 1e-6), BodyError::PoissonRatio { value } if value.is_nan())
    );
    for tolerance in [0.0, 0.1] {
        assert_eq!(with(SHEAR_MODULUS, 0.5, tolerance), BodyError::Tolerance { value: tolerance });
    }
}

#[test]
fn the_skin_must_bound_one_body() {
    let (vertices, faces) = icosphere(8e-3, 1);
    let open = surface((vertices.clone(), faces[1..].to_vec()));
    assert_eq!(with_core().held_vertices(&open).expect_err("open"), BodyError::SkinOpen { border_count: 1 });

    let beside = (vertices.iter().map(|v| v + Vector3::x()).collect(), faces.clone());
    let two = surface(joined(&(vertices.clone(), faces), &beside));
    assert_eq!(with_core().held_vertices(&two).expect_err("two"), BodyError::SkinPieces { count: 2 });

    let mirrored = skin().with_vertices(vertices.iter().map(|v| -v).collect());
    let error = with_core().held_vertices(&mirrored).expect_err("inside out");
    assert!(matches!(error, BodyError::SkinInverted { volume } if volume < 0.0));
}

#[test]
fn a_skin_that_crosses_itself_is_named_where_it_is_solved_and_where_its_coarse_mesh_does_too() {
    let fine = sphere(8e-3, Vector3::zeros());
    let mut vertices = fine.vertices().to_vec();
    let far = (0..vertices.len()).max_by(|&a, &b| vertices[a].x.total_cmp(&vertices[b].x)).expect("some");
    vertices[far] = Vector3::new(-12e-3, 0.5e-3, 0.3e-3);
    let skin = fine.with_vertices(vertices);
    let held: Vec<bool> = skin.vertices().iter().map(|vertex| vertex.z > 4e-3).collect();
    for coarse_edge_length in [Some(0.0), Some(6e-3)] {
        let body = Body { bone: None, fixed: Some(held.clone()), coarse_edge_length };
        let free = held.iter().position(|held| !held).expect("free skin");
        let error = PreparedBody::new(&skin, &body, 60e3, 0.5, &[free], &BodyOptions::default());
        let message = error.expect_err("it encloses no body").to_string();
        assert!(message.contains("the skin crosses itself in"), "{message}");
    }
}

#[test]
fn a_bone_that_is_open_inverted_outside_crossing_or_touching_is_named() {
    let (vertices, faces) = icosphere(3e-3, 1);
    let open = refusal(&with_bone(surface((vertices.clone(), faces[1..].to_vec()))));
    assert!(matches!(open, BodyError::BoneOpen { component: 0, .. }), "{open}");

    let core = sphere(3e-3, Vector3::zeros());
    let mirrored = core.with_vertices(vertices.iter().map(|v| -v).collect());
    let inverted = refusal(&with_bone(mirrored));
    assert!(
        matches!(inverted, BodyError::BoneInverted { component: 0, volume } if volume < 0.0),
        "{inverted}"
    );

    let outside = refusal(&with_bone(sphere(3e-3, Vector3::x() * 0.02)));
    assert_eq!(outside, BodyError::BoneOutside { component: 0, vertex: 0, count: 42 });
    let around = refusal(&with_bone(sphere(9e-3, Vector3::zeros())));
    assert!(matches!(around, BodyError::BoneOutside { .. }), "{around}");

    let crossing = refusal(&with_bone(sphere(3e-3, Vector3::x() * 7e-3)));
    assert!(matches!(crossing, BodyError::BoneCrossesSkin { count, .. } if count > 4), "{crossing}");

    // a vertex of a small bone points at a face's centroid from within and all but meets it
    let corners = skin().faces()[0].map(|v| skin().vertices()[v as usize]);
    let centroid = (corners[0] + corners[1] + corners[2]) / 3.0;
    let small = sphere(1e-3, Vector3::zeros());
    let tip = small.vertices()[0];
    let turn = Rotation3::rotation_between(&tip, &skin().face_normals()[0]).expect("not opposite");
    let place = |v: &Vector3<f64>| turn * (v - tip) + centroid * (1.0 - 1e-9);
    let touching = small.with_vertices(small.vertices().iter().map(place).collect());
    let error = refusal(&with_bone(touching));
    assert!(
        matches!(error, BodyError::BoneTouchesSkin { distance, limit, skin_face: 0, .. } if distance < limit),
        "{error}"
    );
}

#[test]
fn bones_that_cross_each_other_are_named() {
    let (vertices, faces) = icosphere(2e-3, 1);
    let shifted = |x: f64| (vertices.iter().map(|v| v + Vector3::new(x, 0.0, 0.0)).collect(), faces.clone());
    let crossing = surface(joined(&shifted(1e-3), &shifted(-1.2e-3)));
    assert!(matches!(refusal(&with_bone(crossing)), BodyError::BonesMeet { first: 0, second: 1, .. }));
}

#[test]
fn fixed_vertices_must_hold_something_and_leave_something() {
    assert_eq!(
        refusal(&Body { bone: None, fixed: Some(vec![true; 3]), coarse_edge_length: None }),
        BodyError::FixedLength { found: 3, expected: 42 }
    );
    assert_eq!(refusal(&with_fixed(|_, _| false)), BodyError::FixedNothing { vertex_count: 42 });
    assert_eq!(refusal(&with_fixed(|_, _| true)), BodyError::FixedEverything { vertex_count: 42 });
    assert_eq!(refusal(&with_fixed(|i, _| i == 7)), BodyError::FixedWithoutFace { count: 1, first: 7 });
    assert_eq!(
        refusal(&with_fixed(|i, _| i == 3 || i == 2)),
        BodyError::FixedWithoutFace { count: 2, first: 2 }
    );
}

#[test]
fn nodes_must_be_free_skin_vertices_each_listed_once() {
    let options = BodyOptions::default();
    let error = |nodes: &[usize]| prepare(&with_core(), nodes, &options).expect_err("bad nodes");
    assert_eq!(error(&[]), BodyError::NoNodes);
    assert_eq!(error(&[0, 42]), NodesError::OutOfRange { index: 1, vertex: 42, vertex_count: 42 }.into());
    assert_eq!(error(&[4, 0, 4]), NodesError::Repeated { vertex: 4, first: 0, second: 2 }.into());
    let body = with_fixed(|_, v| v.z > 0.0);
    let above: Vec<usize> = (0..42).filter(|&i| skin().vertices()[i].z > 0.0).collect();
    let error = prepare(&body, &above, &options).expect_err("fixed");
    assert_eq!(error, BodyError::NodeFixed { vertex: above[0], count: above.len() });
}

#[test]
fn a_fixed_vertex_of_no_fixed_face_stays_free() {
    let lowest = |v: &Vector3<f64>| v.z < -7.9e-3 || v.x > 3e-3;
    let held = |also: Option<usize>| {
        with_fixed(|i, v| lowest(v) || Some(i) == also).held_vertices(&skin()).expect("sound")
    };
    let alone = far_from_the_rest();
    assert!(held(None).contains(&true) && !held(None)[alone]);
    assert_eq!(held(Some(alone)), held(None));
}

/// The vertex with the smallest x, none of whose neighbours has x > 3 mm.
fn far_from_the_rest() -> usize {
    let skin = skin();
    (0..42).min_by(|&a, &b| skin.vertices()[a].x.total_cmp(&skin.vertices()[b].x)).expect("vertices")
}

#[test]
fn the_memory_limit_is_kept_and_says_what_would_fit() {
    let cost = with_core().estimate(&skin(), 10);
    assert_eq!(cost, BodyCost::estimate(42, 42, 10));
    assert_eq!((cost.unknowns, cost.right_hand_sides, cost.kept_bytes), (252, 30, 8 * 126 * 30));
    let nodes: Vec<usize> = (0..10).collect();
    let options = BodyOptions { memory_limit: Some(cost.peak_bytes - 1), ..BodyOptions::default() };
    let error = prepare(&with_core(), &nodes, &options).expect_err("one byte short");
    let BodyError::MemoryLimit { needed, limit, affordable, .. } = error else { panic!("{error}") };
    assert_eq!((needed, limit), (cost.peak_bytes, cost.peak_bytes - 1));
    assert!(affordable > 0 && affordable < 120);
    let enough = BodyOptions { memory_limit: Some(cost.peak_bytes), ..BodyOptions::default() };
    assert!(prepare(&with_core(), &nodes, &enough).is_ok());
}

#[test]
fn without_a_limit_the_free_memory_is_the_limit_where_the_system_tells_it() {
    let (vertices, faces) = icosphere(8e-3, 7); // 163,842 vertices: 1.9 terabytes
    if cfg!(target_os = "linux") {
        let skin = surface((vertices, faces));
        let error = with_core()
            .prepare(&skin, SHEAR_MODULUS, 0.5, &[0], &BodyOptions::default())
            .expect_err("too large");
        assert!(matches!(error, BodyError::MemoryLimit { skin_count: 163_842, .. }), "{error}");
    }
}

#[test]
fn at_least_one_thread_is_needed() {
    let options = BodyOptions { num_threads: Some(0), ..BodyOptions::default() };
    let error = prepare(&with_core(), &[0], &options).expect_err("no thread");
    assert!(matches!(error, BodyError::Threads(ThreadsError { threads: 0, .. })));
}

#[test]
fn progress_goes_through_the_stages_and_an_interrupt_ends_each() {
    let seen: Mutex<Vec<BodyProgress>> = Mutex::new(Vec::new());
    let progress = |step: BodyProgress| seen.lock().expect("no panic elsewhere").push(step);
    let options = BodyOptions { progress: Some(&progress), num_threads: Some(1), ..BodyOptions::default() };
    prepare(&with_core(), &[0], &options).expect("sound");
    let seen = seen.into_inner().expect("no panic elsewhere");
    let mut stages: Vec<&str> = seen.iter().map(|step| step.stage).collect();
    stages.dedup();
    assert_eq!(stages, ["assembly", "factorization", "solution"]);
    assert!(seen.iter().all(|step| step.done > 0.0 && step.done <= 1.0));

    for (patience, stage) in [(0, "assembly"), (2, "factorization"), (4, "solution")] {
        let asked = AtomicUsize::new(0);
        let interrupt = || asked.fetch_add(1, Ordering::Relaxed) >= patience;
        let options =
            BodyOptions { interrupt: Some(&interrupt), num_threads: Some(1), ..BodyOptions::default() };
        let error = prepare(&with_core(), &[0], &options).expect_err("interrupted");
        assert!(matches!(error, BodyError::Interrupted { stage: found, .. } if found == stage), "{error}");
    }
}

#[test]
fn directions_forces_and_rotations_are_checked() {
    let compliance = prepare(&with_core(), &[0, 5], &BodyOptions::default()).expect("sound");
    let z = Vector3::z();
    let error = compliance.response_along(&[z]).expect_err("too few");
    assert_eq!(error, BodyError::Length { what: "directions", found: 1, expected: 2 });
    let error = compliance.response_along(&[z, z * 2.0]).expect_err("too long");
    assert_eq!(error, BodyError::DirectionLength { index: 1, length: 2.0 });
    let error = compliance.displacements(&[z]).expect_err("too few");
    assert_eq!(error, BodyError::Length { what: "forces", found: 1, expected: 2 });
    let error = compliance.moved(&-Matrix3::identity()).expect_err("a reflection");
    assert_eq!(error, BodyError::Rotation(RigidMotionError::Reflection { determinant: -1.0 }));
    let error = compliance.moved(&(Matrix3::identity() * 1.001)).expect_err("a stretch");
    assert!(matches!(error, BodyError::Rotation(RigidMotionError::NotOrthonormal { .. })));
    assert_eq!(compliance.bone_pressures(&[z, z]).expect("two forces"), None);
}
