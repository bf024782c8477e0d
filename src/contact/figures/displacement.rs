//! Displacement of the candidates.

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
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
