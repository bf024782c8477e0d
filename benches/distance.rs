//! Signed distance, first touch and construction over numbers of points and faces.
//!
//! The skin is a sphere of 50 mm, the product one of 40 mm that it overlaps by 2 mm, both triangulated.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::{Mesh, icosphere};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use nalgebra::Vector3;
use quasirigid::geometry::find_crossings;
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle};

/// Subdivisions k of the spheres, which have 10 · 4^k + 2 vertices and 20 · 4^k faces.
const LADDER: [usize; 4] = [3, 4, 5, 6];

const MAX_DISTANCES: [(&str, Option<f64>); 3] =
    [("unbounded", None), ("10 mm", Some(10e-3)), ("2 mm", Some(2e-3))];

fn skin(subdivisions: usize) -> Vec<Vector3<f64>> {
    let shift = Vector3::new(0.0, 0.0, 88e-3);
    icosphere(50e-3, subdivisions).0.into_iter().map(|vertex| vertex + shift).collect()
}

fn product((vertices, faces): Mesh, check_crossings: bool) -> Obstacle {
    Obstacle::mesh(vertices, faces, &MeshObstacleOptions { check_crossings })
        .expect("a sphere is a good mesh")
}

fn over_points(criterion: &mut Criterion) {
    let obstacle = product(icosphere(40e-3, 5), false);
    let mut group = criterion.benchmark_group("distance/points");
    group.sample_size(20);
    for subdivisions in LADDER {
        let points = skin(subdivisions);
        group.throughput(Throughput::Elements(points.len() as u64));
        for (name, max_distance) in MAX_DISTANCES {
            group.bench_function(BenchmarkId::new(name, points.len()), |bencher| {
                bencher.iter(|| obstacle.signed_distance(black_box(&points), max_distance));
            });
        }
    }
}

fn over_faces(criterion: &mut Criterion) {
    let points = skin(5);
    let mut group = criterion.benchmark_group("distance/faces");
    group.sample_size(20);
    for subdivisions in LADDER {
        let mesh = icosphere(40e-3, subdivisions);
        let faces = mesh.1.len();
        let obstacle = product(mesh, false);
        for (name, max_distance) in MAX_DISTANCES {
            group.bench_function(BenchmarkId::new(name, faces), |bencher| {
                bencher.iter(|| obstacle.signed_distance(black_box(&points), max_distance));
            });
        }
    }
}

fn first_touch(criterion: &mut Criterion) {
    let points = skin(5);
    let mut group = criterion.benchmark_group("first_touch/faces");
    group.sample_size(20);
    for subdivisions in LADDER {
        let mesh = icosphere(40e-3, subdivisions);
        let faces = mesh.1.len();
        let obstacle = product(mesh, false);
        group.bench_function(BenchmarkId::from_parameter(faces), |bencher| {
            bencher.iter(|| obstacle.first_touch(black_box(&points), &Vector3::z()));
        });
    }
}

fn construction(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("construction/faces");
    group.sample_size(20);
    for subdivisions in LADDER {
        let mesh = icosphere(40e-3, subdivisions);
        let faces = mesh.1.len();
        group.bench_function(BenchmarkId::new("checked", faces), |bencher| {
            bencher.iter(|| product(black_box(mesh.clone()), true));
        });
        group.bench_function(BenchmarkId::new("without crossings", faces), |bencher| {
            bencher.iter(|| product(black_box(mesh.clone()), false));
        });
        group.bench_function(BenchmarkId::new("crossings alone", faces), |bencher| {
            bencher.iter(|| find_crossings(black_box(&mesh.0), &mesh.1));
        });
    }
}

criterion_group!(benches, over_points, over_faces, first_touch, construction);
criterion_main!(benches);
