//! Presses of a ball of skin: what a contact holds, what it does not depend on, how it ends, what is refused.

use std::sync::atomic::{AtomicUsize, Ordering};

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Rotation3, Translation3, Vector3};
use quasirigid::contact::{Balance, ContactError, ContactOptions, ContactStatus, Goal, Press, Start, press};
use quasirigid::lcp::LcpStatus;
use quasirigid::obstacle::Obstacle;
use quasirigid::response::{Kernel, KernelSkin, Thickness};
use quasirigid::surface::Surface;

use crate::common::icosphere;
use crate::{
    POISSON_RATIO, SHEAR_MODULUS, UP, along, ball, galerkin, half_space, plate, press_up, pressed, skin,
    solve, upwards,
};

#[test]
fn apart_means_no_contact_and_zeros() {
    let contact = solve(&ball(8e-3, 3), &plate().translated(&(-1e-3 * UP)), &half_space());
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
fn tissue_without_end_leaves_out_the_bone() {
    let thickness = Thickness::Uniform(5e-3);
    let layer = KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, Kernel::Layer { thickness });
    for (skin, knows_bone) in [(half_space(), false), (layer.expect("a layer"), true)] {
        for options in [ContactOptions::on_given_mesh(), ContactOptions::default()] {
            let goal = Goal::Depth(0.3e-3);
            let contact = pressed(&ball(8e-3, 3), &plate(), &skin, goal, &options);
            assert_eq!(contact.left_out.iter().all(|one| one.what != "bone"), knows_bone);
        }
    }
}

#[test]
fn what_only_touches_is_not_pressed() {
    let surface = ball(8e-3, 3);
    for place in [[0.0, 0.0], [1.3e-3, -0.7e-3], [-2.1e-3, 0.4e-3], [0.2e-3, 3.1e-3]] {
        let center = Vector3::new(place[0], place[1], -0.1);
        let obstacle = Obstacle::sphere(center, 5e-3).expect("a sphere");
        let options = ContactOptions::default();
        let contact = pressed(&surface, &obstacle, &half_space(), Goal::Depth(0.0), &options);
        assert_eq!(contact.status, ContactStatus::NoContact, "{place:?}");
        assert_eq!(contact.resultant.contact_area, 0.0);
        let mut messages = contact.warnings.iter().map(|warning| &warning.message);
        assert!(messages.all(|message| !message.contains("lies inside the skin")));
    }
}

#[test]
fn a_solved_contact_is_complementary_and_free_of_penetration() {
    let depth = 0.5e-3;
    let contact = press_up(&ball(8e-3, 4), &plate(), &half_space(), depth);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert!(contact.accuracy.natural_residual <= 1e-10);
    for &vertex in &contact.candidates {
        assert!(contact.gap[vertex] >= -1e-9 * depth);
        assert!(contact.node_force[vertex] >= 0.0);
    }
    assert_relative_eq!(contact.max_penetration_before, depth, max_relative = 1e-9);
    // The obstacle is flat, so the linearized gaps are the true ones.
    assert!(contact.max_penetration_after <= 1e-9 * depth);
    let sum: f64 = contact.node_force.iter().sum();
    assert_relative_eq!(contact.resultant.force.z, sum, max_relative = 1e-12);
    assert_relative_eq!(contact.patches[0].resultant.force, contact.resultant.force, max_relative = 1e-12);
}

#[test]
fn travel_counts_from_infinity_and_is_negative_for_a_start_in_overlap() {
    let surface = ball(8e-3, 3);
    let low = press_up(&surface, &plate().translated(&(-5e-3 * UP)), &half_space(), 1e-4);
    let high = press_up(&surface, &plate().translated(&(5e-3 * UP)), &half_space(), 1e-4);
    assert_relative_eq!(low.travel - high.travel, 10e-3, max_relative = 1e-9);
    assert!(high.travel < 0.0);
    assert_relative_eq!(low.resultant.force.z, high.resultant.force.z, max_relative = 1e-6);
}

#[test]
fn a_press_by_nothing_is_no_contact() {
    let contact = press_up(&ball(8e-3, 2), &plate(), &half_space(), 0.0);
    assert_eq!(contact.status, ContactStatus::NoContact);
}

#[test]
fn force_does_not_depend_on_where_the_scene_lies_or_how_its_vertices_are_numbered() {
    let (depth, skin) = (0.6e-3, half_space());
    let surface = ball(8e-3, 3);
    let rod = Obstacle::capsule(Vector3::new(-0.03, 0.0, -0.01), Vector3::new(0.03, 0.002, -0.01), 6e-3)
        .expect("a valid obstacle");
    let force = press_up(&surface, &rod, &skin, depth).resultant.force.norm();

    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(0.4, -0.2, 1.3);
    let moved = surface.moved(&Isometry3::from_parts(Translation3::from(shift), turn.into()));
    let obstacle = rod.moved(turn.matrix(), &shift).expect("a rigid motion");
    let way = along(turn * UP, Goal::Depth(depth));
    let turned =
        press(&moved, &obstacle, &skin, &way, &ContactOptions::on_given_mesh()).expect("a valid request");
    assert_relative_eq!(turned.resultant.force.norm(), force, max_relative = 1e-6);

    let count = surface.vertices().len();
    let renumber = |vertex: usize| (vertex * 7 + 3) % count;
    assert_eq!(count % 7, 5, "7 must be coprime to the number of vertices");
    let mut vertices = vec![Vector3::zeros(); count];
    surface.vertices().iter().enumerate().for_each(|(old, x)| vertices[renumber(old)] = *x);
    let faces = surface.faces().iter().map(|face| face.map(|v| renumber(v as usize) as u32)).collect();
    let renumbered = Surface::new(vertices, faces).expect("a valid surface");
    let again = press_up(&renumbered, &rod, &skin, depth).resultant.force.norm();
    assert_relative_eq!(again, force, max_relative = 1e-9);
}

#[test]
fn force_grows_with_the_square_of_the_scale() {
    let force = |scale: f64| {
        press_up(&ball(8e-3 * scale, 3), &plate(), &half_space(), 0.5e-3 * scale).resultant.force.z
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
        let skin = KernelSkin::new(modulus, POISSON_RATIO, Kernel::HalfSpace).expect("valid constants");
        press_up(&ball(8e-3, 3), &plate(), &skin, 0.5e-3).resultant.force.z
    };
    assert_relative_eq!(at(6e9), 1e5 * at(6e4), max_relative = 1e-9);
}

#[test]
fn masked_vertices_stay_out_of_contact() {
    let surface = ball(8e-3, 3);
    let mask: Vec<bool> = surface.vertices().iter().map(|x| x.z > 0.2e-3).collect();
    let masked = surface.clone().with_skin_mask(mask.clone()).expect("a mask of the surface");
    let contact = press_up(&masked, &plate(), &half_space(), 0.3e-3);
    assert!(contact.candidates.iter().all(|&vertex| mask[vertex]));
    assert!(contact.travel > press_up(&surface, &plate(), &half_space(), 0.3e-3).travel);
}

fn paper_skin() -> KernelSkin {
    skin(Kernel::GaussianCorrected { height: 0.8e-3, width: 5e-3, cutoff: 15e-3 })
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
    assert!(deep.advice().contains("well-posed response"), "{}", deep.advice());
    // Of the problem alone there is nothing that a press could set.
    assert!(!deep.advice().contains("covering vector"), "{}", deep.advice());
    assert!(deep.resultant.force.z.is_nan(), "no figure may pass for an answer");
    let drawn = deep.drawn_skin(&paper_skin(), &ContactOptions::on_given_mesh()).expect("nothing to draw");
    assert!(drawn.displacement.iter().all(|u| *u == Vector3::zeros()));
}

#[test]
fn bad_questions_are_named() {
    let (surface, skin, options) = (ball(8e-3, 2), half_space(), ContactOptions::on_given_mesh());
    let ask = |direction, depth, start| {
        press(
            &surface,
            &plate(),
            &skin,
            &Press { direction, goal: Goal::Depth(depth), start, balance: Balance::None },
            &options,
        )
    };
    let zero = ask(Vector3::zeros(), 1e-3, Start::Infinity).unwrap_err();
    assert_eq!(zero, ContactError::Direction { direction: [0.0; 3] });
    let negative = ask(UP, -1e-3, Start::Infinity).unwrap_err();
    assert_eq!(negative, ContactError::Depth { depth: -1e-3 });
    assert!(matches!(ask(UP, f64::NAN, Start::Infinity), Err(ContactError::Depth { .. })));

    let overlapping = plate().translated(&(1e-3 * UP));
    let from_here =
        Press { direction: UP, goal: Goal::Depth(1e-3), start: Start::Current, balance: Balance::None };
    match press(&surface, &overlapping, &skin, &from_here, &options).unwrap_err() {
        ContactError::StartsPenetrating { penetration, count, .. } => {
            assert_relative_eq!(penetration, 1e-3, max_relative = 0.2);
            assert!(count > 0);
        }
        other => panic!("{other}"),
    }

    let beside = Obstacle::sphere(Vector3::new(0.1, 0.0, 0.0), 1e-3).expect("a valid obstacle");
    let up = upwards(Goal::Depth(1e-3));
    let masked = |skin_vertices: usize| {
        let mask = (0..surface.vertices().len()).map(|vertex| vertex < skin_vertices).collect();
        surface.clone().with_skin_mask(mask).expect("a mask of the surface")
    };
    let missed = press(&masked(5), &beside, &skin, &up, &options).unwrap_err();
    assert!(matches!(missed, ContactError::NeverTouches { skin_vertices: 5, .. }));
    assert!(missed.to_string().contains("none of the 5 vertices that may touch"), "{missed}");

    let none = press(&masked(0), &plate(), &skin, &up, &options).unwrap_err();
    assert_eq!(none, ContactError::NoSkin { vertex_count: surface.vertices().len() });

    let options = ContactOptions { tolerance: -1.0, ..ContactOptions::on_given_mesh() };
    let refused = press(&surface, &plate(), &skin, &up, &options).unwrap_err();
    assert!(matches!(refused, ContactError::Option { option: "tolerance", .. }));
}

#[test]
fn an_obstacle_in_another_unit_is_warned_about() {
    let (vertices, faces) = icosphere(8.0, 2);
    let huge = Obstacle::mesh(vertices, faces, &Default::default()).expect("a valid obstacle");
    let contact = solve(&ball(8e-3, 2), &huge.translated(&Vector3::new(0.0, 0.0, -9.0)), &half_space());
    assert!(contact.warnings[0].message.contains("unit"), "{:?}", contact.warnings);
}

#[test]
fn threads_change_nothing_and_drawing_uses_those_asked_for() {
    let with = |num_threads| {
        let options = ContactOptions { num_threads: Some(num_threads), ..ContactOptions::on_given_mesh() };
        let contact = pressed(&ball(8e-3, 3), &plate(), &half_space(), Goal::Depth(0.5e-3), &options);
        let seen = AtomicUsize::new(0);
        let look = || {
            seen.fetch_max(rayon::current_num_threads(), Ordering::Relaxed);
            false
        };
        let drawn = contact
            .drawn_skin(&half_space(), &ContactOptions { interrupt: Some(&look), ..options })
            .expect("not interrupted");
        assert_eq!(seen.into_inner(), num_threads);
        (contact.node_force, drawn.displacement)
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn the_free_way_to_the_skin_is_no_depth() {
    let surface = ball(8e-3, 3);
    let skin = half_space();
    let options = ContactOptions::default();
    let at = |away: f64, start: Start, depth: f64| {
        let slab = Obstacle::cuboid(Vector3::new(15e-3, 10e-3, 5e-3)).expect("a box");
        let slab = slab.translated(&Vector3::new(1e-3, 6e-3, -5e-3 - away));
        let press_up = Press { direction: UP, goal: Goal::Depth(depth), start, balance: Balance::None };
        press(&surface, &slab, &skin, &press_up, &options).expect("a depth")
    };
    let expected = at(0.02, Start::Infinity, 5e-4);
    for away in [0.02, 0.03, 0.05] {
        let travel = at(away, Start::Infinity, 5e-4).travel;
        let contact = at(away, Start::Current, travel);
        assert_relative_eq!(contact.resultant.force.z, expected.resultant.force.z, max_relative = 0.02);
        assert!(contact.max_penetration_before < 6e-4, "{}", contact.max_penetration_before);
    }
}

#[test]
fn a_capsule_end_on_is_met_between_vertices_as_its_sphere_is() {
    let surface = ball(8e-3, 2);
    for x in [0.3e-3, 0.9e-3, 1.3e-3] {
        let (low, high) = (Vector3::new(x, 0.4e-3, -0.05), Vector3::new(x, 0.4e-3, -0.03));
        let capsule = Obstacle::capsule(low, high, 3e-4).expect("a capsule");
        let sphere = Obstacle::sphere(high, 3e-4).expect("a sphere");
        let [pin, tip] = [capsule, sphere].map(|product| press_up(&surface, &product, &half_space(), 1e-4));
        assert_relative_eq!(pin.travel, tip.travel, max_relative = 1e-9);
        assert_relative_eq!(pin.resultant.force, tip.resultant.force, max_relative = 1e-9);
    }
}

#[test]
fn forces_stand_upright_on_a_ball_that_the_skin_folds_around() {
    let (radius, depth) = (2e-3, 2e-3);
    let centered = Obstacle::sphere(Vector3::new(0.0, 0.0, -5e-3), radius).expect("a valid obstacle");
    let options = ContactOptions::default();
    for skin in [half_space(), galerkin()] {
        let contact = pressed(&ball(8e-3, 3), &centered, &skin, Goal::Depth(depth), &options);
        let deformed = contact.drawn_skin(&skin, &options).expect("not interrupted").deformed;
        let at_active: Vec<Vector3<f64>> = contact.active.iter().map(|&v| deformed.vertices()[v]).collect();
        let normals = contact.obstacle.signed_distance(&at_active, None).expect("not interrupted").normal;
        let off = contact.active.iter().zip(normals).map(|(&vertex, normal)| {
            let force = contact.node_force[vertex];
            force * (contact.force_vectors[vertex] / force - normal).norm_squared()
        });
        let turned = (off.sum::<f64>() / contact.node_force.iter().sum::<f64>()).sqrt();
        // The drawn skin is moved to the tolerance of R.
        assert!(turned <= 5.0 * options.gap_tolerance + 1e-6, "{turned}");
    }
}
