//! Questions that are probably not meant are answered, with a warning that names the number and the remedy.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Vector3;
use quasirigid::contact::{Contact, ContactOptions, ContactStatus, Goal, WarningKind, solve_contact};
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle};
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::response::{Discretization, Kernel, KernelSkin, PreparedBody};
use quasirigid::surface::Surface;

use crate::common::{Random, galerkin, icosphere};
use crate::{
    POISSON_RATIO, SHEAR_MODULUS, UP, ball, half_space, lattice, plate, press_up, pressed, skin, solve,
};

/// What the warnings of a kind say.
fn told(contact: &Contact, kind: WarningKind) -> Vec<&str> {
    let of_kind = contact.warnings.iter().filter(|one| one.kind == kind);
    of_kind.map(|one| one.message.as_str()).collect()
}

/// Asserts one warning of a kind that says all of `words`.
fn assert_told(contact: &Contact, kind: WarningKind, words: &[&str]) {
    let found = told(contact, kind);
    assert_eq!(found.len(), 1, "{:?}", contact.warnings);
    for word in words {
        assert!(found[0].contains(word), "{word}: {}", found[0]);
    }
}

/// A ball of this radius (m) pressed by a hundredth of it.
fn at_size(radius: f64) -> Contact {
    press_up(&ball(radius, 3), &plate(), &half_space(), 0.01 * radius)
}

#[test]
fn a_skin_of_micrometres_or_of_many_metres_is_asked_for_its_unit() {
    assert_told(&at_size(22.5e-6), WarningKind::Size, &["skin is 4.5000e-5 m", "unit=\"mm\""]);
    assert_told(&at_size(8.0), WarningKind::Size, &["skin is 1.6000e1 m", "outside 0.005 to 1 m"]);
    for radius in [2.6e-3, 8e-3, 0.4] {
        assert!(told(&at_size(radius), WarningKind::Size).is_empty());
    }
}

#[test]
fn a_product_mesh_of_many_metres_is_asked_for_its_unit_and_a_plate_is_not() {
    let of_radius = |radius: f64| {
        let (vertices, faces) = icosphere(radius, 2);
        let product = Obstacle::mesh(vertices, faces, &Default::default()).expect("a valid obstacle");
        let below = product.translated(&Vector3::new(0.0, 0.0, -1.1 * radius));
        let options = ContactOptions::on_given_mesh();
        solve_contact(&ball(8e-3, 2), &below, &half_space(), &options).expect("a valid request")
    };
    assert_told(&of_radius(58.5), WarningKind::Size, &["product is 1.1700e2 m", "outside 0.001 to 3 m"]);
    assert_told(&of_radius(4e-4), WarningKind::Size, &["product is 8.0000e-4 m"]);
    assert!(told(&of_radius(1.0), WarningKind::Size).is_empty());
    assert!(told(&at_size(8e-3), WarningKind::Size).is_empty());
}

#[test]
fn without_bone_half_the_breadth_is_too_deep() {
    let surface = ball(8e-3, 3);
    let at = |depth| press_up(&surface, &plate(), &half_space(), depth);
    assert!(told(&at(7.9e-3), WarningKind::Depth).is_empty());
    // Through its middle, from pole to pole, the ball is 16 mm broad.
    assert_told(&at(8.1e-3), WarningKind::Depth, &["8.1000e-3", "8.0000e-3", "half of the 1.6000e-2 m"]);
    let through = at(1.12);
    let [through, steep] = told(&through, WarningKind::Depth)[..] else { panic!("two warnings of depth") };
    assert!(through.contains("1.1200e0") && through.contains("the whole skin"), "{through}");
    assert!(steep.contains("steeper than 60 degrees"), "{steep}");
}

#[test]
fn over_a_bone_two_thirds_of_the_tissue_are_too_deep() {
    let surface = ball(8e-3, 3);
    let (mut vertices, faces) = icosphere(5e-3, 2);
    vertices.iter_mut().for_each(|vertex| vertex.z += 8e-3);
    let bone = Surface::new(vertices, faces).expect("a bone");
    let nodes: Vec<usize> =
        (0..surface.vertices().len()).filter(|&vertex| surface.vertices()[vertex].z < 6e-3).collect();
    let mask = surface.vertices().iter().map(|vertex| vertex.z < 6e-3).collect();
    let surface = surface.with_skin_mask(mask).expect("one entry a vertex");
    for coarse_edge_length in [Some(0.0), Some(3e-3)] {
        let body = Body { bone: Some(bone.clone()), fixed: None, coarse_edge_length };
        let options = BodyOptions::default();
        let skin = PreparedBody::new(&surface, &body, SHEAR_MODULUS, POISSON_RATIO, &nodes, &options);
        let skin = skin.expect("a body");
        let at = |depth| press_up(&surface, &plate(), &skin, depth);
        // 3 mm of tissue at the pole.
        assert!(told(&at(1.9e-3), WarningKind::Depth).is_empty());
        assert_told(&at(2.2e-3), WarningKind::Depth, &["2.2000e-3", "two thirds", "of tissue"]);
    }
}

#[test]
fn a_modulus_in_kilopascals_is_asked_for_its_unit() {
    let surface = ball(8e-3, 3);
    let of_modulus = |modulus| {
        let skin = KernelSkin::new(modulus, POISSON_RATIO, Kernel::HalfSpace).expect("valid constants");
        press_up(&surface, &plate(), &skin, 1e-4)
    };
    assert_told(&of_modulus(60.0), WarningKind::Modulus, &["6.0000e1 Pa", "60e3"]);
    assert_told(&of_modulus(60e9), WarningKind::Modulus, &["6.0000e10 Pa"]);
    for modulus in [1e3, 60e3, 10e6] {
        assert!(told(&of_modulus(modulus), WarningKind::Modulus).is_empty());
    }
}

#[test]
fn few_cells_in_a_contact_are_told_where_the_mesh_is_taken_as_it_is() {
    let surface = ball(8e-3, 2);
    let coarse = press_up(&surface, &plate(), &half_space(), 0.1e-3);
    assert!(coarse.accuracy.cells_per_radius < 1.5);
    let cells = format!("{:.2} mesh cells", coarse.accuracy.cells_per_radius);
    assert_told(&coarse, WarningKind::CoarseMesh, &[&cells, "target_error"]);
    let refined = pressed(&surface, &plate(), &half_space(), Goal::Depth(0.1e-3), &ContactOptions::default());
    assert!(told(&refined, WarningKind::CoarseMesh).is_empty());
    let fine = press_up(&ball(8e-3, 4), &plate(), &half_space(), 1e-3);
    assert!(fine.accuracy.cells_per_radius > 1.5);
    assert!(told(&fine, WarningKind::CoarseMesh).is_empty());
}

#[test]
fn a_layer_pressed_by_more_than_half_is_out_of_its_range() {
    let surface = ball(8e-3, 3);
    let layer = skin(Kernel::Layer { thickness: 3e-3.into() });
    let at = |depth| press_up(&surface, &plate(), &layer, depth);
    assert!(told(&at(1.4e-3), WarningKind::ResponseRange).is_empty());
    assert_told(&at(1.6e-3), WarningKind::ResponseRange, &["1.6000e-3", "half of the 3.0000e-3 m"]);
    // Two thirds of it are too deep for any tissue.
    assert!(told(&at(1.6e-3), WarningKind::Depth).is_empty());
    assert_told(&at(2.1e-3), WarningKind::Depth, &["2.1000e-3", "two thirds"]);
}

#[test]
fn a_gaussian_under_a_wide_contact_is_out_of_its_range() {
    let surface = ball(8e-3, 3);
    let constant = half_space().kernel_constant();
    let (width, cutoff) = (8e-3, 15e-3);
    // Well below what is balanced.
    let gaussian = skin(Kernel::GaussianCorrected { height: 0.2 * constant / width, width, cutoff });
    let at = |depth| press_up(&surface, &plate(), &gaussian, depth);
    assert!(told(&at(0.3e-3), WarningKind::ResponseRange).is_empty());
    assert_told(&at(4e-3), WarningKind::ResponseRange, &["a third of the 8.0000e-3 m"]);
}

#[test]
fn a_response_larger_than_the_skin_is_asked_for_its_unit() {
    let surface = ball(8e-3, 3);
    let diagonal = surface.bounding_box().diagonal();
    let told_of = |kernel| press_up(&surface, &plate(), &skin(kernel), 0.3e-3);
    let layer = |thickness: f64| told_of(Kernel::Layer { thickness: thickness.into() });
    assert_told(&layer(8.2), WarningKind::ResponseRange, &["thickness is 8.2000e0 m", "8 mm is 8e-3"]);
    assert!(told(&layer(0.9 * diagonal), WarningKind::ResponseRange).is_empty());
    let constant = half_space().kernel_constant();
    let gaussian = |width: f64| {
        told_of(Kernel::GaussianCorrected { height: 0.2 * constant / width, width, cutoff: 2.0 * width })
    };
    assert_told(&gaussian(8.0), WarningKind::ResponseRange, &["width is 8.0000e0 m"]);
    assert!(told(&gaussian(0.9 * diagonal), WarningKind::ResponseRange).is_empty());
}

#[test]
fn a_mask_that_leaves_next_to_nothing_is_asked_whether_it_is_inverted() {
    let surface = ball(8e-3, 3);
    let leaving = |count: usize| {
        let mut order: Vec<usize> = (0..surface.vertices().len()).collect();
        order.sort_by(|&a, &b| surface.vertices()[a].z.total_cmp(&surface.vertices()[b].z));
        let mut mask = vec![false; order.len()];
        order[..count].iter().for_each(|&vertex| mask[vertex] = true);
        let masked = surface.clone().with_skin_mask(mask).expect("one entry a vertex");
        press_up(&masked, &plate(), &half_space(), 1e-4)
    };
    // 642 vertices.
    assert_told(&leaving(6), WarningKind::Mask, &["6 of 642", "0.93 %", "inverted"]);
    assert_told(&leaving(128), WarningKind::Mask, &["128 of 642"]);
    assert!(told(&leaving(129), WarningKind::Mask).is_empty());
    assert!(told(&leaving(642), WarningKind::Mask).is_empty());
}

#[test]
fn guards_are_told_without_contact_and_for_what_is_out_of_reach() {
    let huge = ball(8.0, 3);
    let apart = plate().translated(&Vector3::new(0.0, 0.0, -1.0));
    let options = ContactOptions::on_given_mesh();
    let contact = solve_contact(&huge, &apart, &half_space(), &options).expect("a valid request");
    assert_told(&contact, WarningKind::Size, &["skin"]);
    assert_told(&contact, WarningKind::Size, &["1.6000e1 m"]);
}

#[test]
fn an_ordinary_press_is_told_nothing() {
    for discretization in [Discretization::Collocation, Discretization::Galerkin] {
        let skin = half_space().with_discretization(discretization).expect("a half-space has it");
        let contact = pressed(&ball(8e-3, 3), &plate(), &skin, Goal::Depth(1e-3), &ContactOptions::default());
        assert!(contact.warnings.is_empty(), "{:?}", contact.warnings);
    }
}

#[test]
fn an_obstacle_inside_the_skin_is_no_quiet_miss() {
    let skin = ball(8e-3, 3);
    let at = |height: f64| Obstacle::sphere(height * UP, 2e-3).expect("a sphere");
    let warned =
        |contact: &Contact| contact.warnings.iter().any(|one| one.message.contains("inside the skin"));
    let swallowed = solve(&skin, &at(8e-3), &half_space());
    assert_eq!((swallowed.status, warned(&swallowed)), (ContactStatus::NoContact, true));
    let beside = solve(&skin, &at(-3e-3), &half_space());
    assert_eq!((beside.status, warned(&beside)), (ContactStatus::NoContact, false));
}

#[test]
fn an_obstacle_behind_open_skin_is_no_quiet_miss() {
    let spacing = 1e-3;
    let sides = [Vector3::x() * spacing, Vector3::y() * spacing];
    let skin = lattice(20, sides, Vector3::zeros(), 0.0, &mut Random(1));
    let at = |height: f64| {
        let bead = Obstacle::sphere(Vector3::new(0.3e-3, 0.2e-3, height), 2e-4).expect("a sphere");
        solve(&skin, &bead, &half_space())
    };
    // The skin faces up.
    for (height, is_behind) in [(-1.5e-3, true), (1.5e-3, false)] {
        let contact = at(height);
        let is_told = contact.warnings.iter().any(|one| one.message.contains("inside the skin"));
        assert_eq!((contact.status, is_told), (ContactStatus::NoContact, is_behind), "{height}");
    }
}

#[test]
fn open_skin_pressed_from_behind_is_told_so() {
    let sides = [Vector3::x() * 1e-3, Vector3::y() * 1e-3];
    let surface = lattice(12, sides, Vector3::zeros(), 0.0, &mut Random(1));
    // The skin faces up, and the ball comes from below.
    let ball = Obstacle::sphere(Vector3::new(0.3e-3, 0.2e-3, -1.0), 0.5).expect("a sphere");
    let contact = press_up(&surface, &ball, &half_space(), 1e-4);
    assert_told(&contact, WarningKind::Penetration, &["pulled and not pressed", "from behind"]);
}

/// A plate with its top at z = 0 and a round hole of 7 mm along z, its rim rounded by 0.5 mm.
fn plate_with_hole() -> Obstacle {
    let (hole, rounding, around) = (7e-3, 0.5e-3, 128_u32);
    let on_rim = |step: u32| {
        let (sin, cos) = (f64::from(step) * FRAC_PI_2 / 8.0).sin_cos();
        (hole + rounding * (1.0 - cos), rounding * (sin - 1.0))
    };
    // (radius, z) around the section, counter-clockwise seen from outside.
    let section: Vec<(f64, f64)> = [(hole, -6e-3)]
        .into_iter()
        .chain((0..=8).map(on_rim))
        .chain([(20e-3, 0.0), (20e-3, -6e-3)])
        .collect();
    let rings = section.len() as u32;
    let place = |at: u32| {
        let (radius, z) = section[(at / around) as usize];
        let (sin, cos) = (TAU * f64::from(at % around) / f64::from(around)).sin_cos();
        Vector3::new(radius * cos, radius * sin, z)
    };
    let faces = (0..rings * around).flat_map(|at| {
        let (ring, step) = (at / around, at % around);
        let number = |ring: u32, step: u32| ring % rings * around + step % around;
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(i, j)| number(ring + i, step + j));
        [[a, c, b], [a, d, c]]
    });
    let vertices = (0..rings * around).map(place).collect();
    Obstacle::mesh(vertices, faces.collect(), &MeshObstacleOptions::default()).expect("a closed mesh")
}

/// Whether it is said that the force acts off the obstacle.
fn is_off(contact: &Contact) -> bool {
    let off = "off the obstacle in the mean";
    told(contact, WarningKind::Penetration).iter().any(|message| message.contains(off))
}

#[test]
fn averaged_gaps_of_few_nodes_settle_on_a_smooth_product() {
    let below = Obstacle::sphere(-0.05 * UP, 5e-3).expect("a sphere");
    for depth in [0.3e-3, 0.6e-3] {
        let options = ContactOptions::on_given_mesh();
        let contact = pressed(&ball(8e-3, 3), &below, &galerkin(), Goal::Depth(depth), &options);
        assert!(!contact.active.is_empty() && !is_off(&contact), "{:?}", contact.warnings);
    }
}

#[test]
fn gaps_on_a_rounded_rim_settle_and_a_press_that_ends_before_is_told() {
    let plate = plate_with_hole().translated(&(-0.05 * UP));
    let on_rim = |skin: &KernelSkin, subdivisions, depth, max_linearizations| {
        let options = ContactOptions { max_linearizations, ..ContactOptions::on_given_mesh() };
        let contact = pressed(&ball(8e-3, subdivisions), &plate, skin, Goal::Depth(depth), &options);
        (contact.resultant.force.z, contact.accuracy.force_error.expect("a contact"), is_off(&contact))
    };
    // Averaged gaps settle on a finer mesh.
    for (skin, subdivisions, depth) in [(half_space(), 4, 2e-3), (galerkin(), 5, 1e-3)] {
        let (settled, _, is_told) = on_rim(&skin, subdivisions, depth, 20);
        assert!(!is_told);
        let (early, error, is_told) = on_rim(&skin, subdivisions, depth, 2);
        let is_covered = early - settled < error * early;
        assert!(is_told && early > 1.5 * settled && is_covered, "{early} {settled} {error}");
    }
}
