//! Pressures, forces, moments and areas of solved node forces.

use nalgebra::Vector3;

use crate::contact::figures::pressure::{VertexPressure, recover_pressure};
use crate::contact::outcome::{Patch, Resultant};
use crate::response::kernel::skin::{Gap, Pressure};
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

impl Resultant {
    /// All NaN: the figures of a contact that did not solve.
    pub(crate) fn unknown() -> Self {
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
pub(crate) fn node_pressure(
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
    let peak = match skin.pressure() {
        Pressure::Linear => pressure.clone(),
        // A triangle's pressure is that of its free corners too.
        Pressure::OneRing => {
            let around =
                |vertex: usize| surface.neighbours(vertex).iter().map(|&other| pressure[other as usize]);
            (0..pressure.len()).map(|vertex| around(vertex).fold(pressure[vertex], f64::max)).collect()
        }
    };
    VertexPressure { peak, at_vertices: pressure }
}

impl VertexPressure {
    /// Where a patch is so small that its mean pressure on the area found is above the largest recovered, it is that.
    pub(crate) fn raise_to_means(
        &mut self,
        surface: &Surface,
        node_force: &[f64],
        areas: &[f64],
        active: &[usize],
    ) {
        for patch in surface.patches(active) {
            let sum = |values: &[f64]| patch.iter().map(|&vertex| values[vertex]).sum::<f64>();
            let mean = sum(node_force) / sum(areas);
            let highest = patch.iter().copied().max_by(|&a, &b| self.peak[a].total_cmp(&self.peak[b]));
            let highest = highest.expect("a patch has a vertex");
            self.peak[highest] = self.peak[highest].max(mean);
        }
    }
}

/// Force, moment, centre, area and peak pressure of `nodes`; arrays are per vertex, `areas` the contact's share of
/// each, `deformed` their positions.
pub(crate) fn resultant(
    nodes: &[usize],
    node_force: &[f64],
    pressure: &VertexPressure,
    normals: &[Vector3<f64>],
    areas: &[f64],
    deformed: &[Vector3<f64>],
) -> Resultant {
    let (mut force, mut moment, mut weighted) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
    let (mut total, mut area, mut max_pressure) = (0.0, 0.0, 0.0_f64);
    for &vertex in nodes {
        let (f, position) = (node_force[vertex], deformed[vertex]);
        let load = f * normals[vertex];
        force += load;
        moment += position.cross(&load);
        weighted += f * position;
        total += f;
        area += areas[vertex];
        max_pressure = max_pressure.max(pressure.peak[vertex]);
    }
    Resultant { force, moment, center_of_pressure: weighted / total, contact_area: area, max_pressure }
}

/// The connected parts of the active set, each with what `resultant_of` says of it.
pub(crate) fn patches(
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

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::{node_pressure, resultant};
    use crate::response::kernel::skin::{Gap, Pressure, Response, Skin};
    use crate::surface::checked::Surface;

    #[test]
    fn the_largest_pressure_of_one_rings_may_lie_at_a_vertex_without_force() {
        // Squares cut by one diagonal; the six neighbours of the middle carry force. Twice as much of it lies on the
        // triangles at the middle as on those around them.
        let place = |k: u32| Vector3::new(f64::from(k % 5), f64::from(k / 5), 0.0);
        let cells = (0..20).filter(|k| k % 5 < 4);
        let faces = cells.flat_map(|k| [[k, k + 1, k + 6], [k, k + 6, k + 5]]).collect();
        let surface = Surface::new((0..25).map(place).collect(), faces).expect("a valid surface");
        let middle = 12;
        let active: Vec<usize> = surface.neighbours(middle).iter().map(|&other| other as usize).collect();
        let mut node_force = [0.0; 25];
        active.iter().for_each(|&vertex| node_force[vertex] = 1.0);
        let response = Response::HalfSpace { pressure: Pressure::OneRing, gap: Gap::Node };
        let skin = Skin::new(1.0, 0.5, response).expect("valid constants");
        let pressure = node_pressure(&surface, &skin, &node_force, &active);
        let normals = [Vector3::z(); 25];
        let found =
            resultant(&active, &node_force, &pressure, &normals, surface.vertex_areas(), surface.vertices());
        let largest = pressure.at_vertices.iter().copied().fold(0.0, f64::max);
        assert_eq!(pressure.at_vertices[middle], largest);
        assert_eq!(found.max_pressure, largest);
    }
}
