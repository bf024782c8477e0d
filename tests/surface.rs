//! The skin surface through the public interface.

mod common;

use std::f64::consts::{PI, TAU};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use common::{Mesh, flipped, grid, icosphere, joined};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use quasirigid::geometry::Bounds;
use quasirigid::mesh::MeshError;
use quasirigid::surface::{Surface, SurfaceError};

fn surface(mesh: Mesh) -> Surface {
    Surface::new(mesh.0, mesh.1).expect("a sound mesh")
}

/// Unit cube, two faces a side, all diagonals through vertex 0 or the one opposite to it.
fn cube() -> Mesh {
    let vertices = (0..8).map(|i| Vector3::from_fn(|k, _| f64::from(i >> k & 1))).collect();
    let quads = [[0, 2, 3, 1], [7, 6, 4, 5], [0, 1, 5, 4], [7, 3, 2, 6], [0, 4, 6, 2], [7, 5, 1, 3]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// Tube about z from 0 to `height` with `sectors` squares around; each end closed by rings around a middle
/// vertex if asked.
fn tube(radius: f64, height: f64, sectors: usize, capped: bool) -> Mesh {
    let spacing = TAU * radius / sectors as f64;
    let rows = (height / spacing).ceil() as usize;
    let rings = (radius / spacing).ceil() as usize;
    let mut profile: Vec<(f64, f64)> = Vec::new();
    let radii = (1..rings).map(|i| radius * i as f64 / rings as f64);
    if capped {
        profile.extend(radii.clone().map(|r| (r, 0.0)));
    }
    profile.extend((0..=rows).map(|i| (radius, height * i as f64 / rows as f64)));
    if capped {
        profile.extend(radii.rev().map(|r| (r, height)));
    }
    let mut vertices = Vec::new();
    for (r, z) in &profile {
        vertices.extend((0..sectors).map(|i| {
            let angle = TAU * i as f64 / sectors as f64;
            Vector3::new(r * angle.cos(), r * angle.sin(), *z)
        }));
    }
    let at = |row: usize, i: usize| (row * sectors + i % sectors) as u32;
    let mut faces = Vec::new();
    for row in 0..profile.len() - 1 {
        for i in 0..sectors {
            let (a, b, c, d) = (at(row, i), at(row, i + 1), at(row + 1, i + 1), at(row + 1, i));
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    if capped {
        let (bottom, top) = (vertices.len() as u32, vertices.len() as u32 + 1);
        vertices.extend([Vector3::zeros(), Vector3::new(0.0, 0.0, height)]);
        for i in 0..sectors {
            faces.push([bottom, at(0, i + 1), at(0, i)]);
            faces.push([top, at(profile.len() - 1, i), at(profile.len() - 1, i + 1)]);
        }
    }
    (vertices, faces)
}

fn a_pose() -> Isometry3<f64> {
    let rotation = UnitQuaternion::from_euler_angles(0.3, -1.1, 2.0);
    Isometry3::from_parts(Vector3::new(0.2, -0.1, 0.05).into(), rotation)
}

#[test]
fn a_cube_has_its_area_volume_and_vertex_areas() {
    let cube = surface(cube());
    assert_relative_eq!(cube.area(), 6.0, max_relative = 1e-15);
    assert_relative_eq!(cube.volume(), 1.0, max_relative = 1e-15);
    assert!(cube.face_areas().iter().all(|area| *area == 0.5));
    assert_relative_eq!(cube.mean_edge_length(), (12.0 + 6.0 * 2f64.sqrt()) / 18.0, max_relative = 1e-15);
    for (vertex, area) in cube.vertex_areas().iter().enumerate() {
        assert_relative_eq!(*area, cube.faces_around(vertex).len() as f64 * 0.5 / 3.0, max_relative = 1e-15);
    }
    assert_eq!(cube.bounding_box(), Bounds { low: Vector3::zeros(), high: Vector3::repeat(1.0) });
}

#[test]
fn vertex_normals_of_a_cube_point_along_its_diagonals_however_its_sides_are_cut() {
    let cube = surface(cube());
    let degrees: Vec<usize> = (0..8).map(|vertex| cube.faces_around(vertex).len()).collect();
    assert!(degrees.contains(&4) && degrees.contains(&6), "the diagonals are uneven");
    for (point, normal) in cube.vertices().iter().zip(cube.vertex_normals()) {
        let diagonal = (point - Vector3::repeat(0.5)).normalize();
        assert_relative_eq!(*normal, diagonal, epsilon = 1e-15);
    }
}

#[test]
fn a_sphere_tends_to_the_area_volume_and_normals_of_the_ball() {
    let errors: Vec<[f64; 3]> = (2..5)
        .map(|subdivisions| {
            let sphere = surface(icosphere(0.01, subdivisions));
            let normal_error = |(point, normal): (&Vector3<f64>, &Vector3<f64>)| {
                assert_relative_eq!(normal.norm(), 1.0, max_relative = 1e-14);
                (normal - point.normalize()).norm()
            };
            let normals = sphere.vertices().iter().zip(sphere.vertex_normals()).map(normal_error);
            let area = 1.0 - sphere.area() / (4.0 * PI * 1e-4);
            let volume = 1.0 - sphere.volume() / (4.0 / 3.0 * PI * 1e-6);
            [area, volume, normals.fold(0.0, f64::max)]
        })
        .collect();
    for pair in errors.windows(2) {
        let [area, volume, normals] = [0, 1, 2].map(|i| pair[0][i] / pair[1][i]);
        assert!(area > 3.9 && volume > 3.9, "second order: errors fall by {area} and {volume}");
        assert!(normals > 1.9, "first order where the triangles are uneven: error falls by {normals}");
    }
}

#[test]
fn vertex_areas_add_up_to_the_area() {
    for mesh in [icosphere(0.01, 3), grid(7, 5, 1e-3), cube(), tube(8e-3, 0.03, 24, true)] {
        let surface = surface(mesh);
        assert_relative_eq!(
            surface.vertex_areas().iter().sum::<f64>(),
            surface.area(),
            max_relative = 8.0 * surface.vertices().len() as f64 * f64::EPSILON
        );
    }
}

#[test]
fn a_flat_grid_is_open_and_its_normals_point_up() {
    let surface = surface(grid(5, 4, 1e-3));
    assert!(!surface.is_closed());
    assert!(surface.volume().is_nan());
    assert_relative_eq!(surface.area(), 20e-6, max_relative = 1e-14);
    assert!(surface.vertex_normals().iter().all(|normal| *normal == Vector3::z()));
    assert_eq!(surface.topology().boundary_loops().len(), 1);
    assert_eq!(surface.topology().boundary_loops()[0].len(), 18);
}

#[test]
fn a_far_translation_does_not_spoil_the_volume() {
    let near = surface(icosphere(0.01, 3));
    let far = near.moved(&Isometry3::translation(1e4, -2e4, 3e4));
    // The coordinates themselves lose 4e-12 m of 0.01 m.
    assert_relative_eq!(far.volume(), near.volume(), max_relative = 1e-8);
}

#[test]
fn the_mask_must_have_one_entry_a_vertex() {
    let sphere = surface(icosphere(1.0, 0));
    let error = sphere.clone().with_skin_mask(vec![true; 11]).unwrap_err();
    assert_eq!(error, SurfaceError::MaskLength { found: 11, expected: 12 });
    assert_eq!(error.to_string(), "the skin mask has 11 entries, but the surface has 12 vertices");
    assert!(sphere.skin_mask().iter().all(|skin| *skin));
}

#[test]
fn a_moved_or_deformed_surface_keeps_its_mask_and_neighbours() {
    let mut mask = vec![true; 42];
    mask[7] = false;
    let sphere = surface(icosphere(0.01, 1)).with_skin_mask(mask.clone()).unwrap();
    let moved = sphere.moved(&a_pose());
    assert_eq!(moved.skin_mask(), mask);
    let expected = a_pose() * nalgebra::Point3::from(sphere.vertices()[3]);
    assert_relative_eq!(moved.vertices()[3], expected.coords, epsilon = 1e-16);
    assert_eq!(moved.neighbours(5), sphere.neighbours(5));
    let flat = sphere.vertices().iter().map(|point| Vector3::new(point.x, point.y, 0.0)).collect();
    let flat = sphere.with_vertices(flat);
    assert_abs_diff_eq!(flat.volume(), 0.0, epsilon = 1e-20);
    assert!(flat.vertex_normals().iter().all(|normal| (normal.norm() - 1.0).abs() < 1e-12));
    let point = sphere.with_vertices(vec![Vector3::zeros(); 42]);
    assert_eq!((point.area(), point.mean_edge_length()), (0.0, 0.0));
    assert!(point.vertex_normals().iter().chain(point.face_normals()).all(|normal| normal.norm() == 0.0));
}

#[test]
#[should_panic(expected = "as many positions as the surface has vertices")]
fn deformed_positions_must_be_as_many_as_vertices() {
    surface(icosphere(1.0, 0)).with_vertices(vec![Vector3::zeros(); 11]);
}

#[test]
fn mesh_defects_are_refused_with_their_own_words() {
    let (vertices, faces) = icosphere(1.0, 1);
    let error = Surface::new(vertices.clone(), flipped(&faces)).unwrap_err();
    assert!(matches!(error, SurfaceError::Mesh(MeshError::InsideOut { component: 0, .. })));
    assert!(error.to_string().starts_with("closed component 0 (from face 0 on) is inside out"));
    let ball = (vertices, faces);
    let (vertices, faces) = joined(&ball, &ball);
    let error = Surface::new(vertices, faces).unwrap_err();
    assert!(matches!(error, SurfaceError::Mesh(MeshError::CoincidentShell { component: 1, other: 0, .. })));
}

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
        let mask = surface.flat_cap_mask();
        for (point, skin) in tube.vertices().iter().zip(&mask) {
            assert_eq!(*skin, point.z > 1e-9 && point.z < 0.04 - 1e-9, "{point}");
        }
    }
}

#[test]
fn spheres_open_patches_open_tubes_and_boxes_stay_skin() {
    for mesh in
        [icosphere(0.01, 3), icosphere(0.01, 0), grid(20, 20, 1e-3), tube(8e-3, 0.04, 40, false), cube()]
    {
        assert!(surface(mesh).flat_cap_mask().iter().all(|skin| *skin));
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
    assert!(surface((vertices, faces)).flat_cap_mask().iter().all(|skin| *skin));
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
            for (vertex, skin) in surface.flat_cap_mask().iter().enumerate() {
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
        proptest::prop_assert_eq!(before.flat_cap_mask(), after.flat_cap_mask());
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
        let (mask_before, mask_after) = (before.flat_cap_mask(), after.flat_cap_mask());
        for (vertex, new) in to.iter().enumerate() {
            assert_relative_eq!(before.vertex_areas()[vertex], after.vertex_areas()[*new], max_relative = 1e-14);
            assert_relative_eq!(before.vertex_normals()[vertex], after.vertex_normals()[*new], epsilon = 1e-14);
            proptest::prop_assert_eq!(mask_before[vertex], mask_after[*new]);
        }
    }
}
