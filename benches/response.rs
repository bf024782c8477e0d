//! Assembly of response matrices: a text table of cost and achieved error, then criterion's timings.
//!
//! The unit of comparison between machines is `ratio`: seconds over those of a dense product of two matrices of
//! the same order by faer in the same run, on the same threads. `error` is the largest relative error of an
//! entry (of its K/r part for the other kernels) in 16 columns, against the same columns at tolerance 0.
//!
//! `cargo bench --bench response -- --quick` runs the short ladder.

use criterion::{BenchmarkId, Criterion};
use faer::Mat;
use nalgebra::Vector3;
use quasirigid::response::{
    AssemblyOptions, Discretization, Kernel, KernelSkin, PressureBasis, assemble, assemble_block,
    balanced_height, spectrum,
};
use quasirigid::surface::Surface;
use std::time::Instant;

/// A closed finger-like capsule, radius 8 mm and length 40 mm, with about n vertices on rings.
fn capsule(n: usize) -> Surface {
    let (radius, length) = (8e-3, 40e-3f64);
    let profile = length + std::f64::consts::PI * radius;
    let around_length = 2.0 * std::f64::consts::PI * radius;
    let step = (profile * around_length * 1.15 / n as f64).sqrt();
    let around = (around_length / step).round() as u32;
    let rings = (profile / (step * 0.87)).round() as u32;
    let mut vertices = vec![Vector3::new(0.0, 0.0, -radius)];
    let quarter = 0.5 * std::f64::consts::PI * radius;
    for i in 1..rings {
        let s = profile * i as f64 / rings as f64;
        let (r, z) = if s < quarter {
            (radius * (s / radius).sin(), -radius * (s / radius).cos())
        } else if s < quarter + length {
            (radius, s - quarter)
        } else {
            let t = (s - quarter - length) / radius;
            (radius * t.cos(), length + radius * t.sin())
        };
        for k in 0..around {
            let angle = 2.0 * std::f64::consts::PI * (k as f64 + 0.5 * (i % 2) as f64) / around as f64;
            vertices.push(Vector3::new(r * angle.cos(), r * angle.sin(), z));
        }
    }
    vertices.push(Vector3::new(0.0, 0.0, length + radius));
    let last = vertices.len() as u32 - 1;
    let at = |i: u32, k: u32| 1 + (i - 1) * around + k % around;
    let mut faces = Vec::new();
    for k in 0..around {
        faces.push([0, at(1, k + 1), at(1, k)]);
        faces.push([last, at(rings - 1, k), at(rings - 1, k + 1)]);
    }
    for i in 1..rings - 1 {
        for k in 0..around {
            let shift = i % 2;
            let (a, b, c, d) = (at(i, k), at(i, k + 1), at(i + 1, k), at(i + 1, k + 1));
            if shift == 0 {
                faces.push([a, b, c]);
                faces.push([b, d, c]);
            } else {
                faces.push([a, d, c]);
                faces.push([a, b, d]);
            }
        }
    }
    Surface::new(vertices, faces).expect("a capsule is a valid surface")
}

/// Seconds of `run`, the median after one warm-up.
fn median(times: usize, mut run: impl FnMut()) -> f64 {
    run();
    let mut seconds: Vec<f64> = (0..times)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[times / 2]
}

fn skin(kernel: Kernel) -> KernelSkin {
    KernelSkin::new(60e3, 0.5, kernel).expect("valid constants")
}

fn half_space(discretization: Discretization) -> KernelSkin {
    skin(Kernel::HalfSpace).with_discretization(discretization).expect("a half-space has both")
}

fn kernels() -> Vec<(&'static str, KernelSkin)> {
    let plain = half_space(Discretization::Collocation);
    let (width, cutoff) = (8e-3, 15e-3);
    let height = balanced_height(plain.kernel_constant(), width, cutoff).expect("valid constants");
    vec![
        ("half-space, one_ring", skin(Kernel::HalfSpace).with_basis(PressureBasis::OneRing)),
        ("half-space, galerkin", half_space(Discretization::Galerkin)),
        ("gaussian, balanced", skin(Kernel::GaussianCorrected { height, width, cutoff })),
        ("layer, 2 mm", skin(Kernel::Layer { thickness: 2e-3.into() })),
        ("half-space", plain),
    ]
}

fn product_seconds(order: usize, threads: usize, times: usize) -> f64 {
    let a = Mat::<f64>::from_fn(order, order, |i, j| ((i * 7 + j * 3) % 11) as f64);
    let mut c = Mat::<f64>::zeros(order, order);
    let par = if threads == 1 { faer::Par::Seq } else { faer::Par::rayon(threads) };
    median(times, || {
        faer::linalg::matmul::matmul(c.as_mut(), faer::Accum::Replace, a.as_ref(), a.as_ref(), 1.0, par)
    })
}

/// Largest error in some columns against tolerance 0, relative to the entry of the half-space.
fn achieved_error(surface: &Surface, skin: &KernelSkin, tolerance: f64) -> f64 {
    let rows: Vec<usize> = (0..surface.vertices().len()).collect();
    let columns: Vec<usize> = rows.iter().copied().step_by(rows.len() / 16).collect();
    let block = |skin: &KernelSkin, tolerance| {
        let options = AssemblyOptions { tolerance, ..Default::default() };
        assemble_block(surface, skin, &rows, &columns, &options).expect("a valid request")
    };
    let (found, exact) = (block(skin, tolerance), block(skin, 0.0));
    let scale = block(&half_space(Discretization::Collocation), 1e-6);
    let mut worst: f64 = 0.0;
    for j in 0..found.ncols() {
        for i in 0..found.nrows() {
            worst = worst.max((found[(i, j)] - exact[(i, j)]).abs() / scale[(i, j)]);
        }
    }
    worst
}

/// One line of the table; `product` is the time of a dense product of this order (s).
fn line(name: &str, surface: &Surface, skin: &KernelSkin, tolerance: f64, threads: usize, product: f64) {
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let order = nodes.len();
    let options = AssemblyOptions { tolerance, num_threads: Some(threads), ..Default::default() };
    let run = || drop(std::hint::black_box(assemble(surface, skin, &nodes, &options)));
    let seconds = median(times(order), run);
    let entries = (order * order) as f64;
    println!(
        "{name:<22} {order:>6} {threads:>7} {tolerance:>9.0e} {:>10.2} {:>12.3e} {:>10.1} {:>9.1e} {:>7.3}",
        1e3 * seconds,
        entries / seconds,
        8e-6 * entries,
        achieved_error(surface, skin, tolerance),
        seconds / product
    );
}

/// Runs to take the median of, after a warm-up.
fn times(order: usize) -> usize {
    if order > 1200 { 1 } else { 5 }
}

fn table(quick: bool) {
    let all = std::thread::available_parallelism().map_or(1, usize::from);
    println!(
        "kernel                  nodes threads tolerance         ms    entries/s         MB     error   ratio"
    );
    let ladder: &[usize] = if quick { &[250, 1000] } else { &[250, 500, 1000, 2000, 4000, 8000] };
    for &n in ladder {
        let surface = capsule(n);
        for threads in if all == 1 { vec![1] } else { vec![1, all] } {
            let product = product_seconds(surface.vertices().len(), threads, times(n));
            for (name, skin) in kernels() {
                // the Galerkin matrix costs some 10 times as much and is for contact patches
                let tolerances: &[f64] = match skin.discretization() {
                    Discretization::Galerkin if n > 1000 => continue,
                    Discretization::Galerkin => &[1e-6],
                    Discretization::Collocation => &[1e-3, 1e-6, 1e-9],
                };
                for &tolerance in tolerances {
                    line(name, &surface, &skin, tolerance, threads, product);
                }
            }
        }
    }
    let surface = capsule(if quick { 250 } else { 1000 });
    println!("\ncondition of the symmetric part over {} nodes", surface.vertices().len());
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    for (name, skin) in kernels() {
        let r = assemble(&surface, &skin, &nodes, &AssemblyOptions::default()).expect("a valid request");
        let found = spectrum(r.as_ref());
        println!("{name:<22} definite {:<5} condition {:.2e}", found.is_positive_definite(), found.condition);
    }
}

fn main() {
    let quick = std::env::args().any(|argument| argument == "--quick");
    if !std::env::args().any(|argument| argument == "--test") {
        table(quick);
    }
    let mut criterion = Criterion::default().configure_from_args();
    let mut group = criterion.benchmark_group("response");
    group.sample_size(10);
    for n in [100, 400, 1500] {
        let surface = capsule(n);
        let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
        let (plain, options) = (half_space(Discretization::Collocation), AssemblyOptions::default());
        group.bench_with_input(BenchmarkId::new("half-space", nodes.len()), &nodes, |bench, nodes| {
            bench.iter(|| assemble(&surface, &plain, nodes, &options));
        });
    }
    group.finish();
    criterion.final_summary();
}
