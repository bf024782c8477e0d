//! Solved node forces and what it took to find them.

use std::cell::OnceCell;

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::{AppliedForces, Compliance};
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::linalg::definiteness::Spectrum;

/// Node forces on the candidates, with the gaps that they leave.
#[derive(Debug)]
pub(crate) struct NodeForces {
    /// Vertices in the complementarity problems, ascending.
    pub candidates: Vec<usize>,
    /// Which of them feel each other.
    pub fingers: Fingers,
    /// Which of them feel each other through the product.
    pub on_product: Fingers,
    /// Vertices with f > 0, ascending.
    pub active: Vec<usize>,
    /// f (n, N), zero outside the candidates; NaN on candidates of a problem that did not solve.
    pub force: Vec<f64>,
    /// g = g0 + R f on the candidates (n, m), g0 elsewhere.
    pub gap: Vec<f64>,
    /// f along the obstacle's outward normals (n, N).
    pub vectors: Vec<Vector3<f64>>,
    /// Outward unit normal of the obstacle at each candidate (k).
    pub normal: Vec<Vector3<f64>>,
    /// One solution per uncoupled group of candidates.
    pub solutions: Vec<LcpSolution>,
    /// Extreme eigenvalues of each group's response matrix, where it was examined.
    pub spectra: Vec<Option<Spectrum>>,
    /// First ending other than `Solved`.
    pub failure: Option<LcpStatus>,
    /// How the forces move the candidates (k, m), once somebody asked.
    moved: OnceCell<Vec<Vector3<f64>>>,
}

impl NodeForces {
    /// No forces yet on `candidates`, whose gaps are `at_candidates`.
    pub fn none(
        gaps: &Gaps,
        candidates: Vec<usize>,
        fingers: Fingers,
        on_product: Fingers,
        at_candidates: Measured,
    ) -> Self {
        let vertex_count = gaps.surface.vertices().len();
        Self {
            fingers,
            on_product,
            active: Vec::new(),
            force: vec![0.0; vertex_count],
            gap: gaps.undeformed().to_vec(),
            vectors: vec![Vector3::zeros(); vertex_count],
            normal: at_candidates.normal,
            solutions: Vec::new(),
            spectra: Vec::new(),
            failure: None,
            moved: OnceCell::new(),
            candidates,
        }
    }

    /// Skin and obstacle are apart.
    pub fn apart(gaps: &Gaps) -> Self {
        let nothing = Measured { distance: Vec::new(), normal: Vec::new() };
        Self::none(gaps, Vec::new(), Fingers::one(&[]), Fingers::one(&[]), nothing)
    }

    /// The forces as a response sees them.
    pub fn applied(&self) -> AppliedForces<'_> {
        AppliedForces {
            fingers: &self.fingers,
            on_product: &self.on_product,
            active: &self.active,
            vectors: &self.vectors,
        }
    }

    /// Forces on the skin at the active vertices (N).
    pub fn active_vectors(&self) -> Vec<Vector3<f64>> {
        self.active.iter().map(|&vertex| self.vectors[vertex]).collect()
    }

    /// Their sum (N).
    pub fn total(&self) -> Vector3<f64> {
        self.active.iter().map(|&vertex| self.vectors[vertex]).sum()
    }

    /// How the forces move the candidates (k, m), to the tolerance of R itself: gaps taken anew hang on it.
    pub fn moved(&self, response: &Compliance) -> Result<&[Vector3<f64>], ContactError> {
        if let Some(moved) = self.moved.get() {
            return Ok(moved);
        }
        let moved = response.displace(self.applied(), &self.candidates)?;
        Ok(self.moved.get_or_init(|| moved))
    }

    /// Takes over forces and gaps of the nodes of one problem.
    pub fn adopt(&mut self, nodes: &[usize], solution: &LcpSolution) {
        let solved = solution.status == LcpStatus::Solved;
        for (node, &vertex) in nodes.iter().enumerate() {
            self.force[vertex] = if solved { solution.z[node] } else { f64::NAN };
            self.gap[vertex] = if solved { solution.w[node] } else { f64::NAN };
        }
        if !solved {
            self.failure.get_or_insert(solution.status);
        }
    }

    /// Sets the active vertices and the force vectors.
    pub fn settle(&mut self) {
        self.active = self.candidates.iter().copied().filter(|&vertex| self.force[vertex] > 0.0).collect();
        for (&vertex, normal) in self.candidates.iter().zip(&self.normal) {
            let force = self.force[vertex];
            // Zero where there is no force, whatever the normal.
            self.vectors[vertex] = if force == 0.0 { Vector3::zeros() } else { force * normal };
        }
    }

    /// Which vertices (n) carry force or have a closed gap.
    pub fn touching(&self) -> Vec<bool> {
        let mut touches = vec![false; self.gap.len()];
        for &vertex in &self.candidates {
            touches[vertex] = self.force[vertex] > 0.0 || self.gap[vertex] <= 0.0;
        }
        touches
    }
}
