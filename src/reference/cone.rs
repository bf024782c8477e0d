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
