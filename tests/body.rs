//! The body response through its public interface: known forces, identities of elasticity, units, endings.

mod common;

use approx::assert_relative_eq;
use faer::Mat;
use faer::prelude::Solve;
use nalgebra::{Rotation3, Vector3};
use quasirigid::response::body::{Body, BodyCompliance, BodyError, BodyOptions};
use quasirigid::surface::Surface;

const SHEAR_MODULUS: f64 = 60e3;

fn surface((vertices, faces): common::Mesh) -> Surface {
    Surface::new(vertices, faces).expect("a sound mesh")
}

fn sphere(radius: f64, subdivisions: usize) -> Surface {
    surface(common::icosphere(radius, subdivisions))
}

/// Sphere drawn towards -z by a conformal map: `draw` times finer at that pole than on average.
fn drawn_sphere(radius: f64, subdivisions: usize, draw: f64) -> Surface {
    let (vertices, faces) = common::icosphere(1.0, subdivisions);
    let drawn = vertices.into_iter().map(|p| {
        let polar = 2.0 * ((0.5 * p.x.hypot(p.y).atan2(-p.z)).tan() / draw).atan();
        let around = p.y.atan2(p.x);
        Vector3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), -polar.cos()) * radius
    });
    surface((drawn.collect(), faces))
}

fn with_bone(bone: Surface) -> Body {
    Body { bone: Some(bone), fixed: None }
}

fn prepare(body: &Body, skin: &Surface, poisson_ratio: f64, nodes: &[usize]) -> BodyCompliance {
    body.prepare(skin, SHEAR_MODULUS, poisson_ratio, nodes, &BodyOptions::default()).expect("a sound body")
}

fn all_nodes(skin: &Surface) -> Vec<usize> {
    (0..skin.vertices().len()).collect()
}

/// Skin vertices less than `height` above the lowest point of a sphere about the origin.
fn cap_nodes(skin: &Surface, radius: f64, height: f64) -> Vec<usize> {
    (0..skin.vertices().len()).filter(|&i| skin.vertices()[i].z < height - radius).collect()
}

/// Forces of `g = g0 + R f >= 0`, `f >= 0`, `g f = 0` by exchanging nodes until none has the wrong sign.
fn contact_forces(response: &Mat<f64>, gaps: &[f64]) -> Vec<f64> {
    let all = 0..gaps.len();
    let depth = gaps.iter().fold(0.0_f64, |a, g| a.max(-g));
    let mut active: Vec<usize> = all.clone().filter(|&i| gaps[i] < 0.0).collect();
    for _ in 0..100 {
        let matrix = Mat::from_fn(active.len(), active.len(), |i, j| response[(active[i], active[j])]);
        let right = Mat::from_fn(active.len(), 1, |i, _| -gaps[active[i]]);
        let solved = matrix.partial_piv_lu().solve(right);
        let mut forces = vec![0.0; gaps.len()];
        active.iter().enumerate().for_each(|(row, &i)| forces[i] = solved[(row, 0)]);
        let gap = |i: usize| gaps[i] + active.iter().map(|&j| response[(i, j)] * forces[j]).sum::<f64>();
        let next: Vec<usize> = all
            .clone()
            .filter(|&i| if forces[i] == 0.0 { gap(i) < -1e-9 * depth } else { forces[i] > 0.0 })
            .collect();
        if next == active {
            return forces;
        }
        active = next;
    }
    panic!("the active set does not settle");
}

/// Force (N) of a flat frictionless plate on a sphere about the origin, pressed upwards by `depth`.
fn plate_force(skin: &Surface, compliance: &BodyCompliance, radius: f64, depth: f64) -> f64 {
    let up = vec![Vector3::z(); compliance.nodes().len()];
    let gaps: Vec<f64> = compliance.nodes().iter().map(|&i| skin.vertices()[i].z + radius - depth).collect();
    contact_forces(&compliance.response_along(&up).expect("unit directions"), &gaps).iter().sum()
}

/// Depth (m) and force (N) on a sphere of 8 mm with a core of 3 mm: axisymmetric finite elements and the exact series of
/// the shell, which agree to 0.2 %.
const DEPTHS: [f64; 4] = [0.1e-3, 0.3e-3, 0.6e-3, 1.12e-3];
const SPHERE_FORCES: [(f64, [f64; 4]); 3] = [
    (0.5, [0.0308, 0.1685, 0.495, 1.297]),
    (0.495, [0.0306, 0.1670, 0.491, 1.288]),
    (0.3, [0.0224, 0.125, 0.376, 1.020]),
];

#[test]
fn a_plate_on_a_sphere_with_a_core_meets_the_finite_element_force() {
    let skin = drawn_sphere(8e-3, 3, 4.0);
    let body = with_bone(drawn_sphere(3e-3, 2, 2.0));
    let nodes = cap_nodes(&skin, 8e-3, 1.3e-3);
    for (poisson_ratio, forces) in SPHERE_FORCES {
        let compliance = prepare(&body, &skin, poisson_ratio, &nodes);
        for (depth, expected) in DEPTHS.into_iter().zip(forces) {
            let force = plate_force(&skin, &compliance, 8e-3, depth);
            println!("nu {poisson_ratio}, depth {:.2} mm: {force:.4} N of {expected} N", depth * 1e3);
            assert_relative_eq!(force, expected, max_relative = 0.02);
        }
    }
}

#[test]
fn the_force_converges_under_refinement() {
    let errors: Vec<f64> = [1, 2, 3]
        .into_iter()
        .map(|subdivisions| {
            let skin = drawn_sphere(8e-3, subdivisions, 3.0);
            let nodes = cap_nodes(&skin, 8e-3, 1.6e-3);
            let compliance = prepare(&with_bone(sphere(3e-3, subdivisions)), &skin, 0.5, &nodes);
            (plate_force(&skin, &compliance, 8e-3, 1.12e-3) / 1.297 - 1.0).abs()
        })
        .collect();
    println!("errors {errors:?} at 42, 162, 642 vertices, ratio {:.1}", errors[1] / errors[2]);
    assert!(errors[2] < 0.01 && errors[2] < 0.5 * errors[1] && errors[1] < 0.5 * errors[0]);
}

/// Forces of a uniform pressure (Pa) on every vertex.
fn pressure_forces(skin: &Surface, pressure: f64) -> Vec<Vector3<f64>> {
    skin.vertex_normals().iter().zip(skin.vertex_areas()).map(|(n, area)| n * (-pressure * area)).collect()
}

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
        println!("nu {poisson_ratio}: {low:.1} to {high:.1} Pa on the bone, skin moves {farthest:.2e} m");
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
        println!("nu {poisson_ratio}: {radial:.4e} of {inward:.4e} m, {found:.1} of {on_bone:.1} Pa");
        assert_relative_eq!(radial, inward, max_relative = 0.03);
        assert_relative_eq!(found, on_bone, max_relative = 0.03);

        let inwards: Vec<_> = skin.vertex_normals().iter().map(|n| -n).collect();
        let change = compliance.volume_change_along(&inwards).expect("unit directions");
        let total: f64 =
            change.iter().zip(skin.vertex_areas()).map(|(change, area)| change * pressure * area).sum();
        assert_relative_eq!(total, inward * skin.area(), max_relative = 0.04);
    }
}

#[test]
fn the_force_is_continuous_as_the_tissue_becomes_incompressible() {
    let skin = drawn_sphere(8e-3, 2, 3.0);
    let nodes = cap_nodes(&skin, 8e-3, 1.6e-3);
    let body = with_bone(sphere(5e-3, 2));
    let force = |nu: f64| plate_force(&skin, &prepare(&body, &skin, nu, &nodes), 8e-3, 0.6e-3);
    let limit = force(0.5);
    for (poisson_ratio, bound) in [(0.4999, 1e-2), (0.499999, 1e-4), (0.49999999, 1e-6)] {
        let difference = force(poisson_ratio) / limit - 1.0;
        println!("nu {poisson_ratio}: {difference:.1e} off the limit");
        assert!(difference < 0.0 && difference.abs() < bound);
    }
}

#[test]
fn incompressible_tissue_keeps_its_volume_and_compressible_tissue_does_not() {
    let skin = drawn_sphere(8e-3, 2, 2.0);
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let up = vec![Vector3::z(); nodes.len()];
    let change = |nu: f64| {
        let compliance = prepare(&with_bone(sphere(3e-3, 2)), &skin, nu, &nodes);
        let change = compliance.volume_change_along(&up).expect("unit directions");
        let swept: f64 = (0..skin.vertices().len())
            .map(|i| compliance.block(i, 0).column(2).norm() * skin.vertex_areas()[i])
            .sum();
        change[0] / swept
    };
    assert!(change(0.5).abs() < 1e-12, "{:e}", change(0.5));
    assert!(change(0.3) < -0.01, "{:e}", change(0.3));
}

/// Betti: the work of one load on the displacement of another does not depend on their order.
#[test]
fn loads_do_reciprocal_work_up_to_the_mesh_error() {
    let difference = |subdivisions: usize| {
        let skin = sphere(8e-3, subdivisions);
        let compliance = prepare(&with_bone(sphere(4e-3, subdivisions)), &skin, 0.45, &all_nodes(&skin));
        // a push of the lower half and a shear of the right half, both smooth
        let load = |toward: Vector3<f64>, along: Vector3<f64>| -> Vec<Vector3<f64>> {
            let strength = |v: &Vector3<f64>| (v.dot(&toward) / 8e-3).max(0.0).powi(2);
            skin.vertices()
                .iter()
                .zip(skin.vertex_areas())
                .map(|(v, area)| along * (strength(v) * area))
                .collect()
        };
        let (push, shear) =
            (load(-Vector3::z(), Vector3::new(0.2, 0.0, 1.0)), load(Vector3::x(), Vector3::z()));
        let work = |a: &[Vector3<f64>], b: &[Vector3<f64>]| -> f64 {
            let moved = compliance.displacements(b).expect("one force per node");
            a.iter().zip(moved).map(|(a, moved)| a.dot(&moved)).sum()
        };
        (work(&push, &shear) / work(&shear, &push) - 1.0).abs()
    };
    let (coarse, fine) = (difference(1), difference(2));
    println!("work differs by {coarse:.2e} at 42, {fine:.2e} at 162 vertices");
    assert!(fine < 0.01 && fine < 0.4 * coarse);
}

/// Closed box of the lattice `xs` × `ys` × `zs`.
fn lattice_box(xs: &[f64], ys: &[f64], zs: &[f64]) -> Surface {
    let mut numbers = std::collections::HashMap::new();
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
    let body = Body { bone: None, fixed: Some(fixed) };
    let compliance = prepare(&body, &skin, 0.5, &[at(0.0, 0.0)]);
    let scale = 4.0 * std::f64::consts::PI * SHEAR_MODULUS * h; // h / K at nu = 0.5
    for (x, y, expected) in
        [(0.5, 0.0, 0.44430), (0.0, 1.0, -0.12570), (-2.0, 0.0, -0.05275), (0.0, 2.0, -0.05275)]
    {
        let found = compliance.block(at(x, y), 0)[(2, 2)] * scale;
        println!("r/h = {:.1}: {found:.4} of {expected:.4}", x.hypot(y));
        assert!((found - expected).abs() < 0.02, "r/h = {}: {found}", x.hypot(y));
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
    let scale = 4.0 * std::f64::consts::PI * SHEAR_MODULUS * h; // h / K at nu = 0.5
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
    for (r, expected, tolerance) in [(1.0, -0.12570, 0.013), (2.0, -0.05275, 0.004), (3.0, -0.01672, 0.0015)]
    {
        let next = profile.partition_point(|&(at, _)| at < r);
        let ((r0, u0), (r1, u1)) = (profile[next - 1], profile[next]);
        let found = u0 + (u1 - u0) * (r - r0) / (r1 - r0);
        println!("r/h = {r}: {found:.4} of {expected:.4}");
        assert!((found - expected).abs() < tolerance, "r/h = {r}: {found}");
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
        let compliance =
            prepare(&Body { bone: None, fixed: Some(fixed.clone()) }, &skin, poisson_ratio, &[pole]);
        let constant = (1.0 - poisson_ratio) / (2.0 * std::f64::consts::PI * SHEAR_MODULUS);
        let error_near = |distance: f64| {
            let apart = |i: &usize| ((skin.vertices()[*i] - skin.vertices()[pole]).norm() - distance).abs();
            let node =
                (0..skin.vertices().len()).min_by(|a, b| apart(a).total_cmp(&apart(b))).expect("vertices");
            let r = (skin.vertices()[node] - skin.vertices()[pole]).norm();
            (compliance.block(node, 0)[(2, 2)] * r / constant - 1.0).abs()
        };
        let errors = [1.6e-3, 0.8e-3, 0.4e-3].map(error_near);
        println!("nu {poisson_ratio}: {errors:?} at 1.6, 0.8, 0.4 mm");
        assert!(errors[2] < 0.1 && errors[2] < errors[1] && errors[1] < errors[0]);
    }
}

#[test]
fn turning_the_answer_is_turning_the_body() {
    let (skin, bone) = (drawn_sphere(8e-3, 2, 2.0), sphere(3e-3, 1));
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
    let pose = nalgebra::Isometry3::from_parts(Vector3::new(0.1, -0.2, 0.05).into(), turn.into());
    let turned =
        prepare(&with_bone(bone.clone()), &skin, 0.45, &nodes).moved(turn.matrix()).expect("a rotation");
    let anew = prepare(&with_bone(bone.moved(&pose)), &skin.moved(&pose), 0.45, &nodes);
    let normals: Vec<_> = nodes.iter().map(|&i| turn * skin.vertex_normals()[i]).collect();
    let (a, b) = (turned.response_along(&normals), anew.response_along(&normals));
    let (a, b) = (a.expect("unit directions"), b.expect("unit directions"));
    // far rules may switch by rounding: the integration tolerance
    assert!((&a - &b).norm_max() < 1e-6 * a.norm_max());
    let forces: Vec<_> = normals.iter().map(|n| -n * 1e-2).collect();
    let (a, b) =
        (turned.displacements(&forces).expect("forces"), anew.displacements(&forces).expect("forces"));
    let largest = a.iter().map(Vector3::norm).fold(0.0, f64::max);
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).norm() < 1e-6 * largest));
    // some nodes in another order have the same entries
    let some = [2, 0, 1];
    let some_normals = some.map(|node| normals[node]);
    let among = turned.response_among(&some, &some_normals).expect("one direction each");
    let along = turned.response_along(&normals).expect("unit directions");
    assert!(
        (0..3).all(|i| (0..3).all(|j| among[(i, j)] == along[(some[i], some[j])])),
        "{among:?} of {along:?}"
    );
    assert!(turned.response_among(&some, &normals).is_err());
    // response and displacements agree with each other
    let response = turned.response_along(&normals).expect("unit directions");
    let along: f64 = (0..nodes.len()).map(|j| response[(0, j)] * -1e-2).sum();
    assert_relative_eq!(a[nodes[0]].dot(&normals[0]), along, max_relative = 1e-12);
}

#[test]
fn the_unit_system_does_not_matter() {
    let (skin, bone) = (drawn_sphere(8e-3, 2, 3.0), sphere(3e-3, 1));
    let nodes = cap_nodes(&skin, 8e-3, 2e-3);
    let up = vec![Vector3::z(); nodes.len()];
    let fixed: Vec<bool> = skin.vertices().iter().map(|v| v.z > 2e-3).collect();
    let response = |length: f64, modulus: f64| {
        let scaled = |s: &Surface| s.with_vertices(s.vertices().iter().map(|v| v * length).collect());
        let body = Body { bone: Some(scaled(&bone)), fixed: Some(fixed.clone()) };
        let compliance = body
            .prepare(&scaled(&skin), SHEAR_MODULUS * modulus, 0.5, &nodes, &BodyOptions::default())
            .expect("a sound body");
        compliance.response_along(&up).expect("unit directions") * faer::Scale(length * modulus)
    };
    let expected = response(1.0, 1.0);
    for (length, modulus) in [(1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6), (1e3, 1e-6)] {
        let error = (response(length, modulus) - &expected).norm_max() / expected.norm_max();
        assert!(error < 1e-9, "lengths x {length}, modulus x {modulus}: {error:e}");
    }
}

#[test]
fn the_number_of_threads_does_not_change_the_answer() {
    let skin = drawn_sphere(8e-3, 2, 2.0);
    let nodes = cap_nodes(&skin, 8e-3, 1e-3);
    let with = |threads: usize| {
        let options = BodyOptions { num_threads: Some(threads), ..BodyOptions::default() };
        let body = with_bone(sphere(3e-3, 2));
        body.prepare(&skin, SHEAR_MODULUS, 0.5, &nodes, &options).expect("a sound body")
    };
    let (one, two) = (with(1), with(2));
    assert!(one.parts().displacement == two.parts().displacement);
}

#[test]
fn several_bones_share_the_load() {
    let skin = sphere(8e-3, 2);
    let (vertices, faces) = common::icosphere(2e-3, 1);
    let shifted = |x: f64| (vertices.iter().map(|v| v + Vector3::new(x, 0.0, 0.0)).collect(), faces.clone());
    let bones = surface(common::joined(&shifted(3e-3), &shifted(-3e-3)));
    let options = BodyOptions { bone_pressure: true, ..BodyOptions::default() };
    let nodes = all_nodes(&skin);
    let compliance =
        with_bone(bones).prepare(&skin, SHEAR_MODULUS, 0.5, &nodes, &options).expect("two bones are sound");
    let found = compliance.bone_pressures(&pressure_forces(&skin, 1e4)).expect("forces").expect("asked for");
    assert!(found.iter().all(|p| (p / 1e4 - 1.0).abs() < 0.05), "{found:?}");
}

#[test]
fn stored_parts_build_the_same_compliance() {
    let skin = sphere(8e-3, 1);
    let built = prepare(&with_bone(sphere(3e-3, 1)), &skin, 0.5, &[0, 5]);
    let again = BodyCompliance::from_parts(built.parts().clone()).expect("sound parts");
    assert_eq!(again.block(3, 1), built.block(3, 1));
    let mut parts = built.parts().clone();
    parts.nodes.push(7);
    let error = BodyCompliance::from_parts(parts).expect_err("a node without columns");
    assert_eq!(error, BodyError::Parts { what: "displacement columns", found: 6, expected: 9 });
}
