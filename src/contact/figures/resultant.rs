//! Forces, moments, areas and peaks of solved node forces.

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::figures::pressure::VertexPressure;
use crate::contact::outcome::{Patch, Resultant};
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

/// What resultants are made of; arrays are per vertex (n) where they are not per candidate (k).
pub(crate) struct Resultants<'a> {
    pub surface: &'a Surface,
    pub forces: &'a NodeForces,
    pub pressure: &'a VertexPressure,
    /// The contact's share of each vertex (n, m²).
    pub areas: &'a [f64],
    /// Displacement (k, m).
    pub displacement: &'a [Vector3<f64>],
}

impl Resultants<'_> {
    /// Force, moment, center, area and peak pressure of some active vertices.
    pub fn of(&self, vertices: &[usize]) -> Resultant {
        let (mut force, mut moment, mut weighted) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        let (mut total, mut contact_area, mut max_pressure) = (0.0, 0.0, 0.0_f64);
        for &vertex in vertices {
            let row = self.forces.candidates.binary_search(&vertex).expect("active vertices are candidates");
            let position = self.surface.vertices()[vertex] + self.displacement[row];
            let (f, load) = (self.forces.force[vertex], self.forces.vectors[vertex]);
            force += load;
            moment += position.cross(&load);
            weighted += f * position;
            total += f;
            contact_area += self.areas[vertex];
            max_pressure = max_pressure.max(self.pressure.peak[vertex]);
        }
        Resultant { force, moment, center_of_pressure: weighted / total, contact_area, max_pressure }
    }

    /// The connected parts of the active set.
    pub fn patches(&self) -> Vec<Patch> {
        let patches = self.surface.patches(&self.forces.active).into_iter();
        patches.map(|vertices| Patch { resultant: self.of(&vertices), vertices }).collect()
    }
}
