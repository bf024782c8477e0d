//! Pressure at the vertices.

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::figures::pressure::recovery::recover_pressure;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::surface::checked::Surface;

/// Pressure at the vertices, and the largest that each stands for.
pub(crate) struct VertexPressure {
    /// (n, Pa).
    pub at_vertices: Vec<f64>,
    /// Largest pressure that a vertex under force stands for (n, Pa), never below that at the vertex; the largest of
    /// all is the contact's.
    pub peak: Vec<f64>,
}

impl VertexPressure {
    /// Pressure of node forces: `p_i = f_i / S_i` of hats, from which the Galerkin form recovers a smooth one; with the
    /// one-ring basis constant on each triangle, `p_t = Σ_{j in t} f_j / (3 S_j)`, and averaged to the vertices by area.
    pub fn new(
        surface: &Surface,
        basis: PressureBasis,
        discretization: Discretization,
        forces: &NodeForces,
    ) -> Self {
        match (basis, discretization) {
            (PressureBasis::OneRing, _) => one_ring_pressure(surface, &forces.force, &forces.active),
            (PressureBasis::Linear, Discretization::Collocation) => {
                let at_vertices = coefficients(surface, &forces.force);
                Self { peak: at_vertices.clone(), at_vertices }
            }
            (PressureBasis::Linear, Discretization::Galerkin) => {
                let coefficients = coefficients(surface, &forces.force);
                let (at_vertices, peak) = recover_pressure(surface, coefficients, &forces.active);
                Self { at_vertices, peak }
            }
        }
    }

    /// Raises a patch's peak to its mean pressure F/A where recovery or one-rings left it lower (patches of a few
    /// vertices).
    ///
    /// * `areas`: the contact's share of each vertex (n, m²)
    pub fn raise_to_means(&mut self, surface: &Surface, forces: &NodeForces, areas: &[f64]) {
        for patch in surface.patches(&forces.active) {
            let sum = |values: &[f64]| patch.iter().map(|&vertex| values[vertex]).sum::<f64>();
            let mean = sum(&forces.force) / sum(areas);
            let highest = patch.iter().copied().max_by(|&a, &b| self.peak[a].total_cmp(&self.peak[b]));
            let highest = highest.expect("a patch has a vertex");
            self.peak[highest] = self.peak[highest].max(mean);
        }
    }
}

/// `f_i / S_i` (n, Pa).
fn coefficients(surface: &Surface, node_force: &[f64]) -> Vec<f64> {
    node_force.iter().zip(surface.vertex_areas()).map(|(force, area)| force / area).collect()
}

fn one_ring_pressure(surface: &Surface, node_force: &[f64], active: &[usize]) -> VertexPressure {
    let areas = surface.vertex_areas();
    let mut of_face = vec![0.0; surface.faces().len()];
    for &vertex in active {
        for &face in surface.faces_around(vertex) {
            of_face[face as usize] += node_force[vertex] / (3.0 * areas[vertex]);
        }
    }
    let mut pressure = vec![0.0; node_force.len()];
    for (face, corners) in surface.faces().iter().enumerate() {
        for &corner in corners {
            pressure[corner as usize] += of_face[face] * surface.face_areas()[face];
        }
    }
    pressure.iter_mut().zip(areas).for_each(|(sum, area)| *sum /= 3.0 * area);
    for (pressure, force) in pressure.iter_mut().zip(node_force) {
        // A problem that did not solve has no pressure either.
        if force.is_nan() {
            *pressure = f64::NAN;
        }
    }
    // A triangle's pressure is that of its free corners too.
    let around = |vertex: usize| surface.neighbours(vertex).iter().map(|&other| pressure[other as usize]);
    let peak = (0..pressure.len()).map(|vertex| around(vertex).fold(pressure[vertex], f64::max)).collect();
    VertexPressure { peak, at_vertices: pressure }
}

#[cfg(test)]
mod tests {
    use super::one_ring_pressure;
    use crate::sample::one_diagonal_grid;
    use crate::surface::checked::Surface;

    #[test]
    fn the_largest_pressure_of_one_rings_may_lie_at_a_vertex_without_force() {
        // Squares cut by one diagonal; the six neighbours of the middle carry force. Twice as much of it lies on the
        // triangles at the middle as on those around them.
        let (vertices, faces) = one_diagonal_grid(4);
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        let middle = 12;
        let active: Vec<usize> = surface.neighbours(middle).iter().map(|&other| other as usize).collect();
        let mut node_force = [0.0; 25];
        active.iter().for_each(|&vertex| node_force[vertex] = 1.0);
        let found = one_ring_pressure(&surface, &node_force, &active);
        let largest = found.at_vertices.iter().copied().fold(0.0, f64::max);
        assert_eq!(found.at_vertices[middle], largest);
        assert!(active.iter().all(|&vertex| found.peak[vertex] == largest));
    }
}
