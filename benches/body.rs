//! Body response: preparing it over a ladder of sphere sizes, and what one press then costs.

use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::surface::Surface;

#[path = "../tests/common/mod.rs"]
mod common;

fn sphere(radius: f64, subdivisions: usize) -> Surface {
    let (vertices, faces) = common::icosphere(radius, subdivisions);
    Surface::new(vertices, faces).expect("a sound sphere")
}

fn body(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("body");
    group.sample_size(10).warm_up_time(Duration::from_millis(100));
    let body = Body { bone: Some(sphere(3e-3, 2)), fixed: None, coarse_edge_length: None };
    for subdivisions in [1, 2, 3] {
        let skin = sphere(8e-3, subdivisions);
        let nodes: Vec<usize> =
            (0..skin.vertices().len()).filter(|&i| skin.vertices()[i].z < -4e-3).collect();
        let size = skin.vertices().len();
        let prepare =
            || body.prepare(&skin, 60e3, 0.5, &nodes, &BodyOptions::default()).expect("a sound body");
        group.bench_function(BenchmarkId::new("prepare", size), |bencher| bencher.iter(prepare));
        let compliance = prepare();
        let up = vec![Vector3::z(); nodes.len()];
        group.bench_function(BenchmarkId::new("response_along", size), |bencher| {
            bencher.iter(|| compliance.response_along(&up).expect("unit directions"))
        });
        group.bench_function(BenchmarkId::new("displacements", size), |bencher| {
            bencher.iter(|| compliance.displacements(&up).expect("one force per node"))
        });
    }
    group.finish();
}

criterion_group!(benches, body);
criterion_main!(benches);
