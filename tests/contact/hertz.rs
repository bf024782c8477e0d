//! A sphere on flat skin against Hertz: force, peak pressure and contact area, and their fall under refinement.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::contact::{Contact, ContactOptions, ContactStatus};
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::{Hertz, contact_modulus};
use quasirigid::response::{KernelSkin, PressureBasis};

use crate::common::{Random, jittered_grid};
use crate::{POISSON_RATIO, SHEAR_MODULUS, galerkin, half_space, lattice, solve, surface};

/// A sphere (m) pressed 0.5 mm into a flat skin with `cells` cells per contact radius, its inner vertices moved by
/// up to `jitter` cells.
fn hertz_contact_on(cells: usize, jitter: f64, radius: f64, skin: &KernelSkin) -> (Contact, Hertz, f64) {
    let hertz = Hertz { radius, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let approach = 0.5e-3;
    let spacing = hertz.contact_radius(approach) / cells as f64;
    let count = 2 * (cells + cells / 2);
    let middle = 0.5 * count as f64 * spacing;
    let surface = surface(jittered_grid(count, spacing, jitter, &mut Random(5)));
    let sphere = Obstacle::sphere(Vector3::new(middle, middle, hertz.radius - approach), hertz.radius)
        .expect("a valid obstacle");
    (solve(&surface, &sphere, skin), hertz, approach)
}

/// A sphere R = 200 mm pressed 0.5 mm into a regular flat skin.
fn hertz_contact(cells: usize, basis: PressureBasis) -> (Contact, Hertz, f64) {
    hertz_contact_on(cells, 0.0, 0.2, &half_space().with_basis(basis))
}

fn force_error(cells: usize) -> f64 {
    let (contact, hertz, approach) = hertz_contact(cells, PressureBasis::Linear);
    (contact.resultant.force.norm() / hertz.force(approach) - 1.0).abs()
}

#[test]
fn a_sphere_on_flat_skin_gives_hertz_force_and_peak_pressure() {
    let (contact, hertz, approach) = hertz_contact(8, PressureBasis::Linear);
    assert_eq!(contact.status, ContactStatus::Solved);
    // 0.1 % of it is the true sphere against Hertz's parabola, the rest the mesh.
    assert_relative_eq!(contact.resultant.force.norm(), hertz.force(approach), max_relative = 2e-3);
    assert_relative_eq!(contact.resultant.max_pressure, hertz.max_pressure(approach), max_relative = 5e-3);
    // The sphere presses from above: the skin is pushed down.
    assert!(contact.resultant.force.z < 0.0);
    let skin = half_space();
    let drawn = contact.drawn_skin(&skin, &ContactOptions::on_given_mesh()).expect("not interrupted");
    assert!(drawn.volume_change < 0.0);
}

#[test]
fn the_error_against_hertz_falls_with_refinement() {
    let errors = [2, 4, 8].map(force_error);
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
}

#[test]
fn one_ring_pressures_oscillate_where_linear_ones_do_not() {
    let (linear, hertz, approach) = hertz_contact(8, PressureBasis::Linear);
    let peak_error = |contact: &Contact| {
        // Node force over vertex area is what the LCP itself finds, before any averaging.
        let surface = contact.surface();
        let peak = contact.active.iter().map(|&v| contact.node_force[v] / surface.vertex_areas()[v]);
        peak.fold(0.0, f64::max) / hertz.max_pressure(approach) - 1.0
    };
    assert!(peak_error(&linear).abs() < 0.005);
    let (one_ring, ..) = hertz_contact(8, PressureBasis::OneRing);
    // The force is right all the same; the node pressures are not.
    assert_relative_eq!(one_ring.resultant.force.norm(), linear.resultant.force.norm(), max_relative = 0.02);
    assert!(peak_error(&one_ring) > 0.04, "{}", peak_error(&one_ring));
}

#[test]
fn galerkin_gives_a_better_hertz_force_than_collocation() {
    // So flat a sphere is Hertz's parabola up to d / R = 2.5e-6, and all error the mesh's.
    let errors = |cells: usize, jitter: f64, skin: &KernelSkin| {
        let (contact, hertz, approach) = hertz_contact_on(cells, jitter, 200.0, skin);
        let force = contact.resultant.force.norm() / hertz.force(approach) - 1.0;
        let peak = contact.resultant.max_pressure / hertz.max_pressure(approach) - 1.0;
        (force.abs(), peak.abs(), contact.max_penetration_after / approach)
    };
    for jitter in [0.0, 0.25] {
        for cells in [4, 8] {
            let (collocation, galerkin) =
                (errors(cells, jitter, &half_space()), errors(cells, jitter, &galerkin()));
            assert!(galerkin.0 < 0.5 * collocation.0, "force, {cells} cells: {galerkin:?} {collocation:?}");
            assert!(galerkin.1 < collocation.1, "peak, {cells} cells: {galerkin:?} {collocation:?}");
            // Edges of √2 h, jittered by a quarter at both ends, sag by less than h² / R; in Galerkin form vertices keep a
            // penetration of that order too.
            for (.., penetration) in [collocation, galerkin] {
                assert!(penetration < 1.0 / (cells * cells) as f64, "{galerkin:?} {collocation:?}");
            }
        }
    }
}

/// Root mean squares of the errors of force, peak pressure and contact area against Hertz, over places of the sphere
/// on a mesh of `cells` cells per contact radius.
fn hertz_errors(skin: &KernelSkin, cells: usize, angle: f64, jitter: f64, places: usize) -> [f64; 3] {
    // So flat a sphere is Hertz's parabola up to d / R = 2.5e-6, and all error the mesh's.
    let hertz = Hertz { radius: 200.0, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let approach = 0.5e-3;
    let radius = hertz.contact_radius(approach);
    let sphere = Obstacle::sphere(Vector3::new(0.0, 0.0, hertz.radius - approach), hertz.radius)
        .expect("a valid obstacle");
    let mut random = Random(11);
    let mut sums = [0.0; 3];
    for _ in 0..places {
        // Neither the place in a cell nor the cells per radius are round numbers.
        let h = radius / (cells as f64 * (0.94 + 0.12 * random.next()));
        let edges = [h * Vector3::x(), h * Vector3::new(angle.cos(), angle.sin(), 0.0)];
        let shift = (random.next() - 0.5) * edges[0] + (random.next() - 0.5) * edges[1];
        let surface = lattice(4 * cells, edges, shift, jitter, &mut random);
        let found = solve(&surface, &sphere, skin).resultant;
        let errors = [
            found.force.norm() / hertz.force(approach) - 1.0,
            found.max_pressure / hertz.max_pressure(approach) - 1.0,
            found.contact_area / (PI * radius * radius) - 1.0,
        ];
        sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error);
    }
    sums.map(|sum| (sum / places as f64).sqrt())
}

#[test]
fn galerkin_beats_collocation_in_force_peak_and_area_over_places_on_every_mesh() {
    let meshes = [("equilateral", 120.0, 0.0), ("square", 90.0, 0.0), ("jittered", 90.0, 0.25)];
    for (mesh, degrees, jitter) in meshes {
        let mut before = None;
        for (cells, places) in [(4, 12), (8, 5)] {
            let errors = |skin| hertz_errors(skin, cells, f64::to_radians(degrees), jitter, places);
            let (collocation, galerkin) = (errors(&half_space()), errors(&galerkin()));
            for (k, figure) in ["force", "peak", "area"].into_iter().enumerate() {
                assert!(
                    galerkin[k] < collocation[k],
                    "{figure}, {mesh}, {cells} cells: {galerkin:?} {collocation:?}"
                );
            }
            // A rim of straight chords, and slopes taken as straight, cost its square of the cell over the radius.
            assert!(galerkin[2] < 1.0 / (cells * cells) as f64, "{mesh}, {cells} cells: {galerkin:?}");
            // Force and peak fall with the square of the cell at least, the rim's place with the cell; half as much
            // again for the scatter of few places.
            if let Some(coarse) = before.replace(galerkin) {
                for (k, factor) in [0.375, 0.375, 0.75].into_iter().enumerate() {
                    assert!(galerkin[k] < factor * coarse[k], "{mesh}: {coarse:?} to {galerkin:?}");
                }
            }
        }
    }
}

#[test]
fn the_arrays_of_a_galerkin_contact_agree_with_its_figures() {
    let (contact, hertz, approach) = hertz_contact_on(8, 0.25, 200.0, &galerkin());
    let total: f64 = contact.node_force.iter().sum();
    assert_relative_eq!(contact.resultant.force.norm(), total, max_relative = 1e-4);
    let largest = contact.pressure.iter().copied().fold(0.0, f64::max);
    // The largest is between vertices: by no more than a cell's sag of the pressure, p0 h² / 2 a².
    assert!((0.0..0.5 / 64.0).contains(&(contact.resultant.max_pressure / largest - 1.0)));
    for (vertex, &pressure) in contact.pressure.iter().enumerate() {
        assert_eq!(pressure > 0.0, contact.node_force[vertex] > 0.0, "vertex {vertex}");
    }
    let of_patches: f64 = contact.patches.iter().map(|patch| patch.resultant.contact_area).sum();
    assert_relative_eq!(of_patches, contact.resultant.contact_area, max_relative = 1e-12);
    // Four cells from the rim the vertices' pressures are Hertz's; uncorrected, h² |Δp| / 12 would be 0.26 %, and the
    // jitter adds as much.
    let deformed = contact.drawn_skin(&galerkin(), &ContactOptions::on_given_mesh()).expect("drawn").deformed;
    let center = deformed.vertices().iter().sum::<Vector3<f64>>() / contact.pressure.len() as f64;
    let radius = hertz.contact_radius(approach);
    for (vertex, position) in deformed.vertices().iter().enumerate() {
        let distance = (position - center).xy().norm();
        if distance < 0.5 * radius {
            let error = contact.pressure[vertex] - hertz.pressure(approach, distance);
            assert!(error.abs() < 5e-3 * hertz.max_pressure(approach), "vertex {vertex}: {error}");
        }
    }
}
