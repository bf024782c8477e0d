//! What to change where a response matrix is not positive definite.

use crate::linalg::definiteness::Spectrum;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::{Kernel, KernelSkin};

impl Spectrum {
    /// Why the matrix is not positive definite and which constant to change; `None` if it is.
    pub fn advice(&self, skin: &KernelSkin) -> Option<String> {
        if self.is_positive_definite() {
            return None;
        }
        let found = format!(
            "the response matrix is not positive definite beyond rounding (smallest eigenvalue {:.1e} of the largest), so the \
             contact problem may have no solution or several",
            self.smallest / self.largest
        );
        let remedy = match skin.kernel() {
            _ if skin.basis() == PressureBasis::OneRing => {
                "pressure = one_ring is singular on regular meshes: take pressure = linear".to_string()
            }
            Kernel::GaussianCorrected { height, width, .. } => format!(
                "the Gaussian of height {height:.3e} m/N and width {width:.3e} m takes off more than K/r gives: \
                 without a cutoff a height up to {:.3e} m/N is well posed at this width, balanced and cut off at \
                 L a width from about L/2; or take a layer or half-space",
                skin.kernel_constant() * 0.5f64.exp() / width
            ),
            Kernel::Layer { thickness } => {
                let form = match skin.discretization() {
                    Discretization::Collocation => "on badly shaped flat triangles discretization = galerkin is; ",
                    Discretization::Galerkin => "",
                };
                format!(
                    "the kernel of a layer of thickness {:.3e} m is that of a flat layer: {form}where the surface \
                     bends within some 20 thicknesses, take fewer nodes, lower poisson_ratio a little, or take a \
                     body response",
                    thickness.largest()
                )
            }
            _ => "triangles near the contact are badly shaped: improve the mesh there, or take discretization = galerkin"
                .to_string(),
        };
        Some(format!("{found}; {remedy}"))
    }
}
