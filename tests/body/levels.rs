//! Bodies on two levels: the coarse skin, the near kernel with its remainder, and what both leave as it was.

use approx::assert_relative_eq;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::{Isometry3, Vector3};
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{CoredSphere, plate_on_cored_sphere};
use quasirigid::response::body::{Body, BodyError, BodyOptions};
use quasirigid::response::{
    AssemblyOptions, Discretization, ElasticSkin, Kernel, KernelSkin, Levels, PreparedBody, Request,
    ResponseError, assemble,
};
use quasirigid::surface::{CoarseSkin, Surface};

use crate::forces::contact_forces;
use crate::{SHEAR_MODULUS, all_nodes, cap_nodes, common, drawn_sphere, prepare, sphere, surface, with_bone};

const RADIUS: f64 = CoredSphere::RADIUS;

fn prepared(body: &Body, skin: &Surface, poisson_ratio: f64, nodes: &[usize]) -> PreparedBody {
    PreparedBody::new(skin, body, SHEAR_MODULUS, poisson_ratio, nodes, &BodyOptions::default())
        .expect("a sound body")
}

fn coarse_count(prepared: &PreparedBody) -> Option<usize> {
    match prepared.levels() {
        Levels::One(_) => None,
        Levels::Two(two) => Some(two.remainder.vertex_count()),
    }
}

/// Force (N) of a flat frictionless plate on a sphere about the origin, pressed upwards by `depth`.
fn plate_force(skin: &Surface, body: &PreparedBody, depth: f64) -> f64 {
    let nodes = body.nodes().list();
    let asked = Request { surface: skin, nodes, options: &AssemblyOptions::default() };
    let response = body.matrix(&asked, &vec![Vector3::z(); nodes.len()]).expect("prepared");
    let gaps: Vec<f64> = nodes.iter().map(|&i| skin.vertices()[i].z + RADIUS - depth).collect();
    contact_forces(&response, &gaps).iter().sum()
}

/// Closed tube about z with a flat end at z = 0, which is held, and a round one; edges about 0.6 mm.
fn thumb() -> (Surface, Vec<bool>) {
    let (vertices, faces) = common::icosphere(1.0, 4);
    let stretch = |p: Vector3<f64>| {
        let z = if p.z < -0.5 { 0.0 } else { 8e-3 + 16e-3 * p.z };
        let inside = if p.z < -0.5 { (1.0 - p.z * p.z).sqrt() / 0.75_f64.sqrt() } else { 1.0 };
        let around = Vector3::new(p.x, p.y, 0.0).try_normalize(1e-12).unwrap_or_default();
        let radius = 7e-3 * if p.z > 0.0 { (1.0 - p.z * p.z).max(0.0).sqrt() } else { 1.0 };
        around * (radius * inside) + Vector3::new(0.0, 0.0, z)
    };
    let skin = surface((vertices.into_iter().map(stretch).collect(), faces));
    let held = skin.vertices().iter().map(|p| p.z == 0.0).collect();
    (skin, held)
}

#[test]
fn a_coarse_skin_is_closed_lies_on_the_fine_one_and_keeps_the_outline_of_its_cut() {
    let (fine, held) = thumb();
    let wanted = vec![2.5e-3; fine.vertices().len()];
    let coarse = CoarseSkin::new(&fine, &wanted, &held).expect("a sound mesh");
    let (count, all) = (coarse.fine_vertices.len(), fine.vertices().len());
    assert!(count < all / 6 && count > 60, "{all} to {count} vertices");
    assert!(coarse.surface.is_closed() && coarse.surface.topology().component_count() == 1);
    assert!((1.5e-3..3e-3).contains(&coarse.surface.mean_edge_length()));
    assert!(coarse.deviation < 0.5e-3);
    assert_relative_eq!(coarse.surface.volume(), fine.volume(), max_relative = 0.02);
    let solid = Obstacle::mesh(fine.vertices().to_vec(), fine.faces().to_vec(), &Default::default())
        .expect("a closed mesh");
    for (vertex, point) in coarse.fine_vertices.iter().zip(coarse.surface.vertices()) {
        let off = solid.signed_distance(&[*point], None).expect("finite").distance[0].abs();
        assert!(if held[*vertex] { *point == fine.vertices()[*vertex] } else { off < 0.3e-3 });
    }
    // The cut is as wide as it was, to the sagitta of its edges.
    let cut_area = |surface: &Surface| -> f64 {
        let on_cut = |face: &[u32; 3]| face.iter().all(|&v| surface.vertices()[v as usize].z == 0.0);
        let faces = surface.faces().iter().zip(surface.face_areas());
        faces.filter(|(face, _)| on_cut(face)).map(|(_, area)| area).sum()
    };
    assert_relative_eq!(cut_area(&coarse.surface), cut_area(&fine), max_relative = 0.06);
}

#[test]
fn a_skin_that_may_be_no_coarser_keeps_every_vertex() {
    let fine = sphere(RADIUS, 3);
    let coarse = CoarseSkin::new(&fine, &vec![1e-4; 642], &[false; 642]).expect("a sound mesh");
    assert_eq!(coarse.fine_vertices, all_nodes(&fine));
    assert_eq!(coarse.surface.faces(), fine.faces());
    assert_eq!(coarse.deviation, 0.0);
}

#[test]
fn a_plate_on_a_sphere_with_a_core_meets_the_finite_element_force_on_two_levels() {
    let skin = drawn_sphere(RADIUS, 3, 4.0);
    let body = with_bone(drawn_sphere(CoredSphere::CORE_RADIUS, 2, 2.0));
    let nodes = cap_nodes(&skin, RADIUS, 1.3e-3);
    for CoredSphere { poisson_ratio, indentations, .. } in plate_on_cored_sphere() {
        let two = prepared(&body, &skin, poisson_ratio, &nodes);
        assert!(coarse_count(&two).is_some_and(|count| count < 300));
        for (depth, expected) in indentations {
            let force = plate_force(&skin, &two, depth);
            assert_relative_eq!(force, expected, max_relative = 0.03);
        }
    }
}

#[test]
fn without_a_coarse_skin_the_answer_is_that_of_one_level_to_the_bit() {
    let skin = sphere(RADIUS, 3);
    let nodes = cap_nodes(&skin, RADIUS, 1e-3);
    let bone = sphere(CoredSphere::CORE_RADIUS, 1);
    let one = Body { coarse_edge_length: Some(0.0), ..with_bone(bone.clone()) };
    let directions = vec![Vector3::z(); nodes.len()];
    let asked = Request { surface: &skin, nodes: &nodes, options: &AssemblyOptions::default() };
    let expected = prepare(&one, &skin, 0.5, &nodes).response_along(&directions).expect("unit directions");
    // Of edges shorter than the skin's nothing is left to collapse.
    let as_it_is = Body { coarse_edge_length: Some(1e-4), ..with_bone(bone) };
    for body in [one, as_it_is] {
        let found = prepared(&body, &skin, 0.5, &nodes);
        assert_eq!(coarse_count(&found), None);
        assert_eq!(found.matrix(&asked, &directions).expect("prepared"), expected);
    }
}

#[test]
fn finer_coarse_meshes_come_closer_to_one_level() {
    let skin = drawn_sphere(RADIUS, 3, 2.0);
    let nodes = cap_nodes(&skin, RADIUS, 1.3e-3);
    let body =
        |length| Body { coarse_edge_length: Some(length), ..with_bone(sphere(CoredSphere::CORE_RADIUS, 2)) };
    let force = |length| plate_force(&skin, &prepared(&body(length), &skin, 0.5, &nodes), 1e-3);
    let expected = force(0.0);
    let errors = [4e-3, 2e-3].map(|length| (force(length) / expected - 1.0).abs());
    assert!(errors[0] < 0.05 && errors[1] < 0.015 && errors[1] < errors[0], "off one level by {errors:?}");
}

/// Lamé's thick shell, fixed inside: `u = (b - a³/b²) / (3 K + 4 G a³/b³)` per Pa.
#[test]
fn skin_under_pressure_all_round_follows_lame_on_two_levels() {
    let skin = sphere(RADIUS, 3);
    let (nodes, normals) = (all_nodes(&skin), skin.vertex_normals());
    let asked = Request { surface: &skin, nodes: &nodes, options: &AssemblyOptions::default() };
    let body = with_bone(sphere(CoredSphere::CORE_RADIUS, 2));
    let core = CoredSphere::CORE_RADIUS;
    let inward = |ratio: f64| {
        let bulk = 2.0 * SHEAR_MODULUS * (1.0 + ratio) / (3.0 * (1.0 - 2.0 * ratio));
        (RADIUS - core.powi(3) / RADIUS.powi(2))
            / (3.0 * bulk + 4.0 * SHEAR_MODULUS * (core / RADIUS).powi(3))
    };
    for ratio in [0.3, 0.45, 0.499] {
        let two = prepared(&body, &skin, ratio, &nodes);
        assert!(coarse_count(&two).is_some_and(|count| count < 300));
        let response = two.matrix(&asked, normals).expect("prepared");
        let moved =
            |row: usize| -> f64 { nodes.iter().map(|&j| response[(row, j)] * skin.vertex_areas()[j]).sum() };
        let mean = nodes.iter().map(|&row| moved(row)).sum::<f64>() / nodes.len() as f64;
        // Near incompressible tissue hardly moves: what it is off counts against tissue that does, where the coarse mesh
        // of some 240 vertices costs 2 %.
        let error = (mean - inward(ratio)) / inward(0.3);
        assert!(error.abs() < 0.025, "{error:.3} at {ratio}");
    }
}

#[test]
fn a_ring_around_incompressible_tissue_presses_on_two_levels_as_on_one() {
    let skin = sphere(RADIUS, 3);
    let points = skin.vertices();
    let nodes: Vec<usize> = (0..points.len()).filter(|&v| points[v].z.abs() < 0.7 * RADIUS).collect();
    let normals: Vec<Vector3<f64>> = nodes.iter().map(|&v| skin.vertex_normals()[v]).collect();
    let asked = Request { surface: &skin, nodes: &nodes, options: &AssemblyOptions::default() };
    let [two, one] = [None, Some(0.0)].map(|coarse_edge_length| {
        let body = Body { coarse_edge_length, ..with_bone(sphere(CoredSphere::CORE_RADIUS, 2)) };
        let response = prepared(&body, &skin, 0.5, &nodes).matrix(&asked, &normals).expect("prepared");
        let symmetric =
            Mat::from_fn(nodes.len(), nodes.len(), |i, j| 0.5 * (response[(i, j)] + response[(j, i)]));
        let least = symmetric.self_adjoint_eigenvalues(Side::Lower).expect("finite")[0];
        assert!(least > 0.0, "{least:e} at {coarse_edge_length:?}");
        // All of the ring goes in by 1 m: linear.
        let forces = response.partial_piv_lu().solve(Mat::<f64>::from_fn(nodes.len(), 1, |_, _| 1.0));
        (0..nodes.len()).map(|i| forces[(i, 0)]).sum::<f64>()
    });
    // What the coarse mesh is told to cost such a contact is 3 to 4 %.
    assert_relative_eq!(two, one, max_relative = 0.05);
}

#[test]
fn a_turned_body_answers_as_one_that_is_solved_where_it_stands() {
    let skin = sphere(RADIUS, 3);
    let bone = sphere(CoredSphere::CORE_RADIUS, 2);
    let nodes = cap_nodes(&skin, RADIUS, 0.6e-3);
    let motion = Isometry3::new(Vector3::new(0.1, -0.2, 0.05), Vector3::new(0.4, -0.9, 1.3));
    let turned = skin.moved(&motion);
    let directions: Vec<Vector3<f64>> = nodes.iter().map(|&v| -turned.vertex_normals()[v]).collect();
    let asked = Request { surface: &turned, nodes: &nodes, options: &AssemblyOptions::default() };
    let stood = prepared(&with_bone(bone.clone()), &skin, 0.3, &nodes);
    // What is asked of it before it turns is kept.
    let normals: Vec<Vector3<f64>> = nodes.iter().map(|&v| -skin.vertex_normals()[v]).collect();
    stood.matrix(&Request { surface: &skin, ..asked }, &normals).expect("prepared");
    let moved = stood.moved(&motion).expect("a rotation");
    let anew = prepared(&with_bone(bone.moved(&motion)), &turned, 0.3, &nodes);
    assert_eq!(coarse_count(&moved), coarse_count(&anew));
    let [moved_matrix, anew_matrix] =
        [&moved, &anew].map(|body| body.matrix(&asked, &directions).expect("prepared"));
    let difference = (&moved_matrix - &anew_matrix).norm_max() / anew_matrix.norm_max();
    // The coarse mesh follows lengths that rounding moves; the integrals keep 1e-6.
    assert!(difference < 1e-5, "differ by {difference:.1e}");

    // A newton at each node: few vertices move as they do among all, and as R says.
    let at = |vertices: &[usize]| moved.displace(&asked, &directions, vertices).expect("prepared");
    let (few, all) = (at(&nodes), at(&all_nodes(&turned)));
    for (row, (&node, u)) in nodes.iter().zip(&few).enumerate() {
        assert!((u - all[node]).norm() < 1e-12 * u.norm());
        let expected: f64 = moved_matrix.row(row).iter().sum();
        assert!((u.dot(&directions[row]) / expected - 1.0).abs() < 1e-9);
    }
}

#[test]
fn held_vertices_stay_where_they_are_and_the_rest_goes_as_on_one_level() {
    let (skin, held) = thumb();
    let tip =
        (0..held.len()).max_by(|&a, &b| skin.vertices()[a].z.total_cmp(&skin.vertices()[b].z)).expect("some");
    let displacement = |coarse_edge_length| {
        let body = Body { bone: None, fixed: Some(held.clone()), coarse_edge_length };
        let prepared = prepared(&body, &skin, 0.4, &[tip]);
        let asked = Request { surface: &skin, nodes: &[tip], options: &AssemblyOptions::default() };
        let force = Vector3::new(0.3, 0.1, -0.5);
        prepared.displace(&asked, &[force], &all_nodes(&skin)).expect("prepared")
    };
    let (two, one) = (displacement(Some(1.5e-3)), displacement(Some(0.0)));
    let largest = one.iter().map(|u| u.norm()).fold(0.0, f64::max);
    for (vertex, (two, one)) in two.iter().zip(&one).enumerate() {
        if held[vertex] {
            assert_eq!(*two, Vector3::zeros());
        } else if (skin.vertices()[vertex] - skin.vertices()[tip]).norm() > 2e-3 {
            assert!((two - one).norm() < 0.02 * largest, "vertex {vertex}: {two} of {one}");
        }
    }
}

#[test]
fn averaging_adds_to_a_body_what_it_adds_to_its_near_kernel() {
    let (skin, held) = thumb();
    let nodes = skin.k_ring(&[(0..held.len()).find(|&v| !held[v]).expect("free skin")], 4);
    let nodes: Vec<usize> = nodes.into_iter().filter(|&v| !held[v]).collect();
    let normals: Vec<Vector3<f64>> = nodes.iter().map(|&v| skin.vertex_normals()[v]).collect();
    let options = AssemblyOptions { tolerance: 1e-6, ..AssemblyOptions::default() };
    let asked = Request { surface: &skin, nodes: &nodes, options: &options };
    // Without bone the near kernel is a half-space.
    let half_space = KernelSkin::new(SHEAR_MODULUS, 0.4, Kernel::HalfSpace).expect("valid constants");
    let [of_kernel, of_one, of_two] = [None, Some(0.0), Some(1.5e-3)].map(|coarse_edge_length| {
        let form = |form| {
            if coarse_edge_length.is_none() {
                let kernel = half_space.clone().with_discretization(form).expect("has both");
                return assemble(&skin, &kernel, &nodes, &options).expect("vertices");
            }
            let body = Body { bone: None, fixed: Some(held.clone()), coarse_edge_length };
            let body = prepared(&body, &skin, 0.4, &nodes).with_discretization(form);
            assert_eq!(body.traits(&skin).expect("its surface").discretization, form);
            body.matrix(&asked, &normals).expect("prepared")
        };
        form(Discretization::Galerkin) - form(Discretization::Collocation)
    });
    let largest = of_kernel.norm_max();
    for found in [of_one, of_two] {
        for j in 0..nodes.len() {
            for i in 0..nodes.len() {
                let expected = of_kernel[(i, j)] * normals[i].dot(&normals[j]);
                assert!((found[(i, j)] - expected).abs() < 2e-3 * largest, "{i}, {j}");
            }
        }
    }
}

#[test]
fn coarse_edges_longer_than_the_body_or_none_at_all_are_refused() {
    let skin = sphere(RADIUS, 2);
    for value in [-1e-3, f64::NAN, f64::INFINITY, 0.1] {
        let body = Body { coarse_edge_length: Some(value), ..with_bone(sphere(CoredSphere::CORE_RADIUS, 1)) };
        let error = PreparedBody::new(&skin, &body, SHEAR_MODULUS, 0.5, &[0], &BodyOptions::default());
        let Err(ResponseError::Body(BodyError::CoarseEdgeLength { size, .. })) = error else {
            panic!("{value} is taken")
        };
        assert!((0.02..0.04).contains(&size));
    }
}

#[test]
fn a_coarse_skin_that_meets_the_bone_is_refused() {
    // 0.2 mm of tissue under coarse edges of 6 mm.
    let (skin, bone) = (sphere(RADIUS, 3), sphere(RADIUS - 0.2e-3, 3));
    let body = Body { coarse_edge_length: Some(6e-3), ..with_bone(bone) };
    let error = PreparedBody::new(&skin, &body, SHEAR_MODULUS, 0.5, &[0], &BodyOptions::default());
    let message = error.expect_err("the chords cut through the bone").to_string();
    assert!(message.contains("smaller coarse edge length") && message.contains("bone"), "{message}");
}
