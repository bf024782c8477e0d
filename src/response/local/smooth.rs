//! The layer's smooth part, without derivatives, in a table small enough for the fastest memory.

use super::super::layer::LayerKernel;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;

/// Pieces per unit of r/h.
const PER_UNIT: usize = 16;
/// Largest r/h; the kernel is below 1e-11 beyond.
const LARGEST: usize = 32;
/// Coefficients of a piece.
const TERMS: usize = 6;

/// φ(ρ) by a polynomial on each short piece, through Chebyshev points.
#[derive(Debug)]
pub(super) struct SmoothPart {
    /// Powers of the piece's coordinate -1 .. 1, lowest first.
    pieces: Vec<[f64; TERMS]>,
}

impl SmoothPart {
    pub(super) fn new(kernel: &LayerKernel) -> Self {
        let points: [f64; TERMS] = std::array::from_fn(|k| (PI * (k as f64 + 0.5) / TERMS as f64).cos());
        let powers = SMatrix::<f64, TERMS, TERMS>::from_fn(|k, power| points[k].powi(power as i32));
        let inverse = powers.try_inverse().expect("different points");
        let piece = |i: usize| {
            let rho = |k: usize| (i as f64 + 0.5 * (1.0 + points[k])) / PER_UNIT as f64;
            let values = SVector::<f64, TERMS>::from_fn(|k, _| kernel.smooth_part(rho(k)));
            (inverse * values).into()
        };
        Self { pieces: (0..LARGEST * PER_UNIT).map(piece).collect() }
    }

    /// φ(ρ), with an absolute error below 1e-9; 1/ρ beyond the table.
    #[inline(always)]
    pub(super) fn at(&self, rho: f64) -> f64 {
        let scaled = rho * PER_UNIT as f64;
        let index = (scaled as usize).min(LARGEST * PER_UNIT - 1);
        let x = 2.0 * (scaled - index as f64) - 1.0;
        let c = &self.pieces[index];
        let value = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
        if rho < LARGEST as f64 { value } else { 1.0 / rho }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_pieces_follow_the_kernel() {
        for nu in [0.0, 0.3, 0.5] {
            let kernel = LayerKernel::new(nu).expect("in range");
            let short = SmoothPart::new(&kernel);
            for i in 0..4000 {
                let rho = 0.00901 * i as f64;
                assert!((short.at(rho) - kernel.smooth_part(rho)).abs() < 1e-9, "{nu} {rho}");
            }
        }
    }
}
