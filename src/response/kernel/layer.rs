//! The response kernel of an elastic layer bonded to rigid bone.

use std::sync::{Arc, Mutex, PoisonError};

use crate::response::error::ResponseError;
use crate::response::kernel::layer_table::{LARGEST_RHO, LayerTable};

/// Steps per unit of r/h at which it is known how large the kernel still gets.
const ENVELOPE_STEPS: usize = 16;
/// Kernels that are kept at the most: a study may ask for any number of Poisson's ratios.
const MOST_KEPT: usize = 64;

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
/// [`Thickness`](crate::response::Thickness).
#[derive(Debug)]
pub struct LayerKernel {
    poisson_ratio: f64,
    pub(crate) table: LayerTable,
    /// The largest |h u / K| from each step of r/h on.
    envelope: Vec<f64>,
}

/// 1 - W(t), without cancellation.
fn one_minus_w(t: f64, nu: f64) -> f64 {
    let (k, c) = (3.0 - 4.0 * nu, 5.0 - 12.0 * nu + 8.0 * nu * nu);
    let e = (-2.0 * t).exp();
    (k * e + 2.0 * t * t + 2.0 * t + c) * e / (0.5 * k * (1.0 + e * e) + (2.0 * t * t + c) * e)
}

impl LayerKernel {
    /// The kernel for a Poisson's ratio in 0 ..= 0.5, made once (some 20 ms) and kept until many others were.
    ///
    /// # Errors
    /// [`ResponseError::Constant`] for a ratio out of range.
    pub fn new(poisson_ratio: f64) -> Result<Arc<Self>, ResponseError> {
        static KEPT_KERNELS: Mutex<Vec<Arc<LayerKernel>>> = Mutex::new(Vec::new());
        if !(0.0..=0.5).contains(&poisson_ratio) {
            let (name, value, expected) = ("poisson_ratio", poisson_ratio, "from 0 to 0.5");
            return Err(ResponseError::Constant { name, value, expected });
        }
        let mut kept = KEPT_KERNELS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kernel) = kept.iter().find(|k| k.poisson_ratio == poisson_ratio) {
            return Ok(kernel.clone());
        }
        let kernel = Arc::new(Self::tabulate(poisson_ratio));
        if kept.len() == MOST_KEPT {
            kept.remove(0);
        }
        kept.push(kernel.clone());
        Ok(kernel)
    }

    fn tabulate(nu: f64) -> Self {
        let table = LayerTable::new(|t| one_minus_w(t, nu));
        let mut kernel = Self { poisson_ratio: nu, table, envelope: vec![0.0; LARGEST_RHO * ENVELOPE_STEPS] };
        let mut largest: f64 = 0.0;
        for step in (1..kernel.envelope.len()).rev() {
            largest = largest.max(kernel.value(step as f64 / ENVELOPE_STEPS as f64).abs());
            kernel.envelope[step] = largest;
        }
        kernel.envelope[0] = f64::INFINITY;
        kernel
    }

    /// φ(ρ), the smooth part, with an absolute error below 1e-11; 1/ρ beyond the table.
    pub fn smooth_part(&self, rho: f64) -> f64 {
        self.table.smooth_part(rho)
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
        self.envelope.partition_point(|&largest| largest > threshold) as f64 / ENVELOPE_STEPS as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reach_shrinks_with_the_threshold_and_holds() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        assert!(kernel.reach(1e-3) < kernel.reach(1e-6) && kernel.reach(1e-6) < 18.0);
        let reach = kernel.reach(1e-6);
        assert!((0..100).all(|i| kernel.value(reach + 0.13 * i as f64).abs() <= 1e-6));
    }
}
