//! The Gaussian-corrected kernel.

use approx::assert_relative_eq;
use quasirigid::response::{Kernel, gaussian_hat_integrals, hat_integrals};
use quasirigid::surface::Surface;

use super::*;

/// The Gaussian-corrected matrix by a plain double loop, where the cutoff cuts no one-ring.
fn naive_gaussian(
    surface: &Surface,
    height: f64,
    width: f64,
    cutoff: f64,
    i: usize,
    j: usize,
) -> Option<f64> {
    let (points, faces) = (surface.vertices(), surface.faces());
    let (mut inverse, mut smooth, mut inside) = (0.0, 0.0, true);
    for &f in surface.faces_around(j) {
        let corners = faces[f as usize].map(|v| points[v as usize]);
        inside &= corners.iter().all(|c| (c - points[i]).norm() < cutoff);
        let k = faces[f as usize].iter().position(|&v| v as usize == j).expect("its own face");
        inverse += hat_integrals(&points[i], &corners)[k];
        smooth += gaussian_hat_integrals(&points[i], &corners, width)[k];
    }
    let area = surface.vertex_areas()[j];
    inside.then(|| (skin(HALF_SPACE).kernel_constant() * inverse - height * smooth) / area)
}

#[test]
fn the_gaussian_matrix_equals_the_double_loop_over_closed_forms() {
    let surface = grid(14, 14e-3, 4e-3, 0.3);
    // widths from narrower than a triangle, where Owen's T takes over, to wider than the mesh
    for (height, width, cutoff) in [(0.8e-3, 5e-3, 8e-3), (2e-3, 1.5e-3, 6e-3), (3e-3, 0.2e-3, f64::INFINITY)]
    {
        let response = Kernel::GaussianCorrected { height, width, cutoff };
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let r = matrix(&surface, &skin(response.clone()), tolerance);
            let mut compared = 0;
            for j in (0..r.ncols()).step_by(7) {
                for i in 0..r.nrows() {
                    let Some(expected) = naive_gaussian(&surface, height, width, cutoff, i, j) else {
                        continue;
                    };
                    let distance = (surface.vertices()[i] - surface.vertices()[j]).norm().max(1e-3);
                    let part = skin(HALF_SPACE).kernel_constant() / distance;
                    assert!((r[(i, j)] - expected).abs() <= 2.0 * tolerance * part, "({i}, {j}) {width}");
                    compared += 1;
                }
            }
            assert!(compared > 1000);
        }
    }
}

#[test]
fn a_flat_gaussian_of_no_height_is_the_half_space() {
    let surface = grid(9, 9e-3, 4e-3, 0.3);
    let flat = Kernel::GaussianCorrected { height: 0.0, width: 2e-3, cutoff: f64::INFINITY };
    let (one, other) = (matrix(&surface, &skin(flat), 1e-9), matrix(&surface, &skin(HALF_SPACE), 1e-9));
    for j in 0..one.ncols() {
        for i in 0..one.nrows() {
            assert_relative_eq!(one[(i, j)], other[(i, j)], max_relative = 2e-9);
        }
    }
}

#[test]
fn the_corrected_kernel_falls_to_zero_beyond_its_cutoff() {
    let surface = grid(40, 40e-3, 0.0, 0.0);
    let r = matrix(&surface, &skin(PAPER), 1e-6);
    let constant = skin(PAPER).kernel_constant();
    let center = 20 * 41 + 20;
    let kernel = |distance: f64| constant / distance - 0.8e-3 * (-0.5 * (distance / 5e-3).powi(2)).exp();
    for steps in [4, 8, 12] {
        let entry = r[(center + steps, center)];
        // a hat of 1 mm in place of a point
        assert!((entry - kernel(steps as f64 * 1e-3)).abs() < 0.02 * constant / (steps as f64 * 1e-3));
    }
    assert!(r[(center + 14, center)] != 0.0);
    assert!((17..20).all(|steps| r[(center + steps, center)] == 0.0));
}
