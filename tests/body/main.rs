//! The body response through the public API; the bodies that its tests share.

use nalgebra::Vector3;
use quasirigid::reference::CoredSphere;
use quasirigid::response::body::{Body, BodyCompliance, BodyOptions};
use quasirigid::surface::Surface;

use common::surface;

#[path = "../common/mod.rs"]
mod common;
mod endings;
mod fields;
mod forces;
mod invariance;
mod kelvin;
mod levels;
mod stored;

const SHEAR_MODULUS: f64 = CoredSphere::SHEAR_MODULUS;

fn sphere(radius: f64, subdivisions: usize) -> Surface {
    surface(common::icosphere(radius, subdivisions))
}

/// Sphere drawn towards -z by a conformal map: `draw` times finer at that pole than on average.
fn drawn_sphere(radius: f64, subdivisions: usize, draw: f64) -> Surface {
    let (vertices, faces) = common::icosphere(1.0, subdivisions);
    let drawn = vertices.into_iter().map(|p| {
        let polar = 2.0 * ((0.5 * p.x.hypot(p.y).atan2(-p.z)).tan() / draw).atan();
        let around = p.y.atan2(p.x);
        Vector3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), -polar.cos()) * radius
    });
    surface((drawn.collect(), faces))
}

fn with_bone(bone: Surface) -> Body {
    Body { bone: Some(bone), fixed: None, coarse_edge_length: None }
}

fn prepare(body: &Body, skin: &Surface, poisson_ratio: f64, nodes: &[usize]) -> BodyCompliance {
    body.prepare(skin, SHEAR_MODULUS, poisson_ratio, nodes, &BodyOptions::default()).expect("a sound body")
}

fn all_nodes(skin: &Surface) -> Vec<usize> {
    (0..skin.vertices().len()).collect()
}

/// Skin vertices less than `height` above the lowest point of a sphere about the origin.
fn cap_nodes(skin: &Surface, radius: f64, height: f64) -> Vec<usize> {
    (0..skin.vertices().len()).filter(|&i| skin.vertices()[i].z < height - radius).collect()
}

/// Forces of a uniform pressure (Pa) on every vertex.
fn pressure_forces(skin: &Surface, pressure: f64) -> Vec<Vector3<f64>> {
    skin.vertex_normals().iter().zip(skin.vertex_areas()).map(|(n, area)| n * (-pressure * area)).collect()
}
