//! Initial gaps averaged against the pressures of the nodes, for the weighted form.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::initial::InitialGaps;
use crate::obstacle::posed::Obstacle;
use crate::response::kernel::skin::Pressure;
use crate::response::matrix::average::pressure_average;
use crate::surface::checked::Surface;

/// Signed distances at the middles of the edges around some nodes, beside those at the vertices.
///
/// From the vertices alone a round obstacle's gap would be overrated by some h²/6R on edges of length h, which
/// costs more force than all else in the weighted form.
pub(crate) struct WeightedGaps {
    pressure: Pressure,
    /// g0 (m) in the middle of the edge between two vertices, the smaller first.
    middle: HashMap<[u32; 2], f64>,
}

impl WeightedGaps {
    pub fn new(pressure: Pressure) -> Self {
        Self { pressure, middle: HashMap::new() }
    }

    /// Measures what is missing on the triangles around `nodes`, at their vertices (into `gaps`) and middles.
    pub fn complete(
        &mut self,
        surface: &Surface,
        obstacle: &Obstacle,
        gaps: &mut InitialGaps,
        nodes: &[usize],
    ) -> Result<(), ContactError> {
        gaps.complete(surface.vertices(), obstacle, &surface.k_ring(nodes, 1))?;
        let position = |vertex: u32| surface.vertices()[vertex as usize];
        let mut missing: Vec<[u32; 2]> = nodes
            .iter()
            .flat_map(|&vertex| surface.faces_around(vertex))
            .flat_map(|&face| {
                let [a, b, c] = surface.faces()[face as usize];
                [edge(a, b), edge(b, c), edge(c, a)]
            })
            .filter(|edge| !self.middle.contains_key(edge))
            .collect();
        missing.sort_unstable();
        missing.dedup();
        // A distance changes by no more than the way, so none of these is beyond the reach.
        let mut reach: f64 = 0.0;
        let mut points: Vec<Vector3<f64>> = Vec::with_capacity(missing.len());
        for &[a, b] in &missing {
            reach = reach.max(gaps.distance[a as usize].abs() + (position(a) - position(b)).norm());
            points.push(0.5 * (position(a) + position(b)));
        }
        let answer = obstacle.signed_distance(&points, Some(reach))?;
        self.middle.extend(missing.into_iter().zip(answer.distance));
        Ok(())
    }

    /// Average of the initial gap against the pressure of a completed node (m).
    pub fn average(&self, surface: &Surface, gaps: &InitialGaps, vertex: usize) -> f64 {
        let at_middle = |a: u32, b: u32| self.middle[&edge(a, b)];
        pressure_average(surface, self.pressure, vertex, &gaps.distance, at_middle)
    }
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
