//! Displacements and bone pressures against closed forms: uniform pressure, Lamé's shell, flat layer, half-space.

use std::collections::HashMap;
use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::reference::point_load_on_layer;
use quasirigid::response::body::{Body, BodyOptions};
use quasirigid::surface::Surface;

use crate::{
    SHEAR_MODULUS, all_nodes, cap_nodes, drawn_sphere, prepare, pressure_forces, sphere, surface, with_bone,
};

#[test]
fn uniform_pressure_passes_through_incompressible_tissue_to_the_bone() {
    let skin = sphere(8e-3, 2);
    let options = BodyOptions { bone_pressure: true, ..BodyOptions::default() };
    let pressure = 1e4;
    for poisson_ratio in [0.5, 0.499999] {
        let body = with_bone(sphere(3e-3, 2));
        let nodes = all_nodes(&skin);
        let compliance =
            body.prepare(&skin, SHEAR_MODULUS, poisson_ratio, &nodes, &options).expect("a sound body");
        let forces = pressure_forces(&skin, pressure);
        let found = compliance.bone_pressures(&forces).expect("one force per node").expect("asked for");
        let (low, high) = found.iter().fold((f64::MAX, f64::MIN), |(a, b), &p| (a.min(p), b.max(p)));
        let moved = compliance.displacements(&forces).expect("one force per node");
        let farthest = moved.iter().map(Vector3::norm).fold(0.0, f64::max);
        assert_relative_eq!(low, pressure, max_relative = 0.01);
        assert_relative_eq!(high, pressure, max_relative = 0.01);
        // the faceted sphere under the pressure of a round one: a part of pressure / G times the radius
        assert!(farthest < 1e-3 * pressure / SHEAR_MODULUS * 8e-3);
    }
}

/// Lamé's thick shell, fixed inside: `u = A (r - a³ / r²)`, `A = -p / (3 K + 4 G a³ / b³)`.
#[test]
fn a_compressible_shell_under_uniform_pressure_follows_lame() {
    let (a, b, pressure) = (5e-3, 8e-3, 1e4);
    let skin = sphere(b, 2);
    let options = BodyOptions { bone_pressure: true, ..BodyOptions::default() };
    for poisson_ratio in [0.0, 0.3, 0.45] {
        let bulk = 2.0 * SHEAR_MODULUS * (1.0 + poisson_ratio) / (3.0 * (1.0 - 2.0 * poisson_ratio));
        let amplitude = -pressure / (3.0 * bulk + 4.0 * SHEAR_MODULUS * (a / b).powi(3));
        let inward = amplitude * (b - a.powi(3) / (b * b));
        let on_bone = -amplitude * (3.0 * bulk + 4.0 * SHEAR_MODULUS);

        let body = with_bone(sphere(a, 2));
        let nodes = all_nodes(&skin);
        let compliance =
            body.prepare(&skin, SHEAR_MODULUS, poisson_ratio, &nodes, &options).expect("a sound body");
        let forces = pressure_forces(&skin, pressure);
        let moved = compliance.displacements(&forces).expect("one force per node");
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        let radial = mean(moved.iter().zip(skin.vertex_normals()).map(|(u, n)| u.dot(n)).collect());
        let found = mean(compliance.bone_pressures(&forces).expect("one force per node").expect("asked for"));
        assert_relative_eq!(radial, inward, max_relative = 0.03);
        assert_relative_eq!(found, on_bone, max_relative = 0.03);

        assert_relative_eq!(volume_change(&skin, &moved), inward * skin.area(), max_relative = 0.04);
    }
}

/// How much a skin takes in (m³) where its vertices move so far (m), to first order.
fn volume_change(skin: &Surface, moved: &[Vector3<f64>]) -> f64 {
    let of_face = |(face, (normal, area)): (&[u32; 3], (&Vector3<f64>, &f64))| {
        area / 3.0 * face.iter().map(|&v| moved[v as usize].dot(normal)).sum::<f64>()
    };
    skin.faces().iter().zip(skin.face_normals().iter().zip(skin.face_areas())).map(of_face).sum()
}

#[test]
fn incompressible_tissue_keeps_its_volume_and_compressible_tissue_does_not() {
    let skin = drawn_sphere(8e-3, 2, 2.0);
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let change = |nu: f64| {
        let compliance = prepare(&with_bone(sphere(3e-3, 2)), &skin, nu, &nodes);
        let moved: Vec<Vector3<f64>> =
            (0..skin.vertices().len()).map(|i| compliance.block(i, 0).column(2).into()).collect();
        let swept: f64 = moved.iter().zip(skin.vertex_areas()).map(|(u, area)| u.norm() * area).sum();
        volume_change(&skin, &moved) / swept
    };
    assert!(change(0.5).abs() < 1e-12, "{:e}", change(0.5));
    assert!(change(0.3) < -0.01, "{:e}", change(0.3));
}

/// Closed box of the lattice `xs` × `ys` × `zs`.
fn lattice_box(xs: &[f64], ys: &[f64], zs: &[f64]) -> Surface {
    let mut numbers = HashMap::new();
    let mut vertices = Vec::new();
    let mut faces = Vec::new();
    let last = [xs.len() - 1, ys.len() - 1, zs.len() - 1];
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for end in [0, last[axis]] {
            for i in 0..last[u] {
                for j in 0..last[v] {
                    let mut number = |di: usize, dj: usize| {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (end, i + di, j + dj);
                        *numbers.entry(at).or_insert_with(|| {
                            vertices.push(Vector3::new(xs[at[0]], ys[at[1]], zs[at[2]]));
                            vertices.len() as u32 - 1
                        })
                    };
                    let (a, b, c, d) = (number(0, 0), number(1, 0), number(1, 1), number(0, 1));
                    let two = if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                    faces.extend(two.map(|[a, b, c]| if end == 0 { [a, c, b] } else { [a, b, c] }));
                }
            }
        }
    }
    surface((vertices, faces))
}

/// A wide slab glued to the ground is a flat layer: `h f / K` by Hankel transform, at r/h = 0.5, 1 and 2.
#[test]
fn a_wide_slab_on_fixed_ground_responds_as_a_flat_layer() {
    let h = 4e-3;
    let right = [0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.25, 4.25, 5.5];
    let mut across: Vec<f64> = right.iter().rev().map(|x| -x * h).collect();
    across.push(0.0);
    across.extend(right.map(|x| x * h));
    let skin = lattice_box(&across, &across, &[-h, -0.5 * h, 0.0]);
    let fixed: Vec<bool> = skin.vertices().iter().map(|v| v.z == -h).collect();
    let at = |x: f64, y: f64| {
        let place = Vector3::new(x * h, y * h, 0.0);
        skin.vertices().iter().position(|v| (v - place).norm() < 1e-9).expect("a lattice point")
    };
    let body = Body { bone: None, fixed: Some(fixed), coarse_edge_length: None };
    let compliance = prepare(&body, &skin, 0.5, &[at(0.0, 0.0)]);
    let scale = 4.0 * PI * SHEAR_MODULUS * h; // h / K at nu = 0.5
    let [_, half, one, two, _] = point_load_on_layer();
    for ((r, expected), direction) in
        [(half, (1.0, 0.0)), (one, (0.0, 1.0)), (two, (-1.0, 0.0)), (two, (0.0, 1.0))]
    {
        let found = compliance.block(at(r * direction.0, r * direction.1), 0)[(2, 2)] * scale;
        assert!((found - expected).abs() < 0.02, "r/h = {r}: {found} of {expected}");
    }
    let fixed_corner = at(5.5, 5.5);
    assert!(compliance.block(fixed_corner, 0).amax() * scale < 0.01);
}

/// A thin shell on a large core is nearly flat: the layer's `h f / K` at r/h = 1, 2 and 3, but for the
/// curvature (h / R = 1/20) and the mesh (four edges per h).
#[test]
fn a_thin_shell_on_a_large_core_responds_as_a_flat_layer() {
    let (radius, h) = (40e-3, 2e-3);
    let skin = drawn_sphere(radius, 3, 14.0);
    let pole =
        (0..skin.vertices().len()).min_by(|&a, &b| skin.vertices()[a].z.total_cmp(&skin.vertices()[b].z));
    let pole = pole.expect("vertices");
    let compliance = prepare(&with_bone(drawn_sphere(radius - h, 3, 14.0)), &skin, 0.5, &[pole]);
    let scale = 4.0 * PI * SHEAR_MODULUS * h; // h / K at nu = 0.5
    let mut profile: Vec<(f64, f64)> = skin
        .vertices()
        .iter()
        .enumerate()
        .map(|(i, v)| {
            let inward = -compliance.block(i, 0).column(2).dot(&v.normalize());
            ((v - skin.vertices()[pole]).norm() / h, inward * scale)
        })
        .collect();
    profile.sort_by(|a, b| a.0.total_cmp(&b.0));
    for ((r, expected), tolerance) in point_load_on_layer()[2..].iter().copied().zip([0.013, 0.004, 0.0015]) {
        let next = profile.partition_point(|&(at, _)| at < r);
        let ((r0, u0), (r1, u1)) = (profile[next - 1], profile[next]);
        let found = u0 + (u1 - u0) * (r - r0) / (r1 - r0);
        assert!((found - expected).abs() < tolerance, "r/h = {r}: {found} of {expected}");
    }
}

/// Close to the force a solid sphere, held far away, responds as a half-space: `u = K / r`.
#[test]
fn near_the_force_a_solid_body_responds_as_a_half_space() {
    let skin = drawn_sphere(8e-3, 3, 8.0);
    let fixed: Vec<bool> = skin.vertices().iter().map(|v| v.z > -3e-3).collect();
    let pole =
        (0..skin.vertices().len()).min_by(|&a, &b| skin.vertices()[a].z.total_cmp(&skin.vertices()[b].z));
    let pole = pole.expect("vertices");
    for poisson_ratio in [0.5, 0.3] {
        let compliance = prepare(
            &Body { bone: None, fixed: Some(fixed.clone()), coarse_edge_length: None },
            &skin,
            poisson_ratio,
            &[pole],
        );
        let constant = (1.0 - poisson_ratio) / (2.0 * PI * SHEAR_MODULUS);
        let error_near = |distance: f64| {
            let apart = |i: &usize| ((skin.vertices()[*i] - skin.vertices()[pole]).norm() - distance).abs();
            let node =
                (0..skin.vertices().len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("vertices");
            let r = (skin.vertices()[node] - skin.vertices()[pole]).norm();
            (compliance.block(node, 0)[(2, 2)] * r / constant - 1.0).abs()
        };
        let errors = [1.6e-3, 0.8e-3, 0.4e-3].map(error_near);
        let falls = errors[2] < errors[1] && errors[1] < errors[0];
        assert!(errors[2] < 0.1 && falls, "nu {poisson_ratio}: {errors:?} at 1.6, 0.8, 0.4 mm");
    }
}
