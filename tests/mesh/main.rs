//! Meshes and surfaces through the public interface; the meshes that their tests share.

use std::f64::consts::TAU;

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use quasirigid::mesh::{MeshError, Repair, RepairOptions, check, check_nesting, repair};

use common::{Mesh, surface};

mod collection;
#[path = "../common/mod.rs"]
mod common;
mod crossings;
mod cut_out;
mod defects;
mod measures;
mod nesting;
mod repair;
mod searches;
mod topology;

/// Corner tetrahedron with edges of 1 along the axes, volume 1/6.
fn tetrahedron() -> Mesh {
    let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
    (vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

fn nesting(mesh: &Mesh) -> Result<(), MeshError> {
    let topology = check(&mesh.0, &mesh.1).expect("each component is sound");
    check_nesting(&mesh.0, &mesh.1, &topology)
}

fn shifted(mesh: &Mesh, by: Vector3<f64>) -> Mesh {
    (mesh.0.iter().map(|point| point + by).collect(), mesh.1.clone())
}

fn welded(mesh: &Mesh, weld_tolerance: f64) -> Result<Repair, MeshError> {
    repair(&mesh.0, &mesh.1, &RepairOptions { weld_tolerance })
}

/// Unit cube, two faces a side, all diagonals through vertex 0 or the one opposite to it.
fn unit_cube() -> Mesh {
    let vertices = (0..8).map(|i| Vector3::from_fn(|k, _| f64::from(i >> k & 1))).collect();
    let quads = [[0, 2, 3, 1], [7, 6, 4, 5], [0, 1, 5, 4], [7, 3, 2, 6], [0, 4, 6, 2], [7, 5, 1, 3]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// Tube about z from 0 to `height` with `sectors` squares around; each end closed by rings around a middle
/// vertex if asked.
fn tube(radius: f64, height: f64, sectors: usize, capped: bool) -> Mesh {
    let spacing = TAU * radius / sectors as f64;
    let rows = (height / spacing).ceil() as usize;
    let rings = (radius / spacing).ceil() as usize;
    let mut profile: Vec<(f64, f64)> = Vec::new();
    let radii = (1..rings).map(|i| radius * i as f64 / rings as f64);
    if capped {
        profile.extend(radii.clone().map(|r| (r, 0.0)));
    }
    profile.extend((0..=rows).map(|i| (radius, height * i as f64 / rows as f64)));
    if capped {
        profile.extend(radii.rev().map(|r| (r, height)));
    }
    let mut vertices = Vec::new();
    for (r, z) in &profile {
        vertices.extend((0..sectors).map(|i| {
            let angle = TAU * i as f64 / sectors as f64;
            Vector3::new(r * angle.cos(), r * angle.sin(), *z)
        }));
    }
    let at = |row: usize, i: usize| (row * sectors + i % sectors) as u32;
    let mut faces = Vec::new();
    for row in 0..profile.len() - 1 {
        for i in 0..sectors {
            let (a, b, c, d) = (at(row, i), at(row, i + 1), at(row + 1, i + 1), at(row + 1, i));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    if capped {
        let (bottom, top) = (vertices.len() as u32, vertices.len() as u32 + 1);
        vertices.extend([Vector3::zeros(), Vector3::new(0.0, 0.0, height)]);
        for i in 0..sectors {
            faces.push([bottom, at(0, i + 1), at(0, i)]);
            faces.push([top, at(profile.len() - 1, i), at(profile.len() - 1, i + 1)]);
        }
    }
    (vertices, faces)
}

fn a_pose() -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_euler_angles(0.3, -1.1, 2.0);
    Isometry3::from_parts(Vector3::new(0.2, -0.1, 0.05).into(), rotation)
}
