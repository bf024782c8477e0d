//! Stored parts of a body: whole they build the same body, damaged they are named.

use std::sync::Arc;

use faer::Mat;
use quasirigid::response::body::{BodyCompliance, BodyError, BodyOptions, BodyParts, OneLevel, TwoLevels};
use quasirigid::response::{Levels, NodesError, PreparedBody, ResponseError};
use quasirigid::surface::{CoarsePlace, Surface};

use crate::{SHEAR_MODULUS, prepare, sphere, with_bone};

const NODES: [usize; 3] = [0, 5, 7];

fn skin() -> Surface {
    sphere(8e-3, 1)
}

fn parts() -> BodyParts {
    prepare(&with_bone(sphere(3e-3, 1)), &skin(), 0.5, &NODES).parts().clone()
}

fn refusal(change: impl FnOnce(&mut BodyParts)) -> BodyError {
    let mut parts = parts();
    change(&mut parts);
    BodyCompliance::from_parts(parts).expect_err("damaged parts")
}

#[test]
fn parts_build_the_same_compliance() {
    let built = parts();
    let again = BodyCompliance::from_parts(built.clone()).expect("sound parts");
    assert!(again.parts().displacement == built.displacement);
    assert_eq!(again.nodes(), NODES);
}

#[test]
fn nodes_of_parts_are_there_each_listed_once_and_have_columns() {
    let none = refusal(|parts| {
        parts.nodes.clear();
        parts.displacement = Mat::zeros(3 * 42, 0);
    });
    assert_eq!(none, BodyError::NoNodes);
    assert_eq!(
        refusal(|parts| parts.nodes[2] = 42),
        NodesError::OutOfRange { index: 2, vertex: 42, vertex_count: 42 }.into()
    );
    assert_eq!(
        refusal(|parts| parts.nodes[2] = 5),
        NodesError::Repeated { vertex: 5, first: 1, second: 2 }.into()
    );
    assert_eq!(
        refusal(|parts| parts.nodes.push(9)),
        BodyError::Parts { what: "displacement columns", found: 9, expected: 12 }
    );
    assert_eq!(
        refusal(|parts| parts.displacement.truncate(125, 9)),
        BodyError::Parts { what: "displacement rows", found: 125, expected: 123 }
    );
    assert_eq!(
        refusal(|parts| parts.bone_pressure = Some(Mat::zeros(4, 8))),
        BodyError::Parts { what: "bone pressure columns", found: 8, expected: 9 }
    );
}

#[test]
fn numbers_of_parts_are_finite() {
    let infinite =
        |what, row| BodyError::PartNumber { what, row, value: f64::INFINITY, expected: "finite numbers" };
    assert_eq!(refusal(|parts| parts.displacement[(17, 4)] = f64::INFINITY), infinite("displacement", 17));
    assert_eq!(
        refusal(|parts| parts.bone_pressure = Some(Mat::from_fn(2, 9, |row, _| 1.0 / (1 - row) as f64))),
        infinite("bone pressure", 1)
    );
    let error = refusal(|parts| parts.displacement[(0, 0)] = f64::NAN).to_string();
    assert_eq!(error, "row 0 of the stored displacement holds NaN, expected finite numbers");
}

/// What a body on two levels is built from, and the skin's loaded vertices.
struct Stored {
    remainder: BodyParts,
    places: Vec<CoarsePlace>,
    thickness: Vec<f64>,
    coarse_edges: Vec<f64>,
    fixed: Vec<bool>,
    nodes: Vec<usize>,
}

fn two_levels_skin() -> Surface {
    sphere(8e-3, 3)
}

impl Stored {
    fn new() -> Self {
        let (skin, body) = (two_levels_skin(), with_bone(sphere(3e-3, 1)));
        let nodes: Vec<usize> = (0..642).filter(|&vertex| skin.vertices()[vertex].z < -7e-3).collect();
        let options = BodyOptions::default();
        let solved = PreparedBody::new(&skin, &body, SHEAR_MODULUS, 0.5, &nodes, &options).expect("sound");
        let Levels::Two(two) = solved.levels() else { panic!("a coarse skin") };
        Self {
            remainder: two.remainder.parts().clone(),
            places: two.places.to_vec(),
            thickness: two.thickness.as_deref().expect("a bone").to_vec(),
            coarse_edges: two.coarse_edges.to_vec(),
            fixed: two.fixed.to_vec(),
            nodes,
        }
    }

    fn built(self) -> Result<PreparedBody, ResponseError> {
        let remainder = BodyCompliance::from_parts(self.remainder)?;
        let thickness: Arc<[f64]> = self.thickness.into();
        let (places, edges) = (self.places.into(), self.coarse_edges.into());
        let two = TwoLevels::from_parts(remainder, places, Some(thickness), edges, self.fixed.into())?;
        PreparedBody::from_levels(&two_levels_skin(), &self.nodes, Levels::Two(two))
    }
}

fn refusal_of_two(change: impl FnOnce(&mut Stored)) -> ResponseError {
    let mut stored = Stored::new();
    change(&mut stored);
    stored.built().expect_err("damaged parts")
}

#[test]
fn a_body_on_two_levels_is_built_again() {
    Stored::new().built().expect("sound parts");
}

#[test]
fn nodes_of_the_coarse_skin_ascend() {
    let (mut first, mut second) = (0, 0);
    let error = refusal_of_two(|stored| {
        stored.remainder.nodes.swap(0, 1);
        (first, second) = (stored.remainder.nodes[1], stored.remainder.nodes[0]);
    });
    assert_eq!(error, BodyError::NodeMisplaced { position: 0, vertex: second, expected: first }.into());
}

#[test]
fn every_loaded_vertex_has_columns_at_the_coarse_vertices_beside_it() {
    let mut dropped = 0;
    let error = refusal_of_two(|stored| {
        let columns = 3 * (stored.remainder.nodes.len() - 1);
        dropped = stored.remainder.nodes.pop().expect("some");
        stored.remainder.displacement = stored.remainder.displacement.subcols(0, columns).to_owned();
    });
    let ResponseError::Body(BodyError::NoColumn { vertex, coarse_vertex }) = error else { panic!("{error}") };
    assert_eq!(coarse_vertex, dropped);
    let stored = Stored::new();
    assert!(stored.places[vertex].corners.contains(&(dropped as u32)) && stored.nodes.contains(&vertex));
}

#[test]
fn weights_edges_and_thickness_are_in_range() {
    let number =
        |what, value, expected| ResponseError::from(BodyError::PartNumber { what, row: 3, value, expected });
    let weights = |weights: [f64; 3]| refusal_of_two(|stored| stored.places[3].weights = weights);
    let of_weights = |value| number("coarse weights", value, "finite numbers from 0 on");
    assert_eq!(weights([1.5, -0.5, 0.0]), of_weights(-0.5));
    assert_eq!(weights([f64::INFINITY, 0.0, 0.0]), of_weights(f64::INFINITY));
    assert!(weights([0.0, f64::NAN, 0.0]).to_string().starts_with("row 3 of the stored coarse weights"));
    assert_eq!(weights([0.5, 0.25, 0.0]), number("sums of coarse weights", 0.75, "1"));
    for value in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(
            refusal_of_two(|stored| stored.coarse_edges[3] = value),
            number("coarse edges", value, "finite numbers above 0")
        );
        let error = refusal_of_two(|stored| stored.thickness[3] = value);
        assert!(matches!(error, ResponseError::Constant { name: "thickness", .. }), "{error}");
    }
}

#[test]
fn lists_over_the_skin_have_an_entry_for_each_vertex() {
    let count = |what, found| ResponseError::from(BodyError::Parts { what, found, expected: 642 });
    let fixed = refusal_of_two(|stored| stored.fixed.truncate(640));
    assert_eq!(fixed, count("fixed", 640));
    let edges = refusal_of_two(|stored| stored.coarse_edges.push(1e-3));
    assert_eq!(edges, count("coarse edges", 643));
    let thickness = refusal_of_two(|stored| stored.thickness.clear());
    assert_eq!(thickness, count("thickness", 0));
    let all = refusal_of_two(|stored| {
        stored.places.truncate(641);
        stored.fixed.truncate(641);
        stored.coarse_edges.truncate(641);
        stored.thickness.truncate(641);
    });
    assert_eq!(all, count("skin vertices", 641));
}

#[test]
fn a_compliance_fits_the_skin_and_the_nodes_that_it_is_taken_for() {
    let error = |change: &dyn Fn(&mut BodyParts), nodes: &[usize], thickness: Option<Vec<f64>>| {
        let mut parts = parts();
        change(&mut parts);
        let compliance = BodyCompliance::from_parts(parts).expect("sound parts");
        let level = OneLevel { compliance, thickness: thickness.map(Into::into) };
        PreparedBody::from_levels(&skin(), nodes, Levels::One(level)).expect_err("it does not fit")
    };
    let count = |what, found, expected| ResponseError::from(BodyError::Parts { what, found, expected });
    let one_more = |parts: &mut BodyParts| {
        parts.displacement.resize_with(3 * 43, 9, |_, _| 0.0);
    };
    assert_eq!(error(&one_more, &NODES, None), count("skin vertices", 43, 42));
    assert_eq!(error(&|_| (), &NODES[..2], None), count("nodes", 3, 2));
    assert_eq!(
        error(&|_| (), &[0, 7, 5], None),
        BodyError::NodeMisplaced { position: 1, vertex: 5, expected: 7 }.into()
    );
    assert_eq!(error(&|_| (), &NODES, Some(Vec::new())), count("thickness", 0, 42));
    assert_eq!(
        error(&|_| (), &NODES, Some(vec![0.0; 42])),
        BodyError::PartNumber { what: "thickness", row: 0, value: 0.0, expected: "finite numbers above 0" }
            .into()
    );
}
