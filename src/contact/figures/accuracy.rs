//! How far the figures of a contact can be trusted.

use crate::lcp::certificate::Certificate;
use crate::lcp::solution::LcpSolution;
use crate::linalg::definiteness::{Definiteness, Spectrum};
use crate::response::kernel::basis::Discretization;

/// How far the figures of a contact can be trusted, by source of error.
///
/// Estimated are the errors of meshes. What the response leaves out, as the bone under a half-space, is not among them; nor
/// are the shapes that the given meshes stand for.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Worst natural residual of the complementarity problems (dimensionless).
    pub natural_residual: f64,
    /// Worst complementarity of the complementarity problems (dimensionless).
    pub complementarity: f64,
    /// Largest error of an entry of the response matrix from numerical integration, over the half-space's.
    pub integration_tolerance: f64,
    /// How gaps were taken on the mesh that was solved.
    pub discretization: Discretization,
    /// Largest condition number of the response matrices' symmetric parts, where all were examined.
    pub condition: Option<f64>,
    /// Whether the symmetric part of every response matrix was shown to be positive definite: the answer is
    /// then the only one. False of one that is singular to rounding, too; `None`: not examined.
    pub definite: Option<bool>,
    /// Mesh cells per contact radius, which is twice the area over the length of the rim: a circle's radius, the width
    /// of a strip, and of several patches alike that of one. Below about 4 force and area are coarse, at 8 a sphere's
    /// force is good to 0.2 %.
    pub cells_per_radius: f64,
    /// Estimated error of the force over its length: [`mesh_error`](Self::mesh_error) and
    /// [`body_error`](Self::body_error). `None`, here and below, where no estimate was made.
    pub force_error: Option<f64>,
    /// What the mesh around the contact costs of that.
    pub mesh_error: Option<f64>,
    /// What the coarse mesh of a body costs of that, and that which the matrix of a product is given on; 0 of a kernel.
    pub body_error: Option<f64>,
    /// Estimated error of the contact area over it, with what the body's mesh costs it.
    pub area_error: Option<f64>,
    /// Estimated error of the largest pressure over it, with what cells a quarter as large would add where facets of the
    /// obstacle meet, and how far it stands out from what is beside it; infinite where a sharp edge carries force, or a vertex at a
    /// cut.
    pub max_pressure_error: Option<f64>,
}

impl Accuracy {
    /// Of solved problems, and what they were posed with.
    ///
    /// * `spectra`: of the problems' matrices, where they were examined
    pub(crate) fn new(
        solutions: &[LcpSolution],
        spectra: &[Option<Spectrum>],
        tolerance: f64,
        discretization: Discretization,
        cells_per_radius: f64,
    ) -> Self {
        let certificates = || solutions.iter().map(|solution| &solution.certificate);
        let worst = |value: fn(&Certificate) -> f64| certificates().map(value).fold(0.0, f64::max);
        Self {
            natural_residual: worst(|certificate| certificate.natural_residual),
            complementarity: worst(|certificate| certificate.complementarity),
            integration_tolerance: tolerance,
            discretization,
            condition: worst_condition(spectra),
            definite: definite(solutions, spectra),
            cells_per_radius,
            force_error: None,
            mesh_error: None,
            body_error: None,
            area_error: None,
            max_pressure_error: None,
        }
    }
}

/// The largest condition number, where all matrices were examined.
fn worst_condition(spectra: &[Option<Spectrum>]) -> Option<f64> {
    let conditions: Option<Vec<f64>> = spectra.iter().map(|one| one.map(|one| one.condition)).collect();
    conditions.filter(|all| !all.is_empty()).map(|all| all.into_iter().fold(0.0, f64::max))
}

/// Definite if all matrices were shown to be; indefinite if one was shown not to be, or examined in vain; else
/// unknown.
fn definite(solutions: &[LcpSolution], spectra: &[Option<Spectrum>]) -> Option<bool> {
    let verdict =
        |(solution, spectrum): (&LcpSolution, &Option<Spectrum>)| match solution.certificate.definiteness {
            Definiteness::PositiveDefinite => Some(true),
            Definiteness::NotPositiveDefinite => Some(false),
            Definiteness::Unknown => spectrum.map(|_| false),
        };
    let verdicts: Vec<Option<bool>> = solutions.iter().zip(spectra).map(verdict).collect();
    if verdicts.contains(&Some(false)) {
        return Some(false);
    }
    (!verdicts.is_empty() && verdicts.iter().all(|verdict| *verdict == Some(true))).then_some(true)
}
