//! Faces that cross, found exactly.

use nalgebra::Vector3;
use quasirigid::geometry::find_crossings;

use crate::common::{Mesh, Random, data_dir, icosphere, read_ply, v};

/// Whether two triangles with corners of their own cross, whichever comes first and however they are listed.
fn cross(first: [Vector3<f64>; 3], second: [Vector3<f64>; 3]) -> bool {
    let found: Vec<bool> = [[first, second], [second, first]]
        .into_iter()
        .flat_map(|[a, b]| (0..3).map(move |i| (a, [b[i], b[(i + 2) % 3], b[(i + 1) % 3]])))
        .map(|(a, b)| !find_crossings(&[a, b].concat(), &[[0, 1, 2], [3, 4, 5]]).is_empty())
        .collect();
    assert!(found.iter().all(|one| *one == found[0]), "the verdict depends on the order: {found:?}");
    found[0]
}

/// Whether two faces over given points cross.
fn faces_cross(points: &[Vector3<f64>], first: [u32; 3], second: [u32; 3]) -> bool {
    let [one, other] = [[first, second], [second, first]].map(|faces| find_crossings(points, &faces).len());
    assert_eq!(one, other);
    one == 1
}

const STEP: f64 = 1e-300; // exact predicates see it beside 0

#[test]
fn triangles_apart_touching_and_through_each_other_are_told_apart() {
    let flat = [v(0.0, 0.0, 0.0), v(4.0, 0.0, 0.0), v(0.0, 4.0, 0.0)];
    let upright = |low: f64| [v(1.0, 1.0, low), v(1.0, 2.0, low + 1.0), v(2.0, 1.0, low + 1.0)];
    assert!(cross(flat, upright(-0.5)), "through the inside");
    assert!(cross(flat, upright(0.0)), "standing on it");
    assert!(!cross(flat, upright(STEP)), "a hair above");
    let at_edge = |y: f64| [v(1.0, y, -1.0), v(2.0, y, -1.0), v(1.5, y, 1.0)];
    assert!(cross(flat, at_edge(0.0)), "through an edge");
    assert!(!cross(flat, at_edge(-STEP)), "beside that edge");
    assert!(cross(flat, [v(4.0, 0.0, -1.0), v(4.0, 0.0, 1.0), v(5.0, 0.0, 0.0)]), "edge through a corner");
    assert!(!cross(flat, [v(3.0, 3.0, -1.0), v(3.0, 3.0, 1.0), v(4.0, 4.0, 0.0)]), "boxes alone overlap");
}

#[test]
fn triangles_in_one_plane_cross_where_they_overlap_or_touch() {
    let large = [v(0.0, 0.0, 1.0), v(4.0, 0.0, 1.0), v(0.0, 4.0, 1.0)];
    let shifted = |x: f64, y: f64| [v(x, y, 1.0), v(x + 1.0, y, 1.0), v(x, y + 1.0, 1.0)];
    assert!(cross(large, shifted(0.5, 0.5)), "one inside the other");
    assert!(cross(large, shifted(-0.5, 1.0)), "across a side");
    assert!(cross(large, shifted(4.0, 0.0)), "corner on corner");
    assert!(cross(large, [v(0.0, 0.0, 1.0), v(0.0, 2.0, 1.0), v(-1.0, 0.0, 1.0)]), "side on side");
    assert!(!cross(large, shifted(2.5, 2.5)), "beyond the long side");
    // The same in a plane that no axis is normal to.
    let tilt = |p: Vector3<f64>| v(p.x, p.y, p.x + 2.0 * p.y);
    assert!(cross(large.map(tilt), shifted(0.5, 0.5).map(tilt)));
    assert!(!cross(large.map(tilt), shifted(2.5, 2.5).map(tilt)));
}

#[test]
fn neighbours_over_an_edge_cross_only_when_folded_flat() {
    let folded = |tip: Vector3<f64>| {
        let points = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.5, 1.0, 0.0), tip];
        faces_cross(&points, [0, 1, 2], [1, 0, 3])
    };
    assert!(!folded(v(0.4, -1.0, 0.0)), "spread flat");
    assert!(!folded(v(0.4, 0.5, 0.3)), "at an angle");
    assert!(!folded(v(0.4, 0.5, STEP)), "all but closed");
    assert!(folded(v(0.4, 0.5, 0.0)), "closed");
    assert!(folded(v(0.4, 2.0, 0.0)), "closed over a larger one");
}

#[test]
fn neighbours_at_a_vertex_cross_where_they_meet_beyond_it() {
    let meets = |c: Vector3<f64>, d: Vector3<f64>| {
        let points = [v(0.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0), c, d];
        faces_cross(&points, [0, 1, 2], [0, 3, 4])
    };
    assert!(!meets(v(1.0, 1.0, 1.0), v(-1.0, 1.0, 1.0)), "above");
    assert!(meets(v(0.5, 0.5, 1.0), v(0.5, 0.5, -1.0)), "the far edge passes through");
    assert!(meets(v(3.0, 3.0, 1.0), v(3.0, 3.0, -1.0)), "through the far edge of the first");
    assert!(!meets(v(-1.0, -1.0, 1.0), v(-1.0, -1.0, -1.0)), "on the other side of the vertex");
    assert!(meets(v(0.5, 0.5, 0.0), v(0.0, 0.0, 1.0)), "an edge lies in it");
    assert!(meets(v(1.0, 1.0, 0.0), v(-1.0, 1.0, 0.0)), "overlap in the plane");
    assert!(!meets(v(-1.0, 0.0, 0.0), v(0.0, -1.0, 0.0)), "apart in the plane");
    assert!(meets(v(3.0, 0.0, 0.0), v(0.0, -1.0, 0.0)), "on a common line");
}

#[test]
fn the_same_corners_twice_cross() {
    let points = [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    assert!(faces_cross(&points, [0, 1, 2], [2, 1, 0]));
}

#[test]
fn the_tree_finds_the_pairs_that_all_pairs_give_in_order() {
    let mut random = Random(1);
    let vertices: Vec<_> = (0..300).map(|_| Vector3::from_fn(|_, _| random.next())).collect();
    let corner = |i: usize, k: usize| (7 * i + 31 * k + i * k) as u32 % 300;
    let faces: Vec<[u32; 3]> = (0..120).map(|i| [corner(i, 0), corner(i, 1), corner(i, 2)]).collect();
    let mut expected = Vec::new();
    for i in 0..faces.len() {
        for j in i + 1..faces.len() {
            if !find_crossings(&vertices, &[faces[i], faces[j]]).is_empty() {
                expected.push([i, j]);
            }
        }
    }
    assert!(expected.len() > 100);
    assert_eq!(find_crossings(&vertices, &faces), expected);
}

#[test]
fn good_meshes_have_none() {
    let (vertices, faces) = icosphere(0.05, 4);
    assert_eq!(find_crossings(&vertices, &faces), Vec::<[usize; 2]>::new());
    let Some(data) = data_dir() else { return };
    for name in ["hands/libhand_right_13k", "products/ycb_mug", "products/tbm_screwdriver"] {
        let (vertices, faces) = read_ply(&data.join(name).with_extension("ply"));
        assert_eq!(find_crossings(&vertices, &faces).len(), 0, "{name}");
    }
}

#[test]
fn the_pairs_of_defective_meshes_are_as_counted_by_an_independent_program() {
    let Some(data) = data_dir() else { return };
    let count = |name: &str| {
        let (vertices, faces): Mesh = read_ply(&data.join("bad").join(name).with_extension("ply"));
        find_crossings(&vertices, &faces).len()
    };
    assert_eq!(count("hand_fist_self_crossing"), 964);
    assert_eq!(count("tbm_soda_can_parts"), 165);
    assert_eq!(count("tbm_spray_parts"), 205);
    assert_eq!(count("ycb_mug_scan"), 14 + 3, "and three faces that stand twice");
}
