//! The response kernel of an elastic layer bonded to rigid bone.

use super::error::ResponseError;
use super::rule::gauss;
use std::sync::{Arc, Mutex};

/// Pieces of the table per unit of r/h.
const PER_UNIT: usize = 16;
/// Largest r/h of the table; the kernel is below 1e-11 beyond.
const LARGEST: usize = 32;
/// Coefficients of a piece.
const TERMS: usize = 6;
/// Highest derivative whose bound is kept.
const DERIVATIVES: usize = 17;

/// Kernel of a flat elastic layer, thickness h, bonded to rigid ground.
///
/// In wave numbers the surface answers a pressure by `U(k) = (1-ν)/(G k) W(kh)`,
///
/// ```text
/// W(t) = [(3-4ν) sinh 2t - 2t] / [(3-4ν) cosh 2t + 2t² + 5 - 12ν + 8ν²]
/// ```
///
/// and over the distance r by `u(r) = K [1/r - φ(r/h)/h]` per newton, K = (1-ν)/(2πG), with the smooth part
/// `φ(ρ) = ∫_0^∞ (1 - W(t)) J0(ρt) dt` (Hankel transform; Johnson 1985, §5.8). W grows from 0 to 1 without
/// turning, which makes the matrix of a layer whose thickness varies positive definite: see
/// [`Thickness`](super::Thickness).
#[derive(Debug)]
pub struct LayerKernel {
    poisson_ratio: f64,
    /// Coefficients of φ in the piece's coordinate -1 .. 1, lowest first.
    pieces: Vec<[f64; TERMS]>,
    /// `∫ (1 - W) t^n dt`, which bounds the n-th derivative of φ.
    derivatives: [f64; DERIVATIVES],
}

/// 1 - W(t), without cancellation.
fn one_minus_w(t: f64, nu: f64) -> f64 {
    let (k, c) = (3.0 - 4.0 * nu, 5.0 - 12.0 * nu + 8.0 * nu * nu);
    let e = (-2.0 * t).exp();
    (k * e + 2.0 * t * t + 2.0 * t + c) * e / (0.5 * k * (1.0 + e * e) + (2.0 * t * t + c) * e)
}

impl LayerKernel {
    /// The kernel for a Poisson's ratio in 0 ..= 0.5, made once (some 20 ms) and kept.
    ///
    /// # Errors
    /// [`ResponseError::Constant`] for a ratio out of range.
    pub fn new(poisson_ratio: f64) -> Result<Arc<Self>, ResponseError> {
        static KEPT: Mutex<Vec<Arc<LayerKernel>>> = Mutex::new(Vec::new());
        if !(0.0..=0.5).contains(&poisson_ratio) {
            let (name, value, expected) = ("poisson_ratio", poisson_ratio, "from 0 to 0.5");
            return Err(ResponseError::Constant { name, value, expected });
        }
        let mut kept = KEPT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if let Some(kernel) = kept.iter().find(|k| k.poisson_ratio == poisson_ratio) {
            return Ok(kernel.clone());
        }
        let kernel = Arc::new(Self::tabulate(poisson_ratio));
        kept.push(kernel.clone());
        Ok(kernel)
    }

    fn tabulate(nu: f64) -> Self {
        // Panels of 20 Gauss points up to t = 20, where 1 - W < 1e-14; J0(ρt) turns at most 2.6 times in each.
        let mut points = Vec::new();
        let mut derivatives = [0.0; DERIVATIVES];
        for panel in 0..40 {
            for (u, w) in gauss(20, 0.0) {
                let t = 0.5 * (panel as f64 + u);
                let weight = 0.5 * w * one_minus_w(t, nu);
                points.push((t, weight));
                for (n, bound) in derivatives.iter_mut().enumerate() {
                    *bound += weight * t.powi(n as i32);
                }
            }
        }
        let phi = |rho: f64| points.iter().map(|(t, w)| w * libm::j0(rho * t)).sum::<f64>();
        // Chebyshev series over whole units (φ is analytic within 2 of the real line), then short pieces.
        let mut pieces = Vec::with_capacity(LARGEST * PER_UNIT);
        for unit in 0..LARGEST {
            let series = chebyshev::<20>(|x| phi(unit as f64 + 0.5 * (1.0 + x)));
            for part in 0..PER_UNIT {
                let at = |x: f64| (part as f64 + 0.5 * (1.0 + x)) / PER_UNIT as f64;
                let short = chebyshev::<TERMS>(|x| clenshaw(&series, 2.0 * at(x) - 1.0));
                pieces.push(monomials(&short));
            }
        }
        Self { poisson_ratio: nu, pieces, derivatives }
    }

    /// φ(ρ), the smooth part, with an absolute error below 1e-11; 1/ρ beyond the table.
    #[inline(always)]
    pub fn smooth_part(&self, rho: f64) -> f64 {
        let scaled = rho * PER_UNIT as f64;
        let index = (scaled as usize).min(LARGEST * PER_UNIT - 1);
        let x = 2.0 * (scaled - index as f64) - 1.0;
        let c = &self.pieces[index];
        let value = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
        if rho < LARGEST as f64 { value } else { 1.0 / rho }
    }

    /// W(t): the answer to a pressure wave as a share of the half-space's, t = 2π h / wave length.
    pub fn symbol(t: f64, poisson_ratio: f64) -> f64 {
        1.0 - one_minus_w(t, poisson_ratio)
    }

    /// h u / K = 1/ρ - φ(ρ) at ρ = r/h > 0.
    pub fn value(&self, rho: f64) -> f64 {
        1.0 / rho - self.smooth_part(rho)
    }

    /// The r/h beyond which the kernel stays below `threshold` (relative to K/h).
    pub(crate) fn reach(&self, threshold: f64) -> f64 {
        let steps = LARGEST * PER_UNIT;
        let at = |i: usize| i as f64 / PER_UNIT as f64;
        let last = (1..steps).rev().find(|&i| self.value(at(i)).abs() > threshold);
        at(last.map_or(1, |i| i + 1))
    }

    /// Bound of the error, relative to 1/h, of an n-point Gauss rule for φ over a piece of half-width
    /// `half_width` h: the best polynomial of degree 2n - 1 errs by `2 M (s/2)^2n / (2n)!`, M the bound of the
    /// derivative of order 2n.
    pub(crate) fn rule_error(&self, n: usize, half_width: f64) -> f64 {
        let k = 2 * n;
        let factorial: f64 = (1..=k).map(|v| v as f64).product();
        4.0 * self.derivatives[k] * (0.5 * half_width).powi(k as i32) / factorial
    }

    /// The largest n for which [`Self::rule_error`] is known.
    pub(crate) const MOST_POINTS: usize = (DERIVATIVES - 1) / 2;
}

/// Chebyshev coefficients of the interpolant in N points on -1 .. 1.
fn chebyshev<const N: usize>(f: impl Fn(f64) -> f64) -> [f64; N] {
    let angle = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / N as f64;
    let values: [f64; N] = std::array::from_fn(|k| f(angle(k).cos()));
    std::array::from_fn(|j| {
        let sum: f64 = (0..N).map(|k| values[k] * (j as f64 * angle(k)).cos()).sum();
        sum * if j == 0 { 1.0 } else { 2.0 } / N as f64
    })
}

fn clenshaw(c: &[f64], x: f64) -> f64 {
    let (mut b1, mut b2) = (0.0, 0.0);
    for &ck in c[1..].iter().rev() {
        (b1, b2) = (ck + 2.0 * x * b1 - b2, b1);
    }
    c[0] + x * b1 - b2
}

/// Powers of x from a short Chebyshev series.
fn monomials(c: &[f64; TERMS]) -> [f64; TERMS] {
    let mut sum = [0.0; TERMS];
    let (mut before, mut now) = ([0.0; TERMS], [0.0; TERMS]);
    now[0] = 1.0;
    for (k, &ck) in c.iter().enumerate() {
        for i in 0..TERMS {
            sum[i] += ck * now[i];
        }
        // T_(k+1) = 2 x T_k - T_(k-1), T_1 = x
        let mut next = [0.0; TERMS];
        for i in 1..TERMS {
            next[i] = if k == 0 { 1.0 } else { 2.0 } * now[i - 1];
        }
        for i in 0..TERMS {
            next[i] -= if k == 0 { 0.0 } else { before[i] };
        }
        (before, now) = (now, next);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_part_at_the_origin_has_its_known_values() {
        for (nu, expected) in [(0.5, 1.7702), (0.45, 1.6255), (0.4, 1.5187), (0.3, 1.3769)] {
            let kernel = LayerKernel::new(nu).expect("in range");
            assert!((kernel.smooth_part(0.0) - expected).abs() < 5e-5);
        }
    }

    #[test]
    fn incompressible_kernel_has_its_known_values() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        for (rho, expected) in
            [(0.1, 8.23932), (0.5, 0.44430), (1.0, -0.12570), (2.0, -0.05275), (3.0, -0.01672)]
        {
            assert!((kernel.value(rho) - expected).abs() < 1e-5, "{rho}: {}", kernel.value(rho));
        }
    }

    #[test]
    fn table_is_accurate_to_1e_11() {
        for nu in [0.0, 0.3, 0.5] {
            let kernel = LayerKernel::new(nu).expect("in range");
            // independent quadrature: other panels, other points
            let mut points = Vec::new();
            for panel in 0..90 {
                for (u, w) in gauss(16, 0.0) {
                    let t = 0.25 * (panel as f64 + u);
                    points.push((t, 0.25 * w * one_minus_w(t, nu)));
                }
            }
            for i in 0..200 {
                let rho = 0.157 * i as f64;
                let expected: f64 = points.iter().map(|(t, w)| w * libm::j0(rho * t)).sum();
                assert!(
                    (kernel.smooth_part(rho) - expected).abs() < 1e-11,
                    "{nu} {rho}: {}",
                    kernel.smooth_part(rho) - expected
                );
            }
        }
    }

    #[test]
    fn symbol_grows_from_zero_to_one_for_every_ratio() {
        // on this rests that the matrix of a layer of varying thickness is positive definite
        for i in 0..=50 {
            let nu = 0.01 * i as f64;
            let mut before = 0.0;
            for k in 0..4000 {
                let w = 1.0 - one_minus_w(0.005 * k as f64, nu);
                assert!(w >= before - 2e-16 && w <= 1.0, "{nu} {k}");
                before = w;
            }
            assert!((1.0 - one_minus_w(0.0, nu)).abs() < 1e-15 && 1.0 - before < 1e-12);
        }
    }

    #[test]
    fn kernels_are_kept_and_ratios_checked() {
        let (one, two) =
            (LayerKernel::new(0.37).expect("in range"), LayerKernel::new(0.37).expect("in range"));
        assert!(Arc::ptr_eq(&one, &two));
        for nu in [-0.01, 0.51, f64::NAN] {
            assert!(matches!(
                LayerKernel::new(nu),
                Err(ResponseError::Constant { name: "poisson_ratio", .. })
            ));
        }
    }

    #[test]
    fn reach_shrinks_with_the_threshold_and_holds() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        assert!(kernel.reach(1e-3) < kernel.reach(1e-6) && kernel.reach(1e-6) < 18.0);
        let reach = kernel.reach(1e-6);
        assert!((0..100).all(|i| kernel.value(reach + 0.13 * i as f64).abs() <= 1e-6));
    }
}
