//! Where the contact ends at a sharp edge of the obstacle, not where the gap opens.

use std::collections::BTreeSet;

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::gap::entry::OTHER_SIDE;
use crate::contact::gap::initial::Gaps;
use crate::geometry::bounds::Bounds;
use crate::obstacle::convex_edge::ConvexEdge;

/// The rim of a contact along sharp edges of the obstacle.
#[derive(Debug, Default)]
pub(crate) struct RimOnEdges {
    pub across: Vec<Across>,
    /// Ends of one of the edges (m).
    pub ends: Option<[Vector3<f64>; 2]>,
    /// Share of the area of the vertices under force that belongs to those beside an edge.
    pub share: f64,
}

/// A free vertex beside skin under force, on another side of the obstacle than all of that.
#[derive(Debug)]
pub(crate) struct Across {
    pub vertex: usize,
    /// Gap to its own side (m), as no pressure on the other side changes it: where that ends.
    pub distance: f64,
    /// Normal of the other side, and of its own.
    normals: [Vector3<f64>; 2],
}

impl RimOnEdges {
    pub fn new(gaps: &Gaps, forces: &NodeForces) -> Result<Self, ContactError> {
        let mut across = on_other_sides(gaps, forces)?;
        if across.is_empty() {
            return Ok(Self::default());
        }
        let surface = gaps.surface;
        // The skin that touches goes up to the depth beyond the edge.
        let reach = gaps.deepest() + surface.mean_edge_length();
        let point = |across: &Across| surface.vertices()[across.vertex];
        let around = Bounds::around_each(across.iter().map(point)).grown(reach);
        let is_around = |edge: &ConvexEdge| Bounds::around(&edge.ends).meets(&around);
        let edges: Vec<ConvexEdge> = gaps.scene.obstacle.sharp_edges().filter(is_around).collect();
        let edge_of = |across: &Across| {
            let is_near = |edge: &ConvexEdge| edge.distance(&point(across)) <= across.distance + reach;
            edges.iter().find(|edge| across.is_over(edge) && is_near(edge))
        };
        across.retain(|across| edge_of(across).is_some());
        let ends = across.first().and_then(edge_of).map(|edge| edge.ends);
        let beside: BTreeSet<usize> = across
            .iter()
            .flat_map(|across| surface.neighbours(across.vertex))
            .map(|&other| other as usize)
            .filter(|other| forces.active.binary_search(other).is_ok())
            .collect();
        let area = |vertex: &usize| surface.vertex_areas()[*vertex];
        let share = beside.iter().map(area).sum::<f64>() / forces.active.iter().map(area).sum::<f64>();
        Ok(Self { across, ends, share })
    }
}

impl Across {
    /// Whether the sides meet at such an edge.
    fn is_over(&self, edge: &ConvexEdge) -> bool {
        let [touched, own] = &self.normals;
        let are =
            |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(touched) >= OTHER_SIDE && b.dot(own) >= OTHER_SIDE;
        let [one, other] = &edge.normals;
        are(one, other) || are(other, one)
    }
}

/// Free vertices beside the skin under force whose sides are others than those that touch there.
fn on_other_sides(gaps: &Gaps, forces: &NodeForces) -> Result<Vec<Across>, ContactError> {
    let (surface, touches) = (gaps.surface, forces.touching());
    let mut free = surface.k_ring(&forces.active, 1);
    free.retain(|&vertex| !touches[vertex]);
    let (own, active) = (gaps.at(&free)?, gaps.at(&forces.active)?);
    let side_of = |&vertex: &u32| {
        let row = forces.active.binary_search(&(vertex as usize)).ok()?;
        Some(active.normal[row])
    };
    let across = |(row, &vertex): (usize, &usize)| {
        let (distance, normal) = (own.distance[row], own.normal[row]);
        let mut sides = surface.neighbours(vertex).iter().filter_map(side_of);
        let first = sides.next()?;
        let is_other = |side: Vector3<f64>| side.dot(&normal) < OTHER_SIDE;
        let is_across = distance >= 0.0 && is_other(first) && sides.all(is_other);
        is_across.then_some(Across { vertex, distance, normals: [first, normal] })
    };
    Ok(free.iter().enumerate().filter_map(across).collect())
}
