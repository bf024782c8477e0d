//! The compliance of a body from its near kernel and the remainder.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::mesh::distinct::distinct;
use crate::response::body::check::parts::{Range, check_counts, check_numbers, check_order, components};
use crate::response::body::compliance::BodyCompliance;
use crate::response::body::error::BodyError;
use crate::response::body::levels::gathered::Gathered;
use crate::response::body::levels::near::NearKernel;
use crate::response::body::levels::on_mesh::{NearAndFar, Weights};
use crate::response::body::levels::remainder::Remainder;
use crate::response::body::levels::sizing::coarse_bone;
use crate::response::body::options::BodyOptions;
use crate::response::body::solve::Body;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;
use crate::surface::coarse::{CoarsePlace, CoarseSkin};

/// Least relative error of the integral over one face of the coarse mesh: it changes a force by some 5e-6 of it, far less
/// than that mesh does.
const COARSE_TOLERANCE: f64 = 1e-3;

/// A body on two levels: everything in it, to store it and to build it again.
#[derive(Debug, Clone)]
pub struct TwoLevels {
    /// `B_coarse - N_coarse` at the vertices of the coarse skin, per newton at some of them.
    pub remainder: BodyCompliance,
    /// Where each vertex of the skin lies on the coarse one (n).
    pub places: Arc<[CoarsePlace]>,
    /// Thickness of the tissue at each vertex of the skin (n, m); `None` where nothing is behind it.
    pub thickness: Option<Arc<[f64]>>,
    /// Length of the coarse skin's edges at each vertex of the skin (n, m).
    pub coarse_edges: Arc<[f64]>,
    /// Vertices of the skin that do not move (n).
    pub fixed: Arc<[bool]>,
    weights: Arc<[Option<Weights>]>,
    near: NearKernel,
    /// What contacts asked of the remainder.
    gathered: Gathered,
}

impl TwoLevels {
    /// Builds it from its parts.
    ///
    /// # Errors
    /// [`ResponseError::Body`]: sizes that do not belong together, nodes that do not ascend, numbers out of range;
    /// [`ResponseError::Constant`]: a thickness that is none.
    pub fn from_parts(
        remainder: BodyCompliance,
        places: Arc<[CoarsePlace]>,
        thickness: Option<Arc<[f64]>>,
        coarse_edges: Arc<[f64]>,
        fixed: Arc<[bool]>,
    ) -> Result<Self, ResponseError> {
        let count = places.len();
        check_counts(&[
            ("fixed", fixed.len(), count),
            ("coarse edges", coarse_edges.len(), count),
            ("thickness", thickness.as_ref().map_or(count, |t| t.len()), count),
        ])?;
        let weights: Vec<[f64; 3]> = places.iter().map(|place| place.weights).collect();
        let sums = weights.iter().map(|weights| weights.iter().sum()).enumerate();
        check_numbers("coarse weights", Range::NotNegative, components(&weights))?;
        check_numbers("sums of coarse weights", Range::One, sums)?;
        check_numbers("coarse edges", Range::Positive, coarse_edges.iter().copied().enumerate())?;
        let mut ascending = remainder.nodes().to_vec();
        ascending.sort_unstable();
        check_order(remainder.nodes(), &ascending)?;
        let coarse_count = remainder.vertex_count();
        let corner = places.iter().flat_map(|place| place.corners).max().unwrap_or(0) as usize;
        if corner >= coarse_count {
            return Err(BodyError::Parts {
                what: "coarse vertices",
                found: coarse_count,
                expected: corner + 1,
            }
            .into());
        }
        let (modulus, ratio) = (remainder.parts().shear_modulus, remainder.parts().poisson_ratio);
        let near = NearKernel::new(modulus, ratio, thickness.clone())?;
        let weights = places.iter().map(|place| Some(place.weights_of_corners().collect())).collect();
        Ok(Self {
            remainder,
            places,
            thickness,
            coarse_edges,
            fixed,
            weights,
            near,
            gathered: Gathered::default(),
        })
    }

    /// Solves `body` on its coarse skin.
    ///
    /// * `fixed`: vertices of the skin that do not move (n)
    /// * `nodes`: vertices of the skin that may be loaded
    pub(crate) fn solve(
        body: &Body,
        skin: &Surface,
        coarse: CoarseSkin,
        fixed: &[bool],
        [shear_modulus, poisson_ratio]: [f64; 2],
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<Self, ResponseError> {
        let held: Vec<bool> = coarse.fine_vertices.iter().map(|&vertex| fixed[vertex]).collect();
        let columns = loaded_corners(&coarse, nodes);
        let loaded: Vec<usize> = columns.iter().copied().filter(|&column| !held[column]).collect();
        let coarse_body = Body {
            bone: body.bone.as_ref().map(|bone| {
                // The pressure on a bone is wanted at its own vertices.
                if options.bone_pressure { bone.clone() } else { coarse_bone(bone, &coarse.surface) }
            }),
            fixed: body.fixed.as_ref().map(|_| held),
            coarse_edge_length: Some(0.0),
        };
        let options = &BodyOptions { tolerance: options.tolerance.max(COARSE_TOLERANCE), ..*options };
        // Single precision changes a force by less than 1e-6 of it, and takes half the memory.
        let mut solved = coarse_body.prepare_in::<f32>(
            &coarse.surface,
            [shear_modulus, poisson_ratio],
            &loaded,
            &columns,
            options,
        )?;

        let thickness = body.tissue_thickness(skin, fixed);
        // The vertices of the coarse skin lie outside the skin, the coarse skin as a whole does not.
        let on_coarse = thickness.as_ref().map(|list| coarse.means(list).into());
        let near = NearKernel::new(shear_modulus, poisson_ratio, on_coarse)?;
        let assembly = AssemblyOptions {
            tolerance: options.tolerance,
            interrupt: options.interrupt,
            ..AssemblyOptions::default()
        };
        take_off(&mut solved.displacement, &near, &coarse.surface, &columns, &assembly)?;
        let remainder = BodyCompliance::new(solved);
        let edges = coarse.surface.mean_edges();
        let edge = |place: &CoarsePlace| -> f64 {
            place.weights_of_corners().map(|(corner, weight)| weight * edges[corner as usize]).sum()
        };
        let coarse_edges = coarse.places.iter().map(edge).collect();
        let places = coarse.places.into();
        Self::from_parts(remainder, places, thickness.map(Into::into), coarse_edges, fixed.into())
    }

    /// The same after a turn of the skin.
    ///
    /// # Errors
    /// [`BodyError::Rotation`].
    pub(crate) fn moved(&self, rotation: &Matrix3<f64>) -> Result<Self, BodyError> {
        Ok(Self { remainder: self.remainder.moved(rotation)?, ..self.clone() })
    }

    /// On the skin's own mesh.
    pub(crate) fn near_and_far(&self, discretization: Discretization) -> NearAndFar {
        let remainder = Remainder::new(&self.remainder, None, self.gathered.clone());
        let (weights, fixed) = (Arc::clone(&self.weights), Arc::clone(&self.fixed));
        NearAndFar::new(remainder, weights, fixed, self.near.clone(), discretization)
    }

    /// Whether forces at `nodes` are answered.
    ///
    /// # Errors
    /// [`BodyError::NoColumn`].
    pub(crate) fn check_columns(&self, nodes: &[usize]) -> Result<(), BodyError> {
        for &vertex in nodes {
            for (corner, _) in self.places[vertex].weights_of_corners() {
                let coarse_vertex = corner as usize;
                if self.remainder.nodes().binary_search(&coarse_vertex).is_err() {
                    return Err(BodyError::NoColumn { vertex, coarse_vertex });
                }
            }
        }
        Ok(())
    }

    /// Forces (N) at the loaded vertices of the coarse skin that stand for those at `nodes`.
    pub(crate) fn on_coarse(&self, nodes: &[usize], forces: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let column = |vertex: usize| {
            self.remainder
                .nodes()
                .binary_search(&vertex)
                .expect("the coarse skin was solved around every node")
        };
        let mut spread = vec![Vector3::zeros(); self.remainder.nodes().len()];
        for (&vertex, force) in nodes.iter().zip(forces) {
            for (corner, weight) in self.places[vertex].weights_of_corners() {
                spread[column(corner as usize)] += weight * force;
            }
        }
        spread
    }
}

/// Takes N off B (3 n × 3 k, m/N) at every vertex of the coarse skin per newton at its vertices `columns`.
fn take_off(
    displacement: &mut Mat<f64>,
    near: &NearKernel,
    coarse: &Surface,
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<(), ResponseError> {
    let everywhere: Vec<usize> = (0..coarse.vertices().len()).collect();
    let near = near.blocks(coarse, &everywhere, columns, options)?;
    displacement.par_col_chunks_mut(3).enumerate().for_each(|(column, mut entries)| {
        for row in 0..everywhere.len() {
            let block = near.block(row, column);
            for (a, b) in (0..3).flat_map(|b| (0..3).map(move |a| (a, b))) {
                entries[(3 * row + a, b)] -= block[(a, b)];
            }
        }
    });
    Ok(())
}

/// Vertices of the coarse skin that forces at some vertices of the fine one are passed on to, ascending.
fn loaded_corners(coarse: &CoarseSkin, nodes: &[usize]) -> Vec<usize> {
    let corners = nodes.iter().flat_map(|&vertex| coarse.places[vertex].weights_of_corners());
    distinct(corners.map(|(corner, _)| corner as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::icosphere;

    #[test]
    fn single_precision_is_far_finer_than_the_coarse_mesh() {
        let ball = |radius: f64, halvings| {
            let (vertices, faces) = icosphere(radius, halvings);
            Surface::new(vertices, faces).expect("a ball")
        };
        let skin = ball(8e-3, 2);
        let body = Body { bone: Some(ball(3e-3, 1)), coarse_edge_length: Some(0.0), ..Body::default() };
        for poisson_ratio in [0.0, 0.3, 0.499, 0.5] {
            let constants = [60e3, poisson_ratio];
            let options = BodyOptions { bone_pressure: true, ..BodyOptions::default() };
            let nodes = [3, 40, 100];
            let double = body.prepare_in::<f64>(&skin, constants, &nodes, &nodes, &options).expect("a body");
            let single = body.prepare_in::<f32>(&skin, constants, &nodes, &nodes, &options).expect("a body");
            let pressures = [&double, &single].map(|parts| parts.bone_pressure.as_ref().expect("asked for"));
            for [double, single] in [[&double.displacement, &single.displacement], pressures] {
                let error = (single - double).norm_max() / double.norm_max();
                assert!(error > 0.0 && error < 1e-5, "{error:.1e} at {poisson_ratio}");
            }
        }
    }
}
