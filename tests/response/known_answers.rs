//! Entries of the half-space in closed form.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::response::{AssemblyOptions, PressureBasis, assemble};
use quasirigid::surface::Surface;

use super::*;

#[test]
fn kernel_constant_is_that_of_boussinesq() {
    assert_relative_eq!(skin(HALF_SPACE).kernel_constant(), 1.3263e-6, max_relative = 1e-4);
}

#[test]
fn a_hexagon_moves_its_own_center_by_the_closed_form() {
    // ∫ hat / r over six equilateral triangles of side s: in each, with t the distance from the far edge,
    // ∫∫ (1 - r cos(θ)/h) dr dθ over θ in ±30° = h/2 ∫ dθ / cos θ = h/2 ln 3, h = s √3 / 2.
    let side = 1e-3;
    let mut vertices = vec![Vector3::zeros()];
    let mut faces = Vec::new();
    for k in 0..6u32 {
        let angle = k as f64 * PI / 3.0;
        vertices.push(Vector3::new(side * angle.cos(), side * angle.sin(), 0.0));
        faces.push([0, k + 1, (k + 1) % 6 + 1]);
    }
    let surface = Surface::new(vertices, faces).expect("a hexagon");
    let area = 6.0 * side * side * 3f64.sqrt() / 4.0;
    let height = side * 3f64.sqrt() / 2.0;
    let constant = skin(HALF_SPACE).kernel_constant();
    let options = AssemblyOptions::default();
    let linear = assemble(&surface, &skin(HALF_SPACE), &[0], &options).expect("valid");
    let expected = constant * 6.0 * 0.5 * height * 3f64.ln() / (area / 3.0);
    assert_relative_eq!(linear[(0, 0)], expected, max_relative = 1e-14);
    let one_ring = skin(HALF_SPACE).with_basis(PressureBasis::OneRing);
    let even = assemble(&surface, &one_ring, &[0], &options).expect("valid");
    assert_relative_eq!(even[(0, 0)], constant * 6.0 * height * 3f64.ln() / area, max_relative = 1e-14);
}

#[test]
fn far_away_a_node_acts_as_a_point_load() {
    let surface = grid(40, 40e-3, 0.0, 0.0);
    let r = matrix(&surface, &skin(HALF_SPACE), 1e-9);
    let (i, j) = (5 * 41 + 5, 35 * 41 + 35);
    let distance = (surface.vertices()[i] - surface.vertices()[j]).norm();
    // the hat's second moments leave (h / r)² / 24 or so
    assert_relative_eq!(r[(i, j)] * distance, skin(HALF_SPACE).kernel_constant(), max_relative = 2e-4);
}
