//! Presses deeper than a wall is thick: the way back, and what it changes.

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::contact::{
    Contact, ContactOptions, Goal, RefinementKind, Warning, WarningKind, overlaps, press, solve_contact,
};
use quasirigid::obstacle::{Obstacle, ObstacleError};
use quasirigid::surface::Surface;

use crate::common::{grid, icosphere};
use crate::{along, galerkin, half_space};

const DOWN: Vector3<f64> = Vector3::new(0.0, 0.0, -1.0);

/// Flat skin about the origin, outside above, `count` cells of size `spacing` (m) a side.
fn pad(count: usize, spacing: f64) -> Surface {
    let (vertices, faces) = grid(count, count, spacing);
    let middle = 0.5 * count as f64 * spacing;
    Surface::new(vertices.iter().map(|x| x - Vector3::new(middle, middle, 0.0)).collect(), faces).unwrap()
}

fn pressed(surface: &Surface, obstacle: &Obstacle, depth: f64) -> Contact {
    let way = along(DOWN, Goal::Depth(depth));
    press(surface, obstacle, &half_space(), &way, &ContactOptions::on_given_mesh()).unwrap()
}

/// Warnings but that edges stand in the skin between its vertices, on a mesh taken as it is.
fn of_scene(contact: &Contact) -> impl Iterator<Item = &String> {
    let of_mesh = |warning: &Warning| {
        warning.kind == WarningKind::CoarseMesh
            || warning.message.starts_with("the deformed skin still penetrates")
    };
    contact.warnings.iter().filter(move |warning| !of_mesh(warning)).map(|warning| &warning.message)
}

fn box_of(half_extents: [f64; 3]) -> Obstacle {
    Obstacle::cuboid(half_extents.into()).unwrap()
}

/// The same box as a mesh.
fn mesh_of(half_extents: [f64; 3]) -> Obstacle {
    meshes_of(&[(Vector3::zeros(), half_extents)])
}

/// Boxes about their middles as one mesh.
fn meshes_of(boxes: &[(Vector3<f64>, [f64; 3])]) -> Obstacle {
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let corner = |middle: &Vector3<f64>, half_extents: &[f64; 3], i: usize| {
        middle + Vector3::from_fn(|axis, _| half_extents[axis] * if i >> axis & 1 == 1 { 1.0 } else { -1.0 })
    };
    let corners = boxes.iter().flat_map(|(middle, half)| (0..8).map(move |i| corner(middle, half, i)));
    let of_box = |at: u32| faces.map(|face: [u32; 3]| face.map(|vertex| 8 * at + vertex));
    let faces = (0..boxes.len() as u32).flat_map(of_box).collect();
    Obstacle::mesh(corners.collect(), faces, &Default::default()).unwrap()
}

#[test]
fn the_way_back_leads_to_the_first_meeting() {
    let ball = Obstacle::sphere(Vector3::zeros(), 5.0).unwrap();
    // Travelling down, the ball met a point at its underside: at (3, 0, -4) seen from the ball.
    let met = |z: f64, reach: f64| {
        ball.entry_distances(&[Vector3::new(3.0, 0.0, z)], &(2.0 * DOWN), reach).unwrap()[0]
    };
    assert_relative_eq!(met(-3.5, 1.0).unwrap(), 0.5, max_relative = 1e-14);
    assert_relative_eq!(met(6.0, 100.0).unwrap(), 10.0, max_relative = 1e-14);
    assert_eq!(met(-4.1, 1.0), None, "not met yet");
    assert_eq!(met(6.0, 1.0), None, "met and left before the way began");
    assert_eq!(met(-4.0, 0.0), Some(0.0), "met just now");
    assert_eq!(ball.entry_distances(&[Vector3::new(6.0, 0.0, 0.0)], &DOWN, 100.0).unwrap(), [None]);

    // A mesh finds what the primitive finds, beside edges and behind it too.
    let (points, _) = icosphere(2.5e-3, 4);
    let direction = Vector3::new(0.1, -0.2, -1.0);
    let half_extents = [2e-3, 1e-3, 0.4e-3];
    let [primitive, mesh] = [box_of(half_extents), mesh_of(half_extents)]
        .map(|obstacle| obstacle.entry_distances(&points, &direction, 3e-3).unwrap());
    assert!(primitive.iter().any(Option::is_some) && primitive.iter().any(Option::is_none));
    for (a, b) in primitive.iter().zip(&mesh) {
        assert_eq!(a.is_some(), b.is_some());
        assert!((a.unwrap_or(0.0) - b.unwrap_or(0.0)).abs() < 1e-15);
    }
    let nowhere = ball.entry_distances(&[], &Vector3::zeros(), 1.0).unwrap_err();
    assert_eq!(nowhere, ObstacleError::Direction { direction: [0.0; 3] });
}

#[test]
fn a_fin_thinner_than_the_depth_presses_down_and_not_to_its_sides() {
    // Of the vertices at 0 and 0.2 mm from the middle of a fin 0.6 mm thick, a shallow press finds the edge closest.
    let surface = pad(40, 0.2e-3);
    let fin = box_of([0.3e-3, 20e-3, 5e-3]);
    let shallow = pressed(&surface, &fin, 0.05e-3);
    // It is longer than the pad.
    assert!(of_scene(&shallow).all(|warning| warning.contains("open border")));
    for fin in [fin, mesh_of([0.3e-3, 20e-3, 5e-3])] {
        let deep = pressed(&surface, &fin, 1e-3);
        assert_eq!(deep.candidates, shallow.candidates);
        // The problem is linear in the depth as long as the same vertices touch.
        assert_relative_eq!(deep.resultant.force, 20.0 * shallow.resultant.force, max_relative = 1e-9);
        assert!(deep.active.iter().all(|&vertex| deep.gap[vertex].abs() < 1e-12));
        assert_relative_eq!(deep.max_penetration_before, 1e-3, max_relative = 1e-9);
        assert!(deep.warnings[0].message.contains("123 vertices went through a wall"), "{:?}", deep.warnings);
    }
}

#[test]
fn a_sheet_that_skin_went_all_the_way_through_presses_like_a_block() {
    let surface = pad(12, 2e-3);
    let block = pressed(&surface, &box_of([5e-3, 5e-3, 5e-3]), 0.5e-3);
    assert_eq!(of_scene(&block).next(), None);
    let sheet = pressed(&surface, &box_of([5e-3, 5e-3, 0.05e-3]), 0.5e-3);
    assert_eq!(sheet.candidates, block.candidates);
    assert_relative_eq!(sheet.resultant.force, block.resultant.force, max_relative = 1e-9);
    assert!(sheet.warnings[0].message.contains("25 vertices"), "{:?}", sheet.warnings);
}

#[test]
fn a_sheet_in_overlap_presses_the_skin_that_it_came_in_through() {
    let surface = pad(24, 1e-3);
    let depth = 0.5e-3;
    for skin in [half_space(), galerkin()] {
        let solved = |thickness: f64| {
            let sheet = box_of([5.2e-3, 5.2e-3, 0.5 * thickness]);
            let sheet = sheet.translated(&Vector3::new(0.0, 0.0, 0.5 * thickness - depth));
            solve_contact(&surface, &sheet, &skin, &ContactOptions::on_given_mesh()).unwrap()
        };
        let block = solved(10e-3).resultant.force;
        for thickness in [4e-3, 1e-3, 0.4e-3, 0.2e-3] {
            let contact = solved(thickness);
            assert_relative_eq!(contact.resultant.force, block, max_relative = 1e-9);
            assert_relative_eq!(contact.max_penetration_before, depth, max_relative = 1e-9);
            assert!(
                contact.warnings.iter().all(|warning| !warning.message.contains("pulled")),
                "{:?}",
                contact.warnings
            );
        }
        // As pressed there.
        let sheet = box_of([5.2e-3, 5.2e-3, 0.2e-3]);
        let way = along(DOWN, Goal::Depth(depth));
        let pressed = press(&surface, &sheet, &skin, &way, &ContactOptions::on_given_mesh()).unwrap();
        assert_relative_eq!(pressed.resultant.force, block, max_relative = 1e-9);
    }
}

#[test]
fn a_sheet_in_overlap_presses_like_a_block_on_refined_meshes_too() {
    let (mut vertices, faces) = icosphere(8e-3, 3);
    vertices.iter_mut().for_each(|x| x.z -= 8e-3);
    let ball = Surface::new(vertices, faces).unwrap();
    let depth = 1e-3;
    let solved = |thickness: f64| {
        let wall = box_of([20e-3, 20e-3, 0.5 * thickness]);
        let wall = wall.translated(&Vector3::new(0.0, 0.0, 0.5 * thickness - depth));
        solve_contact(&ball, &wall, &half_space(), &ContactOptions::default()).unwrap()
    };
    let block = solved(20e-3);
    assert!(block.refinements.iter().filter(|round| round.kind == RefinementKind::Mesh).count() > 2);
    for thickness in [1e-3, 0.3e-3] {
        let sheet = solved(thickness);
        assert_relative_eq!(sheet.resultant.force, block.resultant.force, max_relative = 1e-6);
        assert_relative_eq!(sheet.max_penetration_before, block.max_penetration_before, max_relative = 1e-6);
    }
}

#[test]
fn a_sheet_in_overlap_is_found_deeper_than_two_edges() {
    let (mut vertices, faces) = icosphere(8e-3, 3);
    vertices.iter_mut().for_each(|x| x.z -= 8e-3);
    let ball = Surface::new(vertices, faces).unwrap();
    let depth = 3e-3;
    assert!(depth > 2.0 * ball.mean_edge_length());
    for skin in [half_space(), galerkin()] {
        let solved = |thickness: f64| {
            let wall = box_of([20e-3, 20e-3, 0.5 * thickness]);
            let wall = wall.translated(&Vector3::new(0.0, 0.0, 0.5 * thickness - depth));
            solve_contact(&ball, &wall, &skin, &ContactOptions::on_given_mesh()).unwrap()
        };
        let block = solved(20e-3).resultant.force;
        for thickness in [4e-3, 1e-3, 0.2e-3] {
            assert_relative_eq!(solved(thickness).resultant.force, block, max_relative = 0.01);
        }
    }
}

#[test]
fn a_sheet_stands_in_the_skin_that_it_is_nearer_to_and_not_in_that_on_the_other_side() {
    let half_breadth = 2e-3;
    // Edges of 0.5 and of 1.9 mm: skin looks twice as far, and the lens is 4 mm broad.
    for subdivisions in [4, 2] {
        let (mut vertices, faces) = icosphere(8e-3, subdivisions);
        vertices.iter_mut().for_each(|x| x.z *= 0.25);
        let lens = Surface::new(vertices, faces).expect("a valid surface");
        // The lower face of a sheet that came in from above.
        let level = 0.3e-3;
        let sheet = box_of([20e-3, 20e-3, 0.1e-3]).translated(&Vector3::new(0.0, 0.0, level + 0.1e-3));
        let depths = overlaps(&lens, &sheet, &ContactOptions::default()).expect("a valid request");
        // Beside its rim the lens is too thin to tell its sides apart.
        let in_middle = |x: &Vector3<f64>| x.x.hypot(x.y) < 2.0 * half_breadth;
        let middle = depths.iter().zip(lens.vertices()).filter(|(_, x)| in_middle(x));
        assert!(middle.clone().any(|(depth, _)| *depth > 0.8 * half_breadth));
        middle.for_each(|(depth, x)| assert_relative_eq!(*depth, (x.z - level).max(0.0), epsilon = 1e-9));
    }
}

#[test]
fn how_deep_a_finger_stands_does_not_hang_on_another_one() {
    let (radius, apart) = (8e-3, 60e-3);
    let (ball, faces) = icosphere(radius, 3);
    let count = ball.len() as u32;
    let beside = ball.iter().map(|x| x + Vector3::new(apart, 0.0, 0.0));
    let fingers = Surface::new(
        ball.iter().copied().chain(beside).collect(),
        faces.iter().copied().chain(faces.iter().map(|face| face.map(|vertex| vertex + count))).collect(),
    );
    let fingers = fingers.unwrap();
    // A sheet in each, whose lower face came to some depth; the first finger stands over a second one besides.
    let sheet = |x: f64, depth: f64| (Vector3::new(x, 0.0, radius - depth + 0.1e-3), [15e-3, 15e-3, 0.1e-3]);
    let depths = |other: f64| {
        let product = meshes_of(&[sheet(0.0, 1.5e-3), sheet(0.0, 4e-3), sheet(apart, other)]);
        overlaps(&fingers, &product, &ContactOptions::default()).unwrap()
    };
    let (shallow, deep) = (depths(1.5e-3), depths(3.5e-3));
    let [of_first, of_other] = [0..ball.len(), ball.len()..2 * ball.len()];
    assert_eq!(shallow[of_first.clone()], deep[of_first.clone()]);
    let deepest = |depths: &[f64]| depths.iter().copied().fold(0.0, f64::max);
    assert_relative_eq!(deepest(&shallow[of_first]), 1.5e-3, max_relative = 1e-9);
    assert_relative_eq!(deepest(&deep[of_other]), 3.5e-3, max_relative = 1e-9);
}

#[test]
fn an_edge_presses_along_the_press_and_harder_with_depth() {
    // Boxes wider than the press is deep, under a ball: beside their edges the closest side is a lateral one.
    let (mut vertices, faces) = icosphere(8e-3, 4);
    vertices.iter_mut().for_each(|x| x.z -= 8e-3);
    let ball = Surface::new(vertices, faces).unwrap();
    for half in [2e-3, 4e-3] {
        for obstacle in [box_of([half, half, 10e-3]), mesh_of([half, half, 10e-3])] {
            let mut before = 0.0;
            let mut before_slope = 0.0;
            for step in 1..=6 {
                let depth = 0.5e-3 * step as f64;
                let contact = pressed(&ball, &obstacle, depth);
                let force = contact.resultant.force;
                let along = force.dot(&DOWN);
                assert!(along > 0.999 * force.norm(), "{half} {depth}: {force:?}");
                // A punch between a sphere (F ~ d^1.5) and a flat end (F ~ d): each step adds no less than the one before.
                assert!(along - before > 0.9 * before_slope, "{half} {depth}: {along} after {before}");
                (before_slope, before) = (along - before, along);
                assert!(depth > 0.5 * half || of_scene(&contact).next().is_none(), "{:?}", contact.warnings);
            }
        }
    }
}

#[test]
fn smooth_products_keep_their_gaps_to_the_bit() {
    let (mut vertices, faces) = icosphere(8e-3, 4);
    vertices.iter_mut().for_each(|x| x.z -= 8e-3);
    let ball = Surface::new(vertices, faces).unwrap();
    let aside = Vector3::new(2e-3, 0.5e-3, 0.0);
    let obstacles = [
        Obstacle::sphere(aside, 6e-3).unwrap(),
        Obstacle::capsule(Vector3::x(), -Vector3::x(), 5e-3).unwrap().translated(&aside),
        Obstacle::half_space(Vector3::zeros(), Vector3::new(0.2, 0.0, -1.0)).unwrap(),
    ];
    for obstacle in obstacles {
        for depth in [0.3e-3, 1.5e-3] {
            let moved = pressed(&ball, &obstacle, depth);
            let options = ContactOptions::on_given_mesh();
            let there = solve_contact(&ball, &moved.obstacle, &half_space(), &options).unwrap();
            assert!(!moved.candidates.is_empty());
            assert_eq!(moved.node_force, there.node_force);
            assert_eq!(moved.resultant, there.resultant);
        }
    }
}
