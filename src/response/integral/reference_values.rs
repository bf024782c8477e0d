//! Hat integrals by quadrature at 60 digits: `tests/data/hat_integrals.csv`, made by the script beside it.

use nalgebra::Vector3;

/// Integrals of the hats of a triangle, seen from a point.
pub(crate) struct ReferenceIntegrals {
    /// Corners (m).
    pub triangle: [Vector3<f64>; 3],
    /// Point (m).
    pub point: Vector3<f64>,
    /// Width of the Gaussian (m).
    pub width: f64,
    /// Against 1/r (m).
    pub inverse: [f64; 3],
    /// Against the Gaussian (m²).
    pub gaussian: [f64; 3],
}

/// Five triangles (well shaped, random, two slivers, one 2e-6 m high) at 13 points each: vertices, edges, face, 1e-9 m
/// off the plane, near, and up to three edge lengths away.
pub(crate) fn reference_integrals() -> Vec<ReferenceIntegrals> {
    let table = include_str!("../../../tests/data/hat_integrals.csv");
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
        let vector = |k: usize| Vector3::from_column_slice(&numbers[k..k + 3]);
        ReferenceIntegrals {
            triangle: [vector(0), vector(3), vector(6)],
            point: vector(9),
            width: numbers[12],
            inverse: vector(13).into(),
            gaussian: vector(16).into(),
        }
    };
    table.lines().skip(1).map(row).collect()
}
