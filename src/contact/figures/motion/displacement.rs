//! Displacement of the candidates, and of the product opposite them, under node forces.

use nalgebra::Vector3;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::motion::candidates::CandidateMotion;
use crate::contact::gap::initial::Gaps;
use crate::geometry::direction::are_one;

impl CandidateMotion {
    pub fn new(gaps: &Gaps, response: &Compliance, forces: &NodeForces) -> Result<Self, ContactError> {
        let initial = gaps.at(&forces.candidates)?.distance;
        let mut displacement: Vec<Vector3<f64>> = (forces.candidates.iter().zip(initial).zip(&forces.normal))
            .map(|((&vertex, initial), normal)| (forces.gap[vertex] - initial) * normal)
            .collect();
        let mut scalar = forces.candidates.clone();
        scalar.retain(|&vertex| response.skin.is_scalar(vertex));
        // Forces along one direction move it along that.
        if scalar.len() < forces.candidates.len() || !are_one(&forces.normal) {
            let found = forces.moved(response)?;
            for ((u, vector), normal) in displacement.iter_mut().zip(found).zip(&forces.normal) {
                // Along the normal the gap knows more than what is drawn.
                *u = vector + (*u - vector).dot(normal) * normal;
            }
        }
        Ok(Self { displacement, scalar, product: Vec::new() })
    }

    /// The same with how the product moves, and the product's share of what both give way: `-f·u_P / f·(u_H - u_P)`, `None`
    /// without force.
    pub fn with_product(
        self,
        response: &Compliance,
        forces: &NodeForces,
    ) -> Result<(Self, Option<f64>), ContactError> {
        let Some(found) = response.displace_product(forces.applied(), &forces.candidates)? else {
            return Ok((self, (!forces.active.is_empty()).then_some(0.0)));
        };
        let product: Vec<Vector3<f64>> = found.into_iter().map(|moved| -moved).collect();
        let work = |moved: &[Vector3<f64>]| -> f64 {
            let force = forces.candidates.iter().map(|&vertex| &forces.vectors[vertex]);
            force.zip(moved).map(|(force, moved)| force.dot(moved)).sum()
        };
        let share = -work(&product) / work(&self.displacement);
        Ok((Self { product, ..self }, (!forces.active.is_empty()).then_some(share)))
    }
}
