//! Growth of local matrices under refinement, at equal thickness and threshold: a text table.
//!
//! Seconds are of the process on one thread. `exponent` is that of the seconds against the line before, `error` the
//! largest relative error of 8 sampled columns in the Euclidean norm, against dense columns at tolerance 1e-7. The
//! surfaces are a generated finger, and the hands of `QUASIRIGID_DATA` where that folder exists, each refined by
//! cutting faces in four.
//!
//! `cargo bench --bench local -- --quick` runs the short ladder.

#[path = "../tests/common/mod.rs"]
mod common;

use common::Mesh;
use nalgebra::Vector3;
use quasirigid::response::{
    AssemblyOptions, Gap, LocalOptions, Pressure, Response, Skin, assemble_block, assemble_local,
    balanced_height,
};
use quasirigid::surface::Surface;
use std::collections::HashMap;
use std::time::Instant;

const THRESHOLD: f64 = 1e-3;

/// Every face cut in four at the middles of its edges.
fn refined(mesh: &Mesh) -> Mesh {
    let mut vertices = mesh.0.clone();
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]));
            vertices.len() as u32 - 1
        })
    };
    let cut = |&[a, b, c]: &[u32; 3]| {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    };
    let faces = mesh.1.iter().flat_map(cut).collect();
    (vertices, faces)
}

/// An ellipsoid of the size of a finger.
fn finger() -> Mesh {
    let (vertices, faces) = common::icosphere(8e-3, 4);
    (vertices.into_iter().map(|p| Vector3::new(p.x, p.y, 3.0 * p.z)).collect(), faces)
}

fn kernels() -> Vec<(&'static str, Skin)> {
    let skin = |poisson_ratio, response| Skin::new(60e3, poisson_ratio, response).expect("valid constants");
    let pressure = Pressure::Linear;
    let layer = |thickness: f64| Response::Layer { thickness: thickness.into(), pressure, gap: Gap::Node };
    let mut list = vec![
        ("layer 2 mm, nu 0.5", skin(0.5, layer(2e-3))),
        ("layer 2 mm, nu 0.45", skin(0.45, layer(2e-3))),
        ("layer 4 mm, nu 0.5", skin(0.5, layer(4e-3))),
        ("layer 4 mm, nu 0.45", skin(0.45, layer(4e-3))),
    ];
    let (width, cutoff) = (8e-3, 15e-3);
    let height = balanced_height(list[0].1.kernel_constant(), width, cutoff).expect("valid constants");
    list.push((
        "gaussian, cutoff 15 mm",
        skin(0.5, Response::GaussianCorrected { height, width, cutoff, pressure }),
    ));
    list
}

/// Largest relative error of some columns.
fn sampled_error(surface: &Surface, skin: &Skin, apply: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
    let columns: Vec<usize> = nodes.iter().copied().step_by(nodes.len() / 7).collect();
    let options = AssemblyOptions { tolerance: 1e-7, ..Default::default() };
    let exact = assemble_block(surface, skin, &nodes, &columns, &options).expect("a valid request");
    let mut worst: f64 = 0.0;
    for (k, &j) in columns.iter().enumerate() {
        let mut unit = vec![0.0; nodes.len()];
        unit[j] = 1.0;
        let found = apply(&unit);
        let (mut error, mut size) = (0.0, 0.0);
        // where nothing is stored, a finger beyond the air may lie
        for i in nodes.iter().copied().filter(|&i| found[i] != 0.0) {
            error += (found[i] - exact[(i, k)]).powi(2);
            size += exact[(i, k)].powi(2);
        }
        worst = worst.max((error / size).sqrt());
    }
    worst
}

fn ladder(name: &str, mesh: &Mesh, steps: usize) {
    println!("\n{name}");
    println!("kernel                    nodes        s exponent       MB values/node  product s     error");
    for (kernel, skin) in kernels() {
        let mut mesh = mesh.clone();
        let mut last: Option<(f64, f64)> = None;
        for _ in 0..steps {
            let surface = Surface::new(mesh.0.clone(), mesh.1.clone()).expect("a valid surface");
            let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
            let options = LocalOptions { threshold: THRESHOLD, num_threads: Some(1), ..Default::default() };
            let start = Instant::now();
            let matrix = assemble_local(&surface, &skin, &nodes, &options).expect("a fading kernel");
            let seconds = start.elapsed().as_secs_f64();
            let count = nodes.len() as f64;
            let exponent = last.map_or(f64::NAN, |(n, s)| (seconds / s).ln() / (count / n).ln());
            let start = Instant::now();
            std::hint::black_box(matrix.apply(&vec![1.0; nodes.len()]));
            let product = start.elapsed().as_secs_f64();
            println!(
                "{kernel:<22} {:>8} {seconds:>8.2} {exponent:>8.2} {:>8.0} {:>11.0} {product:>10.3} {:>9.1e}",
                nodes.len(),
                1e-6 * matrix.bytes() as f64,
                matrix.entries() as f64 / count,
                sampled_error(&surface, &skin, |forces| matrix.apply(forces))
            );
            last = Some((count, seconds));
            mesh = refined(&mesh);
        }
    }
}

fn main() {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let quick = std::env::args().any(|argument| argument == "--quick");
    ladder("generated finger", &finger(), if quick { 2 } else { 4 });
    let hands = common::data_dir().filter(|_| !quick);
    for hand in hands.iter().flat_map(|data| ["webxr", "libhand"].map(|name| (name, data))) {
        let mesh = common::read_ply(&hand.1.join(format!("hands/{}_right_13k.ply", hand.0)));
        ladder(&format!("hand {}", hand.0), &mesh, 3);
    }
}
