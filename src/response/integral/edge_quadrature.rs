//! Integrals of a radial kernel over a triangle by quadrature along its edges.
//!
//! In polar coordinates about the projection of x on the plane, z its height and s² = r² - z², the function
//! `Ψ(r) = ∫ f(r) r dr` turns the integral of f and its first moment into integrals along the edges,
//!
//! ```text
//! ∫ f dA = Σ d ∫ (Ψ(r) - Ψ(|z|)) / s² dl,      ∫ f (y - x_proj) dA = Σ m ∫ Ψ(r) dl
//! ```
//!
//! with d the distance of an edge and m its outward normal. Both integrands are as smooth as f.

use pulp::Simd;

use crate::response::integral::gauss::gauss_interval;
use crate::response::integral::hat_simd::{NearFace, along, from_point};
use crate::response::simd::lanes::{Lanes, dot};

/// The function Ψ of a kernel; a trait, as a closure would not be compiled for the machine's vectors.
pub(crate) trait EdgePotential<S: Simd> {
    /// Ψ (m² times the kernel), up to a constant, at a squared distance (m²).
    fn at(&self, squared: Lanes<S>) -> Lanes<S>;
}

/// Points and weights along an edge, from 0 to 1.
#[derive(Debug, Default)]
pub(crate) struct EdgeRule {
    points: Vec<(f64, f64)>,
}

impl EdgeRule {
    /// A rule with an error of `allowed` for integrands that are analytic and at most `bound` within the distance
    /// `margin` of an edge of half-length `half`; also for their products with s².
    ///
    /// n points err by `64/15 bound b^-2n / (1 - b^-2)` where the ellipse of Bernstein's parameter b fits
    /// (Trefethen 2013, theorem 19.3); edges longer than their margin are divided.
    pub(crate) fn set(&mut self, half: f64, margin: f64, bound: f64, allowed: f64) {
        let pieces = (0.25 * half / margin).ceil().max(1.0);
        let width = margin * pieces / half;
        let ellipse = width + (1.0 + width * width).sqrt();
        let scale = 64.0 / 15.0 * bound / (1.0 - ellipse.powi(-2));
        let n = ((scale / allowed).ln() / (2.0 * ellipse.ln())).ceil().max(1.0) + 1.0;
        let rule = gauss_interval(n as usize);
        self.points.clear();
        for piece in 0..pieces as usize {
            self.points.extend(rule.iter().map(|(t, w)| ((piece as f64 + t) / pieces, w / pieces)));
        }
    }
}

impl NearFace {
    /// `∫ p(y) f(|x - y|) dA` at each point.
    #[inline(always)]
    pub(crate) fn along_edges<S: Simd>(
        &self,
        x: [Lanes<S>; 3],
        rule: &EdgeRule,
        potential: &impl EdgePotential<S>,
    ) -> Lanes<S> {
        let any = x[0];
        let zero = any.all(0.0);
        let [a, b, c] = &self.corners;
        let to = [from_point(a, &x), from_point(b, &x), from_point(c, &x)];
        let height = along(&to[0], &self.normal);
        let height_squared = height * height;
        let base = potential.at(height_squared);
        let (mut zeroth, mut boundary) = (zero, zero);
        for k in 0..3 {
            let (start, end) = (&to[(k + 1) % 3], &to[(k + 2) % 3]);
            // of the two ends the nearer one gives the distance with the least rounding
            let nearer = dot(start, start).at_most(dot(end, end));
            let d = nearer.pick(along(start, &self.outward[k]), along(end, &self.outward[k]));
            let (s0, s1) = (along(start, &self.tangents[k]), along(end, &self.tangents[k]));
            let length = s1 - s0;
            let (mut turn, mut sum) = (zero, zero);
            for &(t, weight) in &rule.points {
                let s = length.mul_add(any.all(t), s0);
                let in_plane = s.mul_add(s, d * d);
                let psi = any.all(weight) * (potential.at(in_plane + height_squared) - base);
                // where the point itself lies on the edge, d is 0
                turn = turn + psi / (in_plane + any.all(f64::MIN_POSITIVE));
                sum = sum + psi;
            }
            zeroth = (d * length).mul_add(turn, zeroth);
            boundary = (any.all(2.0 * self.edge[k]) * length).mul_add(sum, boundary);
        }
        (any.all(self.at_corner) + along(&to[0], &self.gradient)) * zeroth - boundary
    }
}
