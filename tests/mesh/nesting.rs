//! Closed components inside, on and beside one another.

use nalgebra::Vector3;
use quasirigid::geometry::winding_number;
use quasirigid::mesh::MeshError;

use crate::common::{Mesh, flipped, grid, icosphere, joined};
use crate::{nesting, shifted, tetrahedron, welded};

#[test]
fn an_inward_body_is_named_with_its_volume() {
    let (vertices, faces) = tetrahedron();
    let Err(MeshError::InsideOut { component, face, volume, expected, count, component_count }) =
        nesting(&(vertices, flipped(&faces)))
    else {
        panic!("another error");
    };
    assert_eq!((component, face, expected, count, component_count), (0, 0, '+', 1, 1));
    assert!((volume + 1.0 / 6.0).abs() < 1e-15);
}

#[test]
fn the_second_of_two_bodies_inside_out_is_named() {
    let (vertices, faces) = shifted(&tetrahedron(), Vector3::new(5.0, 0.0, 0.0));
    let mesh = joined(&tetrahedron(), &(vertices, flipped(&faces)));
    let error = nesting(&mesh).unwrap_err();
    assert!(
        matches!(error, MeshError::InsideOut { component: 1, face: 4, count: 1, component_count: 2, .. }),
        "{error}"
    );
}

#[test]
fn a_flat_pillow_encloses_nothing() {
    let mut vertices = grid(2, 2, 1.0).0;
    let top = grid(2, 2, 1.0).1;
    vertices.push(Vector3::new(1.0, 1.0, 0.0));
    let bottom =
        flipped(&top).into_iter().map(|face| face.map(|vertex| if vertex == 4 { 9 } else { vertex }));
    let faces: Vec<[u32; 3]> = top.iter().copied().chain(bottom).collect();
    let faces = faces.into_iter().filter(|face| face.contains(&4) || face.contains(&9)).collect::<Vec<_>>();
    let pillow = (vertices, faces);
    let error = nesting(&pillow).unwrap_err();
    assert!(matches!(error, MeshError::Flat { volume: 0.0, count: 1, .. }), "{error}");
    let both_sides_are_one = MeshError::NothingLeft {
        face_count: 16,
        collapsed: 0,
        degenerate: 0,
        duplicates: 16,
        weld_tolerance: 0.0,
    };
    assert_eq!(welded(&pillow, 0.0).unwrap_err(), both_sides_are_one);
}

#[test]
fn cavities_point_inward_and_solids_in_cavities_outward() {
    let ball = |radius: f64| icosphere(radius, 2);
    let cavity = |radius: f64| {
        let (vertices, faces) = ball(radius);
        (vertices, flipped(&faces))
    };
    nesting(&joined(&ball(3.0), &cavity(2.0))).unwrap();
    nesting(&joined(&joined(&ball(1.0), &cavity(2.0)), &ball(3.0))).unwrap();
    let Err(MeshError::NestedShell { component, face, outer, count, volume }) =
        nesting(&joined(&ball(3.0), &ball(2.0)))
    else {
        panic!("another error");
    };
    assert_eq!((component, face, outer, count), (1, 320, 0, 1));
    assert!((30.0..33.6).contains(&volume));
    let core_inward = nesting(&joined(&joined(&ball(3.0), &cavity(2.0)), &cavity(1.0)));
    assert!(matches!(core_inward, Err(MeshError::InsideOut { component: 2, expected: '+', .. })));
    // each is put right by repair
    for wrong in [joined(&ball(3.0), &ball(2.0)), joined(&cavity(3.0), &ball(2.0))] {
        let mended = welded(&wrong, 0.0).unwrap();
        nesting(&(mended.vertices, mended.faces)).unwrap();
    }
}

#[test]
fn bodies_side_by_side_or_across_each_other_are_not_nested() {
    let ball = icosphere(1.0, 2);
    nesting(&joined(&ball, &shifted(&ball, Vector3::new(5.0, 0.0, 0.0)))).unwrap();
    nesting(&joined(&ball, &shifted(&ball, Vector3::new(1.0, 0.1, 0.2)))).unwrap();
    // inside the bounding box but outside the ball
    let small = icosphere(0.1, 1);
    nesting(&joined(&ball, &shifted(&small, Vector3::repeat(0.85)))).unwrap();
}

#[test]
fn a_body_that_touches_the_one_around_it_is_nested_and_not_coincident() {
    let vertices = (0..6).map(|i| Vector3::ith(i / 2, if i % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let sides = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let faces = sides.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, a, 5]]).collect();
    let octahedron: Mesh = (vertices, faces);
    nesting(&octahedron).unwrap();
    let error = nesting(&joined(&octahedron, &cube(1.0))).unwrap_err();
    assert!(matches!(error, MeshError::NestedShell { component: 0, outer: 1, count: 1, .. }), "{error}");
}

#[test]
fn a_wall_may_be_thin_next_to_its_edges() {
    let inward = |(vertices, faces): Mesh| (vertices, flipped(&faces));
    for wall in [1e-3, 1e-5, 1e-7] {
        let hollow = joined(&cube(1.0), &inward(cube(1.0 - wall)));
        nesting(&hollow).expect("a cavity");
        let repaired = |mesh: &Mesh| welded(mesh, 0.0).expect("shells that are closed");
        assert!(repaired(&hollow).report.is_unchanged());
        let mended = repaired(&inward(hollow.clone()));
        assert_eq!((mended.vertices, mended.faces), hollow);
        // Turned the same way there is no wall: it is given twice.
        let twice = nesting(&joined(&cube(1.0), &cube(1.0 - wall)));
        assert!(matches!(twice, Err(MeshError::CoincidentShell { component: 1, other: 0, .. })));
    }
}

#[test]
fn a_body_of_which_one_tip_or_the_others_leaves_the_other_is_beside_it() {
    let (outer, inner) = (icosphere(1.0, 3), icosphere(0.5, 4));
    let with_tip = |(vertices, faces): &Mesh, tip: usize, share: f64| {
        let mut vertices = vertices.clone();
        vertices[tip] *= share;
        (vertices, faces.clone())
    };
    // Away from the axes a tip 1.2 long stays in the box around the outer one.
    let tips = |(vertices, _): &Mesh| {
        let tips = (0..vertices.len()).filter(|&tip| vertices[tip].normalize().amax() < 0.8);
        tips.step_by(97).collect::<Vec<_>>()
    };
    let spiked = tips(&inner).into_iter().map(|tip| (outer.clone(), with_tip(&inner, tip, 2.4)));
    let dented = tips(&outer).into_iter().map(|tip| (with_tip(&outer, tip, 0.3), inner.clone()));
    for (outer, (vertices, faces)) in spiked.chain(dented) {
        let beside = joined(&outer, &(vertices.clone(), faces.clone()));
        nesting(&beside).expect("side by side");
        assert!(welded(&beside, 0.0).expect("shells that are closed").report.is_unchanged());
        let inverted = nesting(&joined(&outer, &(vertices, flipped(&faces))));
        assert!(matches!(inverted, Err(MeshError::InsideOut { component: 1, expected: '+', .. })));
    }
}

/// Cube about the origin, two faces a side.
fn cube(half: f64) -> Mesh {
    let vertices =
        (0..8).map(|i| Vector3::from_fn(|k, _| if i >> k & 1 == 1 { half } else { -half })).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

#[test]
fn a_shell_given_twice_is_coincident_whichever_way_it_is_turned_or_cut() {
    let ball = icosphere(1.0, 2);
    let inward = (ball.0.clone(), flipped(&ball.1));
    for twice in [joined(&ball, &ball), joined(&ball, &inward)] {
        let error = nesting(&twice).unwrap_err();
        let MeshError::CoincidentShell { component, face, other, other_face, distance, count } = error else {
            panic!("another error: {error}");
        };
        assert_eq!((component, face, other, other_face, count), (1, 320, 0, 0, 1));
        assert!(distance < 1e-15);
        assert_eq!(welded(&twice, 0.0).unwrap().faces.len(), 320);
    }
    // the same cube with its squares cut along the other diagonals
    let (vertices, faces) = cube(1.0);
    let other_cut: Vec<[u32; 3]> = faces
        .chunks(2)
        .flat_map(|pair| {
            let ([a, b, c], d) = (pair[0], pair[1][2]);
            [[b, c, d], [b, d, a]]
        })
        .collect();
    let error = nesting(&joined(&(vertices.clone(), faces), &(vertices, other_cut))).unwrap_err();
    assert!(matches!(error, MeshError::CoincidentShell { .. }), "{error}");
}

#[test]
fn winding_numbers_are_one_inside_and_zero_outside() {
    let (vertices, faces) = icosphere(1.0, 2);
    let at = |x: f64| winding_number(&Vector3::new(x, 0.01, 0.02), &vertices, faces.iter().copied());
    assert!((at(0.3) - 1.0).abs() < 1e-13 && (at(0.9) - 1.0).abs() < 1e-13);
    assert!(at(1.1).abs() < 1e-13 && at(5.0).abs() < 1e-13);
}
