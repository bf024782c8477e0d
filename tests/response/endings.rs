//! Refused constants and requests, interruptions.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::Vector3;
use quasirigid::response::{
    AssemblyOptions, ElasticSkin, Kernel, KernelSkin, NodesError, PreparedKernel, Request, ResponseError,
    Thickness, assemble,
};

use super::*;

fn constant_error(result: Result<KernelSkin, ResponseError>) -> (&'static str, f64) {
    match result {
        Err(ResponseError::Constant { name, value, .. }) => (name, value),
        other => panic!("expected a refused constant, found {other:?}"),
    }
}

#[test]
fn constants_out_of_range_are_named_with_their_value() {
    assert_eq!(constant_error(KernelSkin::new(0.0, 0.5, HALF_SPACE)), ("shear_modulus", 0.0));
    assert_eq!(constant_error(KernelSkin::new(-1.0, 0.5, HALF_SPACE)), ("shear_modulus", -1.0));
    assert_eq!(constant_error(KernelSkin::new(1e200, 0.5, HALF_SPACE)), ("shear_modulus", 1e200));
    assert_eq!(constant_error(KernelSkin::new(1e-61, 0.5, HALF_SPACE)), ("shear_modulus", 1e-61));
    assert_eq!(constant_error(KernelSkin::new(f64::NAN, 0.5, HALF_SPACE)).0, "shear_modulus");
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.51, HALF_SPACE)), ("poisson_ratio", 0.51));
    assert_eq!(constant_error(KernelSkin::new(60e3, -0.1, HALF_SPACE)), ("poisson_ratio", -0.1));
    let gaussian = |height, width, cutoff| {
        KernelSkin::new(60e3, 0.5, Kernel::GaussianCorrected { height, width, cutoff })
    };
    assert_eq!(constant_error(gaussian(-1e-3, 5e-3, 15e-3)), ("height", -1e-3));
    assert_eq!(constant_error(gaussian(1e-3, 0.0, 15e-3)), ("width", 0.0));
    assert_eq!(constant_error(gaussian(1e-3, 5e-3, -1.0)), ("cutoff", -1.0));
    assert!(gaussian(1e-3, 5e-3, f64::INFINITY).is_ok());
}

#[test]
fn malformed_requests_say_what_is_wrong_and_where() {
    let surface = grid(3, 3e-3, 0.0, 0.0);
    let ask = |nodes: &[usize], options: AssemblyOptions| {
        assemble(&surface, &skin(HALF_SPACE), nodes, &options).expect_err("malformed")
    };
    let kernel = skin(HALF_SPACE);
    let prepared = PreparedKernel::new(&surface, &kernel, &[2, 4], &AssemblyOptions::default());
    let prepared = prepared.expect("known nodes");
    let along = |nodes: &[usize], directions: &[Vector3<f64>]| {
        let asked = Request { surface: &surface, nodes, options: &AssemblyOptions::default() };
        let of = |skin: &dyn ElasticSkin| skin.matrix(&asked, directions).expect_err("malformed");
        assert_eq!(of(&kernel), of(&prepared));
        of(&kernel)
    };
    let plain = AssemblyOptions::default();
    assert_eq!(
        ask(&[1, 16], plain),
        NodesError::OutOfRange { index: 1, vertex: 16, vertex_count: 16 }.into()
    );
    assert_eq!(ask(&[4, 2, 4], plain), NodesError::Repeated { vertex: 4, first: 0, second: 2 }.into());
    let up = Vector3::z();
    assert_eq!(along(&[4, 2], &[up]), ResponseError::DirectionCount { directions: 1, nodes: 2 });
    assert_eq!(along(&[4, 2], &[up, Vector3::zeros()]), ResponseError::Direction { index: 1, length: 0.0 });
    let small = AssemblyOptions { memory_limit: Some(100), ..plain };
    assert_eq!(ask(&[0, 1, 2, 3], small), ResponseError::TooLarge { nodes: 4, bytes: 128, limit: 100 });
    for (options, name) in [
        (AssemblyOptions { tolerance: -1.0, ..plain }, "tolerance"),
        (AssemblyOptions { tolerance: f64::NAN, ..plain }, "tolerance"),
        (AssemblyOptions { num_threads: Some(0), ..plain }, "num_threads"),
    ] {
        match ask(&[0], options) {
            ResponseError::Constant { name: found, .. } => assert_eq!(found, name),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn displacements_need_no_more_memory_than_the_matrix_had() {
    let surface = grid(14, 14e-3, 0.0, 0.0);
    let (nodes, everywhere) = ([100, 101, 116], all(&surface));
    let forces = [Vector3::z(); 3];
    let displaced = |memory_limit| {
        let options = AssemblyOptions { memory_limit, ..AssemblyOptions::default() };
        let asked = Request { surface: &surface, nodes: &nodes, options: &options };
        skin(layer(2e-3)).displace(&asked, &forces, &everywhere).expect("room for three rows")
    };
    let (at_once, in_strips) = (displaced(None), displaced(Some(3 * 3 * size_of::<f64>())));
    for (one, other) in at_once.iter().zip(&in_strips) {
        assert!((one - other).norm() <= 1e-6 * at_once[100].norm());
    }
}

#[test]
fn an_interrupted_assembly_says_how_far_it_came() {
    let surface = grid(14, 14e-3, 0.0, 0.0);
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) == 1;
    let options = AssemblyOptions { num_threads: Some(1), interrupt: Some(&stop), ..Default::default() };
    let result = assemble(&surface, &skin(HALF_SPACE), &all(&surface), &options);
    assert_eq!(result.expect_err("stopped"), ResponseError::Interrupted { columns: 64, nodes: 225 });
}

#[test]
fn thicknesses_are_checked() {
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.5, layer(0.0))), ("thickness", 0.0));
    assert_eq!(constant_error(KernelSkin::new(60e3, 0.5, layer(-1e-3))), ("thickness", -1e-3));
    let response = Kernel::Layer { thickness: Thickness::PerVertex(vec![1e-3; 5].into()) };
    let surface = grid(3, 3e-3, 0.0, 0.0);
    let refused = assemble(&surface, &skin(response), &[0], &AssemblyOptions::default());
    assert_eq!(
        refused.expect_err("too short"),
        ResponseError::ThicknessCount { thicknesses: 5, vertex_count: 16 }
    );
    // metres taken for micrometres, everywhere and at one vertex
    let mut list = vec![1e-3; 16];
    list[7] = 1e-8;
    for (thickness, vertex) in [(Thickness::from(1e-8), 0), (Thickness::PerVertex(list.into()), 7)] {
        let skin = skin(Kernel::Layer { thickness });
        let refused = assemble(&surface, &skin, &[0], &AssemblyOptions::default());
        let edge_length = surface.mean_edge_length();
        let expected = ResponseError::TooThin { vertex, thickness: 1e-8, edge_length };
        assert_eq!(refused.expect_err("too thin"), expected);
        assert!(expected.to_string().contains("in metres"));
    }
    let thinnest = skin(layer(1.01e-3 * surface.mean_edge_length()));
    let found = assemble(&surface, &thinnest, &[0, 5], &AssemblyOptions::default()).expect("thick enough");
    assert!(found[(0, 0)] > 0.0 && found[(1, 1)] > 0.0);
}
