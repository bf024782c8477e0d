//! Presses one after the other, each from what the one before leaves.

use approx::assert_relative_eq;
use nalgebra::{Rotation3, Vector3};
use quasirigid::contact::{
    Contact, ContactError, ContactOptions, Goal, RefinementKind, WarmStart, press_after,
};
use quasirigid::reference::{Hertz, contact_modulus};
use quasirigid::surface::Surface;

use crate::common::{Random, joined, surface};
use crate::{POISSON_RATIO, SHEAR_MODULUS, ball, galerkin, half_space, plate, pressed, upwards};

const RADIUS: f64 = 8e-3;

fn after(surface: &Surface, goal: Goal, before: &mut WarmStart) -> Result<Contact, ContactError> {
    press_after(surface, &plate(), &half_space(), &upwards(goal), &ContactOptions::default(), before)
}

fn alone(surface: &Surface, goal: Goal) -> Contact {
    pressed(surface, &plate(), &half_space(), goal, &ContactOptions::default())
}

fn mesh_rounds(contact: &Contact) -> usize {
    contact.refinements.iter().filter(|round| round.kind == RefinementKind::Mesh).count()
}

#[test]
fn a_press_goes_on_on_the_mesh_before_and_keeps_to_hertz() {
    let surface = ball(RADIUS, 3);
    let hertz = Hertz { radius: RADIUS, contact_modulus: contact_modulus(SHEAR_MODULUS, POISSON_RATIO) };
    let mut before = WarmStart::default();
    let first = 0.05e-3;
    // The area grows by half.
    for step in 0..9 {
        let depth = first * 1.05_f64.powi(step);
        let contact = after(&surface, Goal::Depth(depth), &mut before).expect("a depth");
        assert_eq!(mesh_rounds(&contact) == 1, step > 0, "step {step}");
        let error = contact.accuracy.force_error.expect("an estimate");
        assert!(error <= 0.02);
        // The sphere is no paraboloid: its force is above by a share of the depth over the radius.
        assert_relative_eq!(
            contact.resultant.force.z,
            hertz.force(depth),
            max_relative = error + depth / RADIUS
        );
    }
}

/// Averaged gaps of a coarse mesh close late and all at once.
#[test]
fn a_force_that_a_coarse_mesh_jumps_over_is_reached_on_a_finer_one() {
    let surface = ball(RADIUS, 2);
    let mut before = WarmStart::default();
    for force in [1e-3, 2e-3] {
        let asked = upwards(Goal::Force(force));
        let options = ContactOptions::default();
        let contact = press_after(&surface, &plate(), &galerkin(), &asked, &options, &mut before);
        let contact = contact.unwrap_or_else(|error| panic!("{error}"));
        assert_relative_eq!(contact.resultant.force.z, force, max_relative = 1e-6);
        let pointwise = alone(&surface, Goal::Depth(contact.depth.expect("a press")));
        let errors = [&contact, &pointwise].map(|one| one.accuracy.force_error.expect("an estimate"));
        assert!(errors.iter().all(|&error| error <= 0.02), "{errors:?}");
        assert_relative_eq!(pointwise.resultant.force.z, force, max_relative = errors[0] + errors[1]);
    }
}

#[test]
fn a_second_patch_is_met_wherever_in_a_coarse_triangle_it_begins() {
    let mut random = Random(11);
    let mut turned = || {
        let axis = Vector3::from_fn(|_, _| random.signed());
        Rotation3::from_scaled_axis(3.0 * axis)
    };
    let (mut begun, drawn) = (0, ball(RADIUS, 2));
    for _ in 0..20 {
        let (one, other) = (turned(), turned());
        let middle = Vector3::new(0.0, 0.0, RADIUS);
        // Its lowest point is 30 um higher.
        let aside = Vector3::new(40e-3, 0.0, 30e-6);
        let balls = [(one, Vector3::zeros()), (other, aside)].map(|(turn, place)| {
            let vertices = drawn.vertices().iter().map(|x| turn * (x - middle) + middle + place).collect();
            (vertices, drawn.faces().to_vec())
        });
        let surface = surface(joined(&balls[0], &balls[1]));
        let mut before = WarmStart::default();
        for step in 0..8 {
            let depth = 26e-6 + 6e-6 * f64::from(step);
            let warm = after(&surface, Goal::Depth(depth), &mut before).expect("a depth");
            let alone = alone(&surface, Goal::Depth(depth));
            let told = [&warm, &alone].map(|contact| contact.accuracy.force_error.expect("an estimate"));
            let change = warm.resultant.force.z / alone.resultant.force.z - 1.0;
            assert!(change.abs() <= told[0] + told[1], "step {step}: {change:+.4}, {told:?}");
            assert_eq!(warm.patches.len(), alone.patches.len(), "step {step}");
            begun += usize::from(warm.patches.len() == 2);
        }
    }
    assert!(begun > 0);
}

#[test]
fn a_mesh_is_given_up_for_a_contact_of_another_size() {
    let surface = ball(RADIUS, 3);
    let mut before = WarmStart::default();
    for depth in [0.1e-3, 1e-3, 0.1e-3] {
        let contact = after(&surface, Goal::Depth(depth), &mut before).expect("a depth");
        assert_eq!(contact.resultant.force, alone(&surface, Goal::Depth(depth)).resultant.force);
    }
}

#[test]
fn forces_are_found_on_the_mesh_before() {
    let surface = ball(RADIUS, 3);
    let mut before = WarmStart::default();
    for force in [0.5, 0.52, 0.54] {
        let contact = after(&surface, Goal::Force(force), &mut before).expect("within reach");
        assert_relative_eq!(contact.resultant.force.z, force, max_relative = 1e-6);
        let depth = alone(&surface, Goal::Force(force)).depth.expect("a depth");
        assert_relative_eq!(contact.depth.expect("a depth"), depth, max_relative = 0.02);
    }
}

#[test]
fn overlaps_are_found_on_the_mesh_before() {
    let surface = ball(RADIUS, 3);
    let mut before = WarmStart::default();
    for overlap in [0.5e-3, 0.52e-3, 0.54e-3] {
        let contact = after(&surface, Goal::Overlap(overlap), &mut before).expect("within reach");
        assert_eq!(mesh_rounds(&contact), 1);
        assert_relative_eq!(contact.max_penetration_before, overlap, max_relative = 1e-6);
        let force = alone(&surface, Goal::Overlap(overlap)).resultant.force.z;
        assert_relative_eq!(contact.resultant.force.z, force, max_relative = 0.02);
    }
}

#[test]
fn a_bad_press_is_refused_and_the_next_one_begins_anew() {
    let surface = ball(RADIUS, 3);
    let mut before = WarmStart::default();
    after(&surface, Goal::Depth(0.5e-3), &mut before).expect("a depth");
    let error = after(&surface, Goal::Depth(-1.0), &mut before).unwrap_err();
    assert!(matches!(error, ContactError::Depth { .. }));
    let goal = Goal::Depth(0.51e-3);
    let contact = after(&surface, goal, &mut before).expect("a depth");
    assert_eq!(contact.resultant.force, alone(&surface, goal).resultant.force);
}
