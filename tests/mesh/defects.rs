//! Every defect of a mesh is named: each error reached by breaking one thing.

use nalgebra::Vector3;
use quasirigid::mesh::{MeshError, check, check_nesting};

use crate::common::{Mesh, flipped, grid, icosphere, joined};
use crate::{shifted, tetrahedron, welded};

fn error_of(mesh: &Mesh) -> MeshError {
    check(&mesh.0, &mesh.1).expect_err("the mesh is broken")
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
fn a_border_that_is_graded_to_fine_edges_is_welded_and_a_gap_in_it_is_found() {
    // 22 columns of cells at x = 0, 1e-6, 3e-6, 7e-6 ..., with 12 rows of 0.5; straight and with corners of 45°.
    let graded = |slope: f64| {
        let (mut vertices, faces) = grid(22, 12, 1.0);
        for vertex in &mut vertices {
            let y = 0.5 * vertex.y;
            *vertex = Vector3::new(1e-6 * (2f64.powf(vertex.x) - 1.0) + slope * y, y, 0.0);
        }
        (vertices, faces)
    };
    for slope in [0.0, 1.0] {
        let mesh = graded(slope);
        assert_eq!(check(&mesh.0, &mesh.1).expect("it is welded").boundary_loops().len(), 1);
        let across = |p: &Vector3<f64>| Vector3::new(2.0 * slope * p.y - p.x - 1e-9, p.y, 0.0);
        let gap = joined(&mesh, &(mesh.0.iter().map(across).collect(), flipped(&mesh.1)));
        let MeshError::Unwelded { count, weld_tolerance, .. } = error_of(&gap) else {
            panic!("another error");
        };
        assert_eq!(count, 2 * 13);
        let mended = welded(&gap, weld_tolerance).expect("the tolerance that was named");
        assert_eq!((mended.vertices.len(), mended.faces.len()), ((23 + 22) * 13, 2 * 2 * 22 * 12));
    }
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

#[test]
fn coordinates_of_which_areas_overflow_are_named() {
    for factor in [1e61, 1e95, 1e103, 1e300] {
        let mut mesh = tetrahedron();
        mesh.0.iter_mut().for_each(|vertex| *vertex *= factor);
        let expected = MeshError::OutOfRange { vertex: 1, axis: 'x', value: factor, count: 3 };
        assert_eq!(error_of(&mesh), expected);
    }
    let mut mesh = tetrahedron();
    mesh.0.iter_mut().for_each(|vertex| *vertex *= 1e60);
    assert!(check(&mesh.0, &mesh.1).is_ok());
}
