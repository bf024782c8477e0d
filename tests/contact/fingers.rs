//! Fingers side by side: apart where the skin between them is long, together where it is short.

use std::f64::consts::TAU;

use approx::assert_relative_eq;
use nalgebra::{Rotation3, Vector3};
use quasirigid::contact::{Contact, ContactOptions, Goal, press, solve_contact};
use quasirigid::obstacle::Obstacle;
use quasirigid::response::{
    AssemblyOptions, CombinedSkin, ElasticSkin, GivenMatrix, Kernel, PreparedKernel, assemble,
};
use quasirigid::surface::{LONGEST_DETOUR, Surface};

use crate::combined::lower_part;
use crate::common::{data_dir, flipped, grid, icosphere, joined, read_ply};
use crate::{POISSON_RATIO, SHEAR_MODULUS, UP, along, galerkin, half_space, press_up, skin, surface};

/// Distance between the two fingertips (m).
const PITCH: f64 = 20e-3;

/// Two ridges of skin with their crests down, `height` (m) above which they meet; the second a little longer.
fn two_ridges(height: f64) -> Surface {
    let (columns, rows) = (80, 16);
    let (flat, faces) = grid(columns, rows, 1.0);
    let bent = |x: &Vector3<f64>| {
        let along = 2.0 * x.x / columns as f64;
        let depth = 0.5 * height * (1.0 - (TAU * along).cos()) * if along > 1.0 { 1.001 } else { 1.0 };
        let across = 1e-3 * (x.y - 0.5 * rows as f64);
        Vector3::new(PITCH * along, across, 20.0 * across * across - depth)
    };
    let vertices = flat.iter().map(bent).collect();
    // Outside is below.
    Surface::new(vertices, flipped(&faces)).unwrap()
}

fn plate_at(surface: &Surface, depth: f64) -> Obstacle {
    let lowest = surface.vertices().iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    Obstacle::half_space((lowest + depth) * UP, UP).unwrap()
}

fn solve(surface: &Surface, obstacle: &Obstacle, skin: &dyn ElasticSkin, couple_fingers: bool) -> Contact {
    let options = ContactOptions { couple_fingers, ..ContactOptions::on_given_mesh() };
    solve_contact(surface, obstacle, skin, &options).unwrap()
}

fn note<'a>(contact: &'a Contact, what: &str) -> Option<&'a str> {
    contact.left_out.iter().find(|entry| entry.what == what).map(|entry| &entry.why[..])
}

const APART: &str = "coupling between fingers";

#[test]
fn two_fingers_under_one_plate_are_two_problems_that_add_up() {
    let surface = two_ridges(40e-3);
    let plate = plate_at(&surface, 0.4e-3);
    let both = solve(&surface, &plate, &half_space(), false);
    assert_eq!(both.lcp_solutions.len(), 2);

    let only = |first: bool| {
        let mask = surface.vertices().iter().map(|x| (x.x < PITCH) == first).collect();
        let masked = surface.clone().with_skin_mask(mask).unwrap();
        solve(&masked, &plate, &half_space(), false)
    };
    let (first, second) = (only(true), only(false));
    assert!(first.resultant.force.z > 0.0 && second.resultant.force.z > 0.0);
    let drawn = [&both, &first, &second].map(|contact| {
        contact.drawn_skin(&half_space(), &ContactOptions::on_given_mesh()).unwrap().displacement
    });
    for vertex in 0..surface.vertices().len() {
        assert_eq!(both.node_force[vertex], first.node_force[vertex] + second.node_force[vertex]);
        // One finger's forces do not move another one.
        let alone = if surface.vertices()[vertex].x < PITCH { &drawn[1] } else { &drawn[2] };
        if alone[vertex].norm() > 0.0 && both.candidates.contains(&vertex) {
            assert_eq!(drawn[0][vertex], alone[vertex]);
        }
    }
    // The middle between them, far along the skin from both, stays.
    let web = (0..surface.vertices().len()).filter(|&v| (surface.vertices()[v].x - PITCH).abs() < 1e-9);
    assert!(web.clone().count() > 0 && web.clone().all(|v| drawn[0][v] == Vector3::zeros()));

    // The way from crest to crest is up one flank and down the other, at least twice the height.
    let why = note(&both, APART).expect("said to be left out");
    let number = |before: &str| -> f64 {
        let rest = &why[why.find(before).expect(before) + before.len()..];
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    assert!((2.0 * 35e-3..2.0 * 45e-3).contains(&number("is ")), "{why}");
    assert!((0.8 * PITCH..1.2 * PITCH).contains(&number("against ")), "{why}");

    let coupled = solve(&surface, &plate, &half_space(), true);
    assert_eq!(coupled.lcp_solutions.len(), 1);
    assert!(note(&coupled, APART).is_none());
    assert!(coupled.resultant.force.z < 0.97 * both.resultant.force.z);
}

#[test]
fn coupling_fades_as_the_way_between_two_fingers_grows() {
    let force = |height: f64, couple_fingers: bool, skin: &dyn ElasticSkin| {
        let surface = two_ridges(height);
        solve(&surface, &plate_at(&surface, 0.4e-3), skin, couple_fingers).resultant.force.z
    };
    for skin in [half_space(), galerkin()] {
        let shares: Vec<f64> = (0..=24)
            .map(|step| {
                let height = 8e-3 + 0.5e-3 * f64::from(step);
                let surface = two_ridges(height);
                let plate = plate_at(&surface, 0.4e-3);
                let alone = |first: bool| {
                    let mask = surface.vertices().iter().map(|x| (x.x < PITCH) == first).collect();
                    let masked = surface.clone().with_skin_mask(mask).unwrap();
                    solve(&masked, &plate, &skin, false).resultant.force.z
                };
                let apart = alone(true) + alone(false);
                (apart - force(height, false, &skin)) / (apart - force(height, true, &skin))
            })
            .collect();
        assert_relative_eq!(shares[0], 1.0, max_relative = 1e-9);
        assert!(shares[24].abs() < 1e-9, "{shares:?}");
        let steps = shares.windows(2).map(|pair| pair[0] - pair[1]);
        assert!(steps.clone().all(|step| (-1e-9..0.3).contains(&step)), "{shares:?}");
        assert!(steps.filter(|step| *step > 0.01).count() >= 4, "{shares:?}");
    }
}

#[test]
fn every_kernel_tells_fingers_apart_and_a_matrix_of_its_own_is_left_whole() {
    let surface = two_ridges(40e-3);
    let plate = plate_at(&surface, 0.4e-3);
    let kernels = [
        galerkin(),
        skin(Kernel::GaussianCorrected { height: 0.2e-3, width: 5e-3, cutoff: 40e-3 }),
        skin(Kernel::Layer { thickness: 10e-3.into() }),
    ];
    for skin in kernels {
        let told_apart = solve(&surface, &plate, &skin, false);
        assert_eq!(told_apart.lcp_solutions.len(), 2, "{skin:?}");
        assert!(note(&told_apart, APART).is_some());
        assert_eq!(solve(&surface, &plate, &skin, true).lcp_solutions.len(), 1);
    }
    let nodes = solve(&surface, &plate, &half_space(), false).candidates;
    let prepared = PreparedKernel::new(&surface, &half_space(), &nodes, &AssemblyOptions::default()).unwrap();
    assert_eq!(solve(&surface, &plate, &prepared, false).lcp_solutions.len(), 2);
    let matrix = assemble(&surface, &half_space(), &nodes, &AssemblyOptions::default()).expect("a matrix");
    let given = GivenMatrix::new(&surface, &nodes, matrix).unwrap();
    assert_eq!(solve(&surface, &plate, &given, false).lcp_solutions.len(), 1);
}

#[test]
fn a_kernel_beside_a_body_tells_fingers_apart_too() {
    let ridges = two_ridges(40e-3);
    let lowest = ridges.vertices().iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    let (ball, faces) = icosphere(8e-3, 3);
    let beside = Vector3::new(3.0 * PITCH, 0.0, lowest + 8e-3);
    let ball: Vec<Vector3<f64>> = ball.iter().map(|x| x + beside).collect();
    let surface = surface(joined(&(ridges.vertices().to_vec(), ridges.faces().to_vec()), &(ball, faces)));
    let plate = plate_at(&surface, 0.4e-3);
    let part = lower_part(&surface, beside);
    let combined = CombinedSkin::new(&surface, half_space(), vec![part]).expect("a part that fits");
    let on_part = |x: &Vector3<f64>| x.x > 2.5 * PITCH;
    let only = |on_its_side: &dyn Fn(&Vector3<f64>) -> bool| {
        let masked = surface.clone().with_skin_mask(surface.vertices().iter().map(on_its_side).collect());
        solve(&masked.expect("one entry a vertex"), &plate, &combined, false).resultant.force.z
    };
    let alone = [only(&|x| x.x < PITCH), only(&|x| x.x >= PITCH && !on_part(x)), only(&on_part)];
    assert!(alone.iter().all(|force| *force > 0.0));
    let all = solve(&surface, &plate, &combined, false);
    assert_relative_eq!(all.resultant.force.z, alone.iter().sum(), max_relative = 1e-9);
    assert!(note(&all, APART).is_some());
    let coupled = solve(&surface, &plate, &combined, true).resultant.force.z;
    assert!(coupled < 0.98 * all.resultant.force.z);
}

#[test]
fn two_patches_on_one_pad_stay_one_problem() {
    let spacing = 0.5e-3;
    let surface = surface(grid(60, 30, spacing));
    let ball = |x: f64| {
        let (vertices, faces) = icosphere(5e-3, 4);
        let at = Vector3::new(x, 7.5e-3, 4.7e-3);
        (vertices.into_iter().map(|v| v + at).collect(), faces)
    };
    let (vertices, faces) = joined(&ball(8e-3), &ball(22e-3));
    let balls = Obstacle::mesh(vertices, faces, &Default::default()).unwrap();
    let contact = solve(&surface, &balls, &half_space(), false);
    assert_eq!(contact.patches.len(), 2);
    assert_eq!(contact.lcp_solutions.len(), 1);
    assert!(note(&contact, APART).is_none());
    // So do ridges too low to be fingers.
    let low = two_ridges(4e-3);
    let contact = solve(&low, &plate_at(&low, 0.4e-3), &half_space(), false);
    assert_eq!((contact.patches.len(), contact.lcp_solutions.len()), (2, 1));
}

#[test]
fn both_sides_of_a_palm_are_one_piece_of_tissue() {
    // 85 x 100 x 25 mm between two balls: 60 mm apart along the skin, 23 mm in a straight line through the palm.
    let (vertices, faces) = icosphere(1.0, 5);
    let scaled = |x: &Vector3<f64>| Vector3::new(42.5e-3 * x.x, 50e-3 * x.y, 12.5e-3 * x.z);
    let palm = (vertices.iter().map(scaled).collect(), faces);
    // What stands in it as a piece of its own, as nails do, is not in the way.
    let (vertices, faces) = icosphere(3e-3, 3);
    let rod = (vertices.iter().map(|x| Vector3::new(16.0 * x.x, x.y, x.z)).collect(), faces);
    let palm = surface(joined(&palm, &rod));
    let ball = |z: f64| {
        let (vertices, faces) = icosphere(60e-3, 4);
        (vertices.into_iter().map(|x| x + Vector3::new(0.0, 0.0, z)).collect(), faces)
    };
    let (vertices, faces) = joined(&ball(71.5e-3), &ball(-71.5e-3));
    let balls = Obstacle::mesh(vertices, faces, &Default::default()).unwrap();
    let contact = solve(&palm, &balls, &half_space(), false);
    assert_eq!((contact.patches.len(), contact.lcp_solutions.len()), (2, 1));
    assert!(note(&contact, APART).is_none());
}

#[test]
fn parts_of_the_skin_that_nothing_joins_do_not_couple() {
    let (vertices, faces) = grid(20, 20, 0.5e-3);
    let other = (vertices.iter().map(|x| x + Vector3::new(12e-3, 0.0, 0.0)).collect(), faces.clone());
    let surface = surface(joined(&(vertices, faces), &other));
    let rod = Obstacle::capsule(Vector3::new(-0.01, 5e-3, 4.8e-3), Vector3::new(0.04, 5e-3, 4.8e-3), 5e-3);
    let contact = solve(&surface, &rod.unwrap(), &half_space(), false);
    assert_eq!(contact.lcp_solutions.len(), 2);
    assert!(note(&contact, APART).unwrap().contains("no way along the skin"));
}

#[test]
fn a_finger_that_touches_between_its_vertices_is_apart_too() {
    // Two balls of skin on either side of a plate; the second one's nearest vertices stay outside, its smooth skin does not.
    let (radius, thickness) = (8e-3, 10e-3);
    let (ball, faces) = icosphere(radius, 3);
    // The middle of a face to -x.
    let middle: Vector3<f64> = faces[0].iter().map(|&corner| ball[corner as usize]).sum();
    let turn = Rotation3::rotation_between(&middle, &-Vector3::x()).expect("not opposite");
    let turned: Vec<Vector3<f64>> = ball.iter().map(|x| turn * x).collect();
    let farthest = turned.iter().map(|x| -x.x).fold(0.0, f64::max);
    let depth = 0.8 * (radius - farthest);
    let moved = |list: &[Vector3<f64>], x: f64| list.iter().map(|at| at + Vector3::x() * x).collect();
    let left = (moved(&ball, -(radius + 0.5 * thickness - 1e-3)), faces.clone());
    let surface = surface(joined(&left, &(moved(&turned, radius + 0.5 * thickness - depth), faces)));
    let plate = Obstacle::cuboid(Vector3::new(0.5 * thickness, 20e-3, 20e-3)).expect("a plate");
    for skin in [half_space(), galerkin()] {
        let contact =
            solve_contact(&surface, &plate, &skin, &ContactOptions::default()).expect("a valid request");
        assert!(note(&contact, APART).is_some());
        let on_right = contact.force_vectors.iter().zip(contact.surface().vertices());
        let on_right: f64 = on_right.filter(|(_, x)| x.x > 0.0).map(|(force, _)| force.norm()).sum();
        let modulus = 2.0 * SHEAR_MODULUS / (1.0 - POISSON_RATIO);
        let hertz = 4.0 / 3.0 * modulus * radius.sqrt() * depth.powf(1.5);
        assert!((on_right / hertz - 1.0).abs() < 0.1, "{on_right} N, alone {hertz}");
    }
}

#[test]
fn fingers_that_cross_through_a_thin_sheet_press_it_as_alone() {
    // 0.3 mm deep from both sides of a sheet of 0.5 mm: undeformed they stand 0.1 mm in one another.
    let (vertices, faces) = icosphere(8e-3, 4);
    let at = |z: f64| (vertices.iter().map(|x| x + z * UP).collect(), faces.clone());
    let (half, depth) = (0.25e-3, 0.3e-3);
    let off = half - depth + 8e-3;
    let (both, both_faces) = joined(&at(off), &at(-off));
    let fingers = Surface::new(both, both_faces).expect("two balls that cross");
    let sheet = Obstacle::cuboid(Vector3::new(0.03, 0.03, half)).expect("a sheet");
    let squeezed = solve(&fingers, &sheet, &half_space(), false);
    assert_eq!(squeezed.lcp_solutions.len(), 2);

    let upper = surface(at(off));
    let alone = solve(&upper, &sheet, &half_space(), false);
    let of_upper = |vertex: &&usize| **vertex < alone.surface().vertices().len();
    let forces = squeezed.active.iter().filter(of_upper).map(|&vertex| squeezed.force_vectors[vertex].z);
    let upwards: f64 = forces.sum();
    assert_relative_eq!(upwards, alone.resultant.force.z, max_relative = 1e-9);
}

#[test]
fn the_nearest_source_along_the_skin_is_the_one_that_single_searches_find() {
    let surface = two_ridges(40e-3);
    let sources = [7, 300, 900];
    let single: Vec<Vec<(usize, f64)>> =
        sources.iter().map(|&source| surface.skin_distances(&[source], f64::INFINITY)).collect();
    let way = |source: usize, vertex: usize| single[source][vertex].1;
    let nearest = surface.nearest_along_skin(&sources, f64::INFINITY);
    for vertex in 0..surface.vertices().len() {
        let best = (0..3).min_by(|&a, &b| way(a, vertex).total_cmp(&way(b, vertex))).unwrap();
        assert_eq!(nearest.source(vertex), Some(sources[best]));
        assert_eq!(nearest.distance[vertex], way(best, vertex));
    }
    let near = surface.nearest_along_skin(&sources, 5e-3);
    for vertex in 0..surface.vertices().len() {
        let within = nearest.distance[vertex] <= 5e-3;
        assert_eq!(near.distance[vertex].is_finite() && near.source(vertex).is_some(), within);
    }
}

#[test]
fn fingertips_of_a_real_hand_are_told_apart() {
    let Some(data) = data_dir() else { return };
    let hand = surface(read_ply(&data.join("hands/libhand_right_13k.ply")));
    // A plate that meets two fingertips within the depth.
    let direction = Vector3::new(-0.208, -0.927, -0.313).normalize();
    let plate = Obstacle::half_space(Vector3::zeros(), direction).unwrap();
    let way = along(direction, Goal::Depth(2.5e-3));
    let contact = press(&hand, &plate, &half_space(), &way, &ContactOptions::on_given_mesh()).unwrap();
    assert_eq!(contact.lcp_solutions.len(), 2);
    assert!(note(&contact, APART).unwrap().contains(&format!("more than {LONGEST_DETOUR} times")));

    // One fingertip is what lies within 40 mm along the skin of a patch; the other one is farther.
    let near = hand.nearest_along_skin(&contact.patches[0].vertices, 40e-3).distance;
    let alone = |first: bool| {
        let mask = near.iter().map(|distance| distance.is_finite() == first).collect();
        let masked = hand.clone().with_skin_mask(mask).unwrap();
        solve(&masked, &contact.obstacle, &half_space(), false).resultant.force
    };
    let alone = alone(true) + alone(false);
    assert_relative_eq!(alone, contact.resultant.force, max_relative = 1e-12);
}

#[test]
fn a_third_patch_joins_no_two_others() {
    let Some(data) = data_dir() else { return };
    let hand = surface(read_ply(&data.join("hands/libhand_right_13k.ply")));
    let plate = Obstacle::half_space(Vector3::zeros(), UP).unwrap();
    // Two fingertips, and from 3.25 mm on the middle of one of these fingers.
    let pressed = |depth: f64| press_up(&hand, &plate, &half_space(), depth);
    let contacts: Vec<Contact> = (28..=38).map(|step| pressed(f64::from(step) * 1e-4)).collect();
    let patches = |contact: &Contact| hand.patches(&contact.candidates).len();
    assert_eq!((patches(&contacts[0]), patches(&contacts[10])), (2, 3));
    for three in contacts.windows(3) {
        let [before, force, after] = [0, 1, 2].map(|at| three[at].resultant.force.z);
        assert_relative_eq!(force, 0.5 * (before + after), max_relative = 5e-3);
    }
}
