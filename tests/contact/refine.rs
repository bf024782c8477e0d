//! Contacts on meshes refined around them.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Rotation3, Translation3, Vector3};
use quasirigid::contact::{
    Contact, ContactError, ContactOptions, ContactStatus, Goal, RefinementEnd, WarningKind, press,
    solve_contact,
};
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{FlatPunch, Hertz, contact_modulus};
use quasirigid::response::{ElasticSkin, Kernel, KernelSkin, PressureBasis};
use quasirigid::surface::Surface;

use crate::common::{Random, icosphere, jittered_grid, surface, v};
use crate::{POISSON_RATIO, SHEAR_MODULUS, UP, along, ball, galerkin, half_space, plate, pressed};

fn options(target_error: f64) -> ContactOptions<'static> {
    ContactOptions { target_error: Some(target_error), ..ContactOptions::default() }
}

fn refined(surface: &Surface, skin: &dyn ElasticSkin, depth: f64, target_error: f64) -> Contact {
    pressed(surface, &plate(), skin, Goal::Depth(depth), &options(target_error))
}

/// Flat square about the origin, its inner vertices moved by up to a quarter of a cell.
fn jittered(cells: usize, spacing: f64, seed: u64) -> Surface {
    let (mut vertices, faces) = jittered_grid(cells, spacing, 0.25, &mut Random(seed));
    let middle = 0.5 * cells as f64 * spacing;
    vertices.iter_mut().for_each(|vertex| *vertex -= Vector3::new(middle, middle, 0.0));
    Surface::new(vertices, faces).expect("a valid surface")
}

fn smallest_angle(surface: &Surface, face: usize) -> f64 {
    let corners = surface.faces()[face].map(|vertex| surface.vertices()[vertex as usize]);
    let angle = |k: usize| (corners[(k + 1) % 3] - corners[k]).angle(&(corners[(k + 2) % 3] - corners[k]));
    (0..3).map(angle).fold(f64::INFINITY, f64::min)
}

/// A vertex that a scan put too high by a hundredth of the depth: the peak is a seventh too high, force and area hardly.
#[test]
fn the_estimate_of_a_peak_on_a_single_bump_of_the_skin_is_of_the_size_of_its_error() {
    let (radius, depth, cells) = (2.0, 5e-7, 24);
    let hertz = Hertz { radius, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let spacing = hertz.contact_radius(depth) / 6.0;
    let flat = jittered(cells, spacing, 3);
    let middle = (cells / 2) * (cells + 1) + cells / 2;
    let sphere = Obstacle::sphere(Vector3::new(0.0, 0.0, radius - depth), radius).expect("a sphere");
    for place in [middle, middle + 2 * cells + 3] {
        let mut vertices = flat.vertices().to_vec();
        vertices[place].z = 0.01 * depth;
        let surface = Surface::new(vertices, flat.faces().to_vec()).expect("a valid surface");
        for options in [ContactOptions::on_given_mesh(), options(0.02)] {
            let contact = solve_contact(&surface, &sphere, &half_space(), &options).expect("valid");
            let error = contact.resultant.max_pressure / hertz.max_pressure(depth) - 1.0;
            let estimate = contact.accuracy.max_pressure_error.expect("an estimate");
            assert!(error > 0.05 && (0.8..10.0).contains(&(estimate / error)), "{error} of {estimate}");
        }
    }
}

#[test]
fn a_coarse_mesh_meets_hertz_within_its_estimates() {
    let (radius, depth) = (100.0, 5e-5);
    let hertz = Hertz { radius, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let contact_radius = hertz.contact_radius(depth);
    for seed in 1..6 {
        let surface = jittered(12, contact_radius / 3.0, seed);
        let sphere = Obstacle::sphere(Vector3::new(0.0, 0.0, radius - depth), radius).expect("a sphere");
        let contact = solve_contact(&surface, &sphere, &half_space(), &options(0.01)).expect("valid");
        let force = contact.resultant.force.norm() / hertz.force(depth) - 1.0;
        let area = contact.resultant.contact_area / (PI * contact_radius.powi(2)) - 1.0;
        assert!(contact.accuracy.mesh_error.unwrap() <= 0.01 && contact.accuracy.area_error.unwrap() <= 0.01);
        assert_eq!(contact.refinements.last().and_then(|one| one.end), Some(RefinementEnd::Target));
        assert!(force.abs() <= 0.01 && area.abs() <= 0.012, "force {force:+}, area {area:+}");
    }
}

#[test]
fn skin_in_the_rim_of_a_flat_punch_costs_no_more_than_its_share() {
    let (radius, depth) = (3e-3, 0.2e-3);
    let contact_modulus = contact_modulus(SHEAR_MODULUS, POISSON_RATIO);
    let exact = FlatPunch { radius, contact_modulus }.force(depth);
    for seed in 1..4 {
        let surface = jittered(15, 2e-3, seed);
        let punch = Obstacle::cylinder(5e-3, radius).expect("a cylinder");
        let punch = punch.translated(&Vector3::new(0.3e-3, 0.2e-3, 5e-3 - depth));
        let contact = solve_contact(&surface, &punch, &half_space(), &options(0.02)).expect("valid");
        let error = (contact.resultant.force.norm() / exact - 1.0).abs();
        let told = contact.accuracy.force_error.expect("a contact");
        // Between vertices the rim cuts deep into the skin, on a narrow ring.
        assert!(contact.max_penetration_after > 0.05 * depth);
        assert!(error <= told && told < 0.05);
    }
}

#[test]
fn a_layer_thin_against_the_mesh_is_touched_as_far_as_springs_are() {
    // Springs are touched where the sphere cuts their plane, over 2πRd (Johnson 1985, §4.3); 63 thicknesses a radius.
    let (radius, depth) = (0.1, 0.05e-3);
    let thickness = 0.05e-3;
    let surface = jittered(24, 0.5e-3, 3);
    let sphere = Obstacle::sphere((radius - depth) * UP, radius).expect("a sphere");
    for poisson_ratio in [0.0, 0.3] {
        let layer = Kernel::Layer { thickness: thickness.into() };
        let skin = KernelSkin::new(SHEAR_MODULUS, poisson_ratio, layer).expect("valid constants");
        let contact = solve_contact(&surface, &sphere, &skin, &ContactOptions::default()).expect("a request");
        let area = contact.resultant.contact_area;
        assert_relative_eq!(area, 2.0 * PI * radius * depth, max_relative = 0.015);
    }
}

#[test]
fn the_mesh_stays_sound_and_round_and_keeps_its_vertices() {
    let surface = ball(8e-3, 2);
    let contact = refined(&surface, &half_space(), 0.6e-3, 0.005);
    let solved = contact.surface();
    let given = surface.vertices().len();
    assert_eq!(contact.given_vertex_count(), given);
    assert_eq!(&solved.vertices()[..given], surface.vertices());
    assert_eq!(contact.parents().len(), solved.vertices().len() - given);
    let checked = Surface::new(solved.vertices().to_vec(), solved.faces().to_vec()).expect("a sound mesh");
    assert!(checked.is_closed());
    // Added vertices lie on the sphere that the normals imply, to a fifth of what straight edges miss.
    let error = 0.2 * (surface.mean_edge_length() / 8e-3).powi(2) / 8.0;
    for vertex in &solved.vertices()[given..] {
        assert_relative_eq!((vertex - 8e-3 * UP).norm(), 8e-3, max_relative = error);
    }
    let least = |surface: &Surface| {
        (0..surface.faces().len()).map(|face| smallest_angle(surface, face)).fold(f64::INFINITY, f64::min)
    };
    assert!(least(solved) >= 0.5 * least(&surface));
    assert_eq!(contact.pressure.len(), solved.vertices().len());
    assert!(contact.candidates.iter().all(|&vertex| contact.gap[vertex].is_finite()));
    let total: Vector3<f64> = contact.force_vectors.iter().sum();
    assert_relative_eq!(total, contact.resultant.force, max_relative = 1e-12);
}

/// The same mesh with one more vertex in a face, at a share of its edges from its first corner, on the sphere that it is on.
fn with_vertex_beside(mesh: &Surface, face: usize, share: f64) -> Surface {
    let (mut vertices, mut faces) = (mesh.vertices().to_vec(), mesh.faces().to_vec());
    let [a, b, c] = faces[face];
    let [at_a, at_b, at_c] = faces[face].map(|corner| vertices[corner as usize]);
    let own = vertices.len() as u32;
    vertices.push((at_a + share * (at_b + at_c - 2.0 * at_a)).normalize() * at_a.norm());
    faces[face] = [a, b, own];
    faces.extend([[b, c, own], [c, a, own]]);
    Surface::new(vertices, faces).expect("a valid surface")
}

#[test]
fn pressures_are_those_of_the_skin_where_two_vertices_lie_close_together() {
    let turn = Rotation3::new(v(0.4, -0.7, 1.1));
    let (vertices, faces) = icosphere(8e-3, 4);
    let ball = surface((vertices.iter().map(|vertex| turn * vertex).collect(), faces));
    let (depth, target) = (0.6e-3, 0.02);
    let truth = refined(&ball, &galerkin(), depth, target);
    let middle =
        |face: &usize| ball.faces()[*face].iter().map(|&v| ball.vertices()[v as usize].z).sum::<f64>();
    let mut lowest: Vec<usize> = (0..ball.faces().len()).collect();
    lowest.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    // At the peak, between it and the rim, and on the rim.
    for (rank, share) in [(0, 1e-2), (0, 1e-3), (0, 1e-5), (3, 1e-9), (20, 1e-4), (42, 1e-4), (48, 1e-6)] {
        let contact = refined(&with_vertex_beside(&ball, lowest[rank], share), &galerkin(), depth, target);
        let [peak, right] = [&contact, &truth].map(|one| one.resultant.max_pressure);
        assert_relative_eq!(peak, right, max_relative = 0.005);
        let highest = contact.pressure.iter().copied().fold(0.0, f64::max);
        assert!(highest <= peak, "{highest} Pa at a vertex");
    }
}

#[test]
fn motion_scale_and_numbering_change_nothing() {
    let surface = ball(8e-3, 2);
    let count = surface.vertices().len();
    let force = refined(&surface, &half_space(), 0.6e-3, 0.01).resultant.force.norm();

    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let shift = Vector3::new(0.1, -0.2, 0.3);
    let pose = Isometry3::from_parts(Translation3::from(shift), turn.into());
    let there = plate().moved(turn.matrix(), &shift).expect("a rigid motion");
    let way = along(turn * UP, Goal::Depth(0.6e-3));
    let moved = press(&surface.moved(&pose), &there, &half_space(), &way, &options(0.01)).expect("valid");
    assert_relative_eq!(moved.resultant.force.norm(), force, max_relative = 1e-6);

    let large = surface.with_vertices(surface.vertices().iter().map(|vertex| 1e3 * vertex).collect());
    let scaled = refined(&large, &half_space(), 0.6, 0.01);
    assert_relative_eq!(scaled.resultant.force.norm(), 1e6 * force, max_relative = 1e-6);

    let renumbered = |vertex: usize| (vertex * 5 + 3) % count;
    let mut vertices = surface.vertices().to_vec();
    (0..count).for_each(|vertex| vertices[renumbered(vertex)] = surface.vertices()[vertex]);
    let faces = surface.faces().iter().rev();
    let faces = faces.map(|face| face.map(|vertex| renumbered(vertex as usize) as u32)).collect();
    let other = Surface::new(vertices, faces).expect("the same surface");
    let again = refined(&other, &half_space(), 0.6e-3, 0.01);
    assert_relative_eq!(again.resultant.force.norm(), force, max_relative = 1e-6);
}

#[test]
fn what_cannot_be_refined_is_taken_as_it_is_and_says_so() {
    let surface = ball(8e-3, 3);
    let one_ring: KernelSkin = half_space().with_basis(PressureBasis::OneRing);
    let contact = refined(&surface, &one_ring, 0.6e-3, 0.01);
    assert_eq!(contact.surface().vertices().len(), surface.vertices().len());
    assert_eq!((contact.accuracy.force_error, contact.accuracy.area_error), (None, None));
    assert!(contact.left_out.iter().any(|one| one.what == "refinement"));
    assert!(contact.warnings.iter().all(|warning| warning.kind == WarningKind::CoarseMesh));
}

#[test]
fn a_refinement_that_ends_early_says_why() {
    let surface = ball(8e-3, 2);
    let few = ContactOptions { max_nodes: 40, ..options(1e-3) };
    let contact = pressed(&surface, &plate(), &half_space(), Goal::Depth(0.6e-3), &few);
    assert_eq!(contact.status, ContactStatus::Solved);
    assert_eq!(contact.refinements.last().and_then(|one| one.end), Some(RefinementEnd::MaxNodes));
    assert!(contact.warnings.iter().any(|warning| warning.message.contains("max_nodes")));
    let few = ContactOptions { target_error: Some(1e-9), ..few };
    let contact = pressed(&surface, &plate(), &half_space(), Goal::Depth(0.6e-3), &few);
    assert!(contact.warnings.iter().any(|warning| warning.message.contains("target of 1.00e-7 %")));
}

#[test]
fn a_target_out_of_range_is_named() {
    for target in [0.0, -1.0, 1.0, 2.0, f64::NAN] {
        let refused = solve_contact(&ball(8e-3, 1), &plate(), &half_space(), &options(target)).unwrap_err();
        assert!(matches!(refused, ContactError::Option { option: "target_error", .. }));
    }
}

#[test]
fn skin_between_vertices_is_met_by_a_small_obstacle() {
    // A ball smaller than a cell touches the middle of an edge: no vertex is inside.
    let surface = ball(8e-3, 1);
    let [a, b, _] = surface.faces()[0].map(|vertex| surface.vertices()[vertex as usize] - 8e-3 * UP);
    let place = 8e-3 * UP + (8e-3 + 0.45e-3) * (a + b).normalize();
    let small = Obstacle::sphere(place, 0.5e-3).expect("a sphere");
    let as_given = solve_contact(&surface, &small, &half_space(), &ContactOptions::on_given_mesh()).unwrap();
    assert_eq!(as_given.status, ContactStatus::NoContact);
    let refined = solve_contact(&surface, &small, &half_space(), &options(0.05)).unwrap();
    assert_eq!(refined.status, ContactStatus::Solved);
    assert!(refined.resultant.force.norm() > 0.0);
}
