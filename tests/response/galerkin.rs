//! The Galerkin form.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::response::{Discretization, PressureBasis, pressure_average, spectrum};

use super::*;

#[test]
fn galerkin_matrices_are_symmetric_positive_definite_on_any_mesh() {
    for surface in [
        grid(8, 8e-3, 0.0, 0.45),
        grid(7, 7e-3, 4e-3, 0.45),
        squeezed(&grid(4, 4e-3, 0.0, 0.3), 1e-1),
        squeezed(&grid(3, 3e-3, 0.0, 0.3), 1e-3),
    ] {
        let r = matrix(&surface, &galerkin(), 1e-6);
        assert!((0..r.ncols()).all(|j| (0..j).all(|i| r[(i, j)] == r[(j, i)])));
        let found = spectrum(r.as_ref());
        assert!(found.is_positive_definite() && found.smallest > 0.0, "{found:?}");
    }
}

#[test]
fn galerkin_entries_do_not_hang_on_which_corner_of_a_triangle_comes_first() {
    let surface = grid(6, 6e-3, 2e-3, 0.4);
    let turned = (0..).zip(surface.faces()).map(|(k, &corners)| {
        let mut corners = corners;
        corners.rotate_left(k % 3);
        corners
    });
    let turned = Surface::new(surface.vertices().to_vec(), turned.collect()).expect("a valid surface");
    let [one, other] = [&surface, &turned].map(|surface| matrix(surface, &galerkin(), 1e-6));
    let difference = (&one - &other).norm_max();
    // A rule of this tolerance, collapsed at another corner, moves entries by some 5e-7.
    assert!(difference < 1e-9 * one.norm_max(), "{:e}", difference / one.norm_max());
}

#[test]
fn galerkin_entries_of_a_refined_grid_add_up_to_those_of_the_grid() {
    // A hat is a sum of the hats of the mesh with halved edges, and the energy is bilinear:
    // S_i S_j R_ij = Σ_kl hat_i(x_k) hat_j(x_l) s_k s_l r_kl, with no discretisation error at all.
    let n = 4;
    let (coarse, fine) = (grid(n, 4e-3, 0.0, 0.0), grid(2 * n, 4e-3, 0.0, 0.0));
    let hat = |i: usize, k: usize| {
        let fine_place = [(k / (2 * n + 1)) as f64, (k % (2 * n + 1)) as f64];
        let (a, b) = (fine_place[0] - 2.0 * (i / (n + 1)) as f64, fine_place[1] - 2.0 * (i % (n + 1)) as f64);
        // the diagonals run along (1, 1)
        (1.0 - 0.5 * a.abs().max(b.abs()).max((a - b).abs())).max(0.0)
    };
    let scale = matrix(&coarse, &galerkin(), 1e-9);
    let of_layer = |cells: f64| {
        let layer = skin(layer(cells * 1e-3));
        layer.with_discretization(Discretization::Galerkin).expect("a layer has it")
    };
    for skin in [galerkin(), of_layer(2.0), of_layer(5.0)] {
        let (big, small) = (matrix(&coarse, &skin, 1e-9), matrix(&fine, &skin, 1e-9));
        for (i, j) in (0..big.nrows()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let mut sum = 0.0;
            for k in 0..small.nrows() {
                for l in 0..small.ncols() {
                    let share = hat(i, k) * hat(j, l);
                    if share > 0.0 {
                        sum += share * fine.vertex_areas()[k] * fine.vertex_areas()[l] * small[(k, l)];
                    }
                }
            }
            let expected = sum / (coarse.vertex_areas()[i] * coarse.vertex_areas()[j]);
            let error = (big[(i, j)] - expected).abs() / scale[(i, j)];
            // the tolerance of both
            assert!(error < 2e-9, "({i}, {j}): {error:e}");
        }
    }
}

#[test]
fn galerkin_entries_keep_looser_tolerances_and_stay_definite() {
    for surface in [grid(10, 10e-3, 0.0, 0.0), grid(10, 10e-3, 0.0, 0.3), grid(8, 8e-3, 4e-3, 0.45)] {
        let exact = matrix(&surface, &galerkin(), 1e-9);
        for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
            let r = matrix(&surface, &galerkin(), tolerance);
            for (j, i) in (0..r.ncols()).flat_map(|j| (0..r.nrows()).map(move |i| (j, i))) {
                let error = (r[(i, j)] / exact[(i, j)] - 1.0).abs();
                assert!(error <= tolerance, "({i}, {j}) at {tolerance:e}: {error:e}");
                assert_eq!(r[(i, j)], r[(j, i)]);
            }
            assert!(spectrum(r.as_ref()).is_positive_definite(), "{tolerance:e}");
        }
    }
}

#[test]
fn an_average_against_a_node_s_pressure_is_exact_for_quadratic_fields() {
    let surface = grid(6, 6e-3, 2e-3, 0.3);
    let points = surface.vertices();
    let fields: [fn(&Vector3<f64>) -> f64; 3] =
        [|_| 1.0, |p| p.x, |p| p.x * p.x + p.y * p.z - 2.0 * p.z * p.z];
    // Gauss's rule of degree 3 with weights -27/48 and 25/48 (Strang and Fix 1973)
    let rule = [[1.0 / 3.0; 3], [0.6, 0.2, 0.2], [0.2, 0.6, 0.2], [0.2, 0.2, 0.6]];
    let weights = [-27.0 / 48.0, 25.0 / 48.0, 25.0 / 48.0, 25.0 / 48.0];
    for (field, pressure) in
        fields.iter().flat_map(|field| [(field, PressureBasis::Linear), (field, PressureBasis::OneRing)])
    {
        let at_vertices: Vec<f64> = points.iter().map(field).collect();
        let at_middle = |a: u32, b: u32| field(&(0.5 * (points[a as usize] + points[b as usize])));
        for vertex in all(&surface) {
            let (mut sum, mut total) = (0.0, 0.0);
            for &face in surface.faces_around(vertex) {
                let corners = surface.faces()[face as usize].map(|v| v as usize);
                let own = corners.iter().position(|&v| v == vertex).expect("a corner");
                for (l, weight) in rule.iter().zip(weights) {
                    let at =
                        points[corners[0]] * l[0] + points[corners[1]] * l[1] + points[corners[2]] * l[2];
                    let load = if pressure == PressureBasis::Linear { l[own] } else { 1.0 };
                    let share = surface.face_areas()[face as usize] * weight * load;
                    sum += share * field(&at);
                    total += share;
                }
            }
            let found = pressure_average(&surface, pressure, vertex, |v| at_vertices[v as usize], at_middle);
            assert_relative_eq!(found, sum / total, max_relative = 1e-12, epsilon = 1e-18);
        }
    }
}
