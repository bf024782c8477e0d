//! The response matrix through the public interface: known answers, properties, twins, endings.

use std::f64::consts::PI;

use nalgebra::Vector3;
use quasirigid::response::{AssemblyOptions, Kernel, KernelSkin, PressureBasis, assemble, hat_integrals};
use quasirigid::surface::Surface;

use common::{Random, galerkin, skin};

#[path = "../common/mod.rs"]
mod common;
mod endings;
mod galerkin;
mod gaussian;
mod integrals;
mod kernels;
mod known_answers;
mod layer_entries;
mod layer_matrices;
mod properties;
mod twins;
mod well_posed;

const HALF_SPACE: Kernel = Kernel::HalfSpace;
const PAPER: Kernel = Kernel::GaussianCorrected { height: 0.8e-3, width: 5e-3, cutoff: 15e-3 };

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

fn all(surface: &Surface) -> Vec<usize> {
    (0..surface.vertices().len()).collect()
}

fn matrix(surface: &Surface, skin: &KernelSkin, tolerance: f64) -> faer::Mat<f64> {
    let options = AssemblyOptions { tolerance, ..Default::default() };
    assemble(surface, skin, &all(surface), &options).expect("a valid request")
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

fn layer(thickness: f64) -> Kernel {
    Kernel::Layer { thickness: thickness.into() }
}

/// Vertices of a [`grid`] of n² cells that are not on its border.
fn inner_vertices(n: usize) -> Vec<usize> {
    let inner = |v: &usize| [v / (n + 1), v % (n + 1)].iter().all(|&i| i > 0 && i < n);
    (0..(n + 1) * (n + 1)).filter(inner).collect()
}

/// A surface squeezed to `factor` of its width, which makes slivers of its triangles.
fn squeezed(surface: &Surface, factor: f64) -> Surface {
    let vertices = surface.vertices().iter().map(|v| Vector3::new(v.x, factor * v.y, v.z)).collect();
    Surface::new(vertices, surface.faces().to_vec()).expect("slivers are welcome")
}

/// Points and weights of Gauss's rule on [0, 1]: roots of Legendre's polynomial by Newton's method.
fn gauss_rule(n: usize) -> Vec<(f64, f64)> {
    let point = |k: usize| {
        let (mut x, mut slope) = ((PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos(), 0.0);
        for _ in 0..20 {
            let (mut before, mut p) = (1.0, x);
            for m in 1..n {
                let m = m as f64;
                (before, p) = (p, ((2.0 * m + 1.0) * x * p - m * before) / (m + 1.0));
            }
            slope = n as f64 * (before - x * p) / (1.0 - x * x);
            x -= p / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(point).collect()
}
