//! The skin beside the candidates, where the forces put it: the rim and what penetrates there are read from it.

use nalgebra::Vector3;

use crate::contact::discretization::gap_of;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::motion::candidates::CandidateMotion;
use crate::contact::gap::initial::Gaps;
use crate::mesh::distinct::distinct;

/// Rings around the vertices under force in which gaps place the rim.
const RIM_RINGS: usize = 2;

/// Vertices beside the candidates and how they move, which is computed at once: a load that is made ready serves them all.
pub(crate) struct Beside {
    /// Those that can penetrate, ascending.
    near: Vec<usize>,
    /// Those around the vertices under force.
    rim: Vec<usize>,
    /// Both, ascending.
    vertices: Vec<usize>,
    moved: Vec<Vector3<f64>>,
}

impl Beside {
    /// Beside the candidates a vertex can penetrate where its gap was less than the largest displacement of any. Without
    /// candidates an obstacle that is finer than the mesh can stand between vertices.
    pub fn new(
        gaps: &Gaps,
        response: &Compliance,
        forces: &NodeForces,
        motion: &CandidateMotion,
    ) -> Result<Self, ContactError> {
        let surface = gaps.surface;
        let reach = match &motion.displacement[..] {
            [] => surface.mean_edge_length(),
            displacement => displacement.iter().map(Vector3::norm).fold(0.0, f64::max),
        };
        let is_beside = |vertex: &usize| forces.candidates.binary_search(vertex).is_err();
        let mut near = surface.k_ring(&forces.candidates, 1);
        near.extend(gaps.nearer_than(reach));
        near.retain(|vertex| surface.skin_mask()[*vertex] && is_beside(vertex));
        let near = distinct(near);
        let mut rim = surface.k_ring(&forces.active, RIM_RINGS);
        rim.retain(is_beside);
        let vertices = distinct([&near[..], &rim].concat());
        let moved = response.displace(forces.applied(), &vertices)?;
        Ok(Self { near, rim, vertices, moved })
    }

    /// The vertices that can penetrate, ascending, and how they move.
    pub fn near(&self) -> (&[usize], Vec<Vector3<f64>>) {
        (&self.near, self.moved_at(&self.near))
    }

    /// The vertices around those under force, and `g0 + R f` (m) there.
    pub fn rim(&self, gaps: &Gaps) -> Result<(&[usize], Vec<f64>), ContactError> {
        Ok((&self.rim, gap_of(gaps, &self.rim, &self.moved_at(&self.rim))?))
    }

    fn moved_at(&self, vertices: &[usize]) -> Vec<Vector3<f64>> {
        let row = |vertex| self.vertices.binary_search(vertex).expect("one of those beside");
        vertices.iter().map(|vertex| self.moved[row(vertex)]).collect()
    }
}
