//! Rigid flat-ended cylinder pressed into an elastic half-space (Boussinesq 1885; Johnson 1985, §3.8).

use std::f64::consts::PI;

/// A rigid flat-ended cylinder pressed into an elastic half-space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlatPunch {
    /// Radius of the flat end a (m), > 0.
    pub radius: f64,
    /// Contact modulus of the half-space E* (Pa), > 0.
    pub contact_modulus: f64,
}

impl FlatPunch {
    /// Force at an approach δ (m, ≥ 0): `F = 2 a E* δ` (N).
    pub fn force(&self, approach: f64) -> f64 {
        2.0 * self.radius * self.contact_modulus * approach
    }

    /// Pressure at distance r (m, ≥ 0) from the axis: `E* δ / (π √(a² − r²))`, infinite at the rim (Pa).
    pub fn pressure(&self, approach: f64, distance: f64) -> f64 {
        if distance > self.radius {
            return 0.0;
        }
        self.contact_modulus * approach / (PI * (self.radius.powi(2) - distance.powi(2)).sqrt())
    }

    /// Surface displacement at distance r (m) from the axis, along the punch's motion:
    /// `2 δ / π · asin(a / r)` outside the punch, δ beneath it (m).
    pub fn displacement(&self, approach: f64, distance: f64) -> f64 {
        if distance <= self.radius { approach } else { 2.0 / PI * approach * (self.radius / distance).asin() }
    }
}
