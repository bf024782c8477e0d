//! How coarse the mesh of a body is for its tissue, and what that costs.

use std::sync::Arc;

use nalgebra::Vector3;

use crate::mesh::distinct::distinct;
use crate::response::body::levels::thickness::mean_thickness;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Relative error of the force where the edges are as long as the tissue is thick; it falls with their square.
/// Fitted with [`ERROR_PER_LOSS`] to balls all over a hand's palm and digits (docs/measured_once.md).
const ERROR_AT_THICKNESS: f64 = 0.06;

/// Relative error of the force per share of the depth that interpolation between the body's vertices loses there.
const ERROR_PER_LOSS: f64 = 0.4;

/// Tissue counts as no thicker than so many mean thicknesses of the body: fitted to balls and ellipsoids of which a part is held.
const MOST_THICKNESSES: f64 = 1.3;

/// How much more of the former compressible tissue costs, times `(1 - 2 ν)³`: the near kernel is that of flat skin, and on curved
/// skin such tissue has more that is not smooth. Fitted to plates on balls with a core.
const COMPRESSIBLE_ERROR: f64 = 3.0;

/// What the mesh that a body was solved on, or that a matrix is given on, costs a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyDoubt {
    /// Estimated error of the force over its length.
    pub force_error: f64,
    /// Mean length of the body's edges at the contact (m).
    pub edge_length: f64,
}

/// Displacement (m) that linear interpolation between coarse vertices loses: its mean over the forces.
///
/// What is linear moves a coarse vertex as its neighbours on average. What it moves the vertex beyond that is what the
/// coarse mesh does not resolve.
///
/// * `weights`: of the coarse vertices at each node, by their numbers
/// * `forces`: at the nodes (N)
/// * `moved`: how far the first coarse vertex moves along a force on the second (m)
pub(crate) fn lost_displacement(
    coarse_count: usize,
    weights: &[Vec<(usize, f64)>],
    forces: &[Vector3<f64>],
    moved: impl Fn(usize, usize, &Vector3<f64>) -> f64,
) -> f64 {
    let mut spread = vec![Vector3::zeros(); coarse_count];
    let mut beside = vec![Vec::new(); coarse_count];
    for (around, force) in weights.iter().zip(forces) {
        for &(coarse, weight) in around {
            spread[coarse] += weight * force;
            beside[coarse].extend(around.iter().map(|other| other.0).filter(|&other| other != coarse));
        }
    }
    let (mut sum, mut total) = (0.0, 0.0);
    for (own, (force, others)) in spread.iter().zip(beside).enumerate() {
        let others = distinct(others);
        let size = force.norm();
        if size > 0.0 && !others.is_empty() {
            let mean = others.iter().map(|&row| moved(row, own, force)).sum::<f64>() / others.len() as f64;
            sum += size * (moved(own, own, force) - mean).abs();
        }
        total += size;
    }
    sum / total
}

/// Edges of the mesh that a body was solved on, and the tissue's thickness, at each vertex of the skin (n, m).
#[derive(Debug, Clone)]
pub(crate) struct Coarseness {
    edges: Arc<[f64]>,
    thickness: Arc<[f64]>,
    poisson_ratio: f64,
}

impl Coarseness {
    /// * `thickness`: `None` where nothing is behind the tissue
    pub fn new(
        skin: &Surface,
        edges: Arc<[f64]>,
        thickness: Option<&Arc<[f64]>>,
        poisson_ratio: f64,
    ) -> Self {
        let mean = mean_thickness(skin);
        let thickness = match thickness {
            Some(known) => known.iter().map(|known| known.min(MOST_THICKNESSES * mean)).collect(),
            None => vec![mean; edges.len()].into(),
        };
        Self { edges, thickness, poisson_ratio }
    }

    /// On a refinement of the skin, or of a skin that this one is a part of.
    ///
    /// * `own`: vertex of this skin for a given vertex
    pub fn on_refined(&self, mesh: &RefinedSurface, own: impl Fn(usize) -> Option<usize>) -> Self {
        let inherited = |values: &[f64]| {
            mesh.inherit(|vertex| own(vertex).map_or(f64::NAN, |own| values[own]), |a, b| 0.5 * (a + b))
                .into()
        };
        Self { edges: inherited(&self.edges), thickness: inherited(&self.thickness), ..*self }
    }

    /// What it costs a contact: the mean over the forces (N) at `nodes`.
    ///
    /// * `loss`: displacement that interpolation between the body's vertices loses there, over the depth of the contact
    pub fn doubt(&self, nodes: &[usize], forces: &[Vector3<f64>], loss: f64) -> BodyDoubt {
        let total: f64 = forces.iter().map(|force| force.norm()).sum();
        let mean = |value: &dyn Fn(usize) -> f64| {
            nodes.iter().zip(forces).map(|(&node, force)| value(node) * force.norm()).sum::<f64>() / total
        };
        let at_thickness =
            ERROR_AT_THICKNESS * (1.0 + COMPRESSIBLE_ERROR * (1.0 - 2.0 * self.poisson_ratio).powi(3));
        BodyDoubt {
            force_error: ERROR_PER_LOSS * loss
                + at_thickness * mean(&|node| (self.edges[node] / self.thickness[node]).powi(2)),
            edge_length: mean(&|node| self.edges[node]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::icosphere;

    #[test]
    fn tissue_with_nothing_near_behind_it_is_no_better_known_than_the_body_is_thick() {
        let (vertices, faces) = icosphere(8e-3, 1);
        let skin = Surface::new(vertices, faces).expect("a ball");
        let mean = mean_thickness(&skin);
        let count = skin.vertices().len();
        let error_at = |thickness: f64| {
            let edges = vec![0.5 * mean; count].into();
            let coarseness = Coarseness::new(&skin, edges, Some(&vec![thickness; count].into()), 0.5);
            coarseness.doubt(&[0], &[Vector3::z()], 0.0).force_error
        };
        assert!((error_at(mean) / error_at(0.5 * mean) - 0.25).abs() < 1e-12);
        assert_eq!(error_at(1.5 * mean), error_at(3.0 * mean));
    }
}
