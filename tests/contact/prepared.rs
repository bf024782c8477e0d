//! Bodies prepared for some vertices: those beside them end no press that they do not touch.

use quasirigid::contact::{Contact, ContactError, ContactOptions, ContactStatus, solve_contact};
use quasirigid::obstacle::{Obstacle, ProductResponse};
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::response::{ElasticSkin, Kernel, PreparedBody, PressureBasis, ResponseError};
use quasirigid::surface::Surface;

use crate::{POISSON_RATIO, SHEAR_MODULUS, UP, ball, half_space, press_up};

/// The ball held above 5 mm, its response known below a height; its skin mask lets all of it touch.
fn held_ball(known_below: f64) -> (Surface, PreparedBody) {
    let surface = ball(8e-3, 2);
    let fixed: Vec<bool> = surface.vertices().iter().map(|vertex| vertex.z > 2.5e-3).collect();
    let known = |vertex: &usize| !fixed[*vertex] && surface.vertices()[*vertex].z < known_below;
    let nodes: Vec<usize> = (0..fixed.len()).filter(known).collect();
    let body = Body { bone: None, fixed: Some(fixed), coarse_edge_length: Some(0.0) };
    let options = BodyOptions::default();
    let skin = PreparedBody::new(&surface, &body, SHEAR_MODULUS, POISSON_RATIO, &nodes, &options);
    (surface, skin.expect("a body"))
}

fn at_depth(depth: f64, surface: &Surface, skin: &PreparedBody) -> Result<Contact, ContactError> {
    let below = Obstacle::half_space(depth * UP, UP).expect("a valid obstacle");
    solve_contact(surface, &below, skin, &ContactOptions::on_given_mesh())
}

/// Heights (m) of the rings of vertices around the lowest one, ascending.
fn heights(surface: &Surface) -> Vec<f64> {
    let mut all: Vec<f64> = surface.vertices().iter().map(|vertex| vertex.z).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    all
}

#[test]
fn a_contact_beside_vertices_that_are_held_and_not_masked_is_solved() {
    let (surface, skin) = held_ball(1.0);
    let held: Vec<usize> = (0..surface.vertices().len()).filter(|&vertex| skin.is_held(vertex)).collect();
    // All that is free lies inside the obstacle, and nothing that is held.
    let depth = held.iter().map(|&vertex| surface.vertices()[vertex].z).fold(f64::INFINITY, f64::min) - 1e-6;
    let contact = at_depth(depth, &surface, &skin).expect("nothing held is inside");
    assert_eq!(contact.status, ContactStatus::Solved);
    let touches = |vertex: &usize| contact.node_force[*vertex] > 0.0;
    assert!(held.iter().all(|vertex| !touches(vertex)));
    let beside =
        |vertex: &usize| surface.neighbours(*vertex).iter().any(|other| held.contains(&(*other as usize)));
    assert!(contact.active.iter().any(beside));
}

#[test]
fn a_held_vertex_inside_the_obstacle_is_named() {
    let (surface, skin) = held_ball(1.0);
    let depth = 3.5e-3;
    let inside =
        (0..surface.vertices().len()).filter(|&v| skin.is_held(v) && surface.vertices()[v].z < depth);
    let inside: Vec<usize> = inside.collect();
    let refused = at_depth(depth, &surface, &skin).unwrap_err();
    assert_eq!(refused, ContactError::Held { vertex: inside[0], count: inside.len() });
    assert!(refused.to_string().contains("mask them out"), "{refused}");
}

#[test]
fn a_body_prepared_for_what_touches_is_solved_and_for_less_asks_for_more() {
    let all = held_ball(1.0);
    let rings = heights(&all.0);
    // The lowest vertex and the first ring are inside; the second ring is not, and stays outside.
    let depth = 0.5 * (rings[1] + rings[2]);
    let whole = at_depth(depth, &all.0, &all.1).expect("prepared for all");
    let (surface, few) = held_ball(depth);
    let contact = at_depth(depth, &surface, &few).expect("prepared for all that touches");
    assert_eq!(contact.status, ContactStatus::Solved);
    let active = |contact: &Contact| contact.active.clone();
    assert_eq!(active(&contact), active(&whole));
    approx::assert_relative_eq!(contact.resultant.force, whole.resultant.force, max_relative = 1e-9);
    let (surface, fewer) = held_ball(0.5 * (rings[0] + rings[1]));
    let refused = at_depth(depth, &surface, &fewer).unwrap_err();
    assert!(matches!(refused, ContactError::Response(ResponseError::NotPrepared { .. })), "{refused}");
    assert!(refused.to_string().contains("prepare it for these too"), "{refused}");
}

#[test]
fn the_largest_pressure_of_one_rings_is_no_smaller_than_the_mean() {
    let one_ring = half_space().with_basis(PressureBasis::OneRing);
    for subdivisions in [1, 2, 3, 4] {
        for depth in [1e-6, 0.1e-3, 0.5e-3, 2e-3] {
            let contact = press_up(&ball(8e-3, subdivisions), &crate::plate(), &one_ring, depth);
            for part in contact.patches.iter().map(|patch| &patch.resultant).chain([&contact.resultant]) {
                let mean = contact.node_force.iter().sum::<f64>() / part.contact_area;
                let largest = part.max_pressure;
                assert!(largest >= mean * (1.0 - 1e-12), "{subdivisions} {depth}: {largest} {mean}");
            }
        }
    }
}

#[test]
fn the_memory_limit_holds_whatever_answers_for_the_skin_and_counts_the_product() {
    let (surface, skin) = held_ball(1.0);
    let depth = 2.5e-3;
    let below = Obstacle::half_space(depth * UP, UP).expect("a valid obstacle");
    let soft = below.with_material(SHEAR_MODULUS, POISSON_RATIO, ProductResponse::Kernel(Kernel::HalfSpace));
    for (obstacle, side_by_side) in [(below.clone(), 1), (soft.expect("valid constants"), 2)] {
        let solve = |memory_limit: Option<usize>| {
            let options = ContactOptions { memory_limit, ..ContactOptions::on_given_mesh() };
            solve_contact(&surface, &obstacle, &skin, &options)
        };
        let nodes = solve(None).expect("no limit").candidates.len();
        let bytes = 8 * side_by_side * nodes * nodes;
        let refused = solve(Some(bytes - 1)).unwrap_err();
        assert_eq!(
            refused,
            ContactError::Response(ResponseError::TooLarge { nodes, bytes, limit: bytes - 1 })
        );
        assert_eq!(solve(Some(bytes)).expect("within the limit").status, ContactStatus::Solved);
    }
}
