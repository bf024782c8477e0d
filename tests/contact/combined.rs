//! Bodies on parts of a skin, a kernel elsewhere.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, Vector3};
use quasirigid::contact::{Contact, ContactOptions, Goal, press};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::response::{
    AssemblyOptions, CombinedSkin, ElasticSkin, Kernel, Part, PreparedBody, Request, ResponseError,
};
use quasirigid::surface::{Surface, cut_out};

use crate::common::icosphere;
use crate::{UP, along, galerkin, half_space, skin as skin_of, surface};

fn sphere() -> Surface {
    surface(icosphere(8e-3, 3))
}

/// The lowest vertices of a ball of 8 mm, 2 mm and more below its `center`, as a body of their own; prepared at those
/// below 6 mm.
pub(crate) fn lower_part(skin: &Surface, center: Vector3<f64>) -> Part {
    let bottom = center - Vector3::z() * 8e-3;
    let away = |v: usize| (skin.vertices()[v] - bottom).norm();
    let lowest = (0..skin.vertices().len()).min_by(|&a, &b| away(a).total_cmp(&away(b))).expect("some");
    let cut = cut_out(skin, lowest, &(center - Vector3::z() * 2e-3), &-Vector3::z()).expect("a cap");
    let low = |&own: &usize| cut.surface.vertices()[own].z < center.z - 6e-3 && !cut.fixed[own];
    let nodes: Vec<usize> = (0..cut.surface.vertices().len()).filter(low).collect();
    let prepared = PreparedBody::new(
        &cut.surface,
        &Body::of_part(&cut, None),
        60e3,
        0.5,
        &nodes,
        &BodyOptions::default(),
    )
    .expect("held at its cut");
    Part { name: "lower".to_string(), prepared, part_vertices: cut.part_vertices, fixed: cut.fixed }
}

fn near(skin: &Surface, height: impl Fn(f64) -> bool) -> Vec<usize> {
    (0..skin.vertices().len()).filter(|&v| height(skin.vertices()[v].z)).collect()
}

/// Whether a vertex of the whole skin moves with the part.
fn is_moving(part: &Part, vertex: usize) -> bool {
    part.part_vertices[vertex].is_some_and(|own| !part.fixed[own])
}

fn ask<'a>(surface: &'a Surface, nodes: &'a [usize]) -> Request<'a> {
    const PLAIN: AssemblyOptions =
        AssemblyOptions { tolerance: 1e-6, num_threads: None, memory_limit: None, interrupt: None };
    Request { surface, nodes, options: &PLAIN }
}

#[test]
fn each_side_of_a_cut_answers_for_itself() {
    let skin = sphere();
    let part = lower_part(&skin, Vector3::zeros());
    let combined = CombinedSkin::new(&skin, half_space(), vec![part.clone()]).expect("a part that fits");
    combined.traits(&skin).expect("the same surface");
    let (low, high) = (near(&skin, |z| z < -7.5e-3), near(&skin, |z| z > 7.5e-3));
    assert!(!low.is_empty() && !high.is_empty());
    assert!(low.iter().chain(&high).all(|&v| combined.is_prepared(v)));
    let nodes: Vec<usize> = low.iter().chain(&high).copied().collect();
    let up = vec![Vector3::z(); nodes.len()];
    let matrix = combined.matrix(&ask(&skin, &nodes), &up).expect("two patches");

    let own: Vec<usize> = low.iter().map(|&v| part.part_vertices[v].expect("of the part")).collect();
    let body = part.prepared.matrix(&ask(&skin, &own), &up[..own.len()]).expect("prepared");
    let kernel = half_space().matrix(&ask(&skin, &high), &up[..high.len()]).expect("nodes");
    for i in 0..nodes.len() {
        for j in 0..nodes.len() {
            let expected = match (i.checked_sub(low.len()), j.checked_sub(low.len())) {
                (None, None) => body[(i, j)],
                (Some(i), Some(j)) => kernel[(i, j)],
                _ => 0.0,
            };
            assert_eq!(matrix[(i, j)], expected);
        }
    }

    let everywhere: Vec<usize> = (0..skin.vertices().len()).collect();
    let push = vec![Vector3::z() * 0.01; low.len()];
    let moved = combined.displace(&ask(&skin, &low), &push, &everywhere).expect("prepared");
    let moves = |v: usize| moved[v] != Vector3::zeros();
    assert!(everywhere.iter().all(|&v| moves(v) == is_moving(&part, v)));
    assert!(everywhere.iter().all(|&v| combined.is_scalar(v) != is_moving(&part, v)));
}

#[test]
fn off_its_parts_a_skin_answers_as_its_kernel_on_refined_meshes_too() {
    let skin = sphere();
    let layer = skin_of(Kernel::Layer { thickness: 1e-3.into() });
    let part = lower_part(&skin, Vector3::zeros());
    let combined = CombinedSkin::new(&skin, layer.clone(), vec![part]).expect("a part that fits");
    let plate = Obstacle::half_space(UP * 0.02, -UP).expect("a plane");
    let goal = Goal::Depth(0.2e-3);
    let from_above = |elastic: &dyn ElasticSkin| {
        press(&skin, &plate, elastic, &along(-UP, goal), &ContactOptions::default())
            .expect("a plate that touches")
    };
    let (of_kernel, of_combined) = (from_above(&layer), from_above(&combined));
    assert!(of_combined.surface().vertices().len() > skin.vertices().len());
    let figures = |contact: &Contact| (contact.resultant.force.z, contact.resultant.contact_area);
    let (expected, found) = (figures(&of_kernel), figures(&of_combined));
    assert_relative_eq!(found.0, expected.0, max_relative = 1e-7);
    assert_relative_eq!(found.1, expected.1, max_relative = 1e-7);
}

#[test]
fn a_patch_across_the_cut_and_parts_that_do_not_fit_are_named() {
    let skin = sphere();
    let part = lower_part(&skin, Vector3::zeros());
    let combined = CombinedSkin::new(&skin, half_space(), vec![part.clone()]).expect("a part that fits");
    let across = near(&skin, |z| z < 0.0);
    let up = vec![Vector3::z(); across.len()];
    let error = combined.matrix(&ask(&skin, &across), &up).expect_err("straddles");
    let ResponseError::StraddlingPatch { part: name, inside, outside, count } = error else {
        panic!("{error}")
    };
    assert_eq!((name.as_str(), count), ("lower", across.len()));
    assert!(is_moving(&part, inside) && !is_moving(&part, outside));

    let shifted = Isometry3::translation(1e-3, 0.0, 0.0);
    let there = skin.moved(&shifted);
    assert!(matches!(combined.traits(&there), Err(ResponseError::PartMismatch { .. })));
    combined.moved(&shifted).expect("a rigid motion").traits(&there).expect("moved with its skin");

    let refused = |parts: Vec<Part>| CombinedSkin::new(&skin, half_space(), parts).expect_err("does not fit");
    let twice = refused(vec![part.clone(), Part { name: "again".to_string(), ..part.clone() }]);
    assert!(matches!(&twice, ResponseError::PartMismatch { part, .. } if part == "again"), "{twice}");
    let short = refused(vec![Part { fixed: vec![true], ..part.clone() }]);
    assert!(short.to_string().contains("1 entries tell which"), "{short}");
    let few = refused(vec![Part { part_vertices: vec![None], ..part.clone() }]);
    assert!(few.to_string().contains("1 entries for the 642 vertices"), "{few}");

    let error = CombinedSkin::new(&skin, galerkin(), vec![part]).expect_err("Galerkin");
    assert_eq!(error, ResponseError::PartsNeedLinear);
}
