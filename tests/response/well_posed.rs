//! For which constants a kernel is well posed, the volume that it moves, and what the advice says where it is not.

use std::f64::consts::TAU;

use quasirigid::response::{Kernel, KernelSkin, ResponseError, balanced_height};

use super::*;

fn gaussian(height: f64, width: f64, cutoff: f64) -> KernelSkin {
    skin(Kernel::GaussianCorrected { height, width, cutoff })
}

#[test]
fn balanced_height_at_three_widths_is_that_of_the_paper() {
    let constant = gaussian(0.0, 5e-3, 15e-3).kernel_constant();
    let height = balanced_height(constant, 5e-3, 15e-3).expect("valid");
    let closed = 3.0 * constant / (5e-3 * (1.0 - (-4.5f64).exp()));
    assert!((height / closed - 1.0).abs() < 1e-14);
    assert!((height - 0.805e-3).abs() < 1e-6);
    let balanced = gaussian(height, 5e-3, 15e-3);
    assert!(balanced.net_volume().abs() < 1e-15 * TAU * constant * 15e-3);
    for (k, c, l, name) in
        [(0.0, 1.0, 1.0, "kernel_constant"), (1.0, -1.0, 1.0, "width"), (1.0, 1.0, f64::INFINITY, "cutoff")]
    {
        match balanced_height(k, c, l) {
            Err(ResponseError::Constant { name: found, .. }) => assert_eq!(found, name),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn the_papers_constants_are_ill_posed_at_the_known_wave_lengths() {
    // without cutoff: 16.9 to 89 mm; cut off at 15 mm: above 15.2 mm
    let (from, to) = gaussian(0.8e-3, 5e-3, f64::INFINITY).ill_posed_wavelengths().expect("ill posed");
    assert!((from - 16.9e-3).abs() < 0.2e-3 && (to - 89e-3).abs() < 1e-3, "{from} {to}");
    let skin = gaussian(0.8e-3, 5e-3, 15e-3);
    let (from, _) = skin.ill_posed_wavelengths().expect("ill posed");
    assert!((from - 15.2e-3).abs() < 0.2e-3, "{from}");
    let why = skin.ill_posedness().expect("a warning");
    assert!(why.contains("4.37") && why.contains("from 15.3 to"), "{why}");
}

#[test]
fn constants_within_the_bound_are_well_posed() {
    let constant = gaussian(0.0, 5e-3, 15e-3).kernel_constant();
    let bound = constant * 0.5f64.exp() / 5e-3;
    assert_eq!(gaussian(0.999 * bound, 5e-3, f64::INFINITY).ill_posedness(), None);
    assert!(gaussian(1.01 * bound, 5e-3, f64::INFINITY).ill_posedness().is_some());
    let height = balanced_height(constant, 8e-3, 15e-3).expect("valid");
    assert_eq!(gaussian(height, 8e-3, 15e-3).ill_posed_wavelengths(), None);
}

#[test]
fn a_layer_moves_the_volume_of_confined_compression() {
    let skin = |nu| {
        let response = Kernel::Layer { thickness: 2e-3.into() };
        KernelSkin::new(60e3, nu, response).expect("valid constants")
    };
    assert_eq!(skin(0.5).net_volume(), 0.0);
    for nu in [0.0, 0.3, 0.45] {
        let long_wave = skin(nu).symbol(1e-2);
        assert!((long_wave / skin(nu).net_volume() - 1.0).abs() < 1e-4, "{nu}");
    }
}
