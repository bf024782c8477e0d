//! Kelvin's solution: an infinite elastic solid loaded by a point force.
//!
//! With `r = y - x` from the force to the point looked at, `r^` its unit vector, `G = 1` and the
//! *compressibility* `e = 1 - 2 nu` (0 for an incompressible solid, 1 for `nu = 0`):
//!
//! ```text
//! U_ij = 1 / (8 pi (1 + e) r)   { (1 + 2 e) d_ij + r^_i r^_j }
//! T_ij = -1 / (4 pi (1 + e) r²) { dr/dn (e d_ij + 3 r^_i r^_j) - e (r^_i n_j - r^_j n_i) }
//! ```
//!
//! (Brebbia, Telles, Wrobel 1984, §5.3, with `nu` written through `e`.) `U_ij` is the displacement along `j`
//! under a unit force along `i`; `T_ij` the traction along `j` on a surface with unit normal `n`. Everything
//! is finite at `e = 0`.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

/// Kelvin's solution for a shear modulus of 1 and a given Poisson ratio.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kelvin {
    compressibility: f64,
}

impl Kelvin {
    /// Kelvin's solution for a Poisson ratio ν, 0 ..= 0.5.
    pub fn new(poisson_ratio: f64) -> Self {
        debug_assert!((0.0..=0.5).contains(&poisson_ratio));
        Kelvin { compressibility: 1.0 - 2.0 * poisson_ratio }
    }

    /// `1 - 2 ν`: 0 for an incompressible solid, 1 for ν = 0.
    pub fn compressibility(&self) -> f64 {
        self.compressibility
    }

    /// Displacement kernel `U` (1/m for G = 1) at `r` (m) from the force.
    pub fn displacement(&self, r: &Vector3<f64>) -> Matrix3<f64> {
        let distance = r.norm();
        let (isotropic, outer) = self.displacement_factors();
        let unit = r / distance;
        (Matrix3::identity() * isotropic + unit * unit.transpose() * outer) / distance
    }

    /// Traction kernel `T` (1/m²) at `r` (m) from the force on a surface with unit normal `normal`.
    pub fn traction(&self, r: &Vector3<f64>, normal: &Vector3<f64>) -> Matrix3<f64> {
        let distance = r.norm();
        let (isotropic, outer, skew) = self.traction_factors();
        let unit = r / distance;
        let slope = unit.dot(normal);
        (Matrix3::identity() * (isotropic * slope)
            + unit * unit.transpose() * (outer * slope)
            + (unit * normal.transpose() - normal * unit.transpose()) * skew)
            / (distance * distance)
    }

    /// Factors of `I / r` and `r^ r^' / r` in `U`.
    pub(crate) fn displacement_factors(&self) -> (f64, f64) {
        let e = self.compressibility;
        let scale = 1.0 / (8.0 * PI * (1.0 + e));
        (scale * (1.0 + 2.0 * e), scale)
    }

    /// Factors of `dr/dn I / r²`, `dr/dn r^ r^' / r²` and `(r^ n' - n r^') / r²` in `T`.
    pub(crate) fn traction_factors(&self) -> (f64, f64, f64) {
        let e = self.compressibility;
        let scale = -1.0 / (4.0 * PI * (1.0 + e));
        (scale * e, scale * 3.0, -scale * e)
    }
}
