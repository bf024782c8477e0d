//! Sharp edges under force, of the obstacle and of the skin: the pressure there is infinite.

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::figures::cells::mean_edge;
use crate::contact::gap::initial::Gaps;

/// A sharp edge that carries force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LoadedEdge {
    /// Ends of one of them (m).
    pub ends: [Vector3<f64>; 2],
    /// Mean edge length of the mesh there (m).
    pub edge_length: f64,
    /// Share of all force at the vertices there.
    pub share: f64,
}

impl LoadedEdge {
    /// That of the obstacle.
    pub fn of_obstacle(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        Self::among(gaps, forces, |vertex| Some(gaps.line_at(vertex).filter(|line| line.is_sharp)?.ends))
    }

    /// That of the skin.
    pub fn of_skin(gaps: &Gaps, forces: &NodeForces) -> Option<Self> {
        let surface = gaps.surface;
        Self::among(gaps, forces, |vertex| {
            let end = surface.sharp_edge_at(vertex)?;
            Some([vertex, end].map(|end| surface.vertices()[end]))
        })
    }

    /// * `edge_at`: ends (m) of the edge that a vertex is on, or held by
    fn among(
        gaps: &Gaps,
        forces: &NodeForces,
        edge_at: impl Fn(usize) -> Option<[Vector3<f64>; 2]>,
    ) -> Option<Self> {
        let on_edge = |&vertex: &usize| Some((vertex, edge_at(vertex)?));
        let (held, edges): (Vec<_>, Vec<_>) = forces.active.iter().filter_map(on_edge).unzip();
        let &ends = edges.first()?;
        let sum = |vertices: &[usize]| vertices.iter().map(|&vertex| forces.force[vertex]).sum::<f64>();
        let share = sum(&held) / sum(&forces.active);
        Some(Self { ends, edge_length: mean_edge(gaps.surface, &held), share })
    }
}
