//! What repair mends, counts and refuses.

use nalgebra::Vector3;
use quasirigid::mesh::{MeshError, check, check_nesting};

use crate::common::{Mesh, Random, grid, icosphere};
use crate::{tetrahedron, welded};

#[test]
fn repair_leaves_a_sound_mesh_as_it_is() {
    let mesh = icosphere(1.0, 1);
    let mended = welded(&mesh, 1e-3).unwrap();
    assert!(mended.report.is_unchanged() && mended.report.largest_move == 0.0);
    assert_eq!((mended.vertices, mended.faces), mesh);
    assert_eq!(mended.vertex_map, (0..mesh.0.len()).map(Some).collect::<Vec<_>>());
}

#[test]
fn repair_counts_each_change_and_maps_the_vertices() {
    let (mut vertices, mut faces) = tetrahedron();
    vertices.push(Vector3::new(7.0, 7.0, 7.0)); // 4: unused
    vertices.push(Vector3::new(1.0, 0.0, 1e-6)); // 5: twin of 1
    vertices.push(Vector3::new(0.5, 0.5, 0.0)); // 6: on the edge 1-2
    faces[1] = [0, 5, 3];
    faces[2] = [0, 2, 3]; // flipped
    faces.push([1, 5, 2]); // collapses
    faces.push([1, 2, 6]); // no area
    faces.push([3, 1, 2]); // duplicate
    let mended = welded(&(vertices, faces), 1e-5).unwrap();
    let report = &mended.report;
    assert_eq!(report.welded_vertices, 1);
    assert!((report.largest_move - 1e-6).abs() < 1e-18);
    assert_eq!((report.collapsed_faces, report.zero_area_faces, report.duplicate_faces), (1, 1, 1));
    assert_eq!((report.unused_vertices, report.flipped_faces, report.turned_components), (2, 1, 0));
    assert_eq!(mended.vertex_map, [Some(0), Some(1), Some(2), Some(3), None, Some(1), None]);
    assert_eq!((mended.vertices, mended.faces), tetrahedron());
    assert!(
        report
            .to_string()
            .starts_with("1 vertices welded (moved by at most 1.000e-6 m); dropped 1 collapsed")
    );
}

#[test]
fn repair_takes_away_both_sides_of_a_fin() {
    let mut mesh = tetrahedron();
    mesh.0.push(Vector3::new(1.0, 1.0, 0.0));
    mesh.1.extend([[2, 1, 4], [1, 2, 4]]);
    let mended = welded(&mesh, 0.0).unwrap();
    assert_eq!((mended.report.duplicate_faces, mended.report.unused_vertices), (2, 1));
    assert_eq!((mended.vertices, mended.faces), tetrahedron());
}

#[test]
fn repair_keeps_one_of_two_opposite_copies_of_a_face_of_the_surface() {
    let mut mesh = tetrahedron();
    mesh.1.push([1, 3, 2]);
    let mended = welded(&mesh, 0.0).unwrap();
    assert_eq!(mended.report.duplicate_faces, 1);
    assert_eq!((mended.vertices, mended.faces), tetrahedron());
    let mut open = grid(1, 1, 1.0);
    open.1.push([open.1[0][0], open.1[0][2], open.1[0][1]]);
    assert_eq!(welded(&open, 0.0).unwrap().faces, grid(1, 1, 1.0).1);
}

#[test]
fn welding_joins_chains_and_keeps_the_lowest_index_where_it_is() {
    let mut mesh = grid(2, 1, 1.0);
    mesh.0.extend([0.9, 1.8].map(|x| Vector3::new(2.0 + 1e-3 * x, 0.0, 0.0)));
    mesh.1.push([2, 6, 7]);
    let mended = welded(&mesh, 1e-3).unwrap();
    assert_eq!(mended.vertex_map[6..], [Some(2), Some(2)]);
    assert_eq!((mended.vertices, mended.faces), grid(2, 1, 1.0));
    assert!((mended.report.largest_move - 1.8e-3).abs() < 1e-15);
}

#[test]
fn repair_refuses_what_it_cannot_work_on() {
    let mesh = tetrahedron();
    for value in [-1.0, f64::INFINITY] {
        assert_eq!(welded(&mesh, value).unwrap_err(), MeshError::WeldTolerance { value });
    }
    assert!(matches!(welded(&mesh, f64::NAN).unwrap_err(), MeshError::WeldTolerance { .. }));
    let nothing = MeshError::NothingLeft {
        face_count: 4,
        collapsed: 4,
        degenerate: 0,
        duplicates: 0,
        weld_tolerance: 5.0,
    };
    assert_eq!(welded(&mesh, 5.0).unwrap_err(), nothing);
    let mut broken = tetrahedron();
    broken.0[1].x = f64::NAN;
    assert!(matches!(welded(&broken, 0.0).unwrap_err(), MeshError::NonFinite { vertex: 1, count: 1, .. }));
    let mut broken = tetrahedron();
    broken.1[0][0] = 9;
    assert!(matches!(welded(&broken, 0.0).unwrap_err(), MeshError::VertexOutOfRange { vertex: 9, .. }));
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn repair_makes_a_shuffled_noisy_soup_the_sphere_again(seed in 0u64..1000) {
        let (vertices, faces) = icosphere(1.0, 2);
        let mut random = Random(seed);
        let mut soup: Mesh = (Vec::new(), Vec::new());
        for face in random.permutation(faces.len()) {
            let mut corners = faces[face];
            if random.next() < 0.3 {
                corners.swap(0, 1);
            }
            let start = soup.0.len() as u32;
            for vertex in corners {
                let noise = Vector3::from_fn(|_, _| 1e-4 * (random.next() - 0.5));
                soup.0.push(vertices[vertex as usize] + noise);
            }
            soup.1.push([start, start + 1, start + 2]);
        }
        let mended = welded(&soup, 2e-4).unwrap();
        proptest::prop_assert_eq!(mended.vertices.len(), vertices.len());
        proptest::prop_assert_eq!(mended.report.welded_vertices, soup.0.len() - vertices.len());
        proptest::prop_assert!(mended.report.largest_move <= 1e-4 * 3f64.sqrt());
        let topology = check(&mended.vertices, &mended.faces).unwrap();
        proptest::prop_assert!(topology.is_closed());
        check_nesting(&mended.vertices, &mended.faces, &topology).unwrap();
        let again = welded(&(mended.vertices.clone(), mended.faces.clone()), 2e-4).unwrap();
        proptest::prop_assert!(again.report.is_unchanged());
        proptest::prop_assert_eq!(again.faces, mended.faces);
    }
}

/// Faces at random on few points of a coarse lattice: all defects at once.
fn rubble() -> impl proptest::strategy::Strategy<Value = Mesh> {
    use proptest::prelude::*;
    let points = proptest::collection::vec(proptest::array::uniform3(0i8..3), 3..9);
    points.prop_flat_map(|points| {
        let n = points.len() as u32;
        let vertices: Vec<Vector3<f64>> =
            points.into_iter().map(|point| Vector3::from(point.map(f64::from))).collect();
        (Just(vertices), proptest::collection::vec(proptest::array::uniform3(0..n), 1..16))
    })
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn rubble_is_named_or_mended_and_a_second_repair_changes_nothing(mesh in rubble(), weld_tolerance in 0.0..1.5) {
        if let Ok(topology) = check(&mesh.0, &mesh.1) {
            let corners: usize = (0..mesh.0.len()).map(|vertex| topology.faces_around(vertex).len()).sum();
            proptest::prop_assert_eq!(corners, 3 * mesh.1.len());
            let ends: usize = (0..mesh.0.len()).map(|vertex| topology.neighbours(vertex).len()).sum();
            proptest::prop_assert_eq!(ends, 2 * topology.edge_count());
            let border: usize = topology.boundary_loops().iter().map(Vec::len).sum();
            proptest::prop_assert_eq!(3 * mesh.1.len() + border, 2 * topology.edge_count());
        }
        match welded(&mesh, weld_tolerance) {
            Ok(once) => {
                let twice = welded(&(once.vertices.clone(), once.faces.clone()), 0.0).unwrap();
                proptest::prop_assert!(twice.report.is_unchanged(), "{}", twice.report);
                for (vertex, new) in once.vertex_map.iter().enumerate() {
                    if let Some(new) = new {
                        let way = (once.vertices[*new] - mesh.0[vertex]).norm();
                        proptest::prop_assert!(way <= once.report.largest_move);
                    }
                }
            }
            Err(MeshError::NotOrientable { faces, .. }) => proptest::prop_assert!(faces[1] < mesh.1.len()),
            Err(error) => proptest::prop_assert!(matches!(error, MeshError::NothingLeft { .. }), "{}", error),
        }
    }
}
