//! Presses to a force and to an overlap.

use std::f64::consts::{FRAC_PI_4, SQRT_2};
use std::sync::atomic::{AtomicUsize, Ordering};

use approx::assert_relative_eq;
use nalgebra::{Rotation3, Vector3};
use quasirigid::contact::{
    Balance, ContactError, ContactOptions, ContactStatus, Goal, Press, RefinementEnd, Start, press,
    solve_contact,
};
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{Hertz, contact_modulus};
use quasirigid::response::{Kernel, KernelSkin};
use quasirigid::surface::Surface;

use crate::common::{Random, jittered_grid};
use crate::{
    POISSON_RATIO, SHEAR_MODULUS, UP, along, ball, galerkin, half_space, lattice, plate, pressed, skin,
    solve, upwards,
};

fn refused(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin, goal: Goal) -> ContactError {
    press(surface, obstacle, skin, &upwards(goal), &ContactOptions::on_given_mesh()).unwrap_err()
}

#[test]
fn a_force_on_a_flat_skin_asks_for_the_depth_of_hertz() {
    // Wide beside the depth, as Hertz takes the sphere for a paraboloid.
    let hertz = Hertz { radius: 100.0, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let depth = 5e-5;
    let contact_radius = hertz.contact_radius(depth);
    for seed in 1..4 {
        let spacing = contact_radius / 4.0;
        let (mut vertices, faces) = jittered_grid(12, spacing, 0.2, &mut Random(seed));
        // A vertex in the middle is met first, on any mesh.
        vertices.iter_mut().for_each(|vertex| *vertex -= Vector3::new(6.0 * spacing, 6.0 * spacing, 0.0));
        let middle = (0..vertices.len()).min_by(|&a, &b| vertices[a].norm().total_cmp(&vertices[b].norm()));
        vertices[middle.expect("vertices")] = Vector3::zeros();
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        let sphere =
            Obstacle::sphere(Vector3::new(0.0, 0.0, hertz.radius + 0.01), hertz.radius).expect("a sphere");
        let down = along(-UP, Goal::Force(hertz.force(depth)));
        let contact = press(&surface, &sphere, &half_space(), &down, &ContactOptions::default()).unwrap();
        // A force known to the target of 2 % is a depth known to two thirds of that.
        let error = contact.accuracy.mesh_error.expect("an estimate");
        assert!(error <= 0.02);
        assert_relative_eq!(contact.depth.unwrap(), depth, max_relative = 2.0 / 3.0 * error);
        assert_relative_eq!(-contact.resultant.force.z, hertz.force(depth), max_relative = 1e-6);
    }
}

#[test]
fn the_depth_of_a_force_gives_that_force_back() {
    let surface = ball(8e-3, 3);
    for force in [0.01, 0.1, 1.0, 5.0] {
        let given = ContactOptions::on_given_mesh();
        let contact = pressed(&surface, &plate(), &half_space(), Goal::Force(force), &given);
        assert_relative_eq!(contact.resultant.force.z, force, max_relative = 1e-6);
        let again = pressed(&surface, &plate(), &half_space(), Goal::Depth(contact.depth.unwrap()), &given);
        assert_eq!(again.node_force, contact.node_force);
        assert_relative_eq!(again.travel, contact.travel, max_relative = 1e-15);

        let options = ContactOptions::default();
        let refined = pressed(&surface, &plate(), &half_space(), Goal::Force(force), &options);
        assert_eq!(refined.refinements.last().and_then(|one| one.end), Some(RefinementEnd::Target));
        assert_eq!(refined.refinements.last().unwrap().force, refined.resultant.force);
        assert!(refined.accuracy.mesh_error.unwrap().max(refined.accuracy.area_error.unwrap()) <= 0.02);
        assert_relative_eq!(refined.resultant.force.z, force, max_relative = 1e-6);
        let again = pressed(&surface, &plate(), &half_space(), Goal::Depth(refined.depth.unwrap()), &options);
        assert_relative_eq!(again.resultant.force.z, force, max_relative = 0.04);
    }
}

#[test]
fn a_small_force_from_the_current_place_is_found_on_the_smooth_skin() {
    let surface = ball(8e-3, 2);
    for x in [0.0, 0.5e-3, 1.1e-3] {
        let rod = Obstacle::sphere(Vector3::new(x, 0.2e-3, -20e-3), 5e-3).expect("a sphere");
        for (force, start) in [(1e-4, Start::Current), (1e-4, Start::Infinity), (3e-3, Start::Current)] {
            let upwards = Press { direction: UP, goal: Goal::Force(force), start, balance: Balance::None };
            let contact = press(&surface, &rod, &half_space(), &upwards, &ContactOptions::default())
                .expect("a force within reach");
            assert_relative_eq!(contact.resultant.force.z, force, max_relative = 1e-6);
        }
    }
}

#[test]
fn averaged_gaps_find_a_force_that_starts_late() {
    for force in [0.01, 0.1] {
        let contact = pressed(
            &ball(8e-3, 2),
            &plate(),
            &galerkin(),
            Goal::Force(force),
            &ContactOptions::on_given_mesh(),
        );
        assert_relative_eq!(contact.resultant.force.z, force, max_relative = 1e-6);
    }
}

#[test]
fn a_force_by_what_is_smaller_than_the_triangles_is_found() {
    let bead = Obstacle::sphere(Vector3::new(0.3e-3, 0.1e-3, -0.03), 3e-4).expect("a sphere");
    let contact =
        pressed(&ball(8e-3, 2), &bead, &half_space(), Goal::Force(0.01), &ContactOptions::default());
    assert_relative_eq!(contact.resultant.force.z, 0.01, max_relative = 1e-6);
}

#[test]
fn the_overlap_asked_for_is_the_deepest_penetration_before() {
    let rod = Obstacle::capsule(Vector3::new(-0.03, 0.004, -0.01), Vector3::new(0.03, 0.006, -0.01), 6e-3)
        .expect("a valid obstacle");
    for target_error in [None, Some(0.02)] {
        let options = ContactOptions { target_error, ..ContactOptions::default() };
        for overlap in [1e-5, 0.3e-3, 1.12e-3] {
            let contact = pressed(&ball(8e-3, 3), &rod, &half_space(), Goal::Overlap(overlap), &options);
            assert_relative_eq!(contact.max_penetration_before, overlap, max_relative = 1e-6);
            assert!(contact.depth.unwrap() >= overlap);
        }
    }
}

#[test]
fn a_press_from_where_the_obstacle_stands_counts_its_depth_from_there() {
    let surface = ball(8e-3, 3);
    let far = plate().translated(&(-5e-3 * UP));
    let options = ContactOptions::on_given_mesh();
    let from_here = |goal| {
        let upwards = Press { direction: UP, goal, start: Start::Current, balance: Balance::None };
        press(&surface, &far, &half_space(), &upwards, &options).expect("a goal within reach")
    };
    let contact = from_here(Goal::Force(1.0));
    assert_relative_eq!(contact.resultant.force.z, 1.0, max_relative = 1e-6);
    assert_eq!(contact.depth, Some(contact.travel));
    let touching = pressed(&surface, &far, &half_space(), Goal::Force(1.0), &options);
    assert_relative_eq!(contact.travel, touching.travel, max_relative = 1e-6);
    let again = from_here(Goal::Depth(contact.travel));
    assert_eq!(again.node_force, contact.node_force);
    assert_eq!(solve(&surface, &far, &half_space()).depth, None);
}

#[test]
fn a_force_is_found_from_anywhere_where_the_skin_is_met_between_its_vertices() {
    let (x, y) = (Vector3::new(2e-3, 0.0, 0.0), Vector3::new(0.0, 2e-3, 0.0));
    let flat = lattice(20, [x, y], Vector3::zeros(), 0.0, &mut Random(1));
    let ball = Obstacle::sphere(Vector3::new(1.3e-3, 0.5e-3, 3e-3), 0.5e-3).expect("a ball");
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), FRAC_PI_4);
    let bar = Obstacle::cuboid(Vector3::new(0.01, 5e-3, 5e-3)).expect("a bar");
    let bar = bar.moved(turn.matrix(), &Vector3::new(0.0, 1e-3, 9e-3)).expect("a rotation");
    for (obstacle, touch, force) in [(ball, 2.5e-3, 5e-3), (bar, 9e-3 - 5e-3 * SQRT_2, 0.5)] {
        let depth = |start| {
            let direction = -UP;
            let down = Press { direction, goal: Goal::Force(force), start, balance: Balance::None };
            let options = ContactOptions::default();
            let contact = press(&flat, &obstacle, &half_space(), &down, &options).expect("within reach");
            assert_relative_eq!(-contact.resultant.force.z, force, max_relative = 1e-6);
            contact.depth.expect("a press")
        };
        assert_relative_eq!(depth(Start::Current), touch + depth(Start::Infinity), max_relative = 1e-6);
    }
}

#[test]
fn a_goal_that_is_no_positive_number_is_named() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for (goal, name) in [(Goal::Force(value), "force"), (Goal::Overlap(value), "overlap")] {
            match refused(&ball(8e-3, 1), &plate(), &half_space(), goal) {
                ContactError::Goal { goal, .. } => assert_eq!(goal, name),
                other => panic!("{other}"),
            }
        }
    }
}

#[test]
fn a_force_out_of_reach_gives_the_largest_contact() {
    // A ball of 1 mm passes through the skin, and one of the paper's constants ends without solution.
    let small = Obstacle::sphere(Vector3::new(0.0, 0.0, -20e-3), 1e-3).expect("a sphere");
    let constants = Kernel::GaussianCorrected { height: 0.8e-3, width: 5e-3, cutoff: 15e-3 };
    let cases = [(small, half_space(), 100.0), (plate(), skin(constants), 10.0)];
    for (obstacle, skin, force) in cases {
        match refused(&ball(8e-3, 3), &obstacle, &skin, Goal::Force(force)) {
            ContactError::NotReached { asked, found, depth, contact, .. } => {
                assert_eq!(asked, force);
                assert_eq!(contact.0.status, ContactStatus::Solved);
                assert_eq!((contact.0.resultant.force.z, contact.0.depth), (found, Some(depth)));
                assert!(0.0 < found && found < force);
                let message = refused(&ball(8e-3, 3), &obstacle, &skin, Goal::Force(force)).to_string();
                assert!(
                    message.starts_with(&format!("a force of {force} N is not reached: the largest")),
                    "{message}"
                );
            }
            other => panic!("{other}"),
        }
    }
}

#[test]
fn a_search_can_be_interrupted_at_any_question() {
    let surface = ball(8e-3, 2);
    let asked = AtomicUsize::new(0);
    let run = |limit: usize| {
        asked.store(0, Ordering::Relaxed);
        let interrupt = || asked.fetch_add(1, Ordering::Relaxed) >= limit;
        let options = ContactOptions { interrupt: Some(&interrupt), ..ContactOptions::default() };
        press(&surface, &plate(), &half_space(), &upwards(Goal::Force(1.0)), &options)
    };
    assert!(run(usize::MAX).is_ok());
    let questions = asked.load(Ordering::Relaxed);
    for limit in [0, 1, questions / 2, questions - 1] {
        let error = run(limit).expect_err("a search that was told to stop");
        assert!(error.to_string().contains("interrupted"), "{error}");
    }
}

#[test]
fn a_contact_in_place_has_no_depth() {
    let options = ContactOptions::default();
    let touching = plate().translated(&(1e-3 * UP));
    assert_eq!(solve_contact(&ball(8e-3, 2), &touching, &half_space(), &options).unwrap().depth, None);
}
