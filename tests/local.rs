//! Local matrices of fading kernels through the public interface, held against the dense ones.

mod common;

use common::Random;
use faer::Mat;
use nalgebra::Vector3;
use quasirigid::response::{
    AssemblyOptions, Gap, LocalMatrix, LocalOptions, Pressure, Response, ResponseError, Skin, Thickness,
    assemble, assemble_block, assemble_local, definiteness,
};
use quasirigid::surface::Surface;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A jittered grid of (n + 1)² vertices with side `size` (m), bent to a bowl.
fn bowl(n: usize, size: f64) -> Surface {
    let h = size / n as f64;
    let mut random = Random(3);
    let mut vertices = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            let mut shifted = |k: usize| h * (k as f64 + 0.3 * (random.next() - 0.5)) - 0.5 * size;
            let (x, y) = (shifted(i), shifted(j));
            vertices.push(Vector3::new(x, y, 5.0 * (x * x + y * y)));
        }
    }
    Surface::new(vertices, common::one_way_faces(n)).expect("a grid is a valid surface")
}

/// Two fingers of radius 5 mm side by side, 2 mm apart and 40 mm long: an open tube bent to a U, its bend below z = 0.
fn two_fingers(around: usize) -> Surface {
    let (radius, leg, bend) = (5e-3, 40e-3, 6e-3);
    let step = 2.0 * PI * radius / around as f64;
    let length = 2.0 * leg + PI * bend;
    let rings = (length / step).round() as usize;
    let mut vertices = Vec::new();
    for i in 0..=rings {
        let s = length * i as f64 / rings as f64;
        // the middle of the tube, and its direction away from the middle of the bend
        let (middle, outward) = if s < leg {
            (Vector3::new(-bend, 0.0, leg - s), -Vector3::x())
        } else if s < leg + PI * bend {
            let angle = (s - leg) / bend;
            let outward = Vector3::new(-angle.cos(), 0.0, -angle.sin());
            (outward * bend, outward)
        } else {
            (Vector3::new(bend, 0.0, s - leg - PI * bend), Vector3::x())
        };
        for k in 0..around {
            let angle = 2.0 * PI * k as f64 / around as f64;
            vertices.push(middle + (outward * angle.cos() + Vector3::y() * angle.sin()) * radius);
        }
    }
    let at = |i: usize, k: usize| (i * around + k % around) as u32;
    let mut faces = Vec::new();
    for i in 0..rings {
        for k in 0..around {
            faces.push([at(i, k), at(i, k + 1), at(i + 1, k + 1)]);
            faces.push([at(i, k), at(i + 1, k + 1), at(i + 1, k)]);
        }
    }
    Surface::new(vertices, faces).expect("a tube is a valid surface")
}

fn skin(poisson_ratio: f64, response: Response) -> Skin {
    Skin::new(60e3, poisson_ratio, response).expect("valid constants")
}

fn layer(thickness: f64) -> Response {
    Response::Layer { thickness: thickness.into(), pressure: Pressure::Linear, gap: Gap::Node }
}

fn gaussian(height: f64, width: f64, cutoff: f64) -> Response {
    Response::GaussianCorrected { height, width, cutoff, pressure: Pressure::Linear }
}

fn all(surface: &Surface) -> Vec<usize> {
    (0..surface.vertices().len()).collect()
}

fn local(surface: &Surface, skin: &Skin, nodes: &[usize], threshold: f64) -> LocalMatrix {
    let options = LocalOptions { threshold, ..Default::default() };
    assemble_local(surface, skin, nodes, &options).expect("a fading kernel")
}

/// Largest singular value, from below, by the power method.
fn norm(matrix: &Mat<f64>) -> f64 {
    let mut random = Random(11);
    let mut v = Mat::from_fn(matrix.ncols(), 1, |_, _| random.next() - 0.3);
    let mut found = 0.0;
    for _ in 0..50 {
        v /= faer::Scale(v.norm_l2().max(f64::MIN_POSITIVE));
        let w = matrix * &v;
        found = w.norm_l2();
        v = matrix.transpose() * w;
    }
    found
}

#[test]
fn products_are_within_the_threshold_of_the_dense_matrix() {
    let surface = bowl(36, 18e-3);
    let thickness: Vec<f64> = (0..37 * 37).map(|v| 0.5e-3 + 0.5e-3 * (v % 37) as f64 / 37.0).collect();
    let varying = Response::Layer {
        thickness: Thickness::PerVertex(thickness.into()),
        pressure: Pressure::Linear,
        gap: Gap::Node,
    };
    let spread = Response::Layer { thickness: 0.7e-3.into(), pressure: Pressure::OneRing, gap: Gap::Node };
    // a cutoff beyond the surface leaves far blocks to the Gaussian
    let wide = gaussian(2e-4, 4e-3, 40e-3);
    let kernels = [
        (0.5, layer(0.7e-3)),
        (0.45, varying),
        (0.3, spread),
        (0.5, gaussian(1e-3, 3e-3, 5e-3)),
        (0.3, gaussian(3e-4, 4e-3, 7e-3)),
        (0.5, wide),
    ];
    for (poisson_ratio, response) in kernels {
        let skin = skin(poisson_ratio, response);
        let nodes = all(&surface);
        let options = AssemblyOptions { tolerance: 1e-8, ..Default::default() };
        let dense = assemble(&surface, &skin, &nodes, None, &options).expect("valid");
        let scale = norm(&dense);
        let mut entries = 0;
        for threshold in [1e-2, 1e-4, 1e-6] {
            let matrix = local(&surface, &skin, &nodes, threshold);
            // the Frobenius norm is an upper bound of the spectral one
            let error = (&dense - matrix.to_dense()).norm_l2();
            assert!(error <= threshold * scale, "{:?} {threshold:e}: {:e}", skin.response, error / scale);
            assert!(matrix.entries() >= entries && matrix.bytes() > 8 * matrix.entries());
            entries = matrix.entries();
            assert!(2 * entries < nodes.len() * nodes.len() || threshold < 1e-5, "{entries}");
        }
    }
}

#[test]
fn a_cutoff_as_long_as_a_finger_is_thick_keeps_threshold_and_tolerance() {
    // one leg of the U, with nodes on both sides: straight lines of about the cutoff run through the finger
    let surface = two_fingers(20);
    let section = |&v: &usize| surface.vertices()[v].x < 0.0 && surface.vertices()[v].z > 15e-3;
    let nodes: Vec<usize> = all(&surface).into_iter().filter(section).collect();
    for cutoff in [9.3e-3, 10e-3, 10.4e-3] {
        let skin = skin(0.5, gaussian(3e-4, 5e-3, cutoff));
        let dense = |tolerance| {
            let options = AssemblyOptions { tolerance, ..Default::default() };
            assemble(&surface, &skin, &nodes, None, &options).expect("valid")
        };
        let exact = dense(1e-10);
        let scale = norm(&exact);
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let entry = tolerance * skin.kernel_constant() / cutoff;
            let error = (dense(tolerance) - &exact).norm_max();
            // towards the node itself K/r grows up to some 1.5 mm
            assert!(error <= entry * cutoff / 1e-3, "{cutoff} {tolerance:e}: {:e}", error / entry);
        }
        for threshold in [1e-3, 1e-6] {
            let error = (local(&surface, &skin, &nodes, threshold).to_dense() - &exact).norm_l2();
            assert!(error <= threshold * scale, "{cutoff} {threshold:e}: {:e}", error / scale);
        }
    }
}

#[test]
fn thickness_that_jumps_from_node_to_node_keeps_the_threshold() {
    let surface = bowl(36, 30e-3);
    let nodes = all(&surface);
    let mut random = Random(9);
    let back: Vec<f64> = surface.vertices().iter().map(|v| if v.x > 6e-3 { 0.3e-3 } else { 5e-3 }).collect();
    let spot: Vec<f64> =
        surface.vertices().iter().map(|v| if v.norm() < 4e-3 { 3e-3 } else { 0.2e-3 }).collect();
    let scattered: Vec<f64> = nodes.iter().map(|_| if random.next() < 0.1 { 5e-3 } else { 0.3e-3 }).collect();
    let mostly_thick: Vec<f64> =
        nodes.iter().map(|_| if random.next() < 0.3 { 0.3e-3 } else { 5e-3 }).collect();
    let noise: Vec<f64> = nodes.iter().map(|_| 2e-3 * (2.0 * random.next() - 1.0).exp()).collect();
    for (name, thickness) in [
        ("thin on one side", back),
        ("thick spot", spot),
        ("a tenth thick", scattered),
        ("three tenths thin", mostly_thick),
        ("noise", noise),
    ] {
        let thickness = Thickness::PerVertex(thickness.into());
        let skin = skin(0.5, Response::Layer { thickness, pressure: Pressure::Linear, gap: Gap::Node });
        let options = AssemblyOptions { tolerance: 1e-9, ..Default::default() };
        let dense = assemble(&surface, &skin, &nodes, None, &options).expect("valid");
        let scale = norm(&dense);
        for threshold in [1e-3, 1e-6] {
            let matrix = local(&surface, &skin, &nodes, threshold);
            let error = norm(&(&dense - matrix.to_dense()));
            let share = matrix.entries() as f64 / (nodes.len() * nodes.len()) as f64;
            println!("{name} {threshold:e}: error {:.2e}, stored {share:.2}", error / scale);
            assert!(error <= threshold * scale, "{name} {threshold:e}: {:e}", error / scale);
        }
    }
}

#[test]
fn products_groups_and_diagonal_are_those_of_the_matrix_itself() {
    let surface = bowl(30, 18e-3);
    // every second node, in an order that has nothing to do with places
    let mut nodes: Vec<usize> = Random(5).permutation(31 * 31);
    nodes.truncate(480);
    for response in [layer(0.6e-3), gaussian(3e-4, 4e-3, 8e-3)] {
        let matrix = local(&surface, &skin(0.45, response), &nodes, 1e-3);
        let dense = matrix.to_dense();
        let mut random = Random(1);
        let forces: Vec<f64> = nodes.iter().map(|_| random.next() - 0.5).collect();
        let column = Mat::from_fn(nodes.len(), 1, |i, _| forces[i]);
        let (ahead, back) = (&dense * &column, dense.transpose() * &column);
        let close = |found: Vec<f64>, expected: &Mat<f64>| {
            let scale = expected.norm_max();
            assert!(found.iter().enumerate().all(|(i, &u)| (u - expected[(i, 0)]).abs() < 1e-12 * scale));
        };
        close(matrix.apply(&forces), &ahead);
        close(matrix.apply_transposed(&forces), &back);
        let diagonal = matrix.diagonal();
        assert!((0..nodes.len()).all(|i| diagonal[i] == dense[(i, i)] && diagonal[i] > 0.0));
        assert_eq!(matrix.groups(), [(0..nodes.len()).collect::<Vec<_>>()]);
    }
}

#[test]
fn threads_change_no_bit_of_matrix_or_product() {
    let surface = bowl(40, 30e-3);
    for response in [layer(0.8e-3), gaussian(5e-4, 3e-3, 6e-3)] {
        let skin = skin(0.5, response);
        let run = |num_threads| {
            let options = LocalOptions { num_threads, ..Default::default() };
            assemble_local(&surface, &skin, &all(&surface), &options).expect("local")
        };
        let one = run(Some(1));
        assert!(one == run(Some(2)) && one == run(None));
        let forces: Vec<f64> = (0..one.order()).map(|v| (v % 7) as f64 - 2.5).collect();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| (one.apply(&forces), one.apply_transposed(&forces)))
        };
        assert_eq!(on(1), on(3));
    }
}

#[test]
fn patches_out_of_reach_are_separate_groups() {
    let surface = bowl(40, 40e-3);
    let nodes: Vec<usize> = (0..41 * 6).chain(41 * 35..41 * 41).collect();
    let groups = local(&surface, &skin(0.5, layer(0.3e-3)), &nodes, 1e-3).groups();
    assert_eq!(groups.len(), 2);
    assert_eq!(groups[0], (0..41 * 6).collect::<Vec<_>>());
}

#[test]
fn fingers_side_by_side_are_coupled_only_near_their_web() {
    let surface = two_fingers(24);
    for response in [layer(1.5e-3), gaussian(3e-4, 5e-3, 8e-3)] {
        let skin = skin(0.45, response);
        let nodes = all(&surface);
        let z = |v: usize| surface.vertices()[v].z;
        let left = |v: usize| surface.vertices()[v].x < 0.0;
        let tips: Vec<usize> = nodes.iter().copied().filter(|&v| z(v) > 20e-3).collect();
        let matrix = local(&surface, &skin, &tips, 1e-3);
        let groups = matrix.groups();
        assert_eq!(groups.len(), 2, "one for each finger");
        assert!(groups.iter().all(|group| group.iter().all(|&i| left(tips[i]) == left(tips[group[0]]))));
        // Straight lines lead across the gap, so the dense matrix couples what the skin does not.
        let options = AssemblyOptions { tolerance: 1e-6, ..Default::default() };
        let dense = assemble(&surface, &skin, &tips, None, &options).expect("valid");
        let found = matrix.to_dense();
        let scale = norm(&dense);
        let (mut across, mut error) = (0.0_f64, 0.0);
        for (j, &b) in tips.iter().enumerate() {
            for (i, &a) in tips.iter().enumerate() {
                if left(a) == left(b) {
                    error += (dense[(i, j)] - found[(i, j)]).powi(2);
                } else {
                    across = across.max(dense[(i, j)].abs());
                    assert_eq!(found[(i, j)], 0.0);
                }
            }
        }
        assert!(across > 1e-2 * dense[(0, 0)], "{across:e}");
        assert!(error.sqrt() <= 1e-3 * scale, "within a finger {:e}", error.sqrt() / scale);
        // The whole skin is in one piece: in the bend the legs share tissue.
        assert_eq!(local(&surface, &skin, &nodes, 1e-3).groups().len(), 1);
    }
}

#[test]
fn stored_values_grow_almost_linearly_under_refinement() {
    let skin = skin(0.5, layer(0.5e-3));
    let stored = |cells: usize| {
        let surface = bowl(cells, 16e-3);
        local(&surface, &skin, &all(&surface), 1e-2).entries() as f64
    };
    // n log n at these sizes; the pairs within reach grow as n²
    let exponent = (stored(80) / stored(40)).ln() / (81f64 / 41.0).powi(2).ln();
    assert!(exponent < 1.3, "{exponent}");
}

#[test]
fn sampled_columns_of_a_large_matrix_match_their_exact_values() {
    let surface = bowl(90, 45e-3);
    let skin = skin(0.45, layer(1e-3));
    let nodes = all(&surface);
    let matrix = local(&surface, &skin, &nodes, 1e-3);
    let sampled: Vec<usize> = nodes.iter().copied().step_by(997).collect();
    let options = AssemblyOptions { tolerance: 1e-6, ..Default::default() };
    let exact = assemble_block(&surface, &skin, &nodes, &sampled, &options).expect("valid");
    for (k, &j) in sampled.iter().enumerate() {
        let mut unit = vec![0.0; nodes.len()];
        unit[j] = 1.0;
        let found = matrix.apply(&unit);
        let error: f64 = nodes.iter().map(|&i| (found[i] - exact[(i, k)]).powi(2)).sum::<f64>().sqrt();
        let size: f64 = nodes.iter().map(|&i| exact[(i, k)].powi(2)).sum::<f64>().sqrt();
        assert!(error < 1e-3 * size, "{:e}", error / size);
    }
}

#[test]
fn definiteness_is_that_of_the_dense_matrix() {
    let surface = bowl(20, 12e-3);
    let skin = skin(0.3, layer(1e-3));
    let matrix = local(&surface, &skin, &all(&surface), 1e-5);
    let found = matrix.definiteness();
    let expected = definiteness(matrix.to_dense().as_ref());
    assert!(found.positive_definite && found.decided && expected.positive_definite);
    assert!((found.largest / expected.largest - 1.0).abs() < 1e-6);
    assert!(found.smallest >= expected.smallest * (1.0 - 1e-6));
    assert!(found.smallest - found.margin <= expected.smallest, "{found:?} {expected:?}");
    assert_eq!(found.condition, found.largest / found.smallest);
    assert_eq!(found.advice(&matrix), None);
}

#[test]
fn an_indefinite_or_undecided_matrix_comes_with_advice() {
    let surface = bowl(30, 45e-3);
    // the constants of Xie, Kanai, Date 2011
    let paper = local(&surface, &skin(0.5, gaussian(0.8e-3, 5e-3, 15e-3)), &all(&surface), 1e-4);
    let found = paper.definiteness();
    assert!(!found.positive_definite && found.decided && found.smallest < 0.0);
    assert_eq!(found.condition, f64::INFINITY);
    assert!(found.advice(&paper).expect("advice").contains("Gaussian of height 8.000e-4"));
    let surface = bowl(40, 20e-3);
    let coarse = local(&surface, &skin(0.5, layer(6e-3)), &all(&surface), 0.1);
    let found = coarse.definiteness();
    assert!(!found.positive_definite && !found.decided, "{found:?}");
    assert!(found.advice(&coarse).expect("advice").contains("smaller threshold"));
}

#[test]
fn no_nodes_and_one_node_make_matrices_too() {
    let surface = bowl(4, 4e-3);
    let skin = skin(0.5, layer(1e-3));
    let empty = local(&surface, &skin, &[], 1e-3);
    assert_eq!((empty.order(), empty.entries()), (0, 0));
    assert!(
        empty.apply(&[]).is_empty() && empty.groups().is_empty() && empty.definiteness().positive_definite
    );
    let one = local(&surface, &skin, &[12], 1e-3);
    let options = AssemblyOptions { tolerance: 1e-4, ..Default::default() };
    let dense = assemble(&surface, &skin, &[12], None, &options).expect("valid");
    assert_eq!(one.apply(&[2.0]), [2.0 * dense[(0, 0)]]);
    assert_eq!(one.groups(), [[0]]);
}

// ---- errors ----

fn refused(surface: &Surface, response: Response, nodes: &[usize], options: &LocalOptions) -> ResponseError {
    assemble_local(surface, &skin(0.5, response), nodes, options).expect_err("malformed")
}

#[test]
fn kernels_that_are_felt_everywhere_and_weighted_gaps_are_refused() {
    let surface = bowl(4, 4e-3);
    let (nodes, options) = (all(&surface), LocalOptions::default());
    let half_space = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Node };
    let found = refused(&surface, half_space, &nodes, &options);
    assert_eq!(found, ResponseError::NotLocal { kernel: "half-space" });
    let found = refused(&surface, gaussian(1e-4, 5e-3, f64::INFINITY), &nodes, &options);
    assert_eq!(found, ResponseError::NotLocal { kernel: "Gaussian-corrected" });
    let weighted = Response::Layer { thickness: 1e-3.into(), pressure: Pressure::Linear, gap: Gap::Weighted };
    assert_eq!(refused(&surface, weighted, &nodes, &options), ResponseError::GapNotLocal);
}

#[test]
fn malformed_requests_name_what_is_wrong() {
    let surface = bowl(4, 4e-3);
    let (nodes, plain) = (all(&surface), LocalOptions::default());
    for (options, expected) in [
        (LocalOptions { threshold: 0.0, ..plain }, "threshold"),
        (LocalOptions { threshold: f64::NAN, ..plain }, "threshold"),
        (LocalOptions { tolerance: Some(-1.0), ..plain }, "tolerance"),
        (LocalOptions { num_threads: Some(0), ..plain }, "num_threads"),
    ] {
        match refused(&surface, layer(1e-3), &nodes, &options) {
            ResponseError::Constant { name, .. } => assert_eq!(name, expected),
            other => panic!("{other:?}"),
        }
    }
    let found = refused(&surface, layer(1e-3), &[3, 25], &plain);
    assert_eq!(found, ResponseError::NodeOutOfRange { index: 1, vertex: 25, vertex_count: 25 });
    let found = refused(&surface, layer(1e-3), &[3, 4, 3], &plain);
    assert_eq!(found, ResponseError::RepeatedNode { vertex: 3, first: 0, second: 2 });
}

#[test]
fn too_much_memory_ends_the_assembly() {
    let surface = bowl(10, 10e-3);
    let options = LocalOptions { memory_limit: Some(10_000), ..Default::default() };
    match refused(&surface, layer(1e-3), &all(&surface), &options) {
        ResponseError::TooLarge { nodes: 121, bytes, limit: 10_000 } => assert!(bytes > 10_000),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_interrupted_assembly_ends_before_it_is_done() {
    let surface = bowl(20, 20e-3);
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) == 1;
    let options = LocalOptions { num_threads: Some(1), interrupt: Some(&stop), ..Default::default() };
    match refused(&surface, layer(1e-3), &all(&surface), &options) {
        ResponseError::Interrupted { columns, nodes } => assert!(0 < columns && columns < nodes),
        other => panic!("{other:?}"),
    }
}
