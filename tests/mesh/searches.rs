//! Rings, patches, paths and cut faces of a surface, and what renumbering and motion leave as it is.

use approx::assert_relative_eq;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use quasirigid::surface::Surface;

use crate::common::{self, Mesh, grid, icosphere, joined};
use crate::{a_pose, surface, tube, unit_cube};

#[test]
fn k_rings_of_a_grid_grow_by_one_ring_each_and_are_sorted() {
    let patch = surface(grid(8, 8, 1.0));
    assert_eq!(patch.k_ring(&[40, 3, 40], 0), [3, 40]);
    let mut one: Vec<usize> =
        patch.neighbours(40).iter().map(|vertex| *vertex as usize).chain([40]).collect();
    one.sort_unstable();
    assert_eq!(patch.k_ring(&[40], 1), one);
    for rings in 1..6 {
        let inner = patch.k_ring(&[40], rings - 1);
        assert_eq!(patch.k_ring(&[40], rings), patch.k_ring(&inner, 1));
    }
    assert_eq!(patch.k_ring(&[0], 100), (0..81).collect::<Vec<_>>());
    assert!(patch.k_ring(&[], 3).is_empty());
}

#[test]
fn patches_are_the_parts_that_edges_join() {
    let patch = surface(grid(6, 1, 1.0));
    // vertices 0..7 below, 7..14 above; column 3 (3 and 10) parts the rest
    let nodes = [13, 0, 5, 12, 8, 1, 4, 7, 0];
    assert_eq!(patch.patches(&nodes), [vec![0, 1, 7, 8], vec![4, 5, 12, 13]]);
    assert_eq!(patch.patches(&[6, 2]), [vec![2], vec![6]]);
    assert!(patch.patches(&[]).is_empty());
}

#[test]
fn skin_distances_along_a_line_of_edges_are_exact_and_end_at_the_reach() {
    let strip = surface(grid(9, 1, 2e-3));
    let found = strip.skin_distances(&[0], 7e-3);
    let along: Vec<&(usize, f64)> = found.iter().filter(|(vertex, _)| *vertex < 10).collect();
    assert_eq!(along.iter().map(|entry| entry.0).collect::<Vec<_>>(), [0, 1, 2, 3]);
    for (vertex, distance) in along {
        assert_relative_eq!(*distance, 2e-3 * *vertex as f64, max_relative = 1e-14);
    }
    assert_eq!(strip.skin_distances(&[4], 0.0), [(4, 0.0)]);
    assert!(strip.skin_distances(&[], 1.0).is_empty());
}

#[test]
fn skin_distances_equal_those_of_repeated_relaxation_over_all_edges() {
    let ball = joined(&icosphere(0.01, 2), &{
        let (vertices, faces) = icosphere(0.01, 0);
        (vertices.iter().map(|point| point + Vector3::x()).collect(), faces)
    });
    let ball = surface(ball);
    let sources = [5, 77];
    let mut twin = vec![f64::INFINITY; ball.vertices().len()];
    sources.iter().for_each(|source| twin[*source] = 0.0);
    for _ in 0..twin.len() {
        for face in ball.faces() {
            for (a, b) in [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)] {
                let (a, b) = (face[a] as usize, face[b] as usize);
                twin[b] = twin[b].min(twin[a] + (ball.vertices()[b] - ball.vertices()[a]).norm());
            }
        }
    }
    for reach in [3e-3, 1e-2, f64::INFINITY] {
        let found = ball.skin_distances(&sources, reach);
        let expected: Vec<(usize, f64)> = twin
            .iter()
            .copied()
            .enumerate()
            .filter(|entry| entry.1 <= reach && entry.1.is_finite())
            .collect();
        assert_eq!(found, expected);
    }
    assert_eq!(ball.skin_distances(&sources, f64::INFINITY).len(), 162, "the other ball cannot be reached");
}

#[test]
fn both_ends_of_a_capped_tube_are_cut_faces_and_the_rims_belong_to_them() {
    let tube = surface(tube(8e-3, 0.04, 40, true));
    for surface in [tube.clone(), tube.moved(&a_pose())] {
        let mask = surface.skin_without_caps();
        for (point, skin) in tube.vertices().iter().zip(&mask) {
            assert_eq!(*skin, point.z > 1e-9 && point.z < 0.04 - 1e-9, "{point}");
        }
    }
}

#[test]
fn spheres_open_patches_open_tubes_and_boxes_stay_skin() {
    for mesh in
        [icosphere(0.01, 3), icosphere(0.01, 0), grid(20, 20, 1e-3), tube(8e-3, 0.04, 40, false), unit_cube()]
    {
        assert!(surface(mesh).skin_without_caps().iter().all(|skin| *skin));
    }
}

#[test]
fn a_flat_patch_that_meets_the_rest_smoothly_stays_skin() {
    // a ball cut flat below, its rim rounded by a cosine profile
    let (mut vertices, faces) = icosphere(0.01, 4);
    for point in &mut vertices {
        let blend = ((point.z + 0.009) / 0.002).clamp(0.0, 1.0);
        point.z = if blend < 1.0 { -0.008 + 0.001 * blend * blend } else { point.z };
    }
    let flat = vertices.iter().filter(|point| point.z == -0.008).count();
    assert!(flat > 50);
    assert!(surface((vertices, faces)).skin_without_caps().iter().all(|skin| *skin));
}

fn meshes(folder: &str) -> Vec<(String, Mesh)> {
    let Some(data) = common::data_dir() else { return Vec::new() };
    let mut paths: Vec<_> =
        std::fs::read_dir(data.join(folder)).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "ply"));
    paths.sort();
    paths
        .iter()
        .map(|path| (path.file_stem().unwrap().display().to_string(), common::read_ply(path)))
        .collect()
}

#[test]
fn every_good_hand_and_product_is_a_closed_surface() {
    for folder in ["hands", "products"] {
        for (name, (vertices, faces)) in meshes(folder) {
            let surface = Surface::new(vertices, faces).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(surface.is_closed() && surface.volume() > 0.0, "{name}");
        }
    }
}

#[test]
fn the_cut_faces_of_hands_and_fingers_are_their_lowest_vertices() {
    for (name, (vertices, faces)) in meshes("hands") {
        let cut = vertices.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
        let stored = surface((vertices.clone(), faces.clone()));
        // turned and stored again as float32, and in millimetres
        let rounded = stored
            .moved(&a_pose())
            .vertices()
            .iter()
            .map(|point| point.map(|x| f64::from(x as f32)))
            .collect();
        let millimetres = vertices.iter().map(|point| point * 1e3).collect();
        for surface in [stored.clone(), stored.with_vertices(rounded), stored.with_vertices(millimetres)] {
            for (vertex, skin) in surface.skin_without_caps().iter().enumerate() {
                // the low-poly source hand ends round
                let expected = name == "webxr_right_source" || vertices[vertex].y > cut + 1e-6;
                assert_eq!(*skin, expected, "{name}, vertex {vertex} at {}", vertices[vertex]);
            }
        }
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 24, failure_persistence: None, ..Default::default() })]

    #[test]
    fn rigid_motion_and_unit_change_nothing_but_the_unit(
        angles in proptest::array::uniform3(-3.0..3.0),
        shift in proptest::array::uniform3(-1.0..1.0),
    ) {
        let before = surface(tube(8e-3, 0.04, 24, true));
        let [roll, pitch, yaw] = angles;
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let pose = Isometry3::from_parts(Vector3::from(shift).into(), rotation);
        let scaled = before.moved(&pose).vertices().iter().map(|point| point * 1e3).collect();
        let after = Surface::new(scaled, before.faces().to_vec()).unwrap();
        // rounding of coordinates of 1 m against edges of 2 mm
        assert_relative_eq!(after.area(), before.area() * 1e6, max_relative = 1e-11);
        assert_relative_eq!(after.volume(), before.volume() * 1e9, max_relative = 1e-11);
        assert_relative_eq!(after.mean_edge_length(), before.mean_edge_length() * 1e3, max_relative = 1e-11);
        for (a, b) in before.vertex_normals().iter().zip(after.vertex_normals()) {
            assert_relative_eq!(rotation * a, *b, epsilon = 1e-11);
        }
        proptest::prop_assert_eq!(before.skin_without_caps(), after.skin_without_caps());
        let far = before.skin_distances(&[30], 0.0201);
        let again = after.skin_distances(&[30], 20.1);
        proptest::prop_assert_eq!(far.len(), again.len());
    }

    #[test]
    fn renumbering_changes_no_area_and_no_cut_face(seed in 0u64..1000) {
        let mesh = tube(8e-3, 0.04, 24, true);
        let mut random = common::Random(seed);
        let to = random.permutation(mesh.0.len());
        let mut vertices = mesh.0.clone();
        mesh.0.iter().zip(&to).for_each(|(point, new)| vertices[*new] = *point);
        let renumbered = |face: usize| mesh.1[face].map(|vertex| to[vertex as usize] as u32);
        let faces = random.permutation(mesh.1.len()).into_iter().map(renumbered).collect();
        let (before, after) = (surface(mesh.clone()), surface((vertices, faces)));
        let (mask_before, mask_after) = (before.skin_without_caps(), after.skin_without_caps());
        for (vertex, new) in to.iter().enumerate() {
            assert_relative_eq!(before.vertex_areas()[vertex], after.vertex_areas()[*new], max_relative = 1e-14);
            assert_relative_eq!(before.vertex_normals()[vertex], after.vertex_normals()[*new], epsilon = 1e-14);
            proptest::prop_assert_eq!(mask_before[vertex], mask_after[*new]);
        }
    }
}
