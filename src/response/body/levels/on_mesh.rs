//! A body's response on a mesh finer than the one that it was solved on.

use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::columns::par_columns;
use crate::linalg::kernels;
use crate::mesh::distinct::distinct;
use crate::response::body::levels::coarseness::{Coarseness, lost_displacement};
use crate::response::body::levels::near::NearKernel;
use crate::response::body::levels::remainder::Remainder;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::matrix::kept_block::KeptBlock;
use crate::response::skin::elastic::Request;
use crate::response::skin::kernel::ROWS_AT_ONCE;
use crate::surface::refined::RefinedSurface;

/// Weights of coarse vertices that give the value at a vertex of the fine mesh, with sum 1.
pub(crate) type Weights = Vec<(u32, f64)>;

/// Weights at the middle of an edge from those at its ends.
fn joined(a: &Option<Weights>, b: &Option<Weights>) -> Option<Weights> {
    let (a, b) = (a.as_ref()?, b.as_ref()?);
    let mut both: Weights = a.iter().chain(b).map(|&(coarse, weight)| (coarse, 0.5 * weight)).collect();
    both.sort_unstable_by_key(|&(coarse, _)| coarse);
    both.dedup_by(|next, kept| {
        let is_same = next.0 == kept.0;
        kept.1 += if is_same { next.1 } else { 0.0 };
        is_same
    });
    Some(both)
}

/// A body on a refined mesh.
#[derive(Debug, Clone)]
pub(crate) struct BodyOnMesh {
    pub response: NearAndFar,
    pub coarseness: Coarseness,
}

/// The near kernel on a mesh, and the remainder from the coarse mesh.
#[derive(Debug, Clone)]
pub(crate) struct NearAndFar {
    pub remainder: Remainder,
    /// Weights of the coarse vertices at each vertex (n); `None` where the body does not answer.
    pub weights: Arc<[Option<Weights>]>,
    /// Vertices that do not move (n).
    pub fixed: Arc<[bool]>,
    pub near: NearKernel,
    /// How R takes the near kernel; the remainder is smooth, and taken at the nodes.
    pub discretization: Discretization,
    /// What is known of the near kernel at vertices of this mesh.
    pub kept: KeptBlock,
    /// What is known of it as R takes it, where that is not at vertices.
    pub averaged: KeptBlock,
}

impl NearAndFar {
    /// Nothing is known of the near kernel yet.
    pub fn new(
        remainder: Remainder,
        weights: Arc<[Option<Weights>]>,
        fixed: Arc<[bool]>,
        near: NearKernel,
        discretization: Discretization,
    ) -> Self {
        let (kept, averaged) = (KeptBlock::default(), KeptBlock::default());
        Self { remainder, weights, fixed, near, discretization, kept, averaged }
    }

    /// On a refinement of its mesh, or of a mesh that its own is a part of.
    ///
    /// * `own`: vertex of its mesh for a given vertex
    pub fn on_refined(
        &self,
        mesh: &RefinedSurface,
        own: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self, ResponseError> {
        let weights = mesh.inherit(|vertex| self.weights[own(vertex)?].clone(), joined).into();
        let is_fixed = |vertex| own(vertex).is_none_or(|own| self.fixed[own]);
        let fixed = mesh.inherit(is_fixed, |a, b| *a && *b).into();
        let near = self.near.on_refined(mesh, own)?;
        Ok(Self::new(self.remainder.clone(), weights, fixed, near, self.discretization))
    }

    /// Whether the response to a force at `vertex` is known.
    pub fn is_prepared(&self, vertex: usize) -> bool {
        let known = |weights: &Weights| weights.iter().all(|&(coarse, _)| self.remainder.is_loaded(coarse));
        self.weights[vertex].as_ref().is_some_and(known)
    }

    fn weights(&self, vertex: usize) -> &[(u32, f64)] {
        self.weights[vertex].as_deref().unwrap_or_default()
    }

    /// Coarse vertices that some vertices depend on, ascending.
    fn support(&self, vertices: &[usize]) -> Vec<usize> {
        let all = vertices.iter().flat_map(|&vertex| self.weights(vertex));
        distinct(all.map(|&(coarse, _)| coarse as usize))
    }

    /// Displacement (m) that interpolation between coarse vertices loses at the nodes: its mean over the forces (N).
    pub fn lost_displacement(&self, asked: &Request, forces: &[Vector3<f64>]) -> Result<f64, ResponseError> {
        let support = self.support(asked.nodes);
        let at = |coarse: u32| support.binary_search(&(coarse as usize)).expect("a vertex of the support");
        let own = |&vertex: &usize| {
            self.weights(vertex).iter().map(|&(coarse, weight)| (at(coarse), weight)).collect()
        };
        let weights: Vec<Vec<(usize, f64)>> = asked.nodes.iter().map(own).collect();
        let forces: Vec<Vector3<f64>> =
            forces.iter().map(|force| self.remainder.turned_back(force)).collect();
        let blocks = self.remainder.between(&support, &support, asked.options)?;
        let moved = |row: usize, column: usize, force: &Vector3<f64>| {
            let [row, column] = [blocks.rows.of(support[row]), blocks.columns.of(support[column])];
            force.dot(&(blocks.block(row, column) * force)) / force.norm()
        };
        Ok(lost_displacement(support.len(), &weights, &forces, moved))
    }

    /// # Errors
    /// [`ResponseError::NotPrepared`].
    pub fn check_nodes(&self, nodes: &[usize]) -> Result<(), ResponseError> {
        let unknown = |vertex: &&usize| !self.is_prepared(**vertex);
        match nodes.iter().find(unknown) {
            Some(&vertex) => Err(ResponseError::NotPrepared {
                vertex,
                missing: nodes.iter().filter(unknown).count(),
                prepared: self.remainder.loaded_count(),
            }),
            None => Ok(()),
        }
    }

    /// R over the nodes along `directions` (k × k, m/N).
    pub fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let nodes = asked.nodes;
        let support = self.support(nodes);
        let blocks = self.remainder.between(&support, &support, asked.options)?;
        // A node hangs on a few coarse vertices, so that most of a dense product would be with 0.
        let spread = |place: &dyn Fn(usize) -> usize| -> Vec<Vec<(usize, f64)>> {
            let terms = |(&vertex, direction): (&usize, &Vector3<f64>)| {
                let direction = self.remainder.turned_back(direction);
                let along = |&(coarse, weight): &(u32, f64)| {
                    let first = 3 * place(coarse as usize);
                    (0..3).map(move |axis| (first + axis, weight * direction[axis]))
                };
                self.weights(vertex).iter().flat_map(along).collect()
            };
            nodes.iter().zip(directions).map(terms).collect()
        };
        let in_rows = spread(&|coarse| blocks.rows.of(coarse));
        let in_support = spread(&|coarse| support.binary_search(&coarse).expect("a vertex of the support"));
        let mut half = Mat::<f64>::zeros(nodes.len(), 3 * support.len());
        par_columns(&mut half).enumerate().for_each(|(column, half)| {
            let column_there = 3 * blocks.columns.of(support[column / 3]) + column % 3;
            let moved = blocks.entries.col_as_slice(column_there);
            let along =
                |terms: &Vec<(usize, f64)>| terms.iter().map(|&(row, share)| share * moved[row]).sum();
            half.iter_mut().zip(&in_rows).for_each(|(entry, terms)| *entry = along(terms));
        });
        let kept = match self.discretization {
            Discretization::Collocation => &self.kept,
            Discretization::Galerkin => &self.averaged,
        };
        let mut response = self.near.along(asked, directions, self.discretization, kept)?;
        par_columns(&mut response).zip(&in_support).for_each(|(column, terms)| {
            kernels::add_terms(column, terms.len(), |k| (half.col_as_slice(terms[k].0), terms[k].1));
        });
        Ok(response)
    }

    /// Displacement (m) of `vertices` under `forces` (N) at the nodes.
    pub fn displacements(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let columns = self.support(asked.nodes);
        let mut spread = vec![Vector3::zeros(); columns.len()];
        for (&vertex, force) in asked.nodes.iter().zip(forces) {
            for &(coarse, weight) in self.weights(vertex) {
                spread[columns.binary_search(&(coarse as usize)).expect("in the support")] += weight * force;
            }
        }
        let rows = self.support(vertices);
        let smooth = self.remainder.displacements(&rows, &columns, &spread, asked.options)?;
        let mut moved = Vec::with_capacity(vertices.len());
        // What is drawn is asked for once.
        let is_few = vertices.len() <= ROWS_AT_ONCE;
        for some in vertices.chunks(ROWS_AT_ONCE) {
            let unkept = KeptBlock::default();
            let near =
                self.near.displacements(asked, forces, some, if is_few { &self.kept } else { &unkept })?;
            for (near, &vertex) in near.into_iter().zip(some) {
                let at = |coarse: u32| rows.binary_search(&(coarse as usize)).expect("in the support");
                let far = |&(coarse, weight): &(u32, f64)| weight * smooth[at(coarse)];
                let is_still = self.fixed[vertex] || self.weights[vertex].is_none();
                let far: Vector3<f64> = self.weights(vertex).iter().map(far).sum();
                moved.push(if is_still { Vector3::zeros() } else { far + near });
            }
        }
        Ok(moved)
    }
}
