//! The layer's kernel: known values, its table against quadrature, its symbol.

use std::sync::Arc;

use quasirigid::reference::{layer_correction_at_load, point_load_on_layer};
use quasirigid::response::{LayerKernel, ResponseError};

use super::gauss_rule;

#[test]
fn smooth_part_at_the_origin_has_its_known_values() {
    for (nu, expected) in layer_correction_at_load() {
        let kernel = LayerKernel::new(nu).expect("in range");
        assert!((kernel.smooth_part(0.0) - expected).abs() < 5e-5);
    }
}

#[test]
fn incompressible_kernel_has_its_known_values() {
    let kernel = LayerKernel::new(0.5).expect("in range");
    for (rho, expected) in point_load_on_layer() {
        assert!((kernel.value(rho) - expected).abs() < 1e-5, "{rho}: {}", kernel.value(rho));
    }
}

#[test]
fn table_is_accurate_to_1e_11() {
    for nu in [0.0, 0.3, 0.5] {
        let kernel = LayerKernel::new(nu).expect("in range");
        // independent quadrature: other panels, other points
        let mut points = Vec::new();
        for panel in 0..90 {
            for (u, w) in gauss_rule(16) {
                let t = 0.25 * (panel as f64 + u);
                points.push((t, 0.25 * w * (1.0 - LayerKernel::symbol(t, nu))));
            }
        }
        for i in 0..200 {
            let rho = 0.157 * i as f64;
            let expected: f64 = points.iter().map(|(t, w)| w * libm::j0(rho * t)).sum();
            assert!(
                (kernel.smooth_part(rho) - expected).abs() < 1e-11,
                "{nu} {rho}: {}",
                kernel.smooth_part(rho) - expected
            );
        }
    }
}

#[test]
fn symbol_grows_from_zero_to_one_for_every_ratio() {
    // on this rests that the matrix of a layer of varying thickness is positive definite
    for i in 0..=50 {
        let nu = 0.01 * i as f64;
        let mut before = 0.0;
        for k in 0..4000 {
            let w = LayerKernel::symbol(0.005 * k as f64, nu);
            assert!(w >= before - 2e-16 && w <= 1.0, "{nu} {k}");
            before = w;
        }
        assert!(LayerKernel::symbol(0.0, nu).abs() < 1e-15 && 1.0 - before < 1e-12);
    }
}

#[test]
fn kernels_are_kept_and_ratios_checked() {
    let (one, two) = (LayerKernel::new(0.37).expect("in range"), LayerKernel::new(0.37).expect("in range"));
    assert!(Arc::ptr_eq(&one, &two));
    for nu in [-0.01, 0.51, f64::NAN] {
        assert!(matches!(LayerKernel::new(nu), Err(ResponseError::Constant { name: "poisson_ratio", .. })));
    }
}
