//! Rigid sphere pressed into an elastic half-space (Hertz 1882; Johnson 1985, §4.2).

use std::f64::consts::PI;

/// A rigid sphere pressed into an elastic half-space, in Hertz's parabolic approximation.
///
/// It holds while the contact radius is small against the sphere's: the true sphere needs 0.1 % less force at
/// δ/R = 0.0025 and 6 % less at δ/R = 0.1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// Radius of the sphere R (m), > 0.
    pub radius: f64,
    /// Contact modulus of the half-space E* (Pa), > 0.
    pub contact_modulus: f64,
}

impl Hertz {
    /// Force at an approach δ (m, ≥ 0): `F = 4/3 · E* · √R · δ^{3/2}` (N).
    pub fn force(&self, approach: f64) -> f64 {
        4.0 / 3.0 * self.contact_modulus * self.radius.sqrt() * approach.powf(1.5)
    }

    /// Contact radius at an approach δ (m, ≥ 0): `a = √(R δ)` (m).
    pub fn contact_radius(&self, approach: f64) -> f64 {
        (self.radius * approach).sqrt()
    }

    /// Peak pressure at an approach δ (m, ≥ 0): `p0 = 2/π · E* · √(δ/R)` (Pa).
    pub fn max_pressure(&self, approach: f64) -> f64 {
        2.0 / PI * self.contact_modulus * (approach / self.radius).sqrt()
    }

    /// Pressure at distance r (m, ≥ 0) from the axis: `p0 √(1 − r²/a²)`, zero outside the contact (Pa).
    pub fn pressure(&self, approach: f64, distance: f64) -> f64 {
        let ratio = distance / self.contact_radius(approach);
        if ratio < 1.0 { self.max_pressure(approach) * (1.0 - ratio * ratio).sqrt() } else { 0.0 }
    }

    /// Stored elastic energy at an approach δ (m, ≥ 0): `8/15 · E* · √R · δ^{5/2}` (J).
    pub fn energy(&self, approach: f64) -> f64 {
        8.0 / 15.0 * self.contact_modulus * self.radius.sqrt() * approach.powf(2.5)
    }

    /// Approach under a force F (N, ≥ 0): `δ = (3 F / (4 E* √R))^{2/3}` (m).
    pub fn approach(&self, force: f64) -> f64 {
        (0.75 * force / (self.contact_modulus * self.radius.sqrt())).powf(2.0 / 3.0)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    const SPHERE: Hertz = Hertz { radius: 0.2, contact_modulus: 0.24e6 };

    #[test]
    fn load_is_the_slope_of_the_energy() {
        let (approach, step) = (0.5e-3, 1e-8);
        let slope = (SPHERE.energy(approach + step) - SPHERE.energy(approach - step)) / (2.0 * step);
        // Central difference: relative error (step / approach)²; cancellation about 1e-16 · approach / step.
        assert_relative_eq!(slope, SPHERE.force(approach), max_relative = 1e-9);
    }

    #[test]
    fn pressure_integrates_to_the_load() {
        let approach = 0.5e-3;
        let a = SPHERE.contact_radius(approach);
        let n = 200_000;
        let sum: f64 = (0..n)
            .map(|i| {
                let r = a * (i as f64 + 0.5) / n as f64;
                SPHERE.pressure(approach, r) * 2.0 * PI * r * a / n as f64
            })
            .sum();
        // Midpoint rule with a square-root end: error of order n^{-3/2}.
        assert_relative_eq!(sum, SPHERE.force(approach), max_relative = 1e-7);
    }

    #[test]
    fn approach_inverts_force() {
        assert_relative_eq!(SPHERE.approach(SPHERE.force(3e-4)), 3e-4, max_relative = 1e-14);
    }

    #[test]
    fn load_is_the_same_in_millimetres_and_metres() {
        let mm = Hertz { radius: 8.0, contact_modulus: 0.2 }.force(0.5);
        let m = Hertz { radius: 8.0e-3, contact_modulus: 0.2e6 }.force(0.5e-3);
        assert_relative_eq!(mm, m, max_relative = 1e-14);
    }
}
