//! The whole pipeline through the public API: scenes, and the skins and obstacles that they share.

use nalgebra::Vector3;
use quasirigid::contact::{Balance, Contact, ContactOptions, Goal, Press, Start, press, solve_contact};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::{Discretization, Kernel, KernelSkin};
use quasirigid::surface::Surface;

use common::{Random, icosphere, one_diagonal_grid};

mod combined;
#[path = "../common/mod.rs"]
mod common;
mod cuts;
mod edges;
mod elastic_product;
mod fingers;
mod galerkin;
mod guards;
mod hertz;
mod parts;
mod patches;
mod prepared;
mod press;
mod reach;
mod refine;
mod thin_walls;
mod tilt;
mod warm;

const SHEAR_MODULUS: f64 = 60e3;
const POISSON_RATIO: f64 = 0.5;
const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

fn skin(kernel: Kernel) -> KernelSkin {
    KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, kernel).expect("valid constants")
}

fn half_space() -> KernelSkin {
    skin(Kernel::HalfSpace)
}

/// The half-space in Galerkin form.
fn galerkin() -> KernelSkin {
    half_space().with_discretization(Discretization::Galerkin).expect("a half-space has it")
}

fn solve(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin) -> Contact {
    solve_contact(surface, obstacle, skin, &ContactOptions::on_given_mesh()).expect("a valid request")
}

fn press_up(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin, depth: f64) -> Contact {
    let upwards =
        Press { direction: UP, goal: Goal::Depth(depth), start: Start::Infinity, balance: Balance::None };
    press(surface, obstacle, skin, &upwards, &ContactOptions::on_given_mesh()).expect("a valid request")
}

/// A ball of skin, its lowest point near the origin.
fn ball(radius: f64, subdivisions: usize) -> Surface {
    let (mut vertices, faces) = icosphere(radius, subdivisions);
    vertices.iter_mut().for_each(|vertex| vertex.z += radius);
    Surface::new(vertices, faces).expect("a valid surface")
}

fn plate() -> Obstacle {
    Obstacle::half_space(Vector3::zeros(), UP).expect("a valid obstacle")
}

/// Flat lattice of `count`² cells with edges `first` and `second`, each cut by the diagonal between them, about the
/// origin moved by `shift`; inner vertices moved by up to `jitter` of `first`.
fn lattice(
    count: usize,
    [first, second]: [Vector3<f64>; 2],
    shift: Vector3<f64>,
    jitter: f64,
    random: &mut Random,
) -> Surface {
    let (mut vertices, faces) = one_diagonal_grid(count);
    for vertex in &mut vertices {
        let inner = [vertex.x, vertex.y].iter().all(|&at| 0.5 < at && at < count as f64 - 0.5);
        let mut moved = || if inner { jitter * first.norm() * (2.0 * random.next() - 1.0) } else { 0.0 };
        let moved = Vector3::new(moved(), moved(), 0.0);
        let (i, j) = (vertex.x - 0.5 * count as f64, vertex.y - 0.5 * count as f64);
        *vertex = i * first + j * second + shift + moved;
    }
    Surface::new(vertices, faces).expect("a valid surface")
}
