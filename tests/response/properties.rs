//! What holds for every matrix: scaling, rigid motion, reciprocity, definiteness.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Vector3};
use quasirigid::response::{AssemblyOptions, KernelSkin, assemble, spectrum};
use quasirigid::surface::Surface;

use super::*;

#[test]
fn response_scales_with_the_material_and_the_unit() {
    let surface = grid(6, 6e-3, 1e-3, 0.2);
    let soft = matrix(&surface, &skin(HALF_SPACE), 1e-6);
    let hard = matrix(&surface, &KernelSkin::new(120e3, 0.5, HALF_SPACE).expect("valid"), 1e-6);
    let in_mm = grid(6, 6.0, 1.0, 0.2);
    // mm, N, MPa: lengths 1e3, modulus 1e-6, so mm/N is 1e3 times m/N
    let mm = matrix(&in_mm, &KernelSkin::new(60e-3, 0.5, HALF_SPACE).expect("valid"), 1e-6);
    for j in 0..soft.ncols() {
        for i in 0..soft.nrows() {
            assert_relative_eq!(soft[(i, j)], 2.0 * hard[(i, j)], max_relative = 1e-14);
            assert_relative_eq!(mm[(i, j)], 1e3 * soft[(i, j)], max_relative = 1e-12);
        }
    }
}

#[test]
fn a_moved_surface_has_the_same_response() {
    let surface = grid(8, 8e-3, 2e-3, 0.2);
    let pose = Isometry3::new(Vector3::new(0.1, -0.05, 0.2), Vector3::new(0.3, 1.1, -0.4));
    for response in [HALF_SPACE, PAPER] {
        let here = matrix(&surface, &skin(response.clone()), 1e-9);
        let there = matrix(&surface.moved(&pose), &skin(response), 1e-9);
        let scale = here[(0, 0)];
        for j in 0..here.ncols() {
            for i in 0..here.nrows() {
                assert!((here[(i, j)] - there[(i, j)]).abs() < 1e-9 * scale);
            }
        }
    }
}

#[test]
fn half_space_is_positive_and_close_to_reciprocal() {
    let surface = grid(10, 10e-3, 2e-3, 0.0);
    let r = matrix(&surface, &skin(HALF_SPACE), 1e-6);
    let at = |i: usize, j: usize| i * 11 + j;
    assert!((0..r.ncols()).all(|j| (0..r.nrows()).all(|i| r[(i, j)] > 0.0)));
    for (a, b) in [(at(3, 3), at(3, 4)), (at(4, 4), at(6, 7)), (at(2, 5), at(8, 3))] {
        assert_relative_eq!(r[(a, b)], r[(b, a)], max_relative = 0.02);
    }
    assert!(!skin(HALF_SPACE).has_negative_entries());
    assert!(skin(PAPER).has_negative_entries());
}

/// Some 200 vertices of a finger's pad: those nearest to its lowest point (pad to -z).
fn pad_nodes(surface: &Surface, count: usize) -> Vec<usize> {
    let points = surface.vertices();
    let low = points.iter().min_by(|a, b| a.z.total_cmp(&b.z)).expect("vertices");
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| (points[a] - low).norm().total_cmp(&(points[b] - low).norm()));
    order.truncate(count);
    order
}

#[test]
fn patches_of_real_fingers_are_positive_definite_in_both_discretizations() {
    let Some(data) = common::data_dir() else { return };
    for name in ["libhand_right_middle_1500", "webxr_right_middle_1500", "makehuman_female_right_middle_1500"]
    {
        let (vertices, faces) = common::read_ply(&data.join(format!("hands/{name}.ply")));
        let surface = Surface::new(vertices, faces).expect("a good mesh");
        let nodes = pad_nodes(&surface, 150);
        let options = AssemblyOptions::default();
        for skin in [skin(HALF_SPACE), galerkin()] {
            let r = assemble(&surface, &skin, &nodes, &options).expect("valid");
            let found = spectrum(r.as_ref());
            assert!(found.is_positive_definite() && found.condition < 1e3, "{name}: {found:?}");
        }
    }
}
