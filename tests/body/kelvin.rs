//! Kelvin's kernels against one another.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use quasirigid::response::body::kelvin::Kelvin;

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
                (kelvin.displacement(&(r + h))[(i, m)] - kelvin.displacement(&(r - h))[(i, m)]) / (2.0 * step)
            })
            .sum();
        assert!(divergence.abs() < 1e-9);
    }
}
