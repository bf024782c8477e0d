//! What a contact does differently in collocation and in Galerkin form.

use nalgebra::Vector3;

use crate::contact::candidate::groups::with_rings;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::area::{GapsBeside, SMOOTH_RIM, contact_areas};
use crate::contact::figures::beside::Beside;
use crate::contact::figures::rim::RimOnEdges;
use crate::contact::gap::initial::Gaps;
use crate::response::kernel::basis::Discretization;

/// In collocation the hats of the outermost nodes carry force beyond the rim, and their contact is smaller by this share of
/// an edge: fitted to areas under Hertz's spheres.
const COLLOCATION_RIM_SHIFT: f64 = 0.08;

/// Edges in thicknesses of a layer, to the power 3/2, at which its rim is half-way between that of a smooth contact and that
/// of springs, at ν = 1/2, and what is added per 1 - 2ν. Fitted: areas under spheres of 2 to 12 thicknesses a contact radius
/// are right to 1 % then, at ν of 0 to 0.5 and edges of 0.2 to 1.2 thicknesses.
const HALF_SPRINGS: [f64; 2] = [0.35, 2.6];

impl Discretization {
    /// Candidates to begin with, among the prepared vertices: those inside and `rings` rings around them. A Galerkin gap
    /// may be open with its vertex inside and closed with it outside.
    pub(crate) fn start_set(
        self,
        gaps: &Gaps,
        response: &Compliance,
        rings: usize,
    ) -> Result<Vec<usize>, ContactError> {
        let around = |rings| prepared(gaps, response, with_rings(gaps.surface, &gaps.penetrating, rings));
        match self {
            Self::Collocation => Ok(around(rings)),
            Self::Galerkin => {
                let nodes = around(rings.max(1));
                let averages = gaps.averaged(response.traits.basis, &nodes)?;
                let closed = nodes.into_iter().zip(averages).filter(|(_, gap)| *gap < 0.0);
                Ok(closed.map(|(node, _)| node).collect())
            }
        }
    }

    /// g0 (m) of the nodes.
    pub(crate) fn initial_gap(
        self,
        gaps: &Gaps,
        response: &Compliance,
        nodes: &[usize],
    ) -> Result<Vec<f64>, ContactError> {
        match self {
            Self::Collocation => Ok(gaps.at(nodes)?.distance),
            Self::Galerkin => gaps.averaged(response.traits.basis, nodes),
        }
    }

    /// Puts the gaps of the vertices themselves, `g0 + R f`, in place of averaged ones.
    pub(crate) fn vertex_gap(
        self,
        gaps: &Gaps,
        response: &Compliance,
        forces: &mut NodeForces,
    ) -> Result<(), ContactError> {
        if self == Self::Galerkin {
            let gap = gap_at(gaps, response, forces, &forces.candidates)?;
            for (&vertex, gap) in forces.candidates.iter().zip(gap) {
                forces.gap[vertex] = gap;
            }
        }
        Ok(())
    }
}

/// Contact area at each vertex (n, m²), within the rim that sharp edges and the gaps beside it place.
pub(crate) fn areas_within_rim(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
    beside: &Beside,
    on_edges: &RimOnEdges,
) -> Result<Vec<f64>, ContactError> {
    let rim_shift = match response.traits.discretization {
        Discretization::Collocation => COLLOCATION_RIM_SHIFT,
        Discretization::Galerkin => 0.0,
    };
    let mut gap = forces.gap.clone();
    let (vertices, at_rim) = beside.rim(gaps)?;
    vertices.iter().zip(at_rim).for_each(|(&vertex, at_rim)| gap[vertex] = at_rim);
    let mut is_across = vec![false; gap.len()];
    for across in &on_edges.across {
        (gap[across.vertex], is_across[across.vertex]) = (across.distance, true);
    }
    let (touches, active) = (forces.touching(), &forces.active);
    let power = |vertex: usize| {
        let layer =
            response.skin.kernel_at(vertex).and_then(|kernel| Some((kernel, kernel.layer_at(vertex)?)));
        layer.map_or(SMOOTH_RIM, |(kernel, thickness)| {
            rim_on_layer(gaps.surface.shortest_edge(vertex) / thickness, kernel.poisson_ratio())
        })
    };
    let beside = GapsBeside { gap: &gap, is_across: &is_across, power: &power };
    Ok(contact_areas(gaps.surface, rim_shift, &beside, &touches, &forces.force, active))
}

/// Power of the gap that grows with the distance from the rim on a layer: that of a smooth contact near it, and 1 where the
/// layer gives way as springs do.
///
/// * `cell`: length of the edges at the rim in thicknesses
fn rim_on_layer(cell: f64, poisson_ratio: f64) -> f64 {
    let [incompressible, compressible] = HALF_SPRINGS;
    let half = incompressible + compressible * (1.0 - 2.0 * poisson_ratio);
    let cell = cell.powf(1.5);
    SMOOTH_RIM + (1.0 - SMOOTH_RIM) * cell / (cell + half)
}

/// `g0 + R f` (m) at vertices.
pub(crate) fn gap_at(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
    vertices: &[usize],
) -> Result<Vec<f64>, ContactError> {
    gap_of(gaps, vertices, &response.displace(forces.applied(), vertices)?)
}

/// The same where it is known how the vertices move.
pub(crate) fn gap_of(
    gaps: &Gaps,
    vertices: &[usize],
    moved: &[Vector3<f64>],
) -> Result<Vec<f64>, ContactError> {
    let initial = gaps.at(vertices)?;
    let rows = initial.distance.iter().zip(&initial.normal).zip(moved);
    Ok(rows.map(|((distance, normal), u)| distance + normal.dot(u)).collect())
}

/// `vertices` whose response is known; a penetrating one must be.
pub(crate) fn prepared(gaps: &Gaps, response: &Compliance, mut vertices: Vec<usize>) -> Vec<usize> {
    vertices
        .retain(|&vertex| response.is_prepared(vertex) || gaps.penetrating.binary_search(&vertex).is_ok());
    vertices
}
