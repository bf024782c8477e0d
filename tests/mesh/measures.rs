//! Areas, normals, volume and skin mask of a surface.

use std::f64::consts::PI;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use nalgebra::{Isometry3, Vector3};
use quasirigid::geometry::Bounds;
use quasirigid::mesh::MeshError;
use quasirigid::surface::{Surface, SurfaceError};

use crate::common::{flipped, grid, icosphere, joined};
use crate::{a_pose, surface, tube, unit_cube};

#[test]
fn a_cube_has_its_area_volume_and_vertex_areas() {
    let cube = surface(unit_cube());
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
    let cube = surface(unit_cube());
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
    for mesh in [icosphere(0.01, 3), grid(7, 5, 1e-3), unit_cube(), tube(8e-3, 0.03, 24, true)] {
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
