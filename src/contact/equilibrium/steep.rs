//! Force on sides of the obstacle that are steep to the skin, where the linear answer is a guess.

use crate::contact::equilibrium::forces::NodeForces;
use crate::surface::checked::Surface;

/// Cosine between force and outward normal of the skin from which a vertex is pulled.
pub(crate) const PULLING_COSINE: f64 = 0.5;
/// Share of the force that steep sides may carry: between that of a ball at a depth of its radius, whose force rises with the
/// depth as it should, and at 1.25 radii, where it is about to fall.
pub(crate) const MOST_STEEP: f64 = 0.15;

/// Cosine between force and inward normal of the skin below which the obstacle stands steep there, at 60 degrees.
const STEEP_COSINE: f64 = 0.5;

/// Share of the force that stands on sides steeper than 60 degrees to the skin; nan without force.
pub(crate) fn steep_share(surface: &Surface, forces: &NodeForces) -> f64 {
    let outward = surface.vertex_normals();
    let (mut all, mut steep) = (0.0, 0.0);
    for &vertex in &forces.active {
        let force = forces.vectors[vertex];
        all += force.norm();
        // Beyond it is pulled.
        let cosine = -force.dot(&outward[vertex]) / force.norm();
        if (-PULLING_COSINE..STEEP_COSINE).contains(&cosine) {
            steep += force.norm();
        }
    }
    steep / all
}
