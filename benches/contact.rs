//! A press on the mesh as it is, over mesh size and depth.
//!
//! The skin is a ball of a fingertip's radius (8 mm), the product a ball of 40 mm or a plate.

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::icosphere;
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use nalgebra::Vector3;
use quasirigid::contact::{Balance, Contact, ContactOptions, Goal, Press, Start, press};
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle};
use quasirigid::response::{Kernel, KernelSkin};
use quasirigid::surface::Surface;

/// Subdivisions k of the ball of skin, which has 10 · 4^k + 2 vertices.
const LADDER: [usize; 4] = [3, 4, 5, 6];

/// Depths (m): shallow, the paper's, deep.
const DEPTHS: [f64; 3] = [0.5e-3, 1.12e-3, 2e-3];

fn skin(subdivisions: usize) -> Surface {
    let (vertices, faces) = icosphere(8e-3, subdivisions);
    Surface::new(vertices, faces).expect("a sphere is a good mesh")
}

fn half_space() -> KernelSkin {
    let response = Kernel::HalfSpace;
    KernelSkin::new(60e3, 0.5, response).expect("constants of a fingertip")
}

fn plate() -> Obstacle {
    Obstacle::half_space(Vector3::zeros(), Vector3::z()).expect("a plane")
}

fn ball() -> Obstacle {
    let (vertices, faces) = icosphere(40e-3, 5);
    Obstacle::mesh(vertices, faces, &MeshObstacleOptions { check_crossings: false })
        .expect("a sphere is a good mesh")
}

fn pressed(surface: &Surface, obstacle: &Obstacle, depth: f64) -> Contact {
    let upwards = Press {
        direction: Vector3::z(),
        goal: Goal::Depth(depth),
        start: Start::Infinity,
        balance: Balance::None,
    };
    press(surface, obstacle, &half_space(), &upwards, &ContactOptions::on_given_mesh())
        .expect("a press that meets the skin")
}

fn over_vertices(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("press/vertices");
    group.sample_size(20);
    for subdivisions in LADDER {
        let surface = skin(subdivisions);
        let vertices = surface.vertices().len();
        for (name, obstacle) in [("plate", plate()), ("mesh", ball())] {
            group.bench_function(BenchmarkId::new(name, vertices), |bencher| {
                bencher.iter(|| pressed(black_box(&surface), &obstacle, DEPTHS[1]));
            });
        }
    }
}

fn over_depth(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("press/depth");
    group.sample_size(20);
    let (surface, obstacle) = (skin(4), plate());
    for depth in DEPTHS {
        let candidates = pressed(&surface, &obstacle, depth).candidates.len();
        let name = format!("{:.2} mm, {candidates} candidates", depth * 1e3);
        group.bench_function(name, |bencher| {
            bencher.iter(|| pressed(black_box(&surface), &obstacle, depth));
        });
    }
}

criterion_group!(benches, over_vertices, over_depth);
criterion_main!(benches);
