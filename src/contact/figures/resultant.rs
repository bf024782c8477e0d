//! Forces, moments, areas and peaks of vertices under force.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::loaded::{LoadedVertex, LoadedVertices};
use crate::contact::figures::pressure::means::{SQUARE_CENTIMETRE, largest_mean};
use crate::contact::figures::pressure::vertices::VertexPressure;
use crate::contact::outcome::{Contact, ContactPart, Patch, Resultant};
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

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
            mean_pressure: f64::NAN,
        }
    }

    /// Figures of some vertices: a patch, a part, the whole.
    fn of(loaded: &[&LoadedVertex]) -> Self {
        let (mut force, mut moment, mut weighted) = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
        let (mut total, mut contact_area, mut max_pressure) = (0.0, 0.0, 0.0_f64);
        for one in loaded {
            force += one.force;
            moment += one.deformed.cross(&one.force);
            weighted += one.node_force * one.deformed;
            total += one.node_force;
            contact_area += one.contact_area;
            max_pressure = max_pressure.max(one.peak_pressure);
        }
        let mean_pressure = largest_mean(loaded, SQUARE_CENTIMETRE);
        let center_of_pressure = weighted / total;
        Self { force, moment, center_of_pressure, contact_area, max_pressure, mean_pressure }
    }
}

impl LoadedVertices {
    /// * `areas`: the contact's share of each vertex (n, m²)
    /// * `displacement`: of the candidates (k, m)
    pub fn new(
        surface: &Surface,
        forces: &NodeForces,
        pressure: &VertexPressure,
        areas: &[f64],
        displacement: &[Vector3<f64>],
    ) -> Self {
        let loaded = |vertex: usize| {
            let row = forces.candidates.binary_search(&vertex).expect("active vertices are candidates");
            let position = surface.vertices()[vertex];
            LoadedVertex {
                vertex,
                given_vertex: vertex,
                patch: 0,
                position,
                deformed: position + displacement[row],
                force: forces.vectors[vertex],
                node_force: forces.force[vertex],
                contact_area: areas[vertex],
                peak_pressure: pressure.peak[vertex],
            }
        };
        let mut list: Vec<LoadedVertex> = forces.active.iter().map(|&vertex| loaded(vertex)).collect();
        for (patch, vertices) in surface.patches(&forces.active).iter().enumerate() {
            for vertex in vertices {
                list[forces.active.binary_search(vertex).expect("patches are active")].patch = patch;
            }
        }
        let count = surface.vertices().len();
        Self { list, vertex_counts: [count; 2], is_known: forces.failure.is_none() }
    }

    /// The same in the numbers of the whole that `part` belongs to.
    ///
    /// * `vertex_counts`: vertices of the given mesh and of the whole
    pub fn in_whole(mut self, part: &RefinedSurface, vertex_counts: [usize; 2]) -> Self {
        let given = part.nearest_given();
        for one in &mut self.list {
            one.given_vertex = given[one.vertex];
            one.vertex = part.number(one.vertex);
        }
        Self { vertex_counts, ..self }
    }

    /// Figures of the whole, NaN of a contact that did not solve, and its connected parts.
    pub fn whole(&self) -> ContactPart {
        self.of(&self.list.iter().collect::<Vec<_>>())
    }

    /// [`Contact::part`].
    pub fn part(&self, mask: &[bool]) -> Result<ContactPart, ContactError> {
        let [given, whole] = self.vertex_counts;
        let of_mask = |one: &LoadedVertex| if mask.len() == whole { one.vertex } else { one.given_vertex };
        if mask.len() != given && mask.len() != whole {
            return Err(ContactError::MaskLength { found: mask.len(), given, whole });
        }
        let chosen: Vec<&LoadedVertex> = self.list.iter().filter(|one| mask[of_mask(one)]).collect();
        Ok(self.of(&chosen))
    }

    /// [`Contact::mean_pressure`].
    pub fn mean_pressure(&self, area: f64) -> Result<f64, ContactError> {
        if !(area > 0.0 && area.is_finite()) {
            return Err(ContactError::Area { area });
        }
        let all: Vec<&LoadedVertex> = self.list.iter().collect();
        Ok(if self.is_known { largest_mean(&all, area) } else { f64::NAN })
    }

    fn of(&self, loaded: &[&LoadedVertex]) -> ContactPart {
        let patches = patches(loaded);
        let resultant = match &patches[..] {
            _ if !self.is_known => Resultant::unknown(),
            [all] => all.resultant.clone(),
            _ => Resultant::of(loaded),
        };
        ContactPart { resultant, patches }
    }
}

/// Each patch as far as its vertices are among `loaded`.
fn patches(loaded: &[&LoadedVertex]) -> Vec<Patch> {
    let mut groups: BTreeMap<usize, Vec<&LoadedVertex>> = BTreeMap::new();
    loaded.iter().for_each(|one| groups.entry(one.patch).or_default().push(one));
    let patch = |group: Vec<&LoadedVertex>| Patch {
        vertices: group.iter().map(|one| one.vertex).collect(),
        resultant: Resultant::of(&group),
    };
    groups.into_values().map(patch).collect()
}

impl Contact {
    /// Figures of the vertices where `mask` is true; NaN of a contact that did not solve.
    ///
    /// Parts that cover the mesh without sharing a vertex sum to the force, moment and area of the whole.
    ///
    /// * `mask`: one entry a vertex of the given mesh or of the one that was solved. With the former, an added vertex
    ///   takes the entry of the nearer end of the edge that it lies on, of two equally near ones that of the lower number.
    ///
    /// # Errors
    /// [`ContactError::MaskLength`].
    pub fn part(&self, mask: &[bool]) -> Result<ContactPart, ContactError> {
        self.loaded.part(mask)
    }

    /// Largest mean pressure over a disc of a given area (Pa): the node forces within `√(area / π)` of a vertex under
    /// force, in a straight line on the undeformed skin, over `area`. NaN of a contact that did not solve.
    ///
    /// A node whose cell the disc cuts counts by the share of the cell within: where cells are larger than `area`, nothing is
    /// known but its pressure.
    ///
    /// * `area`: of the disc (m²), > 0
    ///
    /// # Errors
    /// [`ContactError::Area`].
    pub fn mean_pressure(&self, area: f64) -> Result<f64, ContactError> {
        self.loaded.mean_pressure(area)
    }
}
