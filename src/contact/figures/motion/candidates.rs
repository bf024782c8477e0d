//! How the candidates of a contact move, and what is kept of that.

use std::borrow::Cow;

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;

/// How the candidates move (k of them).
#[derive(Debug, Clone, Default)]
pub(crate) struct CandidateMotion {
    /// `u_H - u_P` (k, m), against the product.
    pub displacement: Vec<Vector3<f64>>,
    /// Candidates that a scalar kernel answers for, ascending.
    pub scalar: Vec<usize>,
    /// u_P (k, m) of the product opposite each; empty of a rigid one.
    pub product: Vec<Vector3<f64>>,
}

impl CandidateMotion {
    /// u_H (k, m): how the skin itself moves.
    pub fn of_skin(&self) -> Cow<'_, [Vector3<f64>]> {
        if self.product.is_empty() {
            return Cow::Borrowed(&self.displacement);
        }
        Cow::Owned(
            self.displacement.iter().zip(&self.product).map(|(apart, product)| apart + product).collect(),
        )
    }
}

/// What a contact keeps for the drawn skin and product.
#[derive(Debug, Clone)]
pub(crate) struct Drawing {
    pub fingers: Fingers,
    /// The parts that feel each other through the product.
    pub on_product: Fingers,
    pub motion: CandidateMotion,
}
