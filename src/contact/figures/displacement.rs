//! Displacement of the candidates, and what penetration it leaves.

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::fade::Fade;
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::response::skin::elastic::Displacements;

/// How the candidates move (k of them).
#[derive(Debug, Clone, Default)]
pub(crate) struct CandidateMotion {
    /// u (k, m): `u_i = (R f)_i n_i` under a scalar kernel, the whole vector of a body.
    pub displacement: Vec<Vector3<f64>>,
    /// Candidates that a scalar kernel answers for, ascending.
    pub scalar: Vec<usize>,
}

impl CandidateMotion {
    pub fn new(gaps: &Gaps, response: &Compliance, forces: &NodeForces) -> Result<Self, ContactError> {
        let initial = gaps.at(&forces.candidates)?.distance;
        let mut displacement: Vec<Vector3<f64>> = (forces.candidates.iter().zip(initial).zip(&forces.normal))
            .map(|((&vertex, initial), normal)| (forces.gap[vertex] - initial) * normal)
            .collect();
        let mut scalar = forces.candidates.clone();
        if !response.traits.is_kernel {
            let found = response.displace_coarsely(forces.applied(), &forces.candidates)?;
            scalar.clear();
            for (row, along) in found.along_normal.iter().enumerate() {
                match along {
                    Some(_) => scalar.push(forces.candidates[row]),
                    None => {
                        // Along the normal the gap knows more than what is drawn.
                        let normal = forces.normal[row];
                        let missing = displacement[row].dot(&normal) - found.vectors[row].dot(&normal);
                        displacement[row] = found.vectors[row] + missing * normal;
                    }
                }
            }
        }
        Ok(Self { displacement, scalar })
    }
}

/// What a contact keeps for the drawn skin.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    pub fingers: Fingers,
    pub motion: CandidateMotion,
}

/// Displacement (m) of a row before it fades: under a scalar kernel the direction of `Σ_j R_ij f_j n_j` and the magnitude
/// `(R f)_i`; of a body the vector itself.
pub(crate) fn drawn_vector(found: &Displacements, row: usize) -> Vector3<f64> {
    let vector = found.vectors[row];
    let Some(along) = found.along_normal[row] else { return vector };
    let norm = vector.norm();
    if norm > 0.0 { vector * (along.abs() / norm) } else { Vector3::zeros() }
}

/// Deepest penetration of a skin vertex (m, ≥ 0), measured anew at the deformed skin.
///
/// Beside the candidates a vertex can penetrate where its gap was less than the largest displacement of any.
pub(crate) fn penetration_after(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
    motion: &CandidateMotion,
) -> Result<f64, ContactError> {
    let surface = gaps.surface;
    let moved = |(&vertex, u): (&usize, &Vector3<f64>)| surface.vertices()[vertex] + u;
    let mut points: Vec<Vector3<f64>> =
        forces.candidates.iter().zip(&motion.displacement).map(moved).collect();

    let largest = motion.displacement.iter().map(Vector3::norm).fold(0.0, f64::max);
    let may_sink: Vec<usize> = {
        let distance = gaps.distances();
        let is_near = |vertex: usize| surface.skin_mask()[vertex] && distance[vertex] < largest;
        let is_other = |vertex: usize| forces.candidates.binary_search(&vertex).is_err();
        (0..distance.len()).filter(|&vertex| is_near(vertex) && is_other(vertex)).collect()
    };
    if !may_sink.is_empty() {
        let found = response.displace_coarsely(forces.applied(), &may_sink)?;
        let fade = Fade::new(surface, &forces.fingers, &forces.candidates, &motion.scalar);
        for (row, &vertex) in may_sink.iter().enumerate() {
            let share = found.along_normal[row].map_or(1.0, |_| fade.share(vertex));
            points.push(surface.vertices()[vertex] + share * drawn_vector(&found, row));
        }
    }
    let after = Measured::near(&points, &gaps.scene.obstacle, gaps.deepest(), None)?;
    Ok(after.distance.iter().map(|distance| -distance).fold(0.0, f64::max))
}
