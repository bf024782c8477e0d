//! Pressures, forces, moments and areas of solved node forces.

use super::recovered_pressure::{VertexPressure, recover_pressure};
use super::{Patch, Resultant};
use crate::response::{ElasticSkin, Gap, Pressure};
use crate::surface::Surface;
use nalgebra::Vector3;

impl Resultant {
    /// All NaN: the figures of a contact that did not solve.
    pub(super) fn unknown() -> Self {
        let vector = Vector3::repeat(f64::NAN);
        Self {
            force: vector,
            moment: vector,
            center_of_pressure: vector,
            contact_area: f64::NAN,
            max_pressure: f64::NAN,
        }
    }
}

/// Pressure per vertex.
///
/// With the linear basis `p_i = f_i / S_i`, from which the weighted form recovers a smooth pressure. With the one-ring
/// basis the pressure is constant on each triangle, `p_t = Σ_{j in t} f_j / (3 S_j)`, and averaged to the vertices by
/// area.
pub(super) fn node_pressure(
    surface: &Surface,
    skin: &dyn ElasticSkin,
    node_force: &[f64],
    active: &[usize],
) -> VertexPressure {
    let areas = surface.vertex_areas();
    let mut pressure = vec![0.0; node_force.len()];
    match skin.pressure() {
        Pressure::Linear => {
            for (pressure, (force, area)) in pressure.iter_mut().zip(node_force.iter().zip(areas)) {
                *pressure = force / area;
            }
            if skin.gap() == Gap::Weighted {
                return recover_pressure(surface, pressure, active);
            }
        }
        Pressure::OneRing => {
            let mut of_face = vec![0.0; surface.faces().len()];
            for &vertex in active {
                for &face in surface.faces_around(vertex) {
                    of_face[face as usize] += node_force[vertex] / (3.0 * areas[vertex]);
                }
            }
            for (face, corners) in surface.faces().iter().enumerate() {
                for &corner in corners {
                    pressure[corner as usize] += of_face[face] * surface.face_areas()[face];
                }
            }
            pressure.iter_mut().zip(areas).for_each(|(sum, area)| *sum /= 3.0 * area);
            // A problem that did not solve has no pressure either.
            let unknown = node_force.iter().map(|force| force.is_nan());
            pressure.iter_mut().zip(unknown).filter(|(_, unknown)| *unknown).for_each(|(p, _)| *p = f64::NAN);
        }
    }
    VertexPressure { peak: pressure.clone(), at_vertices: pressure }
}

/// Force, moment, centre, area and peak pressure of `nodes`; arrays are per vertex, `areas` the contact's share of
/// each, `deformed` their positions.
pub(super) fn resultant(
    nodes: &[usize],
    node_force: &[f64],
    pressure: &VertexPressure,
    normals: &[Vector3<f64>],
    areas: &[f64],
    deformed: &[Vector3<f64>],
) -> Resultant {
    let (mut force, mut moment, mut weighted) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let (mut total, mut area) = (0.0, 0.0);
    let (mut highest, mut max_pressure) = (0.0, 0.0);
    for &vertex in nodes {
        let (f, position) = (node_force[vertex], deformed[vertex]);
        let load = f * normals[vertex];
        force += load;
        moment += position.cross(&load);
        weighted += f * position;
        total += f;
        area += areas[vertex];
        if pressure.at_vertices[vertex] > highest {
            (highest, max_pressure) = (pressure.at_vertices[vertex], pressure.peak[vertex]);
        }
    }
    Resultant { force, moment, center_of_pressure: weighted / total, contact_area: area, max_pressure }
}

/// The connected parts of the active set, each with what `resultant_of` says of it.
pub(super) fn patches(
    surface: &Surface,
    active: &[usize],
    resultant_of: impl Fn(&[usize]) -> Resultant,
) -> Vec<Patch> {
    surface
        .patches(active)
        .into_iter()
        .map(|vertices| Patch { resultant: resultant_of(&vertices), vertices })
        .collect()
}
