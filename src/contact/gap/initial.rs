//! Initial gaps of a skin, measured on demand.

use std::cell::{Ref, RefCell};
use std::collections::HashMap;

use crate::contact::error::ContactError;
use crate::contact::gap::averaged;
use crate::contact::gap::entry::{EntryGap, measure_entries};
use crate::contact::gap::measured::Measured;
use crate::contact::scene::Scene;
use crate::response::kernel::basis::PressureBasis;
use crate::surface::checked::Surface;

/// Default search distance beyond the depth, in mean edge lengths.
const SEARCH_EDGES: f64 = 2.0;

/// Initial gap g0 (m) and obstacle normal of the skin's vertices, measured anew where somebody asks beyond the search
/// distance.
pub(crate) struct Gaps<'a> {
    pub surface: &'a Surface,
    pub scene: &'a Scene,
    /// Every vertex not measured is at least this far from the obstacle, outside it (m).
    pub search_distance: f64,
    /// Vertices whose gap is measured back along the press.
    pub entry: EntryGap,
    /// Vertices that may touch with g0 < 0, ascending.
    pub penetrating: Vec<usize>,
    measured: RefCell<Measured>,
    /// g0 (m) averaged against the pressure of a node.
    averaged: RefCell<HashMap<usize, f64>>,
}

impl<'a> Gaps<'a> {
    /// Measures every vertex nearer to the obstacle than the search distance and every vertex inside it; under a press
    /// back along the travel where the closest side is not the one that the vertex came in through.
    ///
    /// * `search_distance`: (m); `None`: depth and two mean edge lengths
    pub fn measure(
        surface: &'a Surface,
        scene: &'a Scene,
        search_distance: Option<f64>,
    ) -> Result<Self, ContactError> {
        let depth_bound = scene.depth_bound;
        let default = || depth_bound.unwrap_or(0.0) + SEARCH_EDGES * surface.mean_edge_length();
        let reach = search_distance.unwrap_or_else(default).max(depth_bound.unwrap_or(0.0));
        let mut measured = Measured::near(surface.vertices(), &scene.obstacle, reach, depth_bound)?;
        let entry = match &scene.press {
            Some(travel) => {
                let may_touch = |vertex: usize| surface.skin_mask()[vertex];
                measure_entries(surface.vertices(), may_touch, &scene.obstacle, travel, &mut measured)?
            }
            None => EntryGap::default(),
        };
        let is_inside = |&vertex: &usize| surface.skin_mask()[vertex] && measured.distance[vertex] < 0.0;
        Ok(Self {
            surface,
            scene,
            search_distance: reach,
            entry,
            penetrating: (0..measured.distance.len()).filter(is_inside).collect(),
            measured: RefCell::new(measured),
            averaged: RefCell::default(),
        })
    }

    /// Deepest penetration of a vertex (m, ≥ 0).
    pub fn deepest(&self) -> f64 {
        let distance = self.distances();
        self.penetrating.iter().map(|&vertex| -distance[vertex]).fold(0.0, f64::max)
    }

    /// g0 (n, m) as measured so far.
    pub fn distances(&self) -> Ref<'_, [f64]> {
        Ref::map(self.measured.borrow(), |measured| &measured.distance[..])
    }

    /// g0 (m) and obstacle normal of `vertices`, measured without limit where they have not been yet.
    pub fn at(&self, vertices: &[usize]) -> Result<Measured, ContactError> {
        let mut measured = self.measured.borrow_mut();
        measured.complete(self.surface.vertices(), &self.scene.obstacle, vertices)?;
        Ok(Measured {
            distance: vertices.iter().map(|&vertex| measured.distance[vertex]).collect(),
            normal: vertices.iter().map(|&vertex| measured.normal[vertex]).collect(),
        })
    }

    /// g0 (m) of `nodes`, averaged against their pressures.
    pub fn averaged(&self, basis: PressureBasis, nodes: &[usize]) -> Result<Vec<f64>, ContactError> {
        let mut known = self.averaged.borrow_mut();
        let missing: Vec<usize> = nodes.iter().copied().filter(|node| !known.contains_key(node)).collect();
        if !missing.is_empty() {
            let at_vertices = |vertices: &[usize]| Ok(self.at(vertices)?.distance);
            let averages = averaged::measure(self.surface, self.scene, basis, &missing, at_vertices)?;
            known.extend(missing.into_iter().zip(averages));
        }
        Ok(nodes.iter().map(|node| known[node]).collect())
    }
}
