//! Rigid cone pressed into an elastic half-space (Love 1939; Sneddon 1965, §5; Johnson 1985, §5.2).

use std::f64::consts::{FRAC_2_PI, PI};

/// A rigid cone pressed point first into an elastic half-space.
///
/// It holds while the cone is blunt: slopes `cot α` are taken as small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cone {
    /// Angle between the axis and the face α (rad), in (0, π/2).
    pub semi_angle: f64,
    /// Contact modulus of the half-space E* (Pa), > 0.
    pub contact_modulus: f64,
}

impl Cone {
    /// Force at an approach δ (m, ≥ 0): `F = 2/π · E* · tan α · δ²` (N).
    pub fn force(&self, approach: f64) -> f64 {
        FRAC_2_PI * self.contact_modulus * self.semi_angle.tan() * approach.powi(2)
    }

    /// Contact radius at an approach δ (m, ≥ 0): `a = 2/π · tan α · δ` (m).
    pub fn contact_radius(&self, approach: f64) -> f64 {
        FRAC_2_PI * self.semi_angle.tan() * approach
    }

    /// Pressure at distance r (m, ≥ 0) from the axis: `E*/2 · cot α · arcosh(a/r)`, infinite at the tip, zero outside
    /// the contact (Pa).
    pub fn pressure(&self, approach: f64, distance: f64) -> f64 {
        let ratio = self.contact_radius(approach) / distance;
        if ratio > 1.0 { 0.5 * self.contact_modulus / self.semi_angle.tan() * ratio.acosh() } else { 0.0 }
    }

    /// Stored elastic energy at an approach δ (m, ≥ 0): `2/(3π) · E* · tan α · δ³` (J).
    pub fn energy(&self, approach: f64) -> f64 {
        2.0 / (3.0 * PI) * self.contact_modulus * self.semi_angle.tan() * approach.powi(3)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const BLUNT: Cone = Cone { semi_angle: 1.4, contact_modulus: 0.24e6 };

    #[test]
    fn load_is_the_slope_of_the_energy() {
        let (approach, step) = (0.5e-3, 1e-8);
        let slope = (BLUNT.energy(approach + step) - BLUNT.energy(approach - step)) / (2.0 * step);
        // Central difference: relative error (step / approach)² / 3; cancellation about 1e-16 · approach / step.
        assert_relative_eq!(slope, BLUNT.force(approach), max_relative = 1e-9);
    }

    #[test]
    fn pressure_integrates_to_the_load() {
        let (approach, n) = (0.5e-3, 100_000);
        let a = BLUNT.contact_radius(approach);
        let sum: f64 = (0..n)
            .map(|i| {
                let r = a * (i as f64 + 0.5) / n as f64;
                BLUNT.pressure(approach, r) * 2.0 * PI * r * a / n as f64
            })
            .sum();
        // Midpoint rule with a square-root end: error of order n^{-3/2}.
        assert_relative_eq!(sum, BLUNT.force(approach), max_relative = 1e-7);
    }

    #[test]
    fn approach_and_load_are_those_of_sneddon_s_integrals() {
        // Of a punch of profile f: δ = ∫ a f'(r) / √(a² − r²) dr, F = 2 E* ∫ r² f'(r) / √(a² − r²) dr over r from 0 to
        // a (Sneddon 1965, eq. 6.1, 6.2); a cone has f' = cot α, and r = a sin t takes the root away.
        let (approach, n) = (0.5e-3, 1000);
        let (a, slope) = (BLUNT.contact_radius(approach), 1.0 / BLUNT.semi_angle.tan());
        let step = 0.5 * PI / n as f64;
        let angles = (0..n).map(|i| (i as f64 + 0.5) * step);
        let found: f64 = angles.clone().map(|_| a * slope * step).sum();
        assert_relative_eq!(found, approach, max_relative = 1e-12);
        let load: f64 =
            angles.map(|t| 2.0 * BLUNT.contact_modulus * (a * t.sin()).powi(2) * slope * step).sum();
        assert_relative_eq!(load, BLUNT.force(approach), max_relative = 1e-12);
    }
}
