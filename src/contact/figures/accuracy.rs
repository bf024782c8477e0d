//! How far the figures of a contact can be trusted.

use crate::contact::equilibrium::forces::NodeForces;
use crate::lcp::solution::LcpSolution;
use crate::linalg::definiteness::{Definiteness, Spectrum};
use crate::surface::checked::Surface;

/// How far the figures of a contact can be trusted, by source of error.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Worst natural residual of the complementarity problems (dimensionless).
    pub natural_residual: f64,
    /// Worst complementarity of the complementarity problems (dimensionless).
    pub complementarity: f64,
    /// Relative quadrature tolerance of the response matrix.
    pub integration_tolerance: f64,
    /// Largest condition number of the response matrices' symmetric parts, where they were examined.
    pub condition: Option<f64>,
    /// Whether the symmetric part of every response matrix was shown to be positive definite: the answer is
    /// then the only one. `None`: not examined.
    pub definite: Option<bool>,
    /// Mesh cells per equivalent contact radius, `√(area / π) / mean edge length there`; below about 4 force and
    /// area are coarse, at 8 a sphere's force is good to 0.2 %.
    pub cells_per_radius: f64,
    /// Uncertainty of the contact area from the mesh alone: half the area of the vertices on its rim (m²). In Galerkin
    /// form the rim is found between vertices, and the area is several times as good.
    pub area_resolution: f64,
}

impl Accuracy {
    pub(crate) fn new(surface: &Surface, forces: &NodeForces, contact_area: f64, tolerance: f64) -> Self {
        let solutions = &forces.solutions;
        let worst = |value: fn(&LcpSolution) -> f64| solutions.iter().map(value).fold(0.0, f64::max);
        let mut rim_area = 0.0;
        let (mut length, mut edges) = (0.0, 0_usize);
        for &vertex in &forces.active {
            let position = surface.vertices()[vertex];
            let neighbours = surface.neighbours(vertex);
            if neighbours.iter().any(|&other| forces.force[other as usize] == 0.0) {
                rim_area += surface.vertex_areas()[vertex];
            }
            length += neighbours
                .iter()
                .map(|&other| (surface.vertices()[other as usize] - position).norm())
                .sum::<f64>();
            edges += neighbours.len();
        }
        let radius = (contact_area / std::f64::consts::PI).sqrt();
        Self {
            natural_residual: worst(|solution| solution.natural_residual),
            complementarity: worst(|solution| solution.complementarity),
            integration_tolerance: tolerance,
            condition: worst_condition(&forces.spectra),
            definite: definite(solutions, &forces.spectra),
            cells_per_radius: if edges == 0 { 0.0 } else { radius * edges as f64 / length },
            area_resolution: 0.5 * rim_area,
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
