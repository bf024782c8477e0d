//! The skin surface through the public interface.

mod common;

use approx::assert_relative_eq;
use quasirigid::surface::Surface;

#[test]
fn a_sphere_has_nearly_the_area_and_volume_of_the_ball() {
    let (vertices, faces) = common::icosphere(0.01, 4);
    let surface = Surface::new(vertices, faces).unwrap();
    let pi = std::f64::consts::PI;
    assert!(surface.is_closed());
    assert_relative_eq!(surface.area(), 4.0 * pi * 1e-4, max_relative = 3e-3);
    assert_relative_eq!(surface.volume(), 4.0 / 3.0 * pi * 1e-6, max_relative = 5e-3);
    assert_relative_eq!(surface.vertex_areas().iter().sum::<f64>(), surface.area(), max_relative = 1e-12);
    for (point, normal) in surface.vertices().iter().zip(surface.vertex_normals()) {
        assert!(normal.dot(&point.normalize()) > 0.9999);
    }
}

#[test]
fn a_flat_grid_is_open_and_its_normals_point_up() {
    let (vertices, faces) = common::grid(5, 4, 1e-3);
    let surface = Surface::new(vertices, faces).unwrap();
    assert!(!surface.is_closed());
    assert!(surface.volume().is_nan());
    assert_relative_eq!(surface.area(), 20e-6, max_relative = 1e-14);
    assert!(surface.vertex_normals().iter().all(|normal| normal.z == 1.0));
    assert_eq!(surface.topology().boundary_loops().len(), 1);
    assert_eq!(surface.topology().boundary_loops()[0].len(), 18);
}

#[test]
fn every_good_hand_and_product_is_a_surface() {
    let Some(data) = common::data_dir() else { return };
    let mut count = 0;
    for folder in ["hands", "products"] {
        for entry in std::fs::read_dir(data.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "ply") {
                let (vertices, faces) = common::read_ply(&path);
                let surface =
                    Surface::new(vertices, faces).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
                assert!(surface.is_closed() && surface.volume() > 0.0, "{}", path.display());
                count += 1;
            }
        }
    }
    assert!(count >= 20, "only {count} meshes found");
}
