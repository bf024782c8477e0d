//! What the estimates of error are made from, beside the figures.

use nalgebra::Vector3;

use crate::contact::figures::penetration::receding::Receding;
use crate::contact::gap::deepest::DeepestVertex;
use crate::response::body::levels::coarseness::BodyDoubt;

/// What the estimates of error are made from, beside the figures.
#[derive(Debug, Clone, Default)]
pub(crate) struct Clues {
    /// Where the undeformed skin is pressed in deepest; of a concluded contact the given vertex there.
    pub deepest: Option<DeepestVertex>,
    /// Area within the rim that the gaps beside it place (m²), on the given mesh too.
    pub area_within_rim: f64,
    /// What the coarse mesh of a body costs.
    pub body: Option<BodyDoubt>,
    /// What the mesh costs that a product's matrix is given on.
    pub product: Option<BodyDoubt>,
    /// Share of the force where the skin is cut, masked or held, so that the pressure has no bound there.
    pub at_cuts: f64,
    /// Where a sharp edge of the obstacle carries force.
    pub edge: Option<LoadedEdge>,
    /// Where one of the skin does.
    pub skin_edge: Option<LoadedEdge>,
    /// Share of the area under force that ends at sharp edges of the obstacle.
    pub ends_at_edges: f64,
    /// Whether the obstacle is met between vertices alone, by nothing sharp: it is smaller there than a triangle.
    pub is_between: bool,
    /// Whether gaps taken anew at the deformed skin led to no better answer.
    pub is_unsettled: bool,
    /// Penetration left in the mean over the skin under force, as a share of that before.
    pub mean_penetration: f64,
    /// How far off the obstacle the force acts in the mean, as a share of the penetration before.
    pub apart: f64,
    /// Where the obstacle recedes between vertices under force.
    pub receding: Receding,
    /// Vertices that penetrate away from all force, as averages over their triangles feel nothing of it.
    pub unfelt: Vec<usize>,
    /// Corners of triangles away from all force that something blunt stands in between their vertices.
    pub unmet: Vec<[usize; 3]>,
    /// Number of triangles away from all force that the obstacle touches between their vertices.
    pub touched_between: usize,
}

/// A sharp edge that carries force.
#[derive(Debug, Clone)]
pub(crate) struct LoadedEdge {
    /// Ends of one of them (m).
    pub ends: [Vector3<f64>; 2],
    /// Vertices under force there, ascending.
    pub held: Vec<usize>,
    /// How deep each of them is in the undeformed obstacle (m).
    pub depth: Vec<f64>,
    /// Half the breadth of the obstacle in the undeformed skin at each of them over its depth there, within bounds.
    pub spread: Vec<f64>,
    /// Length of edge under force (m).
    pub length: f64,
    /// Breadth of the skin that the mesh holds on it, in cells: one where vertices lie on the edge, two where the edge runs
    /// between two rows of them.
    pub cells: f64,
    /// Share of all force at the vertices there.
    pub share: f64,
}
