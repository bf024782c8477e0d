//! The elastic layer: definite matrices, sphere indentation, what the definiteness check says.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::contact::{ContactOptions, ContactStatus, solve_contact};
use quasirigid::obstacle::Obstacle;
use quasirigid::reference::sphere_on_layer;
use quasirigid::response::{
    AssemblyOptions, Discretization, Kernel, KernelSkin, Thickness, assemble, net_volume, spectrum,
};
use quasirigid::surface::Surface;

use crate::common::{self, Random, jittered_grid, surface};

const CELL: f64 = 1e-3;

fn skin(poisson_ratio: f64, thickness: impl Into<Thickness>, discretization: Discretization) -> KernelSkin {
    let skin = KernelSkin::new(60e3, poisson_ratio, Kernel::Layer { thickness: thickness.into() });
    let skin = skin.expect("valid constants");
    skin.with_discretization(discretization).expect("a layer has both")
}

/// A flat skin of `cells`² cells with its inner vertices moved by up to `jitter` cells.
fn flat(cells: usize, spacing: f64, jitter: f64) -> Surface {
    surface(jittered_grid(cells, spacing, jitter, &mut Random(11)))
}

/// Smallest over largest eigenvalue of the symmetric part over all vertices, borders included.
fn smallest_share(surface: &Surface, skin: &KernelSkin) -> f64 {
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let r = assemble(surface, skin, &nodes, &AssemblyOptions::default()).expect("valid");
    assert!((0..r.ncols()).all(|j| (0..r.nrows()).all(|i| r[(i, j)].is_finite())));
    let symmetric = faer::Mat::from_fn(r.nrows(), r.ncols(), |i, j| 0.5 * (r[(i, j)] + r[(j, i)]));
    let values = symmetric.self_adjoint_eigenvalues(faer::Side::Lower).expect("converges");
    values[0] / values[values.len() - 1]
}

#[test]
fn layers_of_any_thickness_and_ratio_are_positive_definite_up_to_open_borders() {
    for surface in [flat(10, CELL, 0.0), flat(10, CELL, 0.3)] {
        for poisson_ratio in [0.0, 0.3, 0.49, 0.5] {
            for cells in [0.1, 0.3, 0.6, 1.0, 3.0, 10.0, 100.0] {
                let found =
                    smallest_share(&surface, &skin(poisson_ratio, cells * CELL, Discretization::Collocation));
                // a thin incompressible layer answers long waves by (kh)² of short ones, down to 0.01
                assert!(found > 1e-3, "ratio {poisson_ratio}, thickness {cells} cells: {found:e}");
            }
        }
    }
}

#[test]
fn galerkin_layers_are_symmetric_positive_definite_on_flat_meshes_of_any_shape() {
    let surface = flat(5, CELL, 0.45);
    for poisson_ratio in [0.0, 0.3, 0.5] {
        for cells in [0.1, 1.0, 10.0] {
            let skin = skin(poisson_ratio, cells * CELL, Discretization::Galerkin);
            let found = smallest_share(&surface, &skin);
            assert!(found > 1e-3, "ratio {poisson_ratio}, thickness {cells} cells: {found:e}");
        }
    }
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let mut random = Random(3);
    let varying: Vec<f64> = nodes.iter().map(|_| CELL * (0.5 + 3.0 * random.next())).collect();
    let skin = skin(0.5, Thickness::PerVertex(varying.into()), Discretization::Galerkin);
    let r = assemble(&surface, &skin, &nodes, &AssemblyOptions::default()).expect("valid");
    assert!((0..r.ncols()).all(|j| (0..j).all(|i| r[(i, j)] == r[(j, i)])));
    let found = spectrum(r.as_ref());
    assert!(found.is_positive_definite() && found.smallest > 0.0, "{found:?}");
}

#[test]
fn a_thick_galerkin_layer_is_the_galerkin_half_space() {
    let surface = flat(5, CELL, 0.3);
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let options = AssemblyOptions::default();
    let half_space = KernelSkin::new(60e3, 0.5, Kernel::HalfSpace).expect("valid constants");
    let half_space = half_space.with_discretization(Discretization::Galerkin).expect("it has both");
    let limit = assemble(&surface, &half_space, &nodes, &options).expect("valid");
    for thickness in [1.0, 10.0] {
        let r = assemble(&surface, &skin(0.5, thickness, Discretization::Galerkin), &nodes, &options)
            .expect("valid");
        for j in 0..r.ncols() {
            for i in 0..r.nrows() {
                // 1/r - φ(0)/h, φ(0) = 1.7702, up to (r/h)²
                let expected = limit[(i, j)] - half_space.kernel_constant() * 1.7702 / thickness;
                assert_relative_eq!(
                    r[(i, j)],
                    expected,
                    max_relative = 2e-6 + (10.0 * CELL / thickness).powi(2)
                );
            }
        }
    }
}

#[test]
fn galerkin_layers_keep_the_tolerance_of_the_half_space_s_entries() {
    let surface = flat(6, CELL, 0.25);
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let matrix = |skin: &KernelSkin, tolerance| {
        let options = AssemblyOptions { tolerance, ..AssemblyOptions::default() };
        assemble(&surface, skin, &nodes, &options).expect("valid")
    };
    let half_space = KernelSkin::new(60e3, 0.45, Kernel::HalfSpace).expect("valid constants");
    let half_space = half_space.with_discretization(Discretization::Galerkin).expect("it has both");
    let scale = matrix(&half_space, 1e-6);
    let layer = |cells: f64| skin(0.45, cells * CELL, Discretization::Galerkin);
    let assert_close = |found: &faer::Mat<f64>, expected: &dyn Fn(usize, usize) -> f64, tolerance: f64| {
        for (j, i) in (0..nodes.len()).flat_map(|j| (0..nodes.len()).map(move |i| (j, i))) {
            let error = (found[(i, j)] - expected(i, j)).abs() / scale[(i, j)];
            assert!(error < tolerance, "({i}, {j}) at {tolerance:e}: {error:e}");
        }
    };
    for cells in [0.3, 2.0, 5.0, 8.0] {
        let exact = matrix(&layer(cells), 1e-10);
        for tolerance in [1e-4, 1e-5, 1e-6] {
            assert_close(&matrix(&layer(cells), tolerance), &|i, j| exact[(i, j)], tolerance);
        }
    }
    // Of two nodes the thinner layer counts, whichever is the column.
    let is_thin = |node: usize| surface.vertices()[node].x < surface.vertices()[nodes.len() / 2].x;
    let cells = |node: usize| if is_thin(node) { 0.3 * CELL } else { 8.0 * CELL };
    let varying: Vec<f64> = nodes.iter().map(|&node| cells(node)).collect();
    let varying = skin(0.45, Thickness::PerVertex(varying.into()), Discretization::Galerkin);
    let [thin, thick] = [0.3, 8.0].map(|cells| matrix(&layer(cells), 1e-10));
    let expected = |i, j| if is_thin(i) || is_thin(j) { thin[(i, j)] } else { thick[(i, j)] };
    assert_close(&matrix(&varying, 1e-6), &expected, 1e-6);
}

#[test]
fn an_incompressible_layer_displaces_no_net_volume_on_flat_meshes_of_any_shape() {
    // regular, alternating and jittered triangles; the kernel fades as exp(-0.76 r / h)
    for (cells, jitter, thickness) in [(44, 0.0, 1.0), (44, 0.3, 1.0), (50, 0.2, 0.5), (64, 0.3, 1.5)] {
        let surface = flat(cells, CELL, jitter);
        let options = AssemblyOptions { tolerance: 1e-9, ..Default::default() };
        let skin = skin(0.5, thickness * CELL, Discretization::Collocation);
        let volume = net_volume(&surface, &skin, cells / 2 * (cells + 2), &options).expect("valid");
        assert!(volume.net.abs() < 1e-6 * volume.gross, "{cells}, {jitter}, {thickness}: {volume:?}");
    }
}

#[test]
fn both_discretizations_agree_where_the_layer_is_thick_for_its_mesh() {
    let surface = flat(8, CELL, 0.0);
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let options = AssemblyOptions::default();
    let block = |gap| assemble(&surface, &skin(0.5, 3.0 * CELL, gap), &nodes, &options).expect("valid");
    let (collocation, galerkin) = (block(Discretization::Collocation), block(Discretization::Galerkin));
    let constant = skin(0.5, 1.0, Discretization::Collocation).kernel_constant();
    // seen from four cells away a hat acts through its second moments: (cell / distance)² / 12 or so
    let (middle, far) = (4 * 9 + 4, 4 * 9 + 8);
    let error = (collocation[(far, middle)] - galerkin[(far, middle)]).abs();
    assert!(error < 0.02 * constant / (4.0 * CELL), "{error:e}");
}

/// Force of a sphere R = 200 mm pressed 0.5 mm into a layer, over Hertz's, with `cells` per √(R d).
fn force_ratio(thinness: f64, cells: usize) -> f64 {
    let (radius, depth) = (0.2, 0.5e-3f64);
    let scale = (radius * depth).sqrt();
    // all that can touch: the penetrating disc of radius √2 √(R d), and some rings
    let surface = flat(3 * cells + 6, scale / cells as f64, 0.0);
    let middle = 0.5 * (3 * cells + 6) as f64 * scale / cells as f64;
    let sphere = Obstacle::sphere(Vector3::new(middle, middle, radius - depth), radius).expect("valid");
    let skin = skin(0.5, scale / thinness, Discretization::Collocation);
    let contact = solve_contact(&surface, &sphere, &skin, &ContactOptions::on_given_mesh()).expect("valid");
    assert_eq!(contact.status, ContactStatus::Solved);
    let modulus = 2.0 * 60e3 / 0.5;
    contact.resultant.force.norm() / (4.0 / 3.0 * modulus * radius.sqrt() * depth.powf(1.5))
}

#[test]
fn a_sphere_on_an_incompressible_layer_needs_the_known_force_through_the_pipeline() {
    for case in sphere_on_layer() {
        // a mesh error of some 0.1 % at 8 cells, the rounding of the tabulated ratios, and the true sphere
        assert_relative_eq!(force_ratio(case.thinness, 8), case.force_ratio, max_relative = 3e-3);
    }
}

#[test]
fn a_pad_bent_within_the_layers_reach_is_found_indefinite() {
    let Some(data) = common::data_dir() else { return };
    let surface = surface(common::read_ply(&data.join("hands/libhand_right_middle_1500.ply")));
    let points = surface.vertices();
    let low = points.iter().min_by(|a, b| a.z.total_cmp(&b.z)).expect("vertices");
    let mut nodes: Vec<usize> = (0..points.len()).collect();
    nodes.sort_by(|&a, &b| (points[a] - low).norm().total_cmp(&(points[b] - low).norm()));
    let check = |count: usize, poisson_ratio: f64| {
        let skin = skin(poisson_ratio, 1e-3, Discretization::Collocation);
        let r = assemble(&surface, &skin, &nodes[..count], &AssemblyOptions::default()).expect("valid");
        spectrum(r.as_ref())
    };
    // Around the finger the flat kernel is no energy; of a pad alone, or of a compressible layer, it is.
    for (count, poisson_ratio, expected) in [(800, 0.5, false), (200, 0.5, true), (800, 0.3, true)] {
        let found = check(count, poisson_ratio);
        assert_eq!(found.is_positive_definite(), expected, "{found:?}");
    }
}
