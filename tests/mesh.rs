//! Mesh checks through the public interface: each error reached by breaking one thing.

mod common;

use common::{Mesh, flipped, grid, icosphere, joined};
use nalgebra::Vector3;
use quasirigid::geometry::winding_number;
use quasirigid::mesh::RepairOptions;
use quasirigid::mesh::{MeshError, Topology, check, check_nesting, component_volumes, repair};

/// Corner tetrahedron with edges of 1 along the axes, volume 1/6.
fn tetrahedron() -> Mesh {
    let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
    (vertices, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
}

fn error_of(mesh: &Mesh) -> MeshError {
    check(&mesh.0, &mesh.1).expect_err("the mesh is broken")
}

fn nesting(mesh: &Mesh) -> Result<(), MeshError> {
    let topology = check(&mesh.0, &mesh.1).expect("each component is sound");
    check_nesting(&mesh.0, &mesh.1, &topology)
}

fn shifted(mesh: &Mesh, by: Vector3<f64>) -> Mesh {
    (mesh.0.iter().map(|point| point + by).collect(), mesh.1.clone())
}

fn sorted(row: &[u32]) -> Vec<u32> {
    let mut row = row.to_vec();
    row.sort_unstable();
    row
}

fn welded(mesh: &Mesh, weld_tolerance: f64) -> Result<quasirigid::mesh::Repair, MeshError> {
    repair(&mesh.0, &mesh.1, &RepairOptions { weld_tolerance })
}

#[test]
fn one_rings_of_a_tetrahedron_hold_the_three_other_vertices() {
    let (vertices, faces) = tetrahedron();
    let topology = check(&vertices, &faces).unwrap();
    for vertex in 0..4u32 {
        let others: Vec<u32> = (0..4).filter(|other| *other != vertex).collect();
        assert_eq!(sorted(topology.neighbours(vertex as usize)), others);
        let around: Vec<u32> = (0..4).filter(|face| faces[*face as usize].contains(&vertex)).collect();
        assert_eq!(sorted(topology.faces_around(vertex as usize)), around);
    }
    assert_eq!((topology.vertex_count(), topology.face_count(), topology.edge_count()), (4, 4, 6));
    assert!(topology.is_closed() && topology.is_component_closed(0));
    assert_eq!(topology.component_count(), 1);
    assert!((topology.mean_edge_length() - (3.0 + 3.0 * 2f64.sqrt()) / 6.0).abs() < 4.0 * f64::EPSILON);
    assert_eq!(topology.across(0, 1), Some(3), "edge 2-1 of the floor");
}

#[test]
fn rings_run_counter_clockwise_and_on_a_border_from_border_to_border() {
    let (vertices, faces) = grid(2, 2, 1.0);
    let topology = check(&vertices, &faces).unwrap();
    for vertex in 0..9 {
        let ring = topology.neighbours(vertex);
        let around = topology.faces_around(vertex);
        let open = vertex != 4;
        assert_eq!(ring.len(), around.len() + usize::from(open));
        let wedges = if open { ring.len() - 1 } else { ring.len() };
        for i in 0..wedges {
            let [a, b] = [ring[i], ring[(i + 1) % ring.len()]].map(|other| vertices[other as usize]);
            assert!((a - vertices[vertex]).cross(&(b - vertices[vertex])).z > 0.0);
            let face = faces[around[i] as usize];
            assert!(face.contains(&ring[i]) && face.contains(&ring[(i + 1) % ring.len()]));
        }
    }
}

#[test]
fn the_border_of_a_grid_is_one_loop_with_the_surface_on_its_left() {
    let (vertices, faces) = grid(2, 1, 1.0);
    let topology = check(&vertices, &faces).unwrap();
    assert_eq!(topology.boundary_loops(), [vec![0, 1, 2, 5, 4, 3]]);
    assert!(!topology.is_closed());
}

#[test]
fn single_faces_and_pairs_of_faces_pass() {
    let (vertices, faces) = tetrahedron();
    assert_eq!(check(&vertices[..3], &faces[..1]).unwrap().boundary_loops(), [vec![0, 2, 1]]);
    let pair = check(&vertices, &faces[..2]).unwrap();
    assert_eq!(pair.boundary_loops().len(), 1);
    assert_eq!(pair.edge_count(), 5);
}

#[test]
fn components_are_numbered_by_their_first_faces() {
    let mesh = joined(&tetrahedron(), &shifted(&tetrahedron(), Vector3::new(5.0, 0.0, 0.0)));
    let mesh = joined(&mesh, &shifted(&grid(1, 1, 1.0), Vector3::new(0.0, 9.0, 0.0)));
    let topology = check(&mesh.0, &mesh.1).unwrap();
    assert_eq!(topology.face_components(), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2]);
    assert_eq!([0, 4, 8].map(|vertex| topology.vertex_component(vertex)), [0, 1, 2]);
    assert_eq!([0, 1, 2].map(|label| topology.is_component_closed(label)), [true, true, false]);
    let volumes = component_volumes(&mesh.0, &mesh.1, &topology);
    assert!((volumes[0] - 1.0 / 6.0).abs() < 1e-15 && (volumes[1] - 1.0 / 6.0).abs() < 1e-14);
    assert!(volumes[2].is_nan());
}

#[test]
fn an_empty_mesh_is_named() {
    let (vertices, faces) = tetrahedron();
    assert_eq!(check(&vertices, &[]).unwrap_err(), MeshError::Empty { vertex_count: 4, face_count: 0 });
    assert_eq!(check(&[], &faces).unwrap_err(), MeshError::Empty { vertex_count: 0, face_count: 4 });
}

#[test]
fn coordinates_that_are_not_finite_are_named() {
    let mut mesh = tetrahedron();
    mesh.0[2].y = f64::INFINITY;
    mesh.0[3].x = f64::NEG_INFINITY;
    let expected = MeshError::NonFinite { vertex: 2, axis: 'y', value: f64::INFINITY, count: 2 };
    assert_eq!(error_of(&mesh), expected);
    mesh.0[1].z = f64::NAN;
    assert!(matches!(error_of(&mesh), MeshError::NonFinite { vertex: 1, axis: 'z', count: 3, .. }));
    assert!(error_of(&mesh).to_string().contains("vertex 1 has the coordinate z = NaN (3 vertices"));
}

#[test]
fn indices_out_of_range_are_named() {
    let mut mesh = tetrahedron();
    mesh.1[1][2] = 4;
    mesh.1[3][0] = 7;
    let expected = MeshError::VertexOutOfRange { face: 1, vertex: 4, vertex_count: 4, count: 2 };
    assert_eq!(error_of(&mesh), expected);
}

#[test]
fn a_repeated_index_is_named() {
    for corners in [[3, 3, 0], [3, 0, 3], [0, 3, 3]] {
        let mut mesh = tetrahedron();
        mesh.1[2] = corners;
        assert_eq!(error_of(&mesh), MeshError::RepeatedVertex { face: 2, vertex: 3, count: 1 });
    }
}

/// A square cut along its diagonal whose middle is a vertex at `height` off the diagonal, seen from the middle.
fn sliver(height: f64) -> Mesh {
    let point = |x: f64, y: f64| Vector3::new(x, y, 0.0);
    let vertices = vec![
        point(0.0, 0.0),
        point(1.0, 0.0),
        point(1.0, 1.0),
        point(0.0, 1.0),
        point(0.5 - height, 0.5 + height),
    ];
    (vertices, vec![[0, 1, 2], [0, 2, 4], [0, 4, 3], [4, 2, 3]])
}

#[test]
fn a_face_is_degenerate_below_1e_12_of_its_longest_edge_and_a_sliver_is_not() {
    let MeshError::DegenerateFace { face, height, longest_edge, count } = error_of(&sliver(0.0)) else {
        panic!("another error");
    };
    assert_eq!((face, height, count), (1, 0.0, 1));
    assert!((longest_edge - 2f64.sqrt()).abs() < 1e-15);
    // height over the diagonal: √2 times the offset, over √2
    assert!(matches!(error_of(&sliver(0.9e-12)), MeshError::DegenerateFace { face: 1, .. }));
    let thin = sliver(1.2e-12);
    check(&thin.0, &thin.1).unwrap();
}

#[test]
fn duplicate_faces_are_named_in_any_order_of_their_vertices() {
    for corners in [[1, 2, 3], [2, 3, 1], [3, 2, 1]] {
        let mut mesh = tetrahedron();
        mesh.1.extend([corners, [0, 1, 2]]);
        assert_eq!(error_of(&mesh), MeshError::DuplicateFace { face: 4, earlier: 3, count: 2 });
    }
}

#[test]
fn an_edge_with_three_faces_is_named() {
    let mut mesh = tetrahedron();
    mesh.0.push(Vector3::new(1.0, 1.0, 0.0));
    mesh.1.push([2, 1, 4]);
    assert_eq!(error_of(&mesh), MeshError::NonManifoldEdge { vertices: [1, 2], faces: 3, count: 1 });
}

#[test]
fn a_flipped_face_is_named_with_the_flips_that_mend_it() {
    let mut mesh = tetrahedron();
    mesh.1[2] = [0, 2, 3];
    let expected = MeshError::InconsistentOrientation { vertices: [0, 2], faces: [0, 2], count: 3, flips: 1 };
    assert_eq!(error_of(&mesh), expected);
}

/// Band of `n` squares closed to a ring with one half turn.
fn moebius(n: usize) -> Mesh {
    let mut vertices = Vec::new();
    for i in 0..n {
        let angle = std::f64::consts::TAU * i as f64 / n as f64;
        let across = Vector3::new(
            (angle / 2.0).cos() * angle.cos(),
            (angle / 2.0).cos() * angle.sin(),
            (angle / 2.0).sin(),
        );
        let middle = Vector3::new(angle.cos(), angle.sin(), 0.0);
        vertices.extend([middle - across * 0.3, middle + across * 0.3]);
    }
    let mut faces = Vec::new();
    for i in 0..n as u32 {
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i + 1 < n as u32 { (2 * i + 2, 2 * i + 3) } else { (1, 0) };
        faces.extend([[a, c, d], [a, d, b]]);
    }
    (vertices, faces)
}

#[test]
fn a_moebius_strip_cannot_be_oriented_and_repair_says_so_too() {
    let mesh = moebius(12);
    assert!(matches!(error_of(&mesh), MeshError::NotOrientable { count: 1, .. }));
    assert_eq!(welded(&mesh, 0.0).unwrap_err(), error_of(&mesh));
}

#[test]
fn a_pinched_vertex_is_named_with_its_fans() {
    let mut second = shifted(&tetrahedron(), Vector3::new(3.0, 0.0, 0.0));
    second.0[0] = Vector3::zeros();
    let mut mesh = joined(&tetrahedron(), &second);
    mesh.1.iter_mut().flatten().filter(|vertex| **vertex == 4).for_each(|vertex| *vertex = 0);
    mesh.0.swap_remove(4);
    mesh.1.iter_mut().flatten().filter(|vertex| **vertex == 7).for_each(|vertex| *vertex = 4);
    assert_eq!(error_of(&mesh), MeshError::PinchedVertex { vertex: 0, fans: 2, count: 1 });
}

#[test]
fn unused_vertices_are_named() {
    let mut mesh = tetrahedron();
    mesh.0.insert(0, Vector3::new(9.0, 9.0, 9.0));
    mesh.0.push(Vector3::new(8.0, 9.0, 9.0));
    mesh.1.iter_mut().flatten().for_each(|vertex| *vertex += 1);
    assert_eq!(error_of(&mesh), MeshError::UnusedVertex { vertex: 0, count: 2 });
}

/// A flat grid cut along its middle column, the right half moved away by `gap`.
fn cut_grid(gap: f64) -> Mesh {
    joined(&grid(3, 4, 1.0), &shifted(&grid(3, 4, 1.0), Vector3::new(3.0 + gap, 0.0, 0.0)))
}

#[test]
fn borders_closer_than_1e_3_of_an_edge_are_unwelded_and_wider_ones_are_not() {
    let MeshError::Unwelded { vertex, other, distance, count, weld_tolerance } = error_of(&cut_grid(0.0))
    else {
        panic!("another error");
    };
    assert_eq!((vertex, other, distance, count), (3, 20, 0.0, 10));
    let mended = welded(&cut_grid(0.0), weld_tolerance).unwrap();
    let topology = check(&mended.vertices, &mended.faces).unwrap();
    assert_eq!((mended.vertices.len(), topology.boundary_loops().len()), (35, 1));

    assert!(matches!(error_of(&cut_grid(1e-3)), MeshError::Unwelded { count: 10, .. }));
    let (vertices, faces) = cut_grid(2e-3);
    assert_eq!(check(&vertices, &faces).unwrap().boundary_loops().len(), 2);
}

#[test]
fn a_slit_that_runs_along_a_single_loop_is_unwelded() {
    let (mut vertices, mut faces) = grid(4, 4, 1.0);
    // vertex 12 in the middle gets a twin for the faces below it
    vertices.push(vertices[12]);
    let below: Vec<usize> = (0..faces.len())
        .filter(|face| faces[*face].contains(&12) && faces[*face].iter().all(|vertex| *vertex <= 14))
        .collect();
    for face in below {
        faces[face].iter_mut().filter(|vertex| **vertex == 12).for_each(|vertex| *vertex = 25);
    }
    let MeshError::Unwelded { vertex, other, distance, count, .. } = error_of(&(vertices, faces)) else {
        panic!("another error");
    };
    assert_eq!((vertex, other, distance, count), (12, 25, 0.0, 2));
}

#[test]
fn a_vertex_in_the_middle_of_a_border_edge_is_named() {
    // a coarse square left of x = 2 and a fine strip right of it, which share the corners 1 and 3
    let mut mesh = joined(&grid(1, 1, 2.0), &shifted(&grid(1, 2, 1.0), Vector3::new(2.0, 0.0, 0.0)));
    for vertex in mesh.1.iter_mut().flatten() {
        *vertex = [0, 1, 2, 3, 1, 5, 6, 7, 3, 9][*vertex as usize];
    }
    let MeshError::UnjoinedBorder { vertex, edge, distance, count } = error_of(&mesh) else {
        panic!("another error");
    };
    assert_eq!((vertex, edge, distance, count), (6, [1, 3], 0.0, 1));
}

#[test]
fn loose_triangles_are_named() {
    let (vertices, faces) = tetrahedron();
    let first = (vertices[..3].to_vec(), faces[..1].to_vec());
    let mesh = joined(&shifted(&grid(1, 1, 1.0), Vector3::new(9.0, 0.0, 0.0)), &first);
    assert_eq!(error_of(&mesh), MeshError::LooseFace { face: 2, count: 1, face_count: 3 });
}

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
    assert!(matches!(error, MeshError::InsideOut { volume: 0.0, .. }), "{error}");
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

#[test]
fn verdicts_are_the_same_in_millimetres_and_metres_and_after_a_translation() {
    let broken: Vec<Mesh> = vec![
        cut_grid(0.9e-3),
        sliver(0.5e-12),
        joined(&icosphere(3.0, 1), &icosphere(2.0, 1)),
        joined(&icosphere(3.0, 1), &icosphere(3.0, 1)),
        (tetrahedron().0, flipped(&tetrahedron().1)),
    ];
    let verdict = |mesh: &Mesh| {
        let error = match check(&mesh.0, &mesh.1) {
            Ok(topology) => check_nesting(&mesh.0, &mesh.1, &topology).unwrap_err(),
            Err(error) => error,
        };
        std::mem::discriminant(&error)
    };
    for mesh in broken {
        let scaled = (mesh.0.iter().map(|point| point * 1e-3).collect(), mesh.1.clone());
        assert_eq!(verdict(&mesh), verdict(&scaled));
        assert_eq!(verdict(&mesh), verdict(&shifted(&mesh, Vector3::new(8.0, -4.0, 2.0))));
    }
}

fn counts(topology: &Topology) -> [usize; 4] {
    let loops = topology.boundary_loops();
    [topology.edge_count(), loops.len(), loops.iter().map(Vec::len).sum(), topology.component_count()]
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn renumbering_vertices_and_faces_changes_no_neighbourhood(seed in 0u64..1000) {
        let mesh = joined(&grid(4, 3, 1.0), &shifted(&icosphere(1.0, 1), Vector3::new(0.0, 0.0, 5.0)));
        let mut random = common::Random(seed);
        let to = random.permutation(mesh.0.len());
        let mut vertices = mesh.0.clone();
        mesh.0.iter().zip(&to).for_each(|(point, new)| vertices[*new] = *point);
        let order = random.permutation(mesh.1.len());
        let faces: Vec<[u32; 3]> = order
            .iter()
            .map(|face| {
                let mut corners = mesh.1[*face].map(|vertex| to[vertex as usize] as u32);
                corners.rotate_left((random.next() * 3.0) as usize);
                corners
            })
            .collect();
        let (before, after) = (check(&mesh.0, &mesh.1).unwrap(), check(&vertices, &faces).unwrap());
        proptest::prop_assert_eq!(counts(&before), counts(&after));
        for vertex in 0..mesh.0.len() {
            let renumbered: Vec<u32> =
                before.neighbours(vertex).iter().map(|other| to[*other as usize] as u32).collect();
            proptest::prop_assert_eq!(sorted(&renumbered), sorted(after.neighbours(to[vertex])));
        }
    }

    #[test]
    fn repair_makes_a_shuffled_noisy_soup_the_sphere_again(seed in 0u64..1000) {
        let (vertices, faces) = icosphere(1.0, 2);
        let mut random = common::Random(seed);
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
