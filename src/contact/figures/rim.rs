//! Where the contact ends at a sharp edge of the obstacle, not where the gap opens.

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::gap::entry::OTHER_SIDE;
use crate::contact::gap::initial::Gaps;
use crate::geometry::bounds::Bounds;
use crate::obstacle::edges::SharpEdge;

/// The rim of a contact along sharp edges of the obstacle.
#[derive(Debug, Clone, Default)]
pub(crate) struct RimOnEdges {
    /// Free vertices across an edge from all skin that touches beside them, and how far (m) they are from it: the gap to their
    /// own side, which no displacement changes that the other side asks for.
    pub across: Vec<(usize, f64)>,
    /// Ends of one of the edges (m).
    pub ends: Option<[Vector3<f64>; 2]>,
    /// Share of the vertices under force that stand beside those across, by their areas.
    pub share: f64,
}

impl RimOnEdges {
    pub fn new(gaps: &Gaps, forces: &NodeForces) -> Result<Self, ContactError> {
        let (surface, touches) = (gaps.surface, forces.touching());
        let mut free = surface.k_ring(&forces.active, 1);
        free.retain(|&vertex| !touches[vertex]);
        let around = Bounds::around(free.iter().map(|&vertex| &surface.vertices()[vertex]));
        // The skin that touches goes up to the depth beyond the edge.
        let reach = gaps.deepest() + surface.mean_edge_length();
        let around = around.grown(reach);
        let is_around = |edge: &SharpEdge| Bounds::around(&edge.ends).meets(&around);
        let edges: Vec<SharpEdge> = gaps.scene.obstacle.sharp_edges().filter(is_around).collect();
        if edges.is_empty() {
            return Ok(Self::default());
        }
        let mut rim = Self::default();
        let own = gaps.at(&free)?;
        let mut is_beside = vec![false; touches.len()];
        for (row, &vertex) in free.iter().enumerate() {
            let neighbours = surface.neighbours(vertex).iter().map(|&other| other as usize);
            let touching: Vec<usize> = neighbours.filter(|&other| touches[other]).collect();
            let (normal, distance) = (own.normal[row], own.distance[row]);
            let sides = gaps.at(&touching)?.normal;
            if distance < 0.0 || sides.iter().any(|side| side.dot(&normal) >= OTHER_SIDE) {
                continue;
            }
            let Some(side) = sides.first() else { continue };
            let point = &surface.vertices()[vertex];
            let is_between = |edge: &&SharpEdge| {
                let [one, other] = &edge.normals;
                let joins = |one: &Vector3<f64>, other: &Vector3<f64>| {
                    one.dot(side) >= OTHER_SIDE && other.dot(&normal) >= OTHER_SIDE
                };
                (joins(one, other) || joins(other, one)) && edge.distance(point) <= distance + reach
            };
            if let Some(edge) = edges.iter().find(is_between) {
                rim.across.push((vertex, distance));
                rim.ends = rim.ends.or(Some(edge.ends));
                touching.iter().for_each(|&other| is_beside[other] = true);
            }
        }
        let area = |vertices: &mut dyn Iterator<Item = &usize>| {
            vertices.map(|&vertex| surface.vertex_areas()[vertex]).sum::<f64>()
        };
        rim.share = area(&mut forces.active.iter().filter(|&&vertex| is_beside[vertex]))
            / area(&mut forces.active.iter());
        Ok(rim)
    }
}
