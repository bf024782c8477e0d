//! What the tests share: the meshes on disk, small meshes with known properties, and a skin.
#![allow(dead_code)] // each test program uses a part of it

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use quasirigid::response::{Discretization, Kernel, KernelSkin};
use quasirigid::surface::Surface;

pub use sample::*;

#[path = "../../src/sample.rs"]
mod sample;

/// G (Pa) and ν of the skin.
pub const SHEAR_MODULUS: f64 = 60e3;
pub const POISSON_RATIO: f64 = 0.5;

pub fn v(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

pub fn surface((vertices, faces): Mesh) -> Surface {
    Surface::new(vertices, faces).expect("a sound mesh")
}

pub fn skin(kernel: Kernel) -> KernelSkin {
    KernelSkin::new(SHEAR_MODULUS, POISSON_RATIO, kernel).expect("valid constants")
}

pub fn half_space() -> KernelSkin {
    skin(Kernel::HalfSpace)
}

/// The half-space in Galerkin form.
pub fn galerkin() -> KernelSkin {
    half_space().with_discretization(Discretization::Galerkin).expect("a half-space has it")
}

/// The folder of test meshes: `QUASIRIGID_DATA`, default `../shared/data`; prints why if that is absent.
///
/// Panics if the variable names a folder that holds none.
pub fn data_dir() -> Option<PathBuf> {
    let named = std::env::var_os("QUASIRIGID_DATA").map(PathBuf::from);
    let is_named = named.is_some();
    let path = named.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data"));
    if path.join("hands").is_dir() {
        return Some(path);
    }
    assert!(!is_named, "QUASIRIGID_DATA: no meshes in {}", path.display());
    println!("skipped: no meshes in {} (set QUASIRIGID_DATA)", path.display());
    None
}

/// Reads a binary little-endian PLY of float32 points and triangles (list uchar int), and nothing else.
///
/// Panics with the reason if the file is another.
pub fn read_ply(path: &Path) -> Mesh {
    try_read_ply(path).unwrap_or_else(|reason| panic!("{}: {reason}", path.display()))
}

/// As [`read_ply`], with the reason as an error.
pub fn try_read_ply(path: &Path) -> Result<Mesh, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    let marker = b"end_header\n";
    let header_end =
        bytes.windows(marker.len()).position(|window| window == marker).ok_or("no end_header")?
            + marker.len();
    let header = std::str::from_utf8(&bytes[..header_end]).map_err(|error| error.to_string())?;
    let count = |element: &str| {
        let prefix = format!("element {element} ");
        let line = header.lines().find_map(|line| line.strip_prefix(&prefix));
        line.and_then(|number| number.trim().parse::<usize>().ok()).ok_or(format!("no element {element}"))
    };
    let (vertex_count, face_count) = (count("vertex")?, count("face")?);
    let body = &bytes[header_end..];
    let expected = 12 * vertex_count + 13 * face_count;
    if body.len() != expected {
        return Err(format!("{} bytes after the header, expected {expected}", body.len()));
    }
    let word = |at: usize| <[u8; 4]>::try_from(&body[at..at + 4]).expect("four bytes");
    let vertices = (0..vertex_count)
        .map(|i| Vector3::from_fn(|k, _| f64::from(f32::from_le_bytes(word(12 * i + 4 * k)))))
        .collect();
    let faces = (0..face_count)
        .map(|i| {
            let at = 12 * vertex_count + 13 * i;
            assert_eq!(body[at], 3, "face {i} is no triangle");
            [0, 1, 2].map(|k| u32::from_le_bytes(word(at + 1 + 4 * k)))
        })
        .collect();
    Ok((vertices, faces))
}
