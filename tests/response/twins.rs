//! Matrices against plain double loops over closed forms, threads and blocks against the whole.

use approx::assert_relative_eq;
use quasirigid::response::{AssemblyOptions, PressureBasis, assemble};
use quasirigid::surface::Surface;

use super::*;

#[test]
fn assembly_equals_the_double_loop_over_exact_integrals() {
    for surface in [
        grid(9, 9e-3, 4e-3, 0.3),
        grid(16, 16e-3, 0.0, 0.2),
        squeezed(&grid(5, 5e-3, 1e-3, 0.3), 1e-2),
        squeezed(&grid(4, 4e-3, 1e-3, 0.3), 1e-3),
    ] {
        check_against_double_loop(&surface);
    }
}

fn check_against_double_loop(surface: &Surface) {
    for basis in [PressureBasis::Linear, PressureBasis::OneRing] {
        let skin = skin(HALF_SPACE).with_basis(basis);
        let naive = naive_half_space(surface, &skin, &all(surface));
        for (tolerance, allowed) in [(1e-3, 1e-3), (1e-6, 1e-6), (1e-9, 1e-9), (0.0, 2e-12)] {
            let fast = matrix(surface, &skin, tolerance);
            for j in 0..naive.ncols() {
                for i in 0..naive.nrows() {
                    let error = (fast[(i, j)] / naive[(i, j)] - 1.0).abs();
                    assert!(error <= allowed, "({i}, {j}) at {tolerance:e}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let surface = grid(14, 14e-3, 4e-3, 0.2);
    for response in [HALF_SPACE, PAPER, layer(0.7e-3), layer(5e-3)] {
        let run = |num_threads| {
            let options = AssemblyOptions { num_threads, ..Default::default() };
            assemble(&surface, &skin(response.clone()), &all(&surface), &options).expect("valid")
        };
        let one = run(Some(1));
        assert!(one == run(Some(2)) && one == run(Some(3)) && one == run(None));
    }
}

#[test]
fn a_subset_of_nodes_gives_the_block_of_the_full_matrix() {
    let surface = grid(9, 9e-3, 4e-3, 0.2);
    let full = matrix(&surface, &skin(HALF_SPACE), 1e-6);
    let nodes = [44, 3, 45, 99, 0];
    let options = AssemblyOptions::default();
    let part = assemble(&surface, &skin(HALF_SPACE), &nodes, &options).expect("valid");
    for (j, &b) in nodes.iter().enumerate() {
        for (i, &a) in nodes.iter().enumerate() {
            assert_relative_eq!(part[(i, j)], full[(a, b)], max_relative = 2e-6);
        }
    }
    let none = assemble(&surface, &skin(HALF_SPACE), &[], &options).expect("no nodes is no error");
    assert_eq!((none.nrows(), none.ncols()), (0, 0));
}

#[test]
fn slivers_and_spikes_keep_the_tolerance() {
    let skin = skin(HALF_SPACE);
    for (height, spike) in [(1e-3, 1.0), (1e-5, 1.0), (1e-8, 1.0), (1.0, 1e2), (1.0, 1e4), (1e-6, 1e3)] {
        let plain = grid(5, 5e-3, 1e-3, 0.2);
        let mut vertices = plain.vertices().to_vec();
        // One triangle of that height over its edge, one vertex drawn out by so many edges.
        let (at, near) = (14, 13);
        vertices[at] = vertices[near] + height * (vertices[at] - vertices[near]);
        vertices[28].z += spike * 1e-3;
        let surface = Surface::new(vertices, plain.faces().to_vec()).expect("slivers are welcome");
        let exact = naive_half_space(&surface, &skin, &all(&surface));
        for tolerance in [1e-4, 1e-6, 1e-9] {
            let found = matrix(&surface, &skin, tolerance);
            for j in 0..found.ncols() {
                for i in 0..found.nrows() {
                    let error = (found[(i, j)] / exact[(i, j)] - 1.0).abs();
                    assert!(error < tolerance, "{height} {spike} ({i}, {j}): {error:e} of {tolerance:e}");
                }
            }
        }
    }
}

#[test]
fn a_sliver_takes_no_longer_in_galerkin_form() {
    let plain = grid(5, 5e-3, 0.0, 0.0);
    for height in [1e-4, 1e-6, 1e-8] {
        let mut vertices = plain.vertices().to_vec();
        vertices[14] = vertices[13] + height * (vertices[14] - vertices[13]);
        let surface = Surface::new(vertices, plain.faces().to_vec()).expect("slivers are welcome");
        let start = std::time::Instant::now();
        let r = matrix(&surface, &galerkin(), 1e-6);
        // Where each point was integrated to the last digit this took minutes.
        assert!(start.elapsed().as_secs() < 20);
        assert!((0..r.ncols()).all(|j| (0..=j).all(|i| r[(i, j)] == r[(j, i)] && r[(i, j)] > 0.0)));
    }
}
