//! Patches that begin to touch where the mesh as given feels nothing of them.

use approx::assert_relative_eq;
use nalgebra::{Rotation3, Vector3};
use quasirigid::contact::{Contact, ContactOptions, Goal, WarmStart, press_after};
use quasirigid::response::KernelSkin;
use quasirigid::surface::Surface;

use crate::common::icosphere;
use crate::{UP, galerkin, half_space, plate, pressed, upwards};

const RADIUS: f64 = 8e-3;
/// How much higher the second ball lies (m).
const HIGHER: f64 = 1e-4;

/// Balls beside each other on the x axis, each so high (m) and its lowest vertex turned away by so much (rad).
fn balls(each: &[[f64; 2]]) -> Surface {
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for (number, &[height, angle]) in each.iter().enumerate() {
        let (own, own_faces) = icosphere(RADIUS, 2);
        let first = vertices.len() as u32;
        faces.extend(own_faces.iter().map(|face| face.map(|corner| corner + first)));
        let turn = Rotation3::from_axis_angle(&Vector3::y_axis(), angle);
        let shift = Vector3::new(0.06 * number as f64, 0.0, RADIUS + height);
        vertices.extend(own.iter().map(|vertex| turn * vertex + shift));
    }
    Surface::new(vertices, faces).expect("a valid surface")
}

/// Half of the angle between the lowest vertex of a ball and the next one along x.
fn half_an_edge() -> f64 {
    let (vertices, _) = icosphere(1.0, 2);
    let nearest = vertices.iter().map(|vertex| vertex.angle(&-UP)).filter(|angle| *angle > 1e-6);
    0.5 * nearest.fold(f64::INFINITY, f64::min)
}

fn refined(surface: &Surface, skin: &KernelSkin, depth: f64) -> Contact {
    pressed(surface, &plate(), skin, Goal::Depth(depth), &ContactOptions::default())
}

/// The balls are far apart and share no tissue, so that each answers as alone where the plate stands.
fn is_sum_of(contact: &Contact, skin: &KernelSkin, each: [[f64; 2]; 2]) {
    let alone = each.map(|one| {
        let ball = balls(&[one]);
        let touch = refined(&ball, skin, 0.0).travel;
        // The smooth skin of a mesh touches at one place on it, and on its refinements a little before.
        let near = refined(&ball, skin, contact.travel - touch);
        refined(&ball, skin, near.depth.expect("a press") + contact.travel - near.travel)
    });
    let errors = [contact, &alone[0], &alone[1]].map(|one| one.accuracy.force_error.expect("an estimate"));
    let sum: f64 = alone.iter().map(|one| one.resultant.force.z).sum();
    assert_eq!(contact.patches.len(), 2);
    assert_relative_eq!(contact.resultant.force.z, sum, max_relative = errors.iter().sum::<f64>());
}

#[test]
fn a_vertex_that_averages_do_not_feel_is_refined_until_they_do() {
    let skin = galerkin();
    let each = [[0.0; 2], [HIGHER, 0.0]];
    is_sum_of(&refined(&balls(&each), &skin, HIGHER + 2e-5), &skin, each);
}

#[test]
fn a_patch_between_vertices_is_found_from_one_press_to_the_next() {
    let angle = half_an_edge();
    let each = [[0.0; 2], [HIGHER, angle]];
    for skin in [half_space(), galerkin()] {
        let surface = balls(&each);
        let mut before = WarmStart::default();
        // The vertices beside the lowest edge of the second ball stay above the plate.
        let [one, both] = [HIGHER - 2e-5, HIGHER + 6e-5].map(|depth| {
            let options = ContactOptions::default();
            press_after(&surface, &plate(), &skin, &upwards(Goal::Depth(depth)), &options, &mut before)
                .expect("a depth")
        });
        assert_eq!(one.patches.len(), 1);
        assert!(RADIUS * (1.0 - angle.cos()) > 6e-5);
        is_sum_of(&both, &skin, each);
    }
}
