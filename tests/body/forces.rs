//! Forces of a plate on a sphere with a core against finite elements, their convergence and their incompressible limit.

use approx::assert_relative_eq;
use faer::Mat;
use faer::prelude::Solve;
use nalgebra::Vector3;
use quasirigid::reference::{CoredSphere, plate_on_cored_sphere};
use quasirigid::response::body::BodyCompliance;
use quasirigid::surface::Surface;

use crate::{cap_nodes, drawn_sphere, prepare, sphere, with_bone};

const RADIUS: f64 = CoredSphere::RADIUS;

/// Forces of `g = g0 + R f >= 0`, `f >= 0`, `g f = 0` by exchanging nodes until none has the wrong sign.
pub fn contact_forces(response: &Mat<f64>, gaps: &[f64]) -> Vec<f64> {
    let all = 0..gaps.len();
    let depth = gaps.iter().fold(0.0_f64, |a, g| a.max(-g));
    let mut active: Vec<usize> = all.clone().filter(|&i| gaps[i] < 0.0).collect();
    for _ in 0..100 {
        let matrix = Mat::from_fn(active.len(), active.len(), |i, j| response[(active[i], active[j])]);
        let right = Mat::from_fn(active.len(), 1, |i, _| -gaps[active[i]]);
        let solved = matrix.partial_piv_lu().solve(right);
        let mut forces = vec![0.0; gaps.len()];
        active.iter().enumerate().for_each(|(row, &i)| forces[i] = solved[(row, 0)]);
        let gap = |i: usize| gaps[i] + active.iter().map(|&j| response[(i, j)] * forces[j]).sum::<f64>();
        let next: Vec<usize> = all
            .clone()
            .filter(|&i| if forces[i] == 0.0 { gap(i) < -1e-9 * depth } else { forces[i] > 0.0 })
            .collect();
        if next == active {
            return forces;
        }
        active = next;
    }
    panic!("the active set does not settle");
}

/// Force (N) of a flat frictionless plate on a sphere about the origin, pressed upwards by `depth`.
fn plate_force(skin: &Surface, compliance: &BodyCompliance, depth: f64) -> f64 {
    let up = vec![Vector3::z(); compliance.nodes().len()];
    let gaps: Vec<f64> = compliance.nodes().iter().map(|&i| skin.vertices()[i].z + RADIUS - depth).collect();
    contact_forces(&compliance.response_along(&up).expect("unit directions"), &gaps).iter().sum()
}

#[test]
fn a_plate_on_a_sphere_with_a_core_meets_the_finite_element_force() {
    let skin = drawn_sphere(RADIUS, 3, 4.0);
    let body = with_bone(drawn_sphere(CoredSphere::CORE_RADIUS, 2, 2.0));
    let nodes = cap_nodes(&skin, RADIUS, 1.3e-3);
    for CoredSphere { poisson_ratio, indentations, .. } in plate_on_cored_sphere() {
        let compliance = prepare(&body, &skin, poisson_ratio, &nodes);
        for (depth, expected) in indentations {
            let force = plate_force(&skin, &compliance, depth);
            assert_relative_eq!(force, expected, max_relative = 0.02);
        }
    }
}

#[test]
fn the_force_converges_under_refinement() {
    let CoredSphere { poisson_ratio, indentations, .. } = plate_on_cored_sphere()[0];
    let (depth, expected) = indentations[3];
    let errors = [1, 2, 3].map(|subdivisions| {
        let skin = drawn_sphere(RADIUS, subdivisions, 3.0);
        let nodes = cap_nodes(&skin, RADIUS, 1.6e-3);
        let body = with_bone(sphere(CoredSphere::CORE_RADIUS, subdivisions));
        let compliance = prepare(&body, &skin, poisson_ratio, &nodes);
        (plate_force(&skin, &compliance, depth) / expected - 1.0).abs()
    });
    let falls = errors[2] < 0.5 * errors[1] && errors[1] < 0.5 * errors[0];
    assert!(errors[2] < 0.01 && falls, "errors {errors:?} at 42, 162, 642 vertices");
}

#[test]
fn the_force_is_continuous_as_the_tissue_becomes_incompressible() {
    let skin = drawn_sphere(RADIUS, 2, 3.0);
    let nodes = cap_nodes(&skin, RADIUS, 1.6e-3);
    let body = with_bone(sphere(5e-3, 2));
    let force = |nu: f64| plate_force(&skin, &prepare(&body, &skin, nu, &nodes), 0.6e-3);
    let limit = force(0.5);
    for (poisson_ratio, bound) in [(0.4999, 1e-2), (0.499999, 1e-4), (0.49999999, 1e-6)] {
        let difference = force(poisson_ratio) / limit - 1.0;
        assert!(difference < 0.0 && difference.abs() < bound, "nu {poisson_ratio}: {difference:e}");
    }
}
