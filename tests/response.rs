//! The response matrix through the public interface: known answers, properties, twins, errors.

mod common;

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Vector3};
use quasirigid::lcp::{self, LcpMethod, LcpOptions, LcpProblem, LcpStatus};
use quasirigid::response::{
    AssemblyOptions, Discretization, Kernel, KernelSkin, LayerKernel, PressureBasis, ResponseError,
    Thickness, assemble, assemble_block, gaussian_hat_integrals, hat_integrals, matrix_bytes,
    pressure_average, spectrum,
};
use quasirigid::surface::Surface;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

const HALF_SPACE: Kernel = Kernel::HalfSpace;
const PAPER: Kernel = Kernel::GaussianCorrected { height: 0.8e-3, width: 5e-3, cutoff: 15e-3 };

/// Repeatable numbers in 0 .. 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A grid of (n + 1)² vertices with side `size` (m), one diagonal direction, bent to a bowl of height `bowl`
/// (m) and jittered in its plane by `jitter` cells.
fn grid(n: usize, size: f64, bowl: f64, jitter: f64) -> Surface {
    let mut random = Random(7);
    let h = size / n as f64;
    let mut vertices = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            let inner = i > 0 && j > 0 && i < n && j < n;
            let mut shift = || if inner { jitter * h * (2.0 * random.next() - 1.0) } else { 0.0 };
            let (x, y) = (i as f64 * h - 0.5 * size + shift(), j as f64 * h - 0.5 * size + shift());
            vertices.push(Vector3::new(x, y, bowl * (x * x + y * y) / (size * size)));
        }
    }
    Surface::new(vertices, common::one_way_faces(n)).expect("a grid is a valid surface")
}

fn skin(kernel: Kernel) -> KernelSkin {
    KernelSkin::new(60e3, 0.5, kernel).expect("valid constants")
}

fn all(surface: &Surface) -> Vec<usize> {
    (0..surface.vertices().len()).collect()
}

fn matrix(surface: &Surface, skin: &KernelSkin, tolerance: f64) -> faer::Mat<f64> {
    let options = AssemblyOptions { tolerance, ..Default::default() };
    assemble(surface, skin, &all(surface), None, &options).expect("a valid request")
}

/// The matrix by a plain double loop over the exact triangle integrals.
fn naive_half_space(surface: &Surface, skin: &KernelSkin, nodes: &[usize]) -> faer::Mat<f64> {
    let (points, faces) = (surface.vertices(), surface.faces());
    let pressure = skin.basis();
    faer::Mat::from_fn(nodes.len(), nodes.len(), |i, j| {
        let mut sum = 0.0;
        for &f in surface.faces_around(nodes[j]) {
            let corners = faces[f as usize].map(|v| points[v as usize]);
            let hats = hat_integrals(&points[nodes[i]], &corners);
            for (k, &v) in faces[f as usize].iter().enumerate() {
                sum += match pressure {
                    PressureBasis::Linear if v as usize == nodes[j] => hats[k],
                    PressureBasis::Linear => 0.0,
                    PressureBasis::OneRing => hats[k] / 3.0,
                };
            }
        }
        skin.kernel_constant() * sum / surface.vertex_areas()[nodes[j]]
    })
}

// ---- known answers ----

#[test]
fn kernel_constant_is_that_of_boussinesq() {
    assert_relative_eq!(skin(HALF_SPACE).kernel_constant(), 1.3263e-6, max_relative = 1e-4);
}

#[test]
fn a_hexagon_moves_its_own_centre_by_the_closed_form() {
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
    let linear = assemble(&surface, &skin(HALF_SPACE), &[0], None, &options).expect("valid");
    let expected = constant * 6.0 * 0.5 * height * 3f64.ln() / (area / 3.0);
    assert_relative_eq!(linear[(0, 0)], expected, max_relative = 1e-14);
    let one_ring = skin(HALF_SPACE).with_basis(PressureBasis::OneRing);
    let even = assemble(&surface, &one_ring, &[0], None, &options).expect("valid");
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

// ---- properties ----

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

// ---- twins ----

/// A surface squeezed to `factor` of its width, which makes slivers of its triangles.
fn squeezed(surface: &Surface, factor: f64) -> Surface {
    let vertices = surface.vertices().iter().map(|v| Vector3::new(v.x, factor * v.y, v.z)).collect();
    Surface::new(vertices, surface.faces().to_vec()).expect("slivers are welcome")
}

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

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let surface = grid(14, 14e-3, 4e-3, 0.2);
    for response in [HALF_SPACE, PAPER] {
        let run = |num_threads| {
            let options = AssemblyOptions { num_threads, ..Default::default() };
            assemble(&surface, &skin(response.clone()), &all(&surface), None, &options).expect("valid")
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
    let part = assemble(&surface, &skin(HALF_SPACE), &nodes, None, &options).expect("valid");
    for (j, &b) in nodes.iter().enumerate() {
        for (i, &a) in nodes.iter().enumerate() {
            assert_relative_eq!(part[(i, j)], full[(a, b)], max_relative = 2e-6);
        }
    }
    let none = assemble(&surface, &skin(HALF_SPACE), &[], None, &options).expect("no nodes is no error");
    assert_eq!((none.nrows(), none.ncols()), (0, 0));
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
fn patches_of_real_fingers_are_positive_definite_in_both_forms() {
    let Some(data) = common::data_dir() else { return };
    for name in ["libhand_right_middle_1500", "webxr_right_middle_1500", "makehuman_female_right_middle_1500"]
    {
        let (vertices, faces) = common::read_ply(&data.join(format!("hands/{name}.ply")));
        let surface = Surface::new(vertices, faces).expect("a good mesh");
        let nodes = pad_nodes(&surface, 150);
        let options = AssemblyOptions::default();
        for skin in [skin(HALF_SPACE), galerkin()] {
            let r = assemble(&surface, &skin, &nodes, None, &options).expect("valid");
            let found = spectrum(r.as_ref());
            assert!(found.is_positive_definite() && found.condition < 1e3, "{name}: {found:?}");
            println!("{name}: {found:?}");
        }
    }
}

// ---- the weighted form ----

fn galerkin() -> KernelSkin {
    skin(HALF_SPACE).with_discretization(Discretization::Galerkin).expect("a half-space has it")
}

#[test]
fn weighted_matrices_are_symmetric_positive_definite_on_any_mesh() {
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
fn weighted_entries_of_a_refined_grid_add_up_to_those_of_the_grid() {
    // A hat is a sum of the hats of the mesh with halved edges, and the energy is bilinear:
    // S_i S_j R_ij = Σ_kl hat_i(x_k) hat_j(x_l) s_k s_l r_kl, with no discretisation error at all.
    let n = 4;
    let (coarse, fine) = (grid(n, 4e-3, 0.0, 0.0), grid(2 * n, 4e-3, 0.0, 0.0));
    let (big, small) = (matrix(&coarse, &galerkin(), 1e-9), matrix(&fine, &galerkin(), 1e-9));
    let hat = |i: usize, k: usize| {
        let fine_place = [(k / (2 * n + 1)) as f64, (k % (2 * n + 1)) as f64];
        let (a, b) = (fine_place[0] - 2.0 * (i / (n + 1)) as f64, fine_place[1] - 2.0 * (i % (n + 1)) as f64);
        // the diagonals run along (1, 1)
        (1.0 - 0.5 * a.abs().max(b.abs()).max((a - b).abs())).max(0.0)
    };
    let mut worst: f64 = 0.0;
    for i in 0..big.nrows() {
        for j in 0..=i {
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
            let error = (big[(i, j)] / expected - 1.0).abs();
            // border hats end with a jump, where the outer rule converges more slowly
            worst = worst.max(error);
            assert!(error < 1e-6, "({i}, {j}): {error:e}");
        }
    }
    println!("worst relative error {worst:e}");
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

// ---- the layer ----

fn layer(thickness: f64) -> Kernel {
    Kernel::Layer { thickness: thickness.into() }
}

/// Vertices of a [`grid`] of n² cells that are not on its border.
fn inner_vertices(n: usize) -> Vec<usize> {
    let inner = |v: &usize| [v / (n + 1), v % (n + 1)].iter().all(|&i| i > 0 && i < n);
    (0..(n + 1) * (n + 1)).filter(inner).collect()
}

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
    let solution = lcp::solve(&problem, LcpMethod::Auto, &LcpOptions::default()).expect("valid");
    assert_eq!(solution.status, LcpStatus::Solved);
    let force: f64 = solution.z.iter().sum();
    let hertz = 4.0 / 3.0 * (2.0 * 60e3 / 0.5) * radius.sqrt() * depth.powf(1.5);
    assert_relative_eq!(force / hertz, case.force_ratio, max_relative = 5e-3);
}

#[test]
fn thicknesses_are_checked() {
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.5, layer(0.0))), ("thickness", 0.0));
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.5, layer(-1e-3))), ("thickness", -1e-3));
    let response = Kernel::Layer { thickness: Thickness::PerVertex(vec![1e-3; 5].into()) };
    let surface = grid(3, 3e-3, 0.0, 0.0);
    let refused = assemble(&surface, &skin(response), &[0], None, &AssemblyOptions::default());
    assert_eq!(
        refused.expect_err("too short"),
        ResponseError::ThicknessCount { thicknesses: 5, vertex_count: 16 }
    );
    // metres taken for micrometres, everywhere and at one vertex
    let mut list = vec![1e-3; 16];
    list[7] = 1e-8;
    for (thickness, vertex) in [(Thickness::from(1e-8), 0), (Thickness::PerVertex(list.into()), 7)] {
        let skin = skin(Kernel::Layer { thickness });
        let refused = assemble(&surface, &skin, &[0], None, &AssemblyOptions::default());
        let edge_length = surface.mean_edge_length();
        let expected = ResponseError::TooThin { vertex, thickness: 1e-8, edge_length };
        assert_eq!(refused.expect_err("too thin"), expected);
        assert!(expected.to_string().contains("in metres"));
    }
    let thinnest = skin(layer(1.01e-3 * surface.mean_edge_length()));
    let found =
        assemble(&surface, &thinnest, &[0, 5], None, &AssemblyOptions::default()).expect("thick enough");
    assert!(found[(0, 0)] > 0.0 && found[(1, 1)] > 0.0);
}

// ---- errors ----

fn constant_error(result: Result<KernelSkin, ResponseError>) -> (&'static str, f64) {
    match result {
        Err(ResponseError::Constant { name, value, .. }) => (name, value),
        other => panic!("expected a refused constant, found {other:?}"),
    }
}

#[test]
fn constants_out_of_range_are_named_with_their_value() {
    assert_eq!(constant_error(KernelSkin::new(0.0, 0.5, HALF_SPACE)), ("shear_modulus", 0.0));
    assert_eq!(constant_error(KernelSkin::new(-1.0, 0.5, HALF_SPACE)), ("shear_modulus", -1.0));
    assert_eq!(constant_error(KernelSkin::new(f64::NAN, 0.5, HALF_SPACE)).0, "shear_modulus");
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.51, HALF_SPACE)), ("poisson_ratio", 0.51));
    assert_eq!(constant_error(KernelSkin::new(60e3, -0.1, HALF_SPACE)), ("poisson_ratio", -0.1));
    let gaussian = |height, width, cutoff| {
        KernelSkin::new(60e3, 0.5, Kernel::GaussianCorrected { height, width, cutoff })
    };
    assert_eq!(constant_error(gaussian(-1e-3, 5e-3, 15e-3)), ("height", -1e-3));
    assert_eq!(constant_error(gaussian(1e-3, 0.0, 15e-3)), ("width", 0.0));
    assert_eq!(constant_error(gaussian(1e-3, 5e-3, -1.0)), ("cutoff", -1.0));
    assert!(gaussian(1e-3, 5e-3, f64::INFINITY).is_ok());
}

#[test]
fn malformed_requests_say_what_is_wrong_and_where() {
    let surface = grid(3, 3e-3, 0.0, 0.0);
    let ask = |nodes: &[usize], directions: Option<&[Vector3<f64>]>, options: AssemblyOptions| {
        assemble(&surface, &skin(HALF_SPACE), nodes, directions, &options).expect_err("malformed")
    };
    let plain = AssemblyOptions::default();
    assert_eq!(
        ask(&[1, 16], None, plain),
        ResponseError::NodeOutOfRange { index: 1, vertex: 16, vertex_count: 16 }
    );
    assert_eq!(ask(&[4, 2, 4], None, plain), ResponseError::RepeatedNode { vertex: 4, first: 0, second: 2 });
    let up = Vector3::z();
    assert_eq!(ask(&[4, 2], Some(&[up]), plain), ResponseError::DirectionCount { directions: 1, nodes: 2 });
    assert_eq!(
        ask(&[4, 2], Some(&[up, Vector3::zeros()]), plain),
        ResponseError::Direction { index: 1, value: [0.0; 3] }
    );
    let small = AssemblyOptions { memory_limit: Some(100), ..plain };
    assert_eq!(matrix_bytes(4, 4), 128);
    assert_eq!(ask(&[0, 1, 2, 3], None, small), ResponseError::TooLarge { nodes: 4, bytes: 128, limit: 100 });
    for (options, name) in [
        (AssemblyOptions { tolerance: -1.0, ..plain }, "tolerance"),
        (AssemblyOptions { tolerance: f64::NAN, ..plain }, "tolerance"),
        (AssemblyOptions { num_threads: Some(0), ..plain }, "num_threads"),
    ] {
        match ask(&[0], None, options) {
            ResponseError::Constant { name: found, .. } => assert_eq!(found, name),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn an_interrupted_assembly_says_how_far_it_came() {
    let surface = grid(14, 14e-3, 0.0, 0.0);
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) == 1;
    let options = AssemblyOptions { num_threads: Some(1), interrupt: Some(&stop), ..Default::default() };
    let result = assemble(&surface, &skin(HALF_SPACE), &all(&surface), None, &options);
    assert_eq!(result.expect_err("stopped"), ResponseError::Interrupted { columns: 64, nodes: 225 });
}
