//! The largest answer of a kernel to a pressure wave, against which a relative threshold is measured.

use super::super::layer::LayerKernel;
use super::super::rule::gauss;
use super::super::skin::{Response, Skin};
use std::f64::consts::TAU;

/// Wave numbers, times the kernel's own length, at which its answer is looked at.
const WAVES: [f64; 12] = [0.1, 0.5, 1.0, 1.3, 1.6, 2.0, 2.5, 3.0, 4.0, 6.0, 9.0, 14.0];

/// Norm of the response matrix of a wide surface times the area of a node, `max_k |∫ u(r) J0(k r) 2π r dr|` (m³/N),
/// over the reach (m): never too large, as only some wave numbers k are looked at.
///
/// * `reach`: the skin's, of its thickest part (m)
pub(super) fn norm_over_reach(skin: &Skin, reach: f64) -> f64 {
    let constant = skin.kernel_constant();
    match &skin.response {
        Response::Layer { thickness, .. } => {
            // (1-ν) W(kh) / (G k) = 2π K h W(t) / t
            let answer = |t: f64| LayerKernel::symbol(t, skin.poisson_ratio) / t;
            TAU * constant * thickness.largest() / reach * WAVES.into_iter().map(answer).fold(0.0, f64::max)
        }
        Response::GaussianCorrected { height, width, cutoff, .. } => {
            let rule = gauss(60, 0.0);
            let answer = |wave: f64| -> f64 {
                let integrand = |r: f64| {
                    let kernel = constant - height * r * (-0.5 * (r / width).powi(2)).exp();
                    kernel * libm::j0(wave * r / cutoff)
                };
                rule.iter().map(|(t, weight)| weight * integrand(t * cutoff)).sum::<f64>().abs()
            };
            TAU * WAVES.into_iter().map(answer).fold(0.0, f64::max)
        }
        Response::HalfSpace { .. } => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::skin::{Gap, Pressure};
    use super::*;

    #[test]
    fn without_a_gaussian_the_wave_of_no_length_sees_the_whole_volume() {
        // ∫_0^L K/r 2π r dr = 2π K L is the largest answer of a kernel without change of sign
        let cutoff = 3e-3;
        let response =
            Response::GaussianCorrected { height: 0.0, width: 1e-3, cutoff, pressure: Pressure::Linear };
        let skin = Skin::new(60e3, 0.5, response).expect("valid constants");
        let found = norm_over_reach(&skin, cutoff) / (TAU * skin.kernel_constant());
        assert!(found <= 1.0 && found > 0.99, "{found}");
    }

    #[test]
    fn a_layer_answers_a_wave_of_some_four_thicknesses_most() {
        let response = Response::Layer { thickness: 2e-3.into(), pressure: Pressure::Linear, gap: Gap::Node };
        let skin = Skin::new(60e3, 0.5, response).expect("valid constants");
        let found = norm_over_reach(&skin, 2e-3) / (TAU * skin.kernel_constant());
        let fine = (1..4000).map(|i| 0.005 * i as f64).map(|t| LayerKernel::symbol(t, 0.5) / t);
        let most = fine.fold(0.0, f64::max);
        assert!(found <= most && found > 0.95 * most, "{found} {most}");
    }
}
