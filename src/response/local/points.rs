//! The load of a node as a few point forces.

use super::super::rule::{hat_rule, triangle_rule};
use super::super::skin::{Pressure, Skin};
use super::super::source::density;
use crate::surface::Surface;
use nalgebra::{Matrix3, Vector3};

/// Corners of a tetrahedron: mean 0, second moments 1.
const CORNERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];

/// Point forces, a Gauss rule of n x n on each triangle, in place of the load of a vertex.
pub(super) fn spread(
    surface: &Surface,
    skin: &Skin,
    vertex: usize,
    n: usize,
    mut push: impl FnMut(Vector3<f64>, f64),
) {
    for &face in surface.faces_around(vertex) {
        let corners = surface.faces()[face as usize];
        let area = surface.face_areas()[face as usize];
        let density = density(surface, corners, vertex, skin.pressure());
        let first = corners.iter().position(|&corner| corner as usize == vertex).expect("a face around it");
        let [a, b, c] = [0, 1, 2].map(|k| surface.vertices()[corners[(first + k) % 3] as usize]);
        let (rule, share) = match skin.pressure() {
            Pressure::Linear => (hat_rule(n), area * density[first] / 3.0),
            Pressure::OneRing => (triangle_rule(n), area * density[first]),
        };
        for (l, weight) in rule {
            push(a * l[0] + b * l[1] + c * l[2], weight * share);
        }
    }
}

/// Four equal point forces with the centre and the second moments of a vertex's unit load.
pub(super) fn with_same_moments(surface: &Surface, skin: &Skin, vertex: usize) -> [Vector3<f64>; 4] {
    let node = surface.vertices()[vertex];
    let (mut mean, mut moments) = (Vector3::zeros(), Matrix3::<f64>::zeros());
    spread(surface, skin, vertex, 2, |point, share| {
        let arm = point - node;
        mean += arm * share;
        moments += arm * arm.transpose() * share;
    });
    moments -= mean * mean.transpose();
    // A square root of the moments (Cholesky); a flat load leaves directions without extent.
    let negligible = 1e-12 * moments.trace();
    let mut root = Matrix3::<f64>::zeros();
    for j in 0..3 {
        let pivot = moments[(j, j)] - (0..j).map(|k| root[(j, k)] * root[(j, k)]).sum::<f64>();
        if pivot <= negligible {
            continue;
        }
        root[(j, j)] = pivot.sqrt();
        for i in j + 1..3 {
            let rest = moments[(i, j)] - (0..j).map(|k| root[(i, k)] * root[(j, k)]).sum::<f64>();
            root[(i, j)] = rest / root[(j, j)];
        }
    }
    CORNERS.map(|corner| node + mean + root * Vector3::from(corner))
}
