//! What the body's answer does not depend on: order of loads, pose, units, threads, storage; several bones.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Rotation3, Vector3};
use quasirigid::response::body::{Body, BodyOptions, OneLevel};
use quasirigid::response::{AssemblyOptions, ElasticSkin, Levels, PreparedBody, Request};
use quasirigid::surface::Surface;

use crate::common::{icosphere, joined};
use crate::{
    SHEAR_MODULUS, all_nodes, cap_nodes, drawn_sphere, prepare, pressure_forces, sphere, surface, with_bone,
};

/// Betti: the work of one load on the displacement of another does not depend on their order.
#[test]
fn loads_do_reciprocal_work_up_to_the_mesh_error() {
    let difference = |subdivisions: usize| {
        let skin = sphere(8e-3, subdivisions);
        let compliance = prepare(&with_bone(sphere(4e-3, subdivisions)), &skin, 0.45, &all_nodes(&skin));
        // a push of the lower half and a shear of the right half, both smooth
        let load = |toward: Vector3<f64>, along: Vector3<f64>| -> Vec<Vector3<f64>> {
            let strength = |v: &Vector3<f64>| (v.dot(&toward) / 8e-3).max(0.0).powi(2);
            skin.vertices()
                .iter()
                .zip(skin.vertex_areas())
                .map(|(v, area)| along * (strength(v) * area))
                .collect()
        };
        let (push, shear) =
            (load(-Vector3::z(), Vector3::new(0.2, 0.0, 1.0)), load(Vector3::x(), Vector3::z()));
        let work = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
            let moved = compliance.displacements(b).expect("one force per node");
            a.iter().zip(moved).map(|(a, moved)| a.dot(&moved)).sum()
        };
        (work(&push, &shear) / work(&shear, &push) - 1.0).abs()
    };
    let (coarse, fine) = (difference(1), difference(2));
    assert!(fine < 0.01 && fine < 0.4 * coarse, "{coarse:e} at 42, {fine:e} at 162 vertices");
}

#[test]
fn turning_the_answer_is_turning_the_body() {
    let (skin, bone) = (drawn_sphere(8e-3, 2, 2.0), sphere(3e-3, 1));
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let pose = Isometry3::from_parts(Vector3::new(0.1, -0.2, 0.05).into(), turn.into());
    let turned =
        prepare(&with_bone(bone.clone()), &skin, 0.45, &nodes).moved(turn.matrix()).expect("a rotation");
    let anew = prepare(&with_bone(bone.moved(&pose)), &skin.moved(&pose), 0.45, &nodes);
    let normals: Vec<_> = nodes.iter().map(|&i| turn * skin.vertex_normals()[i]).collect();
    let (a, b) = (turned.response_along(&normals), anew.response_along(&normals));
    let (a, b) = (a.expect("unit directions"), b.expect("unit directions"));
    // far rules may switch by rounding: the integration tolerance
    assert!((&a - &b).norm_max() < 1e-6 * a.norm_max());
    let forces: Vec<_> = normals.iter().map(|n| -n * 1e-2).collect();
    let (a, b) =
        (turned.displacements(&forces).expect("forces"), anew.displacements(&forces).expect("forces"));
    let largest = a.iter().map(Vector3::norm).fold(0.0, f64::max);
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).norm() < 1e-6 * largest));
    // some nodes in another order have the same entries
    let some = [2, 0, 1];
    let some_normals = some.map(|node| normals[node]);
    let surface = skin.moved(&pose);
    let level = OneLevel { compliance: turned.clone(), thickness: None };
    let prepared = PreparedBody::from_levels(&surface, &nodes, Levels::One(level)).expect("its own skin");
    let some_nodes = some.map(|node| nodes[node]);
    let asked = Request { surface: &surface, nodes: &some_nodes, options: &AssemblyOptions::default() };
    let among = prepared.matrix(&asked, &some_normals).expect("known nodes");
    let along = turned.response_along(&normals).expect("unit directions");
    assert!(
        (0..3).all(|i| (0..3).all(|j| among[(i, j)] == along[(some[i], some[j])])),
        "{among:?} of {along:?}"
    );
    // response and displacements agree with each other
    let response = turned.response_along(&normals).expect("unit directions");
    let along: f64 = (0..nodes.len()).map(|j| response[(0, j)] * -1e-2).sum();
    assert_relative_eq!(a[nodes[0]].dot(&normals[0]), along, max_relative = 1e-12);
}

#[test]
fn the_unit_system_does_not_matter() {
    let (skin, bone) = (drawn_sphere(8e-3, 2, 3.0), sphere(3e-3, 1));
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let up = vec![Vector3::z(); nodes.len()];
    let fixed: Vec<bool> = skin.vertices().iter().map(|v| v.z > 2e-3).collect();
    let response = |length: f64, modulus: f64| {
        let scaled = |s: &Surface| s.with_vertices(s.vertices().iter().map(|v| v * length).collect());
        let body = Body { bone: Some(scaled(&bone)), fixed: Some(fixed.clone()), coarse_edge_length: None };
        let compliance = body
            .prepare(&scaled(&skin), SHEAR_MODULUS * modulus, 0.5, &nodes, &BodyOptions::default())
            .expect("a sound body");
        compliance.response_along(&up).expect("unit directions") * faer::Scale(length * modulus)
    };
    let expected = response(1.0, 1.0);
    for (length, modulus) in [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6), (1e3, 1e-6)] {
        let error = (response(length, modulus) - &expected).norm_max() / expected.norm_max();
        assert!(error < 1e-9, "lengths x {length}, modulus x {modulus}: {error:e}");
    }
}

#[test]
fn the_number_of_threads_does_not_change_the_answer() {
    let skin = drawn_sphere(8e-3, 2, 2.0);
    let nodes = cap_nodes(&skin, 8e-3, 1e-3);
    let with = |threads: usize| {
        let options = BodyOptions { num_threads: Some(threads), ..BodyOptions::default() };
        let body = with_bone(sphere(3e-3, 2));
        body.prepare(&skin, SHEAR_MODULUS, 0.5, &nodes, &options).expect("a sound body")
    };
    let (one, two) = (with(1), with(2));
    assert!(one.parts().displacement == two.parts().displacement);
}

#[test]
fn several_bones_share_the_load() {
    let skin = sphere(8e-3, 2);
    let (vertices, faces) = icosphere(2e-3, 1);
    let shifted = |x: f64| (vertices.iter().map(|v| v + Vector3::new(x, 0.0, 0.0)).collect(), faces.clone());
    let bones = surface(joined(&shifted(3e-3), &shifted(-3e-3)));
    let options = BodyOptions { bone_pressure: true, ..BodyOptions::default() };
    let nodes = all_nodes(&skin);
    let compliance =
        with_bone(bones).prepare(&skin, SHEAR_MODULUS, 0.5, &nodes, &options).expect("two bones are sound");
    let found = compliance.bone_pressures(&pressure_forces(&skin, 1e4)).expect("forces").expect("asked for");
    assert!(found.iter().all(|p| (p / 1e4 - 1.0).abs() < 0.05), "{found:?}");
}
