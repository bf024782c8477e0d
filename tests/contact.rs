//! The whole pipeline through the public API: known answers, invariance, endings.

mod common;

use approx::assert_relative_eq;
use common::{Random, grid, icosphere};
use nalgebra::{Isometry3, Rotation3, Translation3, Vector3};
use quasirigid::contact::{
    Contact, ContactError, ContactOptions, ContactStatus, Press, Start, press, solve_contact,
};
use quasirigid::lcp::LcpStatus;
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{Hertz, contact_modulus};
use quasirigid::response::{Gap, Pressure, Response, Skin};
use quasirigid::surface::Surface;

const SHEAR_MODULUS: f64 = 60e3;
const POISSON_RATIO: f64 = 0.5;
const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

fn half_space(pressure: Pressure) -> Skin {
    Skin::new(SHEAR_MODULUS, POISSON_RATIO, Response::HalfSpace { pressure, gap: Gap::Node }).unwrap()
}

fn linear() -> Skin {
    half_space(Pressure::Linear)
}

fn go_on() -> bool {
    false
}

fn solve(surface: &Surface, obstacle: &Obstacle, skin: &Skin) -> Contact {
    solve_contact(surface, obstacle, skin, &ContactOptions::default(), &go_on).unwrap()
}

fn press_up(surface: &Surface, obstacle: &Obstacle, skin: &Skin, depth: f64) -> Contact {
    let upwards = Press { direction: UP, depth, start: Start::Infinity };
    press(surface, obstacle, skin, &upwards, &ContactOptions::default(), &go_on).unwrap()
}

/// A sphere (m) pressed 0.5 mm into a flat skin with `cells` cells per contact radius, its inner vertices moved by
/// up to `jitter` cells.
fn hertz_contact_on(cells: usize, jitter: f64, radius: f64, skin: &Skin) -> (Contact, Hertz, f64) {
    let hertz = Hertz { radius, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let approach = 0.5e-3;
    let spacing = hertz.contact_radius(approach) / cells as f64;
    let count = 2 * (cells + cells / 2);
    let (mut vertices, faces) = grid(count, count, spacing);
    let (middle, mut random) = (0.5 * count as f64 * spacing, Random(5));
    for vertex in &mut vertices {
        if (*vertex - Vector3::new(middle, middle, 0.0)).amax() < 0.999 * middle {
            vertex.x += jitter * spacing * (2.0 * random.next() - 1.0);
            vertex.y += jitter * spacing * (2.0 * random.next() - 1.0);
        }
    }
    let surface = Surface::new(vertices, faces).unwrap();
    let sphere =
        Obstacle::sphere(Vector3::new(middle, middle, hertz.radius - approach), hertz.radius).unwrap();
    (solve(&surface, &sphere, skin), hertz, approach)
}

/// A sphere R = 200 mm pressed 0.5 mm into a regular flat skin.
fn hertz_contact(cells: usize, pressure: Pressure) -> (Contact, Hertz, f64) {
    hertz_contact_on(cells, 0.0, 0.2, &half_space(pressure))
}

fn force_error(cells: usize) -> f64 {
    let (contact, hertz, approach) = hertz_contact(cells, Pressure::Linear);
    (contact.resultant.force.norm() / hertz.force(approach) - 1.0).abs()
}

#[test]
fn a_sphere_on_flat_skin_gives_hertz_force_and_peak_pressure() {
    let (contact, hertz, approach) = hertz_contact(8, Pressure::Linear);
    assert_eq!(contact.status, ContactStatus::Solved);
    // 0.1 % of it is the true sphere against Hertz's parabola, the rest the mesh.
    assert_relative_eq!(contact.resultant.force.norm(), hertz.force(approach), max_relative = 2e-3);
    assert_relative_eq!(contact.resultant.max_pressure, hertz.max_pressure(approach), max_relative = 5e-3);
    // The sphere presses from above: the skin is pushed down.
    assert!(contact.resultant.force.z < 0.0);
    assert!(contact.volume_change < 0.0);
}

#[test]
fn the_error_against_hertz_falls_with_refinement() {
    let errors = [2, 4, 8].map(force_error);
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

#[test]
fn averaged_gaps_give_a_better_hertz_force_than_gaps_at_vertices() {
    let weighted = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Weighted };
    let weighted = Skin::new(SHEAR_MODULUS, POISSON_RATIO, weighted).unwrap();
    // So flat a sphere is Hertz's parabola up to d / R = 2.5e-6, and all error the mesh's.
    let errors = |cells: usize, jitter: f64, skin: &Skin| {
        let (contact, hertz, approach) = hertz_contact_on(cells, jitter, 200.0, skin);
        let force = contact.resultant.force.norm() / hertz.force(approach) - 1.0;
        let peak = contact.resultant.max_pressure / hertz.max_pressure(approach) - 1.0;
        (force.abs(), peak.abs(), contact.max_penetration_after / approach)
    };
    for jitter in [0.0, 0.25] {
        for cells in [4, 8] {
            let (node, averaged) = (errors(cells, jitter, &linear()), errors(cells, jitter, &weighted));
            assert!(averaged.0 < 0.5 * node.0, "force, {cells} cells: {averaged:?} {node:?}");
            // As good at the peak as the node form is at 8 cells, already at 4.
            assert!(averaged.1 < 5e-3, "peak, {cells} cells: {averaged:?}");
            // A vertex may keep a penetration, of the order of the mesh error: edges of √2 h sag by h² / R at most.
            assert!(averaged.2 < 1.0 / (cells * cells) as f64, "{averaged:?}");
            assert!(node.2 < 1e-9, "{node:?}");
        }
    }
}

#[test]
fn a_press_too_shallow_for_averaged_gaps_keeps_its_penetration_and_says_so() {
    let response = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Weighted };
    let skin = Skin::new(SHEAR_MODULUS, POISSON_RATIO, response).unwrap();
    let contact = press_up(&ball(8e-3, 3), &plate(), &skin, 1e-5);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert_eq!(contact.resultant.force, Vector3::zeros());
    assert_relative_eq!(contact.max_penetration_after, 1e-5, max_relative = 1e-9);
    assert!(contact.warnings[0].contains("refine the mesh"), "{:?}", contact.warnings);
}

#[test]
fn one_ring_pressures_oscillate_where_linear_ones_do_not() {
    let (linear, hertz, approach) = hertz_contact(8, Pressure::Linear);
    let peak_error = |contact: &Contact| {
        // Node force over vertex area is what the LCP itself finds, before any averaging.
        let surface = &contact.deformed;
        let peak = contact.active.iter().map(|&v| contact.node_force[v] / surface.vertex_areas()[v]);
        peak.fold(0.0, f64::max) / hertz.max_pressure(approach) - 1.0
    };
    assert!(peak_error(&linear).abs() < 0.005);
    let (one_ring, ..) = hertz_contact(8, Pressure::OneRing);
    // The force is right all the same; the node pressures are not.
    assert_relative_eq!(one_ring.resultant.force.norm(), linear.resultant.force.norm(), max_relative = 0.02);
    assert!(peak_error(&one_ring) > 0.04, "{}", peak_error(&one_ring));
}

/// A ball of skin, its lowest point near the origin.
fn ball(radius: f64, subdivisions: usize) -> Surface {
    let (mut vertices, faces) = icosphere(radius, subdivisions);
    vertices.iter_mut().for_each(|vertex| vertex.z += radius);
    Surface::new(vertices, faces).unwrap()
}

fn plate() -> Obstacle {
    Obstacle::half_space(Vector3::zeros(), UP).unwrap()
}

#[test]
fn apart_means_no_contact_and_zeros() {
    let contact = solve(&ball(8e-3, 3), &plate().translated(&(-1e-3 * UP)), &linear());
    assert_eq!(contact.status, ContactStatus::NoContact);
    assert_eq!(contact.resultant.force, Vector3::zeros());
    assert_eq!(contact.resultant.contact_area, 0.0);
    assert!(contact.resultant.center_of_pressure.x.is_nan());
    assert!(contact.lcp_solutions.is_empty() && contact.candidates.is_empty());
    assert!(contact.node_force.iter().all(|&force| force == 0.0));
    let left_out: Vec<&str> = contact.left_out.iter().map(|entry| entry.what).collect();
    assert!(left_out.contains(&"response matrix") && left_out.contains(&"complementarity problem"));
    assert!(contact.timings.iter().all(|timing| timing.stage != "response" && timing.stage != "lcp"));
}

#[test]
fn a_solved_contact_is_complementary_and_free_of_penetration() {
    let depth = 0.5e-3;
    let contact = press_up(&ball(8e-3, 4), &plate(), &linear(), depth);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert!(contact.accuracy.natural_residual <= 1e-10);
    for &vertex in &contact.candidates {
        assert!(contact.gap[vertex] >= -1e-9 * depth);
        assert!(contact.node_force[vertex] >= 0.0);
    }
    assert_relative_eq!(contact.max_penetration_before, depth, max_relative = 1e-9);
    // The obstacle is flat, so the linearised gaps are the true ones.
    assert!(contact.max_penetration_after <= 1e-9 * depth);
    let sum: f64 = contact.node_force.iter().sum();
    assert_relative_eq!(contact.resultant.force.z, sum, max_relative = 1e-12);
    assert_relative_eq!(contact.patches[0].resultant.force, contact.resultant.force, max_relative = 1e-12);
    let area: f64 = contact.active.iter().map(|&v| ball_area(&contact, v)).sum();
    assert!(area > 0.0);
}

fn ball_area(contact: &Contact, vertex: usize) -> f64 {
    if contact.node_force[vertex] > 0.0 { contact.node_force[vertex] / contact.pressure[vertex] } else { 0.0 }
}

#[test]
fn travel_counts_from_infinity_and_is_negative_for_a_start_in_overlap() {
    let surface = ball(8e-3, 3);
    let low = press_up(&surface, &plate().translated(&(-5e-3 * UP)), &linear(), 1e-4);
    let high = press_up(&surface, &plate().translated(&(5e-3 * UP)), &linear(), 1e-4);
    assert_relative_eq!(low.travel - high.travel, 10e-3, max_relative = 1e-9);
    assert!(high.travel < 0.0);
    assert_relative_eq!(low.resultant.force.z, high.resultant.force.z, max_relative = 1e-6);
}

#[test]
fn a_press_by_nothing_is_no_contact() {
    let contact = press_up(&ball(8e-3, 2), &plate(), &linear(), 0.0);
    assert_eq!(contact.status, ContactStatus::NoContact);
}

#[test]
fn force_does_not_depend_on_where_the_scene_lies_or_how_its_vertices_are_numbered() {
    let (depth, skin) = (0.6e-3, linear());
    let surface = ball(8e-3, 3);
    let rod =
        Obstacle::capsule(Vector3::new(-0.03, 0.0, -0.01), Vector3::new(0.03, 0.002, -0.01), 6e-3).unwrap();
    let force = press_up(&surface, &rod, &skin, depth).resultant.force.norm();

    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(0.4, -0.2, 1.3);
    let moved = surface.moved(&Isometry3::from_parts(Translation3::from(shift), turn.into()));
    let obstacle = rod.moved(turn.matrix(), &shift).unwrap();
    let press_along = Press { direction: turn * UP, depth, start: Start::Infinity };
    let turned = press(&moved, &obstacle, &skin, &press_along, &ContactOptions::default(), &go_on).unwrap();
    assert_relative_eq!(turned.resultant.force.norm(), force, max_relative = 1e-6);

    let count = surface.vertices().len();
    let renumber = |vertex: usize| (vertex * 7 + 3) % count;
    assert_eq!(count % 7, 5, "7 must be coprime to the number of vertices");
    let mut vertices = vec![Vector3::zeros(); count];
    surface.vertices().iter().enumerate().for_each(|(old, x)| vertices[renumber(old)] = *x);
    let faces = surface.faces().iter().map(|face| face.map(|v| renumber(v as usize) as u32)).collect();
    let renumbered = Surface::new(vertices, faces).unwrap();
    let again = press_up(&renumbered, &rod, &skin, depth).resultant.force.norm();
    assert_relative_eq!(again, force, max_relative = 1e-9);
}

#[test]
fn force_grows_with_the_square_of_the_scale() {
    let force = |scale: f64| {
        press_up(&ball(8e-3 * scale, 3), &plate(), &linear(), 0.5e-3 * scale).resultant.force.z
            / (scale * scale)
    };
    let reference = force(1.0);
    for scale in [1e-3, 0.37, 1e3] {
        assert_relative_eq!(force(scale), reference, max_relative = 1e-8);
    }
}

#[test]
fn force_is_proportional_to_the_shear_modulus() {
    let at = |modulus: f64| {
        let response = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Node };
        let skin = Skin::new(modulus, POISSON_RATIO, response).unwrap();
        press_up(&ball(8e-3, 3), &plate(), &skin, 0.5e-3).resultant.force.z
    };
    assert_relative_eq!(at(6e9), 1e5 * at(6e4), max_relative = 1e-9);
}

#[test]
fn masked_vertices_stay_out_of_contact() {
    let surface = ball(8e-3, 3);
    let mask: Vec<bool> = surface.vertices().iter().map(|x| x.z > 0.2e-3).collect();
    let masked = surface.clone().with_skin_mask(mask.clone()).unwrap();
    let contact = press_up(&masked, &plate(), &linear(), 0.3e-3);
    assert!(contact.candidates.iter().all(|&vertex| mask[vertex]));
    assert!(contact.travel > press_up(&surface, &plate(), &linear(), 0.3e-3).travel);
}

fn paper_skin() -> Skin {
    let response = Response::GaussianCorrected {
        height: 0.8e-3,
        width: 5e-3,
        cutoff: 15e-3,
        pressure: Pressure::Linear,
    };
    Skin::new(SHEAR_MODULUS, POISSON_RATIO, response).unwrap()
}

#[test]
fn the_paper_s_constants_solve_shallow_presses_and_end_on_a_ray_in_deep_ones() {
    // A ball of the fingertip's radius, edges of about 1.1 mm.
    let surface = ball(8e-3, 3);
    let shallow = press_up(&surface, &plate(), &paper_skin(), 0.15e-3);
    assert_eq!(shallow.status, ContactStatus::Solved);
    assert!(shallow.candidates.len() > shallow.active.len(), "rings are added");

    let deep = press_up(&surface, &plate(), &paper_skin(), 1.5e-3);
    assert_eq!(deep.status, ContactStatus::Failed(LcpStatus::Ray));
    assert!(!deep.advice().is_empty());
    assert!(deep.resultant.force.z.is_nan(), "no figure may pass for an answer");
    assert!(deep.displacement.iter().all(|u| *u == Vector3::zeros()));
}

#[test]
fn bad_questions_are_named() {
    let (surface, skin, options) = (ball(8e-3, 2), linear(), ContactOptions::default());
    let ask = |direction, depth, start| {
        press(&surface, &plate(), &skin, &Press { direction, depth, start }, &options, &go_on)
    };
    let zero = ask(Vector3::zeros(), 1e-3, Start::Infinity).unwrap_err();
    assert_eq!(zero, ContactError::Direction { direction: [0.0; 3] });
    let negative = ask(UP, -1e-3, Start::Infinity).unwrap_err();
    assert_eq!(negative, ContactError::Depth { depth: -1e-3 });
    assert!(matches!(ask(UP, f64::NAN, Start::Infinity), Err(ContactError::Depth { .. })));

    let overlapping = plate().translated(&(1e-3 * UP));
    let from_here = Press { direction: UP, depth: 1e-3, start: Start::Current };
    match press(&surface, &overlapping, &skin, &from_here, &options, &go_on).unwrap_err() {
        ContactError::StartsPenetrating { penetration, count, .. } => {
            assert_relative_eq!(penetration, 1e-3, max_relative = 0.2);
            assert!(count > 0);
        }
        other => panic!("{other}"),
    }

    let beside = Obstacle::sphere(Vector3::new(0.1, 0.0, 0.0), 1e-3).unwrap();
    let up = Press { direction: UP, depth: 1e-3, start: Start::Infinity };
    let missed = press(&surface, &beside, &skin, &up, &options, &go_on).unwrap_err();
    assert!(matches!(missed, ContactError::NeverTouches { .. }));

    let masked = surface.clone().with_skin_mask(vec![false; surface.vertices().len()]).unwrap();
    let none = press(&masked, &plate(), &skin, &up, &options, &go_on).unwrap_err();
    assert_eq!(none, ContactError::NoSkin { vertex_count: surface.vertices().len() });

    let options = ContactOptions { tolerance: -1.0, ..ContactOptions::default() };
    let refused = press(&surface, &plate(), &skin, &up, &options, &go_on).unwrap_err();
    assert!(matches!(refused, ContactError::Option { option: "tolerance", .. }));
}

#[test]
fn an_obstacle_in_another_unit_is_warned_about() {
    let (vertices, faces) = icosphere(8.0, 2);
    let huge = Obstacle::mesh(vertices, faces, &Default::default()).unwrap();
    let contact = solve(&ball(8e-3, 2), &huge.translated(&Vector3::new(0.0, 0.0, -9.0)), &linear());
    assert!(contact.warnings[0].contains("unit"), "{:?}", contact.warnings);
}

#[test]
fn threads_change_nothing() {
    let with = |num_threads| {
        let options = ContactOptions { num_threads: Some(num_threads), ..ContactOptions::default() };
        let up = Press { direction: UP, depth: 0.5e-3, start: Start::Infinity };
        press(&ball(8e-3, 3), &plate(), &linear(), &up, &options, &go_on).unwrap()
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.node_force, two.node_force);
    assert_eq!(one.displacement, two.displacement);
}
