//! The skin where forces put it, and the gaps that they leave there.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::growth::PRESSED_SHARE;
use crate::contact::error::ContactError;
use crate::contact::figures::motion::candidates::CandidateMotion;
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::contact::report::record::Report;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::Traits;

/// How far normals may turn, over the gap tolerance, so that forces are off by some such share of theirs: on sides as steep as a
/// ball's that the skin folds around, gaps vanish long before the forces stand upright on it.
const TURNED_PER_GAP: f64 = 5.0;

/// What a linearization leaves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Left {
    /// Gaps of vertices under force and penetration of others (m).
    pub largest: f64,
    /// Root of the mean square, over those that are more than rounded: it falls steadily where single vertices come and go.
    pub mean: f64,
    /// How far the normals have turned from those that the forces act along: root of the mean square, by force.
    turned: f64,
}

impl Left {
    /// * `rounding`: of the gaps (m)
    /// * `turned`: [`Left::turned`]
    fn of(gaps: impl Iterator<Item = f64>, rounding: f64, turned: f64) -> Self {
        let (mut largest, mut squares, mut count) = (0.0_f64, 0.0, 0_usize);
        for gap in gaps.filter(|gap| *gap > rounding) {
            (largest, squares, count) = (largest.max(gap), squares + gap * gap, count + 1);
        }
        Self { largest, mean: (squares / count.max(1) as f64).sqrt(), turned }
    }

    /// Whether less is left than such shares of the gaps that another leaves; of the turns, where gaps are next to none.
    ///
    /// * `none`: a mean gap (m) that is next to none
    pub fn is_less(&self, [of_gaps, of_turns]: [f64; 2], other: &Self, none: f64) -> bool {
        let is_turned_less = self.turned < of_turns * other.turned;
        self.mean < of_gaps * other.mean || self.mean.max(other.mean) <= none && is_turned_less
    }

    /// * `tolerance`: of gaps, as a share of the deepest
    pub fn is_settled(&self, tolerance: f64, deepest: f64) -> bool {
        self.largest <= tolerance * deepest && self.turned <= TURNED_PER_GAP * tolerance
    }
}

/// The skin around a contact where its forces put it.
pub(super) struct Deformed {
    /// Candidates and the vertices beside the active ones, but for those on sharp edges, ascending.
    pub vertices: Vec<usize>,
    /// u (m).
    pub displacement: Vec<Vector3<f64>>,
    /// Signed distance (m) and normal there.
    pub measured: Measured,
}

impl Deformed {
    pub fn new(
        gaps: &Gaps,
        response: &Compliance,
        forces: &NodeForces,
        report: &mut Report,
    ) -> Result<Self, ContactError> {
        let (started, surface) = (Instant::now(), gaps.surface);
        let is_other =
            |vertex: &usize| surface.skin_mask()[*vertex] && forces.candidates.binary_search(vertex).is_err();
        let mut beside = surface.k_ring(&forces.active, 1);
        beside.retain(|vertex| is_other(vertex) && response.is_prepared(*vertex));
        let found = response.displace_coarsely(forces.applied(), &beside)?;
        let motion = CandidateMotion::new(gaps, response, forces)?;
        let candidates = forces.candidates.iter().copied().zip(motion.displacement);
        let mut moved: Vec<(usize, Vector3<f64>)> = candidates.chain(beside.into_iter().zip(found)).collect();
        moved.retain(|(vertex, _)| gaps.line_at(*vertex).is_none());
        moved.sort_unstable_by_key(|(vertex, _)| *vertex);
        let (vertices, displacement) = moved.into_iter().unzip();
        report.clock("response", started);
        Self::at(gaps, vertices, displacement, report)
    }

    pub fn at(
        gaps: &Gaps,
        vertices: Vec<usize>,
        displacement: Vec<Vector3<f64>>,
        report: &mut Report,
    ) -> Result<Self, ContactError> {
        let started = Instant::now();
        let measured = gaps.measured_at(&vertices, &displacement)?;
        report.clock("signed_distance", started);
        Ok(Self { vertices, displacement, measured })
    }

    /// What forces leave; gaps in Galerkin form are how far the averaged ones of nodes under force are from those solved with.
    pub fn left(&self, gaps: &Gaps, traits: &Traits, forces: &NodeForces) -> Result<Left, ContactError> {
        let turned = self.turned(forces);
        let rounding = PRESSED_SHARE * gaps.deepest();
        if traits.discretization == Discretization::Galerkin {
            // Solved, the gap is as far from nothing as another linearization along the same normals changes it.
            let mut anew = gaps.clone();
            anew.linearize(&self.vertices, &self.displacement, &self.measured);
            let (active, normals) = (&forces.active, gaps.at(&forces.active)?.normal);
            let before = gaps.averaged(traits.basis, active)?;
            let after = anew.averaged_along(traits.basis, active, &normals)?;
            let changes = before.into_iter().zip(after).map(|(before, after)| (after - before).abs());
            return Ok(Left::of(changes, rounding, turned));
        }
        let rows = self.vertices.iter().zip(&self.measured.distance);
        let off = |(&vertex, &distance): (&usize, &f64)| {
            if forces.force[vertex] > 0.0 { distance.abs() } else { (-distance).max(0.0) }
        };
        Ok(Left::of(rows.map(off), rounding, turned))
    }

    /// [`Left::turned`] of such forces.
    fn turned(&self, forces: &NodeForces) -> f64 {
        let (mut squares, mut total) = (0.0, 0.0);
        for (&vertex, normal) in self.vertices.iter().zip(&self.measured.normal) {
            let force = forces.force[vertex];
            if force > 0.0 {
                squares += force * (forces.vectors[vertex] / force - normal).norm_squared();
                total += force;
            }
        }
        if total > 0.0 { f64::sqrt(squares / total) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_count_where_gaps_are_next_to_none() {
        let left = |mean: f64, turned: f64| Left { largest: mean, mean, turned };
        let is_less = |a: Left, b: Left| a.is_less([0.7, 0.9], &b, 1e-6);
        assert!(is_less(left(6e-5, 0.2), left(1e-4, 0.1)));
        assert!(!is_less(left(8e-5, 0.05), left(1e-4, 0.1)));
        assert!(is_less(left(8e-7, 0.08), left(7e-7, 0.1)));
        assert!(!is_less(left(8e-7, 0.095), left(7e-7, 0.1)));
        assert!(!is_less(left(1.1e-6, 0.08), left(7e-7, 0.1)));
    }
}
