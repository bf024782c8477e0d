//! How far the figures of a contact can be trusted.

use crate::lcp::{Definiteness, LcpSolution};
use crate::surface::Surface;

/// How far the figures of a contact can be trusted, by source of error.
#[derive(Debug, Clone, PartialEq)]
pub struct Accuracy {
    /// Worst natural residual of the complementarity problems (dimensionless).
    pub natural_residual: f64,
    /// Worst complementarity of the complementarity problems (dimensionless).
    pub complementarity: f64,
    /// Relative quadrature tolerance of the response matrix.
    pub integration_tolerance: f64,
    /// Condition number of the response matrix, where it was estimated.
    pub condition: Option<f64>,
    /// Whether the symmetric part of every response matrix was shown to be positive definite: the answer is
    /// then the only one. `None`: not examined.
    pub definite: Option<bool>,
    /// Mesh cells per equivalent contact radius, `√(area / π) / mean edge length there`; below about 4 force and
    /// area are coarse, at 8 a sphere's force is good to 0.2 %.
    pub cells_per_radius: f64,
    /// Uncertainty of the contact area from the mesh alone: half the area of the vertices on its rim (m²).
    pub area_resolution: f64,
}

impl Accuracy {
    pub(super) fn new(
        surface: &Surface,
        node_force: &[f64],
        active: &[usize],
        contact_area: f64,
        integration_tolerance: f64,
        solutions: &[LcpSolution],
    ) -> Self {
        let worst = |value: fn(&LcpSolution) -> f64| solutions.iter().map(value).fold(0.0, f64::max);
        let mut rim_area = 0.0;
        let (mut length, mut edges) = (0.0, 0_usize);
        for &vertex in active {
            let position = surface.vertices()[vertex];
            let neighbours = surface.neighbours(vertex);
            if neighbours.iter().any(|&other| node_force[other as usize] == 0.0) {
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
            integration_tolerance,
            condition: None,
            definite: definiteness(solutions),
            cells_per_radius: if edges == 0 { 0.0 } else { radius * edges as f64 / length },
            area_resolution: 0.5 * rim_area,
        }
    }
}

/// Definite if all problems were shown to be; indefinite if one was shown not to be; else unknown.
fn definiteness(solutions: &[LcpSolution]) -> Option<bool> {
    let verdicts = || solutions.iter().map(|solution| solution.certificate.definiteness);
    if verdicts().any(|verdict| verdict == Definiteness::NotPositiveDefinite) {
        return Some(false);
    }
    let all = verdicts().all(|verdict| verdict == Definiteness::PositiveDefinite);
    (!solutions.is_empty() && all).then_some(true)
}
