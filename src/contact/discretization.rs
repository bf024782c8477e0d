//! What a contact does differently in collocation and in Galerkin form.

use crate::contact::candidate::groups::with_rings;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::area::contact_areas;
use crate::contact::figures::pressure::VertexPressure;
use crate::contact::gap::initial::Gaps;
use crate::response::kernel::basis::Discretization;

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

    /// Contact area at each vertex (n, m²). In Galerkin form the rim is found between the vertices, and the peak of a patch
    /// is no less than its mean pressure F/A.
    pub(crate) fn contact_area(
        self,
        gaps: &Gaps,
        response: &Compliance,
        forces: &NodeForces,
        pressure: &mut VertexPressure,
    ) -> Result<Vec<f64>, ContactError> {
        let surface = gaps.surface;
        if self == Self::Collocation {
            return Ok(surface.vertex_areas().to_vec());
        }
        let mut gap = forces.gap.clone();
        let mut beside = surface.k_ring(&forces.active, 2);
        beside.retain(|vertex| forces.candidates.binary_search(vertex).is_err());
        for (&vertex, beside) in beside.iter().zip(gap_at(gaps, response, forces, &beside)?) {
            gap[vertex] = beside;
        }
        let areas = contact_areas(surface, &gap, &forces.touching(), &forces.force, &forces.active);
        pressure.raise_to_means(surface, forces, &areas);
        Ok(areas)
    }
}

/// `g0 + R f` (m) at vertices, of a kernel.
fn gap_at(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
    vertices: &[usize],
) -> Result<Vec<f64>, ContactError> {
    let initial = gaps.at(vertices)?.distance;
    let moved = response.displace(forces.applied(), vertices)?.along_normal;
    let along = |moved: Option<f64>| moved.expect("only kernels have a Galerkin form");
    Ok(initial.into_iter().zip(moved).map(|(gap, moved)| gap + along(moved)).collect())
}

/// `vertices` whose response is known; a penetrating one must be.
pub(crate) fn prepared(gaps: &Gaps, response: &Compliance, mut vertices: Vec<usize>) -> Vec<usize> {
    vertices.retain(|&vertex| {
        response.skin.is_prepared(vertex) || gaps.penetrating.binary_search(&vertex).is_ok()
    });
    vertices
}
