//! Entries of the elastic layer.

use approx::assert_relative_eq;
use quasirigid::lcp::{self, LcpMethod, LcpOptions, LcpProblem, LcpStatus};
use quasirigid::response::{
    AssemblyOptions, Kernel, KernelSkin, LayerKernel, Thickness, assemble_block, hat_integrals,
};
use quasirigid::surface::Surface;

use super::*;

/// Smallest and largest eigenvalue of the symmetric part, entries scaled by the vertex areas so that the
/// answer does not depend on the size of border triangles.
fn extreme_eigenvalues(surface: &Surface, r: &faer::Mat<f64>) -> (f64, f64) {
    let area = surface.vertex_areas();
    let symmetric = faer::Mat::from_fn(r.nrows(), r.ncols(), |i, j| {
        0.5 * (r[(i, j)] + r[(j, i)]) * (area[i] * area[j]).sqrt()
    });
    let values = symmetric.self_adjoint_eigenvalues(faer::Side::Lower).expect("converges");
    (values[0], values[values.len() - 1])
}

#[test]
fn layer_matrix_equals_the_double_loop_with_fine_quadrature() {
    let surface = grid(8, 8e-3, 2e-3, 0.25);
    let half_space = naive_half_space(&surface, &skin(HALF_SPACE), &all(&surface));
    let (points, faces) = (surface.vertices(), surface.faces());
    let gauss = [(-0.774596669241483f64, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774596669241483, 5.0 / 9.0)];
    for thickness in [0.4e-3, 2e-3, 10e-3] {
        let kernel = LayerKernel::new(0.5).expect("in range");
        let smooth = |i: usize, j: usize| {
            // 3 x 3 points on 20² parallelogram cells folded into the triangle
            let mut sum = 0.0;
            for &f in surface.faces_around(j) {
                let face = faces[f as usize];
                let k = face.iter().position(|&v| v as usize == j).expect("its own face");
                let c = [k, (k + 1) % 3, (k + 2) % 3].map(|k| points[face[k] as usize]);
                let area = 0.5 * (c[1] - c[0]).cross(&(c[2] - c[0])).norm();
                let cells = 20;
                for a in 0..cells {
                    for (s, w) in gauss {
                        let u = (a as f64 + 0.5 + 0.5 * s) / cells as f64;
                        for b in 0..cells {
                            for (t, v) in gauss {
                                let along = (b as f64 + 0.5 + 0.5 * t) / cells as f64;
                                let y = c[0] * (1.0 - u) + (c[1] * (1.0 - along) + c[2] * along) * u;
                                let weight = 2.0 * area * u * w * v / 4.0 / (cells * cells) as f64;
                                sum += weight
                                    * (1.0 - u)
                                    * kernel.smooth_part((points[i] - y).norm() / thickness);
                            }
                        }
                    }
                }
            }
            sum / thickness / surface.vertex_areas()[j]
        };
        let constant = skin(HALF_SPACE).kernel_constant();
        for tolerance in [1e-3, 1e-6] {
            let r = matrix(&surface, &skin(layer(thickness)), tolerance);
            for j in [0, 13, 40, 57] {
                for i in inner_vertices(8) {
                    let expected = half_space[(i, j)] - constant * smooth(i, j);
                    let error = (r[(i, j)] - expected).abs() / half_space[(i, j)];
                    assert!(error < tolerance.max(2e-7), "({i}, {j}) at {thickness}: {error:e}");
                }
            }
        }
    }
}

/// The layer's displacement at x per newton at a vertex, and its 1/r part: 5 × 5 Gauss points on `cells`² cells of
/// each triangle for the smooth part.
fn layer_by_quadrature(
    surface: &Surface,
    skin: &KernelSkin,
    thickness: f64,
    (i, j): (usize, usize),
    cells: usize,
) -> (f64, f64) {
    let kernel = LayerKernel::new(skin.poisson_ratio()).expect("in range");
    let gauss = [
        (-0.906179845938664f64, 0.236926885056189),
        (-0.538469310105683, 0.478628670499366),
        (0.0, 0.568888888888889),
        (0.538469310105683, 0.478628670499366),
        (0.906179845938664, 0.236926885056189),
    ];
    let points: Vec<(f64, f64)> = (0..cells)
        .flat_map(|c| gauss.map(|(s, w)| ((c as f64 + 0.5 + 0.5 * s) / cells as f64, 0.5 * w / cells as f64)))
        .collect();
    let x = surface.vertices()[i];
    let (mut inverse, mut smooth) = (0.0, 0.0);
    for &f in surface.faces_around(j) {
        let face = surface.faces()[f as usize];
        let k = face.iter().position(|&v| v as usize == j).expect("its own face");
        let c = [k, (k + 1) % 3, (k + 2) % 3].map(|k| surface.vertices()[face[k] as usize]);
        inverse += hat_integrals(&x, &c)[0];
        for &(u, v) in &points {
            for &(along, w) in &points {
                let y = c[0] * (1.0 - u) + (c[1] * (1.0 - along) + c[2] * along) * u;
                let weight = 2.0 * surface.face_areas()[f as usize] * u * v * w;
                smooth += weight * (1.0 - u) * kernel.smooth_part((x - y).norm() / thickness);
            }
        }
    }
    let scale = skin.kernel_constant() / surface.vertex_areas()[j];
    (scale * (inverse - smooth / thickness), scale * inverse)
}

#[test]
fn layer_entries_keep_each_tolerance_near_and_far_for_thin_and_thick_layers() {
    let surface = grid(24, 24e-3, 8e-3, 0.25);
    let columns = [0, 12, 13 * 25 + 11];
    // on the border a thin layer is looked at a little inside
    let rows: Vec<usize> = inner_vertices(24).into_iter().step_by(3).collect();
    for (nu, thickness, cells) in [
        (0.5, 0.15e-3, 20),
        (0.5, 1e-3, 5),
        (0.5, 4e-3, 3),
        (0.3, 0.4e-3, 10),
        (0.3, 10e-3, 3),
        (0.5, 0.1, 2),
    ] {
        let skin = KernelSkin::new(60e3, nu, layer(thickness)).expect("valid constants");
        let known: Vec<Vec<(f64, f64)>> = columns
            .iter()
            .map(|&j| {
                rows.iter().map(|&i| layer_by_quadrature(&surface, &skin, thickness, (i, j), cells)).collect()
            })
            .collect();
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let options = AssemblyOptions { tolerance, ..Default::default() };
            let r = assemble_block(&surface, &skin, &rows, &columns, &options).expect("valid");
            for (j, column) in known.iter().enumerate() {
                for (i, (expected, inverse)) in column.iter().enumerate() {
                    let error = (r[(i, j)] - expected).abs() / inverse;
                    assert!(error <= tolerance, "({i}, {j}) at {thickness}, {tolerance:e}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn a_pair_of_nodes_answers_as_a_uniform_layer_of_the_smaller_of_their_thicknesses() {
    let surface = grid(14, 14e-3, 4e-3, 0.25);
    let mut random = Random(5);
    let list: Vec<f64> = surface.vertices().iter().map(|_| 0.6e-3 * 30f64.powf(random.next())).collect();
    let varying = skin(Kernel::Layer { thickness: Thickness::PerVertex(list.clone().into()) });
    let rows = inner_vertices(14);
    let half_space = skin(HALF_SPACE);
    for tolerance in [1e-3, 1e-6] {
        let options = AssemblyOptions { tolerance, ..Default::default() };
        for j in [16, 7 * 15 + 6, 7 * 15 + 7, 9 * 15 + 11] {
            let block = |skin: &KernelSkin, rows: &[usize]| {
                assemble_block(&surface, skin, rows, &[j], &options).expect("valid")
            };
            let (found, scale) = (block(&varying, &rows), block(&half_space, &rows));
            for (row, &i) in rows.iter().enumerate() {
                let uniform = block(&skin(layer(list[i].min(list[j]))), &[i])[(0, 0)];
                let error = (found[(row, 0)] - uniform).abs() / scale[(row, 0)];
                assert!(error <= 2.0 * tolerance, "({i}, {j}) at {tolerance:e}: {error:e}");
            }
        }
    }
}

#[test]
fn layer_entries_do_not_change_with_the_unit_of_length() {
    let surface = grid(12, 12e-3, 3e-3, 0.25);
    let large = surface.with_vertices(surface.vertices().iter().map(|x| x * 1e3).collect());
    for thickness in [0.5e-3, 3e-3] {
        let (small, large) = (
            matrix(&surface, &skin(layer(thickness)), 1e-6),
            matrix(&large, &skin(layer(1e3 * thickness)), 1e-6),
        );
        let half_space = matrix(&surface, &skin(HALF_SPACE), 1e-6);
        for (j, i) in (0..small.ncols()).flat_map(|j| (0..small.nrows()).map(move |i| (j, i))) {
            let error = (1e3 * large[(i, j)] - small[(i, j)]).abs();
            assert!(error < 1e-10 * half_space[(i, j)], "({i}, {j}) at {thickness}");
        }
    }
}

#[test]
fn a_layer_of_varying_thickness_is_positive_definite() {
    let surface = grid(9, 9e-3, 0.0, 0.2);
    let mut random = Random(3);
    // 1 to 6 mm in steps from vertex to vertex, far rougher than any hand
    let list: Vec<f64> = surface.vertices().iter().map(|_| 1e-3 + 5e-3 * random.next()).collect();
    let response = Kernel::Layer { thickness: Thickness::PerVertex(list.into()) };
    let (least, largest) = extreme_eigenvalues(&surface, &matrix(&surface, &skin(response), 1e-4));
    assert!(least > 0.0, "{least:e} of {largest:e}");
}

#[test]
fn a_thick_layer_is_the_half_space() {
    let surface = grid(8, 8e-3, 2e-3, 0.2);
    let half_space = matrix(&surface, &skin(HALF_SPACE), 1e-9);
    let mut before = f64::INFINITY;
    for thickness in [0.1, 1.0, 10.0, 100.0] {
        let r = matrix(&surface, &skin(layer(thickness)), 1e-9);
        let mut worst: f64 = 0.0;
        for j in 0..r.ncols() {
            for i in 0..r.nrows() {
                worst = worst.max((r[(i, j)] / half_space[(i, j)] - 1.0).abs());
            }
        }
        // φ(0) r / h at the far corner of the grid
        assert!(worst < 1.8 * 12e-3 / thickness && worst < 0.2 * before, "{thickness}: {worst:e}");
        before = worst;
    }
}

#[test]
fn an_incompressible_layer_displaces_no_net_volume() {
    // hats sum to 1 on a regular grid, so that the sum over nodes is exact up to the grid's finite width
    let n = 80;
    let surface = grid(n, 80e-3, 0.0, 0.0);
    let center = (n / 2) * (n + 1) + n / 2;
    let skin = skin(layer(2e-3));
    let options = AssemblyOptions { tolerance: 1e-9, ..Default::default() };
    let column = assemble_block(&surface, &skin, &all(&surface), &[center], &options).expect("valid");
    let (mut net, mut gross) = (0.0, 0.0);
    for (i, area) in surface.vertex_areas().iter().enumerate() {
        net += area * column[(i, 0)];
        gross += area * column[(i, 0)].abs();
    }
    assert!(net.abs() < 1e-6 * gross, "{net:e} of {gross:e}");
    // and it fades exponentially
    let at = |steps: usize| column[(center + steps, 0)].abs();
    assert!(at(20) < 2e-3 * at(4) && at(36) < 4e-3 * at(20));
}

#[test]
fn a_sphere_on_an_incompressible_layer_needs_the_known_force() {
    // parabolic gap, d/R = 1e-3, 8 cells per √(R d); the LCP on all nodes that can come into contact
    let (radius, depth) = (0.2, 0.2e-3f64);
    let scale = (radius * depth).sqrt();
    let known = quasirigid::reference::sphere_on_layer();
    let case = known.iter().find(|case| (case.thinness - 0.5).abs() < 1e-12).expect("chi = 0.5");
    let n = 26;
    let surface = grid(n, n as f64 * scale / 8.0, 0.0, 0.0);
    let r = matrix(&surface, &skin(layer(scale / case.thinness)), 1e-6);
    let gap: Vec<f64> =
        surface.vertices().iter().map(|v| (v.x * v.x + v.y * v.y) / (2.0 * radius) - depth).collect();
    let problem = LcpProblem::new(r.as_ref(), &gap).expect("shaped");
    let solution = lcp::solve(&problem, &LcpMethod::default(), &LcpOptions::default()).expect("valid");
    assert_eq!(solution.status, LcpStatus::Solved);
    let force: f64 = solution.z.iter().sum();
    let hertz = 4.0 / 3.0 * (2.0 * 60e3 / 0.5) * radius.sqrt() * depth.powf(1.5);
    assert_relative_eq!(force / hertz, case.force_ratio, max_relative = 5e-3);
}
