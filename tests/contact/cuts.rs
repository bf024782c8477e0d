//! Contacts that reach where the skin is cut, and the warning of it.

use nalgebra::Vector3;
use quasirigid::contact::{Contact, ContactOptions, WarningKind, solve_contact};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::response::{ElasticSkin, PreparedBody};
use quasirigid::surface::Surface;

use crate::common::one_diagonal_grid;
use crate::{POISSON_RATIO, SHEAR_MODULUS, UP, ball, half_space};

/// Flat square of 20 cells of 1 mm, a corner in the origin.
fn square() -> Surface {
    let (mut vertices, faces) = one_diagonal_grid(20);
    vertices.iter_mut().for_each(|vertex| *vertex *= 1e-3);
    Surface::new(vertices, faces).expect("a valid surface")
}

/// A ball of 20 mm that dips 0.4 mm into the plane z = 0 over (x, 10) mm: its contact is some 2.8 mm wide.
fn over(x: f64) -> Obstacle {
    Obstacle::sphere(Vector3::new(x, 10e-3, 19.6e-3), 20e-3).expect("a sphere")
}

fn both(surface: &Surface, obstacle: &Obstacle, skin: &dyn ElasticSkin) -> [Contact; 2] {
    [ContactOptions::on_given_mesh(), ContactOptions::default()]
        .map(|options| solve_contact(surface, obstacle, skin, &options).expect("a valid request"))
}

/// The warnings of cuts.
fn cuts(contact: &Contact) -> Vec<&String> {
    let of_cuts = contact.warnings.iter().filter(|warning| warning.kind == WarningKind::Cut);
    of_cuts.map(|warning| &warning.message).collect()
}

/// Asserts one warning, of `place`, with the force at the active vertices that `is_at` names.
fn assert_warns(contact: &Contact, place: &str, is_at: impl Fn(usize) -> bool) {
    let at_cut = contact.active.iter().filter(|&&vertex| is_at(vertex));
    let force: f64 = at_cut.map(|&vertex| contact.node_force[vertex]).sum();
    let share = 100.0 * force / contact.node_force.iter().sum::<f64>();
    let found = cuts(contact);
    assert_eq!(found.len(), 1, "{:?}", contact.warnings);
    assert!(share > 0.1);
    assert_eq!(contact.accuracy.max_pressure_error, Some(f64::INFINITY));
    assert!(found[0].contains(place), "{}", found[0]);
    assert!(found[0].contains(&format!("{force:.3e} N there ({share:.2} % of all)")), "{}", found[0]);
}

#[test]
fn a_contact_at_an_open_border_says_so_and_one_inside_does_not() {
    for contact in both(&square(), &over(10e-3), &half_space()) {
        assert!(cuts(&contact).is_empty());
        assert!(contact.accuracy.max_pressure_error.is_some_and(f64::is_finite));
    }
    for contact in both(&square(), &over(0.5e-3), &half_space()) {
        assert_warns(&contact, "open border", |vertex| contact.surface().vertices()[vertex].x < 1e-9);
    }
}

#[test]
fn a_contact_at_the_rim_of_the_skin_mask_says_so() {
    let surface = square();
    let mask = surface.vertices().iter().map(|vertex| vertex.x > 4.5e-3).collect();
    let surface = surface.with_skin_mask(mask).expect("one entry a vertex");
    for contact in both(&surface, &over(12e-3), &half_space()) {
        assert!(cuts(&contact).is_empty());
    }
    for contact in both(&surface, &over(5e-3), &half_space()) {
        let solved = contact.surface();
        let is_beside = |vertex: usize| {
            solved.neighbours(vertex).iter().any(|&other| !solved.skin_mask()[other as usize])
        };
        assert_warns(&contact, "rim of the skin mask", is_beside);
    }
}

#[test]
fn a_contact_beside_vertices_that_a_body_holds_says_so() {
    let surface = ball(8e-3, 2);
    // All but a cap around the lowest point is held.
    let fixed: Vec<bool> = surface.vertices().iter().map(|vertex| vertex.z > 1.5e-3).collect();
    let free: Vec<usize> = (0..fixed.len()).filter(|&vertex| !fixed[vertex]).collect();
    let mask = fixed.iter().map(|held| !held).collect();
    let surface = surface.with_skin_mask(mask).expect("one entry a vertex");
    let body = Body { bone: None, fixed: Some(fixed.clone()), coarse_edge_length: Some(0.0) };
    let (options, constants) = (BodyOptions::default(), (SHEAR_MODULUS, POISSON_RATIO));
    let skin = PreparedBody::new(&surface, &body, constants.0, constants.1, &free, &options).expect("a body");
    let below = |depth: f64| Obstacle::half_space(depth * UP, UP).expect("a valid obstacle");
    let [contact, _] = both(&surface, &below(1.3e-3), &skin);
    let is_beside = |vertex: usize| surface.neighbours(vertex).iter().any(|&other| fixed[other as usize]);
    assert_warns(&contact, "holds fixed", is_beside);
    let [contact, refined] = both(&surface, &below(0.1e-3), &skin);
    assert!(cuts(&contact).is_empty() && cuts(&refined).is_empty());
}

#[test]
fn a_body_held_within_the_skin_mask_warns_on_a_refined_mesh_too() {
    let surface = ball(8e-3, 2);
    let fixed: Vec<bool> = surface.vertices().iter().map(|vertex| vertex.z > 2.5e-3).collect();
    let free: Vec<usize> = (0..fixed.len()).filter(|&vertex| !fixed[vertex]).collect();
    let mask = fixed.iter().map(|held| !held).collect();
    let surface = surface.with_skin_mask(mask).expect("one entry a vertex");
    let body = Body { bone: None, fixed: Some(fixed), coarse_edge_length: Some(0.0) };
    let options = BodyOptions::default();
    let skin = PreparedBody::new(&surface, &body, SHEAR_MODULUS, POISSON_RATIO, &free, &options);
    let skin = skin.expect("a body");
    let deep = Obstacle::half_space(2.2e-3 * UP, UP).expect("a valid obstacle");
    for contact in both(&surface, &deep, &skin) {
        let found = cuts(&contact);
        assert_eq!(found.len(), 1);
        assert!(found[0].contains("holds fixed") && found[0].contains("Body(fixed=)"), "{}", found[0]);
    }
}
