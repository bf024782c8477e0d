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
    /// Kelvin's solution for `poisson_ratio` (0 ≤ ν ≤ 0.5), which the caller has checked.
    pub(crate) fn new(poisson_ratio: f64) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn somewhere() -> Vector3<f64> {
        Vector3::new(0.3, -0.7, 0.45)
    }

    /// Traction from the displacement by central differences and Hooke's law with G = 1.
    fn traction_by_differences(kelvin: &Kelvin, r: &Vector3<f64>, normal: &Vector3<f64>) -> Matrix3<f64> {
        let e = kelvin.compressibility();
        let lame = (1.0 - e) / e;
        let step = 1e-5;
        let slope: Vec<Matrix3<f64>> = (0..3)
            .map(|axis| {
                let h = Vector3::ith(axis, step);
                (kelvin.displacement(&(r + h)) - kelvin.displacement(&(r - h))) / (2.0 * step)
            })
            .collect();
        Matrix3::from_fn(|i, j| {
            let divergence: f64 = (0..3).map(|m| slope[m][(i, m)]).sum();
            let shear: f64 = (0..3).map(|m| (slope[m][(i, j)] + slope[j][(i, m)]) * normal[m]).sum();
            lame * divergence * normal[j] + shear
        })
    }

    #[test]
    fn the_traction_kernel_is_the_stress_of_the_displacement_kernel() {
        let normal = Vector3::new(1.0, 2.0, -0.5).normalize();
        for nu in [0.0, 0.2, 0.3, 0.45, 0.49] {
            let kelvin = Kelvin::new(nu);
            let expected = traction_by_differences(&kelvin, &somewhere(), &normal);
            let found = kelvin.traction(&somewhere(), &normal);
            assert!((found - expected).amax() < 1e-7, "nu = {nu}: {found} {expected}");
        }
    }

    #[test]
    fn an_incompressible_solid_has_a_divergence_free_displacement_and_the_closed_form_traction() {
        let kelvin = Kelvin::new(0.5);
        let r = somewhere();
        let normal = Vector3::new(0.2, -0.3, 1.0).normalize();
        let unit = r.normalize();
        let expected = unit * unit.transpose() * (-3.0 / (4.0 * PI * r.norm_squared()) * unit.dot(&normal));
        assert!((kelvin.traction(&r, &normal) - expected).amax() < 1e-15);
        let step = 1e-5;
        for i in 0..3 {
            let divergence: f64 = (0..3)
                .map(|m| {
                    let h = Vector3::ith(m, step);
                    (kelvin.displacement(&(r + h))[(i, m)] - kelvin.displacement(&(r - h))[(i, m)])
                        / (2.0 * step)
                })
                .sum();
            assert!(divergence.abs() < 1e-9);
        }
    }
}
