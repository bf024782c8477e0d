//! Volume that the skin moves per unit force, and for which constants a kernel is well posed.

use std::f64::consts::{PI, TAU};

use crate::response::column::gaussian::SILENT_WIDTHS;
use crate::response::error::ResponseError;
use crate::response::integral::gauss::gauss_interval;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::layer::LayerKernel;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::matrix::collocation::assemble_block;
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;

/// From here on the integral of J0 has an asymptotic series (dimensionless).
const ASYMPTOTIC_FROM: f64 = 50.0;

/// Volume under the displacement of a unit force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetVolume {
    /// Dents less bulges (m³/N).
    pub net: f64,
    /// Dents and bulges added up (m³/N).
    pub gross: f64,
}

/// Volume that the mesh moves per newton at `node`: `Σ S_i R_ij` over all its vertices, S the vertex areas.
///
/// R is that of the Galerkin discretization where the kernel has it (half-space, layer): the sum is then the integral
/// of the displacement over the mesh, whatever its triangles. The Gaussian is summed as it is at the vertices.
///
/// The paper's condition (its eq. 4) asks for a net volume of 0. A half-space moves a volume that grows with
/// the mesh.
///
/// # Errors
/// As [`assemble`](crate::response::matrix::collocation::assemble).
pub fn net_volume(
    surface: &Surface,
    skin: &KernelSkin,
    node: usize,
    options: &AssemblyOptions,
) -> Result<NetVolume, ResponseError> {
    let rows: Vec<usize> = (0..surface.vertices().len()).collect();
    let galerkin = skin.clone().with_discretization(Discretization::Galerkin);
    let skin = galerkin.as_ref().unwrap_or(skin);
    let column = assemble_block(surface, skin, &rows, &[node], options)?;
    let mut volume = NetVolume { net: 0.0, gross: 0.0 };
    for (i, area) in surface.vertex_areas().iter().enumerate() {
        volume.net += area * column[(i, 0)];
        volume.gross += area * column[(i, 0)].abs();
    }
    Ok(volume)
}

/// Height a (m/N) of the Gaussian that makes the corrected kernel keep volume, eq. 5 of Xie, Kanai, Date 2011:
/// `∫_0^cutoff (K/r - a exp(-r²/2c²)) r dr = 0`.
///
/// * `kernel_constant`: K = (1-ν)/(2πG) (m²/N), > 0
/// * `width`: c (m), > 0
/// * `cutoff`: L (m), > 0, finite
///
/// # Errors
/// [`ResponseError::Constant`] names the constant that is out of range.
pub fn balanced_height(kernel_constant: f64, width: f64, cutoff: f64) -> Result<f64, ResponseError> {
    let expected = "finite and positive";
    for (name, value) in [("kernel_constant", kernel_constant), ("width", width), ("cutoff", cutoff)] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(ResponseError::Constant { name, value, expected });
        }
    }
    Ok(kernel_constant * cutoff / gaussian_integral(width, cutoff))
}

/// `∫ exp(-r²/2w²) r dr` (m²) from 0 to the cutoff (m).
fn gaussian_integral(width: f64, cutoff: f64) -> f64 {
    -(-0.5 * (cutoff / width).powi(2)).exp_m1() * width * width
}

/// `∫ f(r) dr` from 0 to `end` by a Gauss rule on each of `panels` parts.
fn in_panels(end: f64, panels: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (step, rule) = (end / panels, gauss_interval(20));
    let panel = |p: usize| rule.iter().map(move |(u, w)| (step * (p as f64 + u), w * step));
    (0..panels as usize).flat_map(panel).map(|(r, w)| w * f(r)).sum()
}

/// `∫ J0(t) dt` from 0 to x. From [`ASYMPTOTIC_FROM`] on what is missing to 1 comes from integration by parts,
/// `A_n = ∫ J0 / t²ⁿ dt from x on = -J1 / x²ⁿ + (2n+1) (J0 / x²ⁿ⁺¹ - (2n+1) A_(n+1))`, to 3e-15.
fn bessel_integral(x: f64) -> f64 {
    if x < ASYMPTOTIC_FROM {
        return in_panels(x, (x / 12.0).ceil().max(1.0), libm::j0);
    }
    let (j0, j1) = (libm::j0(x), libm::j1(x));
    let step = |next: f64, n: i32| {
        let odd = f64::from(2 * n + 1);
        -j1 * x.powi(-2 * n) + odd * (j0 * x.powi(-2 * n - 1) - odd * next)
    };
    1.0 - (0..8).rev().fold(0.0, step)
}

impl KernelSkin {
    /// Volume moved per newton on a wide flat surface (m³/N); infinite for a half-space and for a Gaussian
    /// without cutoff.
    pub fn net_volume(&self) -> f64 {
        let (g, nu) = (self.shear_modulus(), self.poisson_ratio());
        match self.kernel() {
            Kernel::GaussianCorrected { height, width, cutoff } if cutoff.is_finite() => {
                TAU * (self.kernel_constant() * cutoff - height * gaussian_integral(*width, *cutoff))
            }
            // confined compression: h / (2 G (1-ν) / (1-2ν))
            Kernel::Layer { thickness } => thickness.largest() * (1.0 - 2.0 * nu) / (2.0 * g * (1.0 - nu)),
            _ => f64::INFINITY,
        }
    }

    /// Answer of a wide flat surface to a pressure wave of wave number k = 2π / wave length (m³/N): the
    /// kernel's two-dimensional Fourier transform. Where it is negative the kernel is not well posed.
    ///
    /// * `wave_number`: k (1/m), > 0
    pub fn symbol(&self, wave_number: f64) -> f64 {
        let (k, constant) = (wave_number, self.kernel_constant());
        match self.kernel() {
            &Kernel::GaussianCorrected { height, width, cutoff } => {
                if cutoff.is_infinite() {
                    return TAU
                        * (constant / k - height * width * width * (-0.5 * (k * width).powi(2)).exp());
                }
                // panels of at most two turns of J0 or a width of the Gaussian
                let felt = cutoff.min(SILENT_WIDTHS * width);
                let panels = (felt * k / 12.0).max(felt / width).ceil().max(1.0);
                let gaussian =
                    in_panels(felt, panels, |r| r * (-0.5 * (r / width).powi(2)).exp() * libm::j0(k * r));
                TAU * (constant * bessel_integral(k * cutoff) / k - height * gaussian)
            }
            Kernel::Layer { thickness } => {
                TAU * constant / k * LayerKernel::symbol(k * thickness.largest(), self.poisson_ratio())
            }
            _ => TAU * constant / k,
        }
    }

    /// The range of wave lengths (m) at which the kernel answers a pressure with the wrong sign, if there is
    /// one: a patch about as wide can push itself in without end, and the contact problem then has no
    /// solution. The upper end is infinite where all longer waves are wrong.
    pub fn ill_posed_wavelengths(&self) -> Option<(f64, f64)> {
        let Kernel::GaussianCorrected { width, .. } = *self.kernel() else { return None };
        let wrong = |length: f64| self.symbol(2.0 * PI / length) < 0.0;
        // from half a width to 200 widths, in steps of 1 %
        let length = |i: usize| 0.5 * width * 1.01f64.powi(i as i32);
        let steps = 600;
        let first = (0..steps).find(|&i| wrong(length(i)))?;
        let last = (0..steps).rfind(|&i| wrong(length(i)))?;
        // the end between a right and a wrong length
        let end = |mut right: f64, mut bad: f64| {
            for _ in 0..40 {
                let middle = 0.5 * (right + bad);
                if wrong(middle) { bad = middle } else { right = middle }
            }
            bad
        };
        let from = if first == 0 { length(0) } else { end(length(first - 1), length(first)) };
        let to = if last + 1 == steps { f64::INFINITY } else { end(length(last + 1), length(last)) };
        Some((from, to))
    }

    /// A warning about constants for which the kernel is not well posed, with what to change; `None` for all
    /// others. [`KernelSkin::ill_posed_wavelengths`] has the numbers.
    pub fn ill_posedness(&self) -> Option<String> {
        let Kernel::GaussianCorrected { height, width, cutoff } = *self.kernel() else { return None };
        let (from, to) = self.ill_posed_wavelengths()?;
        let range = if to.is_finite() {
            format!("from {:.1} to {:.1} mm", 1e3 * from, 1e3 * to)
        } else {
            format!("above {:.1} mm", 1e3 * from)
        };
        let bound = self.kernel_constant() * 0.5f64.exp() / width;
        Some(format!(
            "the Gaussian-corrected kernel (height {height:.3e} m/N, width {width:.3e} m, cutoff {cutoff:.3e} m) is \
             not well posed: wave lengths {range} are pushed in by an outward pressure, so contacts of that \
             width can end on a ray. Without cutoff a height up to K exp(1/2) / width = {bound:.3e} m/N is well \
             posed; balanced and cut off at L, a width from about L / 2; or take a layer or half-space"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_of_j0_goes_on_in_its_asymptotic_series() {
        for x in [50.0, 51.3, 80.0, 400.0] {
            let quadrature = in_panels(x, (x / 4.0_f64).ceil(), libm::j0);
            assert!((bessel_integral(x) - quadrature).abs() < 1e-13, "at {x}");
        }
        assert!((bessel_integral(1e300) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_answer_to_a_wave_does_not_know_how_far_the_cutoff_is() {
        let symbol = |cutoff| {
            let kernel = Kernel::GaussianCorrected { height: 1e-4, width: 5e-3, cutoff };
            KernelSkin::new(60e3, 0.5, kernel).expect("valid constants").symbol(700.0)
        };
        // What is missing of the half-space falls with the root of the cutoff.
        let whole = symbol(f64::INFINITY);
        for cutoff in [1.0, 1e3, 1e9, 1e30] {
            let missing = (2.0 / (PI * 700.0 * cutoff)).sqrt();
            assert!((symbol(cutoff) / whole - 1.0).abs() < 2.0 * missing + 1e-13, "cutoff {cutoff}");
        }
    }
}
