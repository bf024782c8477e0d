//! Obstacles through the public interface; the shapes that their tests share.

use nalgebra::Vector3;
use quasirigid::obstacle::{MeshObstacleOptions, Obstacle};

use common::{Mesh, Random, v};

#[path = "../common/mod.rs"]
mod common;
mod first_touch;
mod invariance;
mod meshes;
mod primitives;
mod refusals;

fn mesh_obstacle((vertices, faces): Mesh) -> Obstacle {
    Obstacle::mesh(vertices, faces, &MeshObstacleOptions::default()).expect("a good mesh")
}

/// Distance, closest point, normal.
fn ask(obstacle: &Obstacle, point: Vector3<f64>) -> (f64, Vector3<f64>, Vector3<f64>) {
    let found = obstacle.signed_distance(&[point], None).expect("a finite point");
    (found.distance[0], found.closest[0], found.normal[0])
}

#[track_caller]
fn assert_near(found: Vector3<f64>, expected: Vector3<f64>, tolerance: f64) {
    assert!((found - expected).norm() <= tolerance, "found {found:?}, expected {expected:?}");
}

/// The box with these half extents as 12 triangles.
fn box_mesh(h: Vector3<f64>) -> Mesh {
    let corner = |i: usize| {
        let side = |bit: usize, h: f64| if i & bit == 0 { -h } else { h };
        v(side(1, h.x), side(2, h.y), side(4, h.z))
    };
    #[rustfmt::skip]
    let faces = vec![
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ];
    ((0..8).map(corner).collect(), faces)
}

fn random_points(random: &mut Random, count: usize, reach: f64) -> Vec<Vector3<f64>> {
    (0..count).map(|_| Vector3::from_fn(|_, _| (2.0 * random.next() - 1.0) * reach)).collect()
}

fn random_direction(random: &mut Random) -> Vector3<f64> {
    loop {
        let direction = random_points(random, 1, 1.0)[0];
        if (0.1..1.0).contains(&direction.norm()) {
            return direction.normalize();
        }
    }
}

fn primitives() -> Vec<Obstacle> {
    vec![
        Obstacle::half_space(v(0.1, 0.0, -0.2), v(1.0, 2.0, -0.5)).unwrap(),
        Obstacle::sphere(v(0.1, -0.2, 0.3), 0.4).unwrap(),
        Obstacle::cuboid(v(0.3, 0.2, 0.5)).unwrap(),
        Obstacle::capsule(v(-0.3, 0.1, 0.0), v(0.4, 0.2, 0.2), 0.2).unwrap(),
        Obstacle::cylinder(0.4, 0.3).unwrap(),
    ]
}
