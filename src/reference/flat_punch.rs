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

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const PUNCH: FlatPunch = FlatPunch { radius: 5e-3, contact_modulus: 0.24e6 };

    #[test]
    fn pressure_integrates_to_the_load() {
        // r = a sin t removes the singular rim: the integrand becomes smooth, the midpoint rule second order.
        let (approach, n) = (1e-3, 1000);
        let sum: f64 = (0..n)
            .map(|i| {
                let t = PI / 2.0 * (i as f64 + 0.5) / n as f64;
                let r = PUNCH.radius * t.sin();
                let dr = PUNCH.radius * t.cos() * PI / 2.0 / n as f64;
                PUNCH.pressure(approach, r) * 2.0 * PI * r * dr
            })
            .sum();
        assert_relative_eq!(sum, PUNCH.force(approach), max_relative = 1e-6);
    }

    #[test]
    fn far_field_is_that_of_a_point_load() {
        let (approach, r) = (1e-3, 5.0);
        let point_load = PUNCH.force(approach) / (PI * PUNCH.contact_modulus * r);
        // asin(x) = x (1 + x²/6 + …) with x = 1e-3.
        assert_relative_eq!(PUNCH.displacement(approach, r), point_load, max_relative = 2e-7);
    }
}
