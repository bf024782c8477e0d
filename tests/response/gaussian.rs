//! The Gaussian-corrected kernel.

use std::f64::consts::PI;

use approx::assert_relative_eq;
use nalgebra::Vector3;
use quasirigid::response::{AssemblyOptions, Kernel, assemble_block, gaussian_hat_integrals, hat_integrals};
use quasirigid::surface::Surface;

use super::*;

/// The Gaussian-corrected matrix by a plain double loop, where the cutoff cuts no one-ring.
fn naive_gaussian(
    surface: &Surface,
    height: f64,
    width: f64,
    cutoff: f64,
    i: usize,
    j: usize,
) -> Option<f64> {
    let (points, faces) = (surface.vertices(), surface.faces());
    let (mut inverse, mut smooth, mut inside) = (0.0, 0.0, true);
    for &f in surface.faces_around(j) {
        let corners = faces[f as usize].map(|v| points[v as usize]);
        inside &= corners.iter().all(|c| (c - points[i]).norm() < cutoff);
        let k = faces[f as usize].iter().position(|&v| v as usize == j).expect("its own face");
        inverse += hat_integrals(&points[i], &corners)[k];
        smooth += gaussian_hat_integrals(&points[i], &corners, width)[k];
    }
    let area = surface.vertex_areas()[j];
    inside.then(|| (skin(HALF_SPACE).kernel_constant() * inverse - height * smooth) / area)
}

#[test]
fn the_gaussian_matrix_equals_the_double_loop_over_closed_forms() {
    let surface = grid(14, 14e-3, 4e-3, 0.3);
    // widths from narrower than a triangle, where Owen's T takes over, to wider than the mesh
    for (height, width, cutoff) in [(0.8e-3, 5e-3, 8e-3), (2e-3, 1.5e-3, 6e-3), (3e-3, 0.2e-3, f64::INFINITY)]
    {
        let response = Kernel::GaussianCorrected { height, width, cutoff };
        for tolerance in [1e-3, 1e-6, 1e-9] {
            let r = matrix(&surface, &skin(response.clone()), tolerance);
            let mut compared = 0;
            for j in (0..r.ncols()).step_by(7) {
                for i in 0..r.nrows() {
                    let Some(expected) = naive_gaussian(&surface, height, width, cutoff, i, j) else {
                        continue;
                    };
                    let distance = (surface.vertices()[i] - surface.vertices()[j]).norm().max(1e-3);
                    let part = skin(HALF_SPACE).kernel_constant() / distance;
                    assert!((r[(i, j)] - expected).abs() <= 2.0 * tolerance * part, "({i}, {j}) {width}");
                    compared += 1;
                }
            }
            assert!(compared > 1000);
        }
    }
}

#[test]
fn a_flat_gaussian_of_no_height_is_the_half_space() {
    let surface = grid(9, 9e-3, 4e-3, 0.3);
    let flat = Kernel::GaussianCorrected { height: 0.0, width: 2e-3, cutoff: f64::INFINITY };
    let (one, other) = (matrix(&surface, &skin(flat), 1e-9), matrix(&surface, &skin(HALF_SPACE), 1e-9));
    for j in 0..one.ncols() {
        for i in 0..one.nrows() {
            assert_relative_eq!(one[(i, j)], other[(i, j)], max_relative = 2e-9);
        }
    }
}

#[test]
fn the_corrected_kernel_falls_to_zero_beyond_its_cutoff() {
    let surface = grid(40, 40e-3, 0.0, 0.0);
    let r = matrix(&surface, &skin(PAPER), 1e-6);
    let constant = skin(PAPER).kernel_constant();
    let center = 20 * 41 + 20;
    let kernel = |distance: f64| constant / distance - 0.8e-3 * (-0.5 * (distance / 5e-3).powi(2)).exp();
    for steps in [4, 8, 12] {
        let entry = r[(center + steps, center)];
        // a hat of 1 mm in place of a point
        assert!((entry - kernel(steps as f64 * 1e-3)).abs() < 0.02 * constant / (steps as f64 * 1e-3));
    }
    assert!(r[(center + 14, center)] != 0.0);
    assert!((17..20).all(|steps| r[(center + steps, center)] == 0.0));
}

/// Cutoff (m) and widths (m) of the kernels that are compared with rays.
const CUTOFF: f64 = 6e-3;
const WIDTHS: [f64; 3] = [8e-3, 2e-3, 0.3e-3];

/// A triangle whose first corner, the loaded node, carries `density` (1/m²).
struct Face {
    corners: [Vector3<f64>; 3],
    normal: Vector3<f64>,
    area: f64,
    density: f64,
}

/// A bent hexagon of some 1 mm around the origin, to be loaded in the middle, vertex 0, and two triangles without load
/// at each of `points`: point k is vertex 7 + 4 k.
fn hexagon_and(points: &[Vector3<f64>]) -> Surface {
    let ring = |k: usize| {
        let angle = k as f64 * PI / 3.0 + 0.1 * k as f64;
        Vector3::new(1.2e-3 * angle.cos(), 1e-3 * angle.sin(), 0.2e-3 * (k % 3) as f64)
    };
    let mut vertices: Vec<_> = std::iter::once(Vector3::zeros()).chain((0..6).map(ring)).collect();
    let mut faces: Vec<[u32; 3]> = (0..6u32).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect();
    for point in points {
        let first = vertices.len() as u32;
        faces.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        let beside = [[0.0, 0.0], [1e-4, 0.0], [1e-4, 1e-4], [0.0, 1e-4]];
        vertices.extend(beside.map(|[x, y]| point + Vector3::new(x, y, 0.0)));
    }
    Surface::new(vertices, faces).expect("a hexagon and triangles")
}

/// One face's share of the displacement (m/N) at x in polar coordinates about the projection of x: Gauss rules along
/// each ray and over the angle, between the angles of the corners and of the points where the cutoff crosses an edge.
fn by_rays((constant, height, width, cutoff): (f64, f64, f64, f64), face: &Face, x: &Vector3<f64>) -> f64 {
    let normal = face.normal;
    let z = (x - face.corners[0]).dot(&normal);
    if z.abs() >= cutoff {
        return 0.0;
    }
    let foot = x - normal * z;
    let radius = (cutoff * cutoff - z * z).sqrt();
    let across = (face.corners[1] - face.corners[0]).normalize();
    let axes = [across, normal.cross(&across)];
    let corners = face.corners.map(|corner| axes.map(|axis| (corner - foot).dot(&axis)));
    let sides = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (corners[a], corners[b]));
    let mut turns = vec![-PI, PI];
    for ([ax, ay], [bx, by]) in sides {
        turns.push(ay.atan2(ax));
        let (ex, ey) = (bx - ax, by - ay);
        // seen from close by, an edge runs away towards its own two directions
        for (side, k) in [-1.0, 1.0].into_iter().flat_map(|side| (0..8).map(move |k| (side, k))) {
            let angle = ey.atan2(ex) + side * 0.25f64.powi(k);
            turns.extend([angle, angle + PI, angle - PI].into_iter().filter(|turn| turn.abs() < PI));
        }
        let (p, q) = ((ax * ex + ay * ey), ex * ex + ey * ey);
        let root = p * p - q * (ax * ax + ay * ay - radius * radius);
        for t in [-1.0, 1.0].map(|sign| (sign * root.max(0.0).sqrt() - p) / q) {
            if root > 0.0 && (0.0..1.0).contains(&t) {
                turns.push((ay + t * ey).atan2(ax + t * ex));
            }
        }
    }
    turns.sort_by(f64::total_cmp);
    let rule = gauss_rule(20);
    let ray = |angle: f64| -> f64 {
        let (sin, cos) = angle.sin_cos();
        // where the ray is on the inner side of all three edges
        let (mut from, mut to) = (0.0_f64, radius);
        for ([ax, ay], [bx, by]) in sides {
            let (ex, ey) = (bx - ax, by - ay);
            let (at_foot, slope) = (ay * ex - ax * ey, ex * sin - ey * cos);
            let crossing = at_foot / slope;
            if slope > 0.0 { from = from.max(crossing) } else { to = to.min(crossing) }
        }
        if from >= to {
            return 0.0;
        }
        let value = |s: f64| {
            let y = foot + axes[0] * (s * cos) + axes[1] * (s * sin);
            let share = (face.corners[1] - y).cross(&(face.corners[2] - y)).dot(&normal) / (2.0 * face.area);
            let r = s.hypot(z);
            let u = constant / r - height * (-0.5 * (r / width).powi(2)).exp();
            face.density * share * u * s
        };
        rule.iter().map(|(t, w)| w * (to - from) * value(from + t * (to - from))).sum()
    };
    let over = |pair: &[f64]| -> f64 {
        let step = pair[1] - pair[0];
        rule.iter().map(|(t, w)| w * step * ray(pair[0] + t * step)).sum()
    };
    turns.windows(2).map(over).sum()
}

/// Compares the column of the loaded node with rays at each tolerance; returns how many points were cut and how many
/// lie beyond.
fn check_against_rays(width: f64, points: &[Vector3<f64>]) -> (usize, usize) {
    let surface = hexagon_and(points);
    let constant = skin(HALF_SPACE).kernel_constant();
    let height = constant / width;
    let faces: Vec<Face> = (0..6)
        .map(|face| Face {
            corners: surface.faces()[face].map(|v| surface.vertices()[v as usize]),
            normal: surface.face_normals()[face],
            area: surface.face_areas()[face],
            density: 1.0 / surface.vertex_areas()[0],
        })
        .collect();
    let kernel = (constant, height, width, CUTOFF);
    let rays = |x: &Vector3<f64>| faces.iter().map(|face| by_rays(kernel, face, x)).sum();
    let expected: Vec<f64> = points.iter().map(rays).collect();
    let rows: Vec<usize> = (0..points.len()).map(|k| 7 + 4 * k).collect();
    let skin = skin(Kernel::GaussianCorrected { height, width, cutoff: CUTOFF });
    // without tolerance what is left is the error of the rays
    for (tolerance, allowed) in [(1e-3, 1e-3), (1e-6, 1e-6), (1e-9, 1e-9), (0.0, 1e-10)] {
        let options = AssemblyOptions { tolerance, ..Default::default() };
        let found = assemble_block(&surface, &skin, &rows, &[0], &options).expect("valid");
        for (k, (x, expected)) in points.iter().zip(&expected).enumerate() {
            let error = (found[(k, 0)] - expected).abs() * CUTOFF / constant;
            assert!(error <= allowed, "{x:?} at {tolerance:e}, width {width}: {error:e}");
        }
    }
    let cut = points.iter().filter(|x| x.norm() + 1.2e-3 > CUTOFF).count();
    let beyond = expected.iter().filter(|&&u| u == 0.0).count();
    (cut - beyond, beyond)
}

#[test]
fn what_the_cutoff_cuts_matches_rays() {
    let point = |k: usize| {
        let angle = 0.7 * k as f64;
        let distance = 5e-3 + 0.07e-3 * k as f64;
        Vector3::new(distance * angle.cos(), distance * angle.sin(), 2e-3 * (0.3 * angle).sin())
    };
    let points: Vec<_> = (0..40).map(point).collect();
    for width in WIDTHS {
        let (cut, beyond) = check_against_rays(width, &points);
        assert!(cut > 10 && beyond > 5, "{cut} {beyond}");
    }
}

#[test]
fn points_above_and_behind_the_load_are_cut_as_those_beside_it() {
    // all directions from straight above over beside to straight behind, at distances about the cutoff
    let mut points = Vec::new();
    for k in 0..=36 {
        let (polar, azimuth) = (5f64.to_radians() * k as f64, 1.3 * k as f64);
        for distance in [4.9e-3, 5.5e-3, 5.9e-3, 5.99e-3, 6.05e-3, 6.3e-3] {
            let (sin, cos) = polar.sin_cos();
            points.push(Vector3::new(sin * azimuth.cos(), sin * azimuth.sin(), cos) * distance);
        }
    }
    // a plate just closer than the cutoff, so fine that points project on corners, edges and faces
    let mut plate = Vec::new();
    for i in -8..=8 {
        for j in -8..=8 {
            plate.push(Vector3::new(0.15e-3 * f64::from(i), 0.15e-3 * f64::from(j), 5.9e-3));
        }
    }
    for width in WIDTHS {
        let cut = check_against_rays(width, &points).0 + check_against_rays(width, &plate).0;
        assert!(cut > 400, "{cut}");
    }
}
