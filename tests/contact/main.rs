//! The whole pipeline through the public API: scenes, and the skins and obstacles that they share.

use nalgebra::Vector3;
use quasirigid::contact::{Balance, Contact, ContactOptions, Goal, Press, Start, press, solve_contact};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::{ElasticSkin, KernelSkin};
use quasirigid::surface::Surface;

use common::{
    POISSON_RATIO, Random, SHEAR_MODULUS, galerkin, half_space, icosphere, one_diagonal_grid, skin, surface,
};

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

const UP: Vector3<f64> = Vector3::new(0.0, 0.0, 1.0);

fn solve(surface: &Surface, obstacle: &Obstacle, skin: &KernelSkin) -> Contact {
    solve_contact(surface, obstacle, skin, &ContactOptions::on_given_mesh()).expect("a valid request")
}

/// A press from infinity that does not turn.
fn along(direction: Vector3<f64>, goal: Goal) -> Press {
    Press { direction, goal, start: Start::Infinity, balance: Balance::None }
}

fn upwards(goal: Goal) -> Press {
    along(UP, goal)
}

fn pressed(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    goal: Goal,
    options: &ContactOptions,
) -> Contact {
    press(surface, obstacle, skin, &upwards(goal), options).expect("a goal within reach")
}

fn press_up(surface: &Surface, obstacle: &Obstacle, skin: &dyn ElasticSkin, depth: f64) -> Contact {
    pressed(surface, obstacle, skin, Goal::Depth(depth), &ContactOptions::on_given_mesh())
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
