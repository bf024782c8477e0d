//! Cutting a finger out of a hand for its body response.

use nalgebra::Vector3;
use quasirigid::geometry::{Bounds, find_crossings};
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::surface::{CutOut, CutOutError, Surface, cut_out, cut_out_marked};

use crate::common::{data_dir, icosphere, read_ply};
use crate::surface;

fn sphere(subdivisions: usize) -> Surface {
    surface(icosphere(8e-3, subdivisions))
}

fn lowest(skin: &Surface) -> usize {
    (0..skin.vertices().len())
        .min_by(|&a, &b| skin.vertices()[a].z.total_cmp(&skin.vertices()[b].z))
        .expect("vertices")
}

/// What must hold of every part: closed, its kept vertices those of the whole, faces of a tame shape.
fn check_part(skin: &Surface, part: &CutOut) {
    assert!(part.surface.is_closed() && part.surface.volume() > 0.0);
    assert!(find_crossings(part.surface.vertices(), part.surface.faces()).is_empty());
    assert_eq!(part.fixed.len(), part.surface.vertices().len());
    assert_eq!(part.source_vertices.len(), part.surface.vertices().len());
    for (vertex, source) in part.source_vertices.iter().enumerate() {
        match source {
            Some(source) => {
                assert_eq!(skin.vertices()[*source], part.surface.vertices()[vertex]);
                assert_eq!(part.part_vertices[*source], Some(vertex));
            }
            None => assert!(part.fixed[vertex], "cap vertices are fixed"),
        }
        let may_touch = !part.fixed[vertex] && source.is_some_and(|source| skin.skin_mask()[source]);
        assert_eq!(part.surface.skin_mask()[vertex], may_touch);
    }
    let kept = part.part_vertices.iter().flatten().count();
    assert_eq!(kept, part.source_vertices.iter().flatten().count());
}

#[test]
fn a_border_aslant_over_a_waist_is_moved_until_its_cap_does_not_fold() {
    let (vertices, faces) = icosphere(1.0, 4);
    let waist = |p: &Vector3<f64>| {
        let width = 1.0 - 0.9 * (-(p.z / 0.35).powi(2)).exp();
        8e-3 * Vector3::new(width * p.x, 0.6 * width * p.y, 1.5 * p.z)
    };
    let skin = surface((vertices.iter().map(waist).collect(), faces));
    for slope in [0.9, 1.5] {
        let keep: Vec<bool> = vertices.iter().map(|p| p.z < slope * p.x).collect();
        let part = cut_out_marked(&skin, &keep).expect("a part");
        check_part(&skin, &part);
        let kept = part.source_vertices.iter().flatten();
        assert!(kept.clone().all(|&vertex| keep[vertex]));
        assert!(kept.count() > keep.iter().filter(|&&marked| marked).count() / 2);
    }
}

#[test]
fn a_cap_of_a_sphere_has_the_volume_of_the_segment_and_can_be_solved() {
    let skin = sphere(3);
    let part = cut_out(&skin, lowest(&skin), &Vector3::new(0.0, 0.0, -1e-3), &Vector3::new(0.0, 0.0, -3.0))
        .expect("a cap");
    check_part(&skin, &part);
    let rim = part.surface.vertices().iter().zip(&part.fixed).filter(|(_, fixed)| **fixed).map(|(v, _)| v.z);
    let height = 8e-3 + rim.clone().sum::<f64>() / rim.count() as f64;
    let segment = std::f64::consts::PI * height * height * (3.0 * 8e-3 - height) / 3.0;
    assert!((part.surface.volume() / segment - 1.0).abs() < 0.03, "{} {segment}", part.surface.volume());
    let worst = |faces: &[f64]| faces.iter().fold(f64::INFINITY, |a: f64, &b| a.min(b));
    assert!(worst(part.surface.face_areas()) > 0.1 * worst(skin.face_areas()));

    let node = part.part_vertices[lowest(&skin)].expect("the tip is kept");
    let compliance = Body::of_part(&part, None)
        .prepare(&part.surface, 60e3, 0.5, &[node], &BodyOptions::default())
        .expect("held at its cut");
    assert!(compliance.block(node, 0)[(2, 2)] > 0.0);
    assert_eq!(compliance.block(part.fixed.iter().position(|&f| f).expect("a rim"), 0).amax(), 0.0);
}

#[test]
fn a_part_can_be_cut_again() {
    let skin = sphere(3);
    let lower = cut_out(&skin, lowest(&skin), &(Vector3::z() * 3e-3), &-Vector3::z()).expect("a part");
    let side = lower
        .surface
        .vertices()
        .iter()
        .enumerate()
        .max_by(|a, b| a.1.x.total_cmp(&b.1.x))
        .map(|(i, _)| i)
        .expect("vertices");
    let belt = cut_out(&lower.surface, side, &(Vector3::z() * -3e-3), &Vector3::z()).expect("a belt");
    check_part(&lower.surface, &belt);
}

#[test]
fn a_finger_comes_out_of_a_whole_hand() {
    let Some(data) = data_dir() else { return };
    let hand = surface(read_ply(&data.join("hands/makehuman_male_right_13k.ply")));
    // an open hand, fingers along y: the middle finger reaches farthest
    let tip = (0..hand.vertices().len())
        .max_by(|&a, &b| hand.vertices()[a].y.total_cmp(&hand.vertices()[b].y))
        .expect("vertices");
    let point = hand.vertices()[tip] - Vector3::y() * 45e-3;
    let finger = cut_out(&hand, tip, &point, &Vector3::y()).expect("a finger");
    check_part(&hand, &finger);
    let Bounds { low, high } = finger.surface.bounding_box();
    let size = high - low;
    assert!((size.y - 45e-3).abs() < 4e-3 && size.x < 30e-3 && size.z < 35e-3, "{size:?} m");
    Body::of_part(&finger, None).held_vertices(&finger.surface).expect("a sound body");
}

#[test]
fn a_cut_that_leaves_nothing_or_everything_is_named() {
    let skin = sphere(1);
    let (tip, z) = (lowest(&skin), Vector3::z());
    let error = |tip: usize, point: Vector3<f64>, normal: Vector3<f64>| {
        cut_out(&skin, tip, &point, &normal).expect_err("no part")
    };
    assert_eq!(error(42, z, z), CutOutError::TipOutOfRange { tip: 42, vertex_count: 42 });
    assert_eq!(error(0, z, z * 0.0), CutOutError::Normal { length: 0.0 });
    assert_eq!(
        error(tip, -z, -z),
        CutOutError::TipCutOff { tip, distance: -1.0 + skin.vertices()[tip].z.abs() }
    );
    assert_eq!(error(tip, -z, z), CutOutError::NothingCut { tip });
}

#[test]
fn a_cut_whose_cap_folds_is_named_with_what_a_plane_or_a_mask_can_do() {
    // A ball bent to a crescent, whose middle lies outside of it.
    let (vertices, faces) = icosphere(1.0, 4);
    let bent = |p: &Vector3<f64>| 8e-3 * Vector3::new(p.x, 0.15 * p.y + 2.0 * p.x * p.x, p.z);
    let skin = surface((vertices.iter().map(bent).collect(), faces));
    let tip = lowest(&skin);
    let by_plane = cut_out(&skin, tip, &Vector3::zeros(), &-Vector3::z()).unwrap_err();
    assert_eq!(by_plane, CutOutError::PlaneFolds);
    let keep: Vec<bool> = skin.vertices().iter().map(|vertex| vertex.z < 0.0).collect();
    assert_eq!(cut_out_marked(&skin, &keep).unwrap_err(), CutOutError::Folds);
}

#[test]
fn a_mask_cuts_what_the_plane_between_its_vertices_cuts() {
    let skin = sphere(3);
    let normal = Vector3::new(0.0, 0.0, -1.0);
    let by_plane = cut_out(&skin, lowest(&skin), &Vector3::new(0.0, 0.0, -1e-3), &normal).expect("a cap");
    let keep: Vec<bool> = skin.vertices().iter().map(|vertex| vertex.z < -1e-3).collect();
    let by_mask = cut_out_marked(&skin, &keep).expect("a cap");
    check_part(&skin, &by_mask);
    assert_eq!(by_mask.part_vertices, by_plane.part_vertices);
    assert_eq!(by_mask.surface.faces(), by_plane.surface.faces());
}

#[test]
fn of_two_pieces_the_larger_is_kept() {
    let skin = sphere(3);
    let keep: Vec<bool> = skin.vertices().iter().map(|vertex| vertex.z < -4e-3 || vertex.z > 2e-3).collect();
    let part = cut_out_marked(&skin, &keep).expect("a cap");
    check_part(&skin, &part);
    assert!(part.source_vertices.iter().flatten().all(|&source| skin.vertices()[source].z > 2e-3));
}

#[test]
fn a_mask_of_no_part_is_refused() {
    let skin = sphere(1);
    let vertex_count = skin.vertices().len();
    let refused = |keep: &[bool]| cut_out_marked(&skin, keep).unwrap_err();
    assert_eq!(refused(&[true; 3]), CutOutError::KeepLength { found: 3, vertex_count });
    for marked in [0, vertex_count] {
        let keep = vec![marked > 0; vertex_count];
        assert_eq!(refused(&keep), CutOutError::KeepNothing { marked, vertex_count });
    }
}
