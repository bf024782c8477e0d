//! Edges, pins and balls that meet the skin between its vertices.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::contact::{Contact, ContactOptions, Goal, RefinementEnd};
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle};
use quasirigid::response::KernelSkin;
use quasirigid::surface::Surface;

use crate::common::Random;
use crate::{SHEAR_MODULUS, UP, ball, galerkin, half_space, lattice, press_up, pressed};

/// Where the obstacles of a press begin.
const BELOW: Vector3<f64> = Vector3::new(0.0, 0.0, -0.05);

/// Under a half-space, on up to 1000 nodes: sharp edges refine to the end, and these forces have settled by then.
fn settled(surface: &Surface, obstacle: &Obstacle, depth: f64) -> Contact {
    settled_on(surface, obstacle, &half_space(), depth)
}

fn settled_on(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin, depth: f64) -> Contact {
    let options = ContactOptions { max_nodes: 1000, ..ContactOptions::default() };
    pressed(surface, obstacle, skin, Goal::Depth(depth), &options)
}

/// A roof along x with its ridge on the x axis, upwards.
fn ridge(half_angle: f64) -> Obstacle {
    let (length, height) = (0.03, 0.02);
    let width = height * half_angle.tan();
    let section = [[0.0, 0.0], [-width, -height], [width, -height]];
    let corner =
        |i: usize| Vector3::new(if i < 3 { -length } else { length }, section[i % 3][0], section[i % 3][1]);
    let faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
    Obstacle::mesh((0..6).map(corner).collect(), faces.to_vec(), &Default::default()).unwrap()
}

/// A pin upright, the middle of its end at the origin.
fn pin(radius: f64) -> Obstacle {
    Obstacle::cylinder(5e-3, radius).unwrap().translated(&Vector3::new(0.0, 0.0, -5e-3))
}

/// A ball, its top at the origin.
fn bead(radius: f64) -> Obstacle {
    Obstacle::sphere(Vector3::new(0.0, 0.0, -radius), radius).unwrap()
}

/// Square cells about the origin, outside below, their corners half a cell off it.
fn flat(cells: usize, spacing: f64) -> Surface {
    let edges = [Vector3::y(), Vector3::x()].map(|axis| spacing * axis);
    lattice(cells, edges, Vector3::zeros(), 0.0, &mut Random(1))
}

/// What a contact says of penetration that is left.
fn of_penetration(contact: &Contact) -> &str {
    let mut messages = contact.warnings.iter().map(|warning| &warning.message);
    messages.find(|message| message.contains("still penetrates")).expect("a warning of penetration")
}

#[test]
fn a_ridge_presses_straight_and_steadily_wherever_it_meets_the_mesh() {
    // The pad and the ridge are symmetric, the mesh of the pad turned against both.
    let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), 0.4);
    let pad = ball(8e-3, 3);
    let turned = pad.vertices().iter().map(|x| turn * x).collect();
    let pad = Surface::new(turned, pad.faces().to_vec()).unwrap();
    for degrees in [16.0_f64, 45.0, 70.0] {
        let roof = ridge(degrees.to_radians()).translated(&BELOW);
        let mut before = None;
        for step in 0..3 {
            let shift = Vector3::new(0.0, 1e-4 * f64::from(step), 0.0);
            let contact = settled(&pad, &roof.translated(&shift), 1.12e-3);
            let force = contact.resultant.force;
            let sideways = force.x.hypot(force.y);
            assert!(step > 0 || sideways <= 0.02 * force.z, "{degrees}: {force:?}");
            let change = before.map_or(0.0, |before| force.z / before - 1.0);
            assert!(f64::abs(change) <= 0.05, "{degrees}, step {step}: {change}");
            before = Some(force.z);
            assert!(contact.max_penetration_after <= 0.05 * contact.max_penetration_before);
            assert_eq!(contact.accuracy.max_pressure_error, Some(f64::INFINITY));
            assert!(contact.left_out.iter().any(|left| left.what == "a finite peak pressure"));
        }
    }
}

#[test]
fn a_ball_within_a_triangle_is_felt_as_a_mesh_as_much_as_by_its_radius() {
    let pad = flat(8, 2e-3);
    let at = Vector3::new(0.7e-3, 0.4e-3, 0.0);
    for (radius, depth) in [(0.8e-3, 0.1e-3), (0.4e-3, 0.2e-3)] {
        let drawn = ball(radius, 5);
        let mesh = Obstacle::mesh(
            drawn.vertices().to_vec(),
            drawn.faces().to_vec(),
            &MeshObstacleOptions::default(),
        );
        let (mesh, round) = (mesh.unwrap(), Obstacle::sphere(Vector3::zeros(), radius).unwrap());
        for skin in [half_space(), galerkin()] {
            let [mesh, round] = [&mesh, &round].map(|obstacle| {
                let below = BELOW + at;
                pressed(
                    &pad,
                    &obstacle.translated(&below),
                    &skin,
                    Goal::Depth(depth),
                    &ContactOptions::default(),
                )
            });
            // Facets of 0.07 radii lie up to 0.0006 radii within the ball.
            let lost = 1.5 * 6e-4 * radius / depth;
            assert_relative_eq!(mesh.resultant.force.z, round.resultant.force.z, max_relative = 0.01 + lost);
        }
    }
}

#[test]
fn a_ridge_along_a_row_of_vertices_presses_as_hard_as_between_two() {
    let pad = flat(8, 1e-3);
    let to_the_end = |obstacle: &Obstacle, depth: f64| {
        pressed(&pad, obstacle, &half_space(), Goal::Depth(depth), &ContactOptions::default())
    };
    for degrees in [16.0_f64, 45.0, 70.0] {
        let roof = ridge(degrees.to_radians()).translated(&Vector3::new(0.0, 0.0, -1e-3));
        for depth in [0.5e-3, 1e-3] {
            // A row of the finer meshes lies at 0.5 mm.
            let [between, near, on] = [0.3e-3, 0.4e-3, 0.5e-3].map(|y| {
                let contact = to_the_end(&roof.translated(&Vector3::new(0.0, y, 0.0)), depth);
                assert_eq!(contact.accuracy.max_pressure_error, Some(f64::INFINITY));
                contact.resultant.force.z
            });
            let steps = [near / between, on / near].map(|ratio| f64::abs(ratio - 1.0));
            assert!(steps.iter().all(|&step| step <= 0.05), "{degrees} degrees, {depth} m: {steps:?}");
        }
    }
}

#[test]
fn what_is_smaller_than_a_triangle_is_met_in_its_middle() {
    const DEPTH: f64 = 0.3e-3;
    let coarse = flat(10, 2e-3);
    let fine = flat(80, 0.25e-3);
    // Off all vertices and edges of both.
    let place = BELOW + Vector3::new(0.37e-3, 0.73e-3, 0.0);
    let small_ball = bead(0.6e-3);
    let small_pins = [0.3e-3, 0.5e-3].map(pin);
    for obstacle in small_pins.iter().chain([&small_ball]) {
        let obstacle = obstacle.translated(&place);
        let contact = settled(&coarse, &obstacle, DEPTH);
        // Its end is at z = -50 mm, the skin at 0.
        assert_relative_eq!(contact.travel, 0.05 + DEPTH, max_relative = 1e-12);
        let force = contact.resultant.force;
        assert!(force.z > 0.0 && force.x.hypot(force.y) < 0.02 * force.z, "{force:?}");
        let closer = settled(&fine, &obstacle, DEPTH).resultant.force;
        assert_relative_eq!(force.z, closer.z, max_relative = 0.1);
    }
}

#[test]
fn a_ball_deeper_than_its_radius_presses_ever_harder_and_does_not_slip_through_a_fine_mesh() {
    let radius = 0.6e-3;
    let ball = bead(radius).translated(&(BELOW + Vector3::new(0.07e-3, 0.03e-3, 0.0)));
    for skin in [half_space(), galerkin()] {
        let forces = [(20, 2e-4), (40, 1e-4)].map(|(cells, spacing)| {
            let surface = flat(cells, spacing);
            [0.6, 0.9, 1.2, 1.5, 1.8].map(|share| {
                let options = ContactOptions::on_given_mesh();
                let contact = pressed(&surface, &ball, &skin, Goal::Depth(share * radius), &options);
                let force = contact.resultant.force;
                // Where it stands to the mesh tells on three cells in a radius; skin that lets it through pushes to a side alone.
                assert!(force.x.hypot(force.y) < 0.1 * force.z, "{force:?}");
                force.z
            })
        });
        for on_mesh in &forces {
            assert!(on_mesh.is_sorted(), "{forces:?}");
        }
        let [coarse, fine] = forces.map(|on_mesh| on_mesh[4]);
        // So deep it is a guess, and a warning says so, but the same one on any mesh, to less than a cell in three.
        assert!((fine / coarse - 1.0).abs() < 0.2, "{forces:?}");
    }
}

#[test]
fn what_a_finer_mesh_loses_is_kept_with_an_error_without_bound() {
    let ball = bead(0.2e-3).translated(&(BELOW + Vector3::new(0.7e-3, 0.4e-3, 0.0)));
    let contact = settled(&flat(8, 2e-3), &ball, 1e-3);
    assert!(contact.resultant.force.z > 0.0);
    assert_eq!(contact.accuracy.force_error, Some(f64::INFINITY));
    assert_eq!(contact.refinements.last().and_then(|round| round.end), Some(RefinementEnd::ForceLost));
    assert!(contact.warnings.iter().any(|warning| warning.message.contains("on a finer mesh nothing")));
}

#[test]
fn gaps_that_did_not_settle_are_no_met_target() {
    let ball = bead(1e-3).translated(&BELOW);
    let contact = settled(&flat(16, 1e-3), &ball, 2e-3);
    assert!(contact.accuracy.force_error > Some(0.02), "{:?}", contact.accuracy);
    let end = contact.refinements.last().and_then(|round| round.end);
    assert_ne!(end, Some(RefinementEnd::Target));
}

#[test]
fn a_blade_is_felt_with_a_side_along_a_row_of_vertices() {
    let pad = flat(80, 0.15e-3);
    let blade = Obstacle::cuboid(Vector3::new(5e-3, 0.005e-3, 5e-3)).expect("a box");
    // A row lies at y = 0.075 mm, where signed distances of the side are rounding.
    let [beside, on_row] = [0.06e-3, 0.07e-3].map(|y| {
        let blade = blade.translated(&(BELOW + Vector3::new(0.11e-3, y, -5e-3)));
        settled(&pad, &blade, 1e-3).resultant.force.z
    });
    // One cell broad or two: the force of a line goes with the logarithm of that.
    assert!(on_row > 0.5 * beside && beside > 0.0, "{on_row} {beside}");
}

#[test]
fn a_flat_pin_presses_like_the_flat_punch() {
    // Sneddon: F = 4 G a d / (1 - nu), with nu = 1/2; the pad is much wider than the pin.
    for (radius, depth) in [(0.3e-3, 0.1e-3), (1e-3, 0.2e-3)] {
        let punch = 8.0 * SHEAR_MODULUS * radius * depth;
        for skin in [half_space(), galerkin()] {
            let contact = settled_on(&flat(20, 1e-3), &pin(radius).translated(&BELOW), &skin, depth);
            assert_relative_eq!(contact.resultant.force.z, punch, max_relative = 0.02);
            assert_relative_eq!(contact.resultant.contact_area, PI * radius * radius, max_relative = 0.01);
        }
    }
}

#[test]
fn a_contact_that_ends_at_an_edge_knows_its_area_and_that_the_peak_is_infinite_on_any_mesh() {
    let (radius, depth) = (4e-3, 0.1e-3);
    let punch = 8.0 * SHEAR_MODULUS * radius * depth;
    for (cells, edge) in [(16, 1.5e-3), (24, 1e-3), (48, 0.5e-3)] {
        let upright = pin(radius).translated(&(BELOW + Vector3::new(0.13e-3, 0.21e-3, 0.0)));
        let contact = press_up(&flat(cells, edge), &upright, &galerkin(), depth);
        let accuracy = &contact.accuracy;
        let error = contact.resultant.force.z / punch - 1.0;
        assert!(error.abs() <= accuracy.force_error.unwrap(), "{error} at {edge} m");
        let error = contact.resultant.contact_area / (PI * radius * radius) - 1.0;
        assert!(error.abs() <= accuracy.area_error.unwrap().min(0.03), "{error} at {edge} m");
        assert_eq!(accuracy.max_pressure_error, Some(f64::INFINITY));
        assert!(contact.left_out.iter().any(|left| left.what == "a finite peak pressure"));
    }
}

#[test]
fn flat_skin_beside_a_sharp_edge_of_its_own_stays_flat() {
    // Two sheets at a right angle, the lower one pressed half a cell from the edge.
    let sheet = flat(8, 2e-3);
    let edge = sheet.vertices().iter().map(|x| x.x).fold(f64::INFINITY, f64::min) + 8e-3;
    let up = |x: &Vector3<f64>| match x.x - edge {
        beyond if beyond > 0.0 => Vector3::new(edge, x.y, beyond),
        _ => *x,
    };
    let bent = Surface::new(sheet.vertices().iter().map(up).collect(), sheet.faces().to_vec())
        .expect("a bent sheet");
    for off in [1.0e-3, 1.4e-3, 2.0e-3] {
        let ball = Obstacle::sphere(BELOW + Vector3::x() * (edge - off), 4e-3).expect("a ball");
        let [beside, alone] = [&bent, &sheet].map(|skin| settled(skin, &ball, 0.1e-3));
        let is_on_sheets = |x: &Vector3<f64>| x.z == 0.0 || (x.x - edge).abs() < 1e-12;
        assert!(beside.surface().vertices().iter().all(is_on_sheets));
        let doubt = [&beside, &alone].map(|contact| contact.accuracy.force_error.expect("a contact"));
        let [force, expected] = [&beside, &alone].map(|contact| contact.resultant.force.z);
        assert_relative_eq!(force, expected, max_relative = doubt[0] + doubt[1]);
    }
}

#[test]
fn an_edge_left_in_the_triangles_of_a_mesh_taken_as_it_is_is_said() {
    // The edges of a block between the columns of vertices: the skin hangs over them.
    let block = Obstacle::cuboid(Vector3::new(2.6e-3, 2.6e-3, 5e-3)).unwrap();
    let contact = press_up(&flat(14, 1e-3), &block.translated(&BELOW), &half_space(), 1e-3);
    assert!(contact.active.iter().all(|&vertex| contact.gap[vertex].abs() < 1e-12));
    assert!(contact.max_penetration_after > 0.05 * contact.max_penetration_before);
    let warning = of_penetration(&contact);
    assert!(warning.contains("between vertices"), "{warning}");
}

#[test]
fn skin_gives_way_around_a_corner_without_being_left_in_it() {
    // A corner of a cube, upwards.
    let tilt = nalgebra::Rotation3::rotation_between(&Vector3::repeat(1.0), &UP).expect("no half turn");
    let cube = Obstacle::cuboid(Vector3::repeat(0.02)).expect("a box");
    let corner = cube.moved(tilt.matrix(), &(BELOW - UP * 0.02 * 3f64.sqrt())).expect("a rotation");
    let contact = settled(&ball(8e-3, 3), &corner, 1.12e-3);
    assert!(contact.max_penetration_after < 0.05 * contact.max_penetration_before);
}
