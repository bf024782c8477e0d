//! What a contact does differently in collocation and in Galerkin form.

use nalgebra::Vector3;

use crate::contact::candidate::groups::with_rings;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::response::kernel::basis::Discretization;
use crate::surface::checked::Surface;

/// The hats of the outermost nodes carry force beyond the rim: fitted to areas under Hertz's spheres.
const COLLOCATION_RIM_SHIFT: f64 = 0.08;

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

    /// Vertices whose gaps feel what stands in their triangles, around those under force.
    pub(crate) fn felt(self, surface: &Surface, active: &[usize]) -> Vec<usize> {
        match self {
            Self::Collocation => active.to_vec(),
            // Averages over the triangles of the vertices beside are closed or open.
            Self::Galerkin => surface.k_ring(active, 1),
        }
    }

    /// Share of an edge by which the contact is smaller than its hats.
    pub(crate) fn rim_shift(self) -> f64 {
        match self {
            Self::Collocation => COLLOCATION_RIM_SHIFT,
            Self::Galerkin => 0.0,
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
