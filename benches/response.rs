//! Assembly of response matrices: a text table of cost and achieved error, then criterion's timings.
//!
//! The unit of comparison between machines is `ratio`: seconds over those of a dense product of two matrices
//! of the same order by faer in the same run, on the same threads.

use faer::Mat;
use nalgebra::Vector3;
use quasirigid::response::{AssemblyOptions, Gap, Pressure, Response, Skin, assemble};
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

fn median(mut run: impl FnMut(), times: usize) -> f64 {
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

fn main() {
    let response = Response::HalfSpace { pressure: Pressure::Linear, gap: Gap::Node };
    let skin = Skin::new(60e3, 0.5, response).expect("valid constants");
    for n in [400, 1500] {
        let surface = capsule(n);
        let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
        let k = nodes.len();
        let product = {
            let a = Mat::<f64>::from_fn(k, k, |i, j| ((i * 7 + j * 3) % 11) as f64);
            median(|| drop(std::hint::black_box(&a * &a)), 9)
        };
        let exact = assemble(
            &surface,
            &skin,
            &nodes,
            None,
            &AssemblyOptions { tolerance: 0.0, ..Default::default() },
        )
        .unwrap();
        for tolerance in [1e-3, 1e-6, 1e-9, 0.0] {
            let options = AssemblyOptions { tolerance, ..Default::default() };
            let seconds = median(|| drop(assemble(&surface, &skin, &nodes, None, &options)), 9);
            let r = assemble(&surface, &skin, &nodes, None, &options).unwrap();
            let mut worst: f64 = 0.0;
            for j in 0..k {
                for i in 0..k {
                    worst = worst.max((r[(i, j)] / exact[(i, j)] - 1.0).abs());
                }
            }
            println!(
                "{k:6} {tolerance:8.0e} {:9.3} ms  product {:9.3} ms ratio {:.3} error {worst:.1e}",
                seconds * 1e3,
                product * 1e3,
                seconds / product
            );
        }
    }
}
