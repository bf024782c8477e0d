//! A whole hand: solved bodies where there are some, a kernel everywhere else.
//!
//! Parts of the skin, such as fingers cut out by [`cut_out`](crate::surface::cut_out()), answer with the compliance of their
//! body; the rest answers with a kernel. Forces on a part move that part alone, forces elsewhere move the rest alone:
//! across a cut nothing is felt, as each body is held there. So a connected patch of candidates must lie on one
//! side of every cut; one that straddles is an error that names the part.

use std::sync::Arc;

use faer::Mat;
use nalgebra::{Isometry3, Vector3};

use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::elastic::{Displacements, ElasticSkin, Request, Traits};
use crate::response::skin::prepared_body::PreparedBody;
use crate::surface::checked::Surface;

/// Largest distance, in mean edge lengths, between a part's vertices and those of the whole skin.
const SAME_PLACE_DISTANCE: f64 = 1e-6;

/// A part of the skin with the compliance of its body.
#[derive(Debug, Clone)]
pub struct Part {
    /// For messages.
    pub name: String,
    /// The body's compliance, prepared for the part's own surface.
    pub prepared: PreparedBody,
    /// For each vertex of the whole skin its vertex in the part, if it belongs to it.
    pub part_vertices: Vec<Option<usize>>,
    /// Vertices of the part that do not move with the body: its cut, rim included. Those of the whole skin answer
    /// with the kernel.
    pub fixed: Vec<bool>,
}

impl Part {
    /// Vertex of the part that moves with the body.
    fn moving(&self, vertex: usize) -> Option<usize> {
        self.part_vertices[vertex].filter(|&own| !self.fixed[own])
    }

    /// Those of the part, for vertices of the whole skin that move with the body.
    fn all_moving(&self, vertices: &[usize]) -> Vec<usize> {
        vertices.iter().filter_map(|&vertex| self.moving(vertex)).collect()
    }

    fn check(&self, surface: &Surface) -> Result<(), ResponseError> {
        let mismatch = |what: String| ResponseError::PartMismatch { part: self.name.clone(), what };
        let (found, expected) = (self.part_vertices.len(), surface.vertices().len());
        if found != expected {
            return Err(mismatch(format!("{found} entries for the {expected} vertices of the whole skin")));
        }
        let own_count = self.prepared.nodes().vertices().len();
        if self.fixed.len() != own_count {
            return Err(mismatch(format!(
                "{} entries tell which of its {own_count} vertices are fixed",
                self.fixed.len()
            )));
        }
        let allowed = SAME_PLACE_DISTANCE * surface.mean_edge_length();
        for (vertex, own) in self.part_vertices.iter().enumerate() {
            let Some(own) = *own else { continue };
            let place = self.prepared.nodes().vertices().get(own);
            let place = place.ok_or_else(|| mismatch(format!("vertex {own} of {own_count}")))?;
            let distance = (surface.vertices()[vertex] - place).norm();
            if distance > allowed {
                return Err(mismatch(format!(
                    "its vertex {own} is {distance:.3e} m from vertex {vertex} of the whole skin (allowed \
                     {allowed:.1e} m); move the part with the skin"
                )));
            }
        }
        Ok(())
    }
}

/// Bodies on parts of a skin, a kernel elsewhere; goes wherever a [`KernelSkin`] goes.
#[derive(Debug, Clone)]
pub struct CombinedSkin {
    background: KernelSkin,
    parts: Vec<Part>,
    /// Number of the part that each vertex moves with.
    owner: Arc<[Option<usize>]>,
}

impl CombinedSkin {
    /// Joins parts of `surface` with the kernel `background`.
    ///
    /// # Errors
    /// - [`ResponseError::PartMismatch`]: a part does not fit the surface, is no body, or shares vertices with another
    /// - [`ResponseError::PartsNeedLinear`]: the kernel averages gaps or spreads forces over one-rings
    pub fn new(surface: &Surface, background: KernelSkin, parts: Vec<Part>) -> Result<Self, ResponseError> {
        if background.discretization() != Discretization::Collocation
            || background.basis() != PressureBasis::Linear
        {
            return Err(ResponseError::PartsNeedLinear);
        }
        let mut owner: Vec<Option<usize>> = vec![None; surface.vertices().len()];
        for (number, part) in parts.iter().enumerate() {
            part.check(surface)?;
            for (vertex, owner) in owner.iter_mut().enumerate() {
                if part.moving(vertex).is_none() {
                    continue;
                }
                if let Some(first) = owner.replace(number) {
                    let what = format!("vertex {vertex} belongs to part {:?} too", parts[first].name);
                    return Err(ResponseError::PartMismatch { part: part.name.clone(), what });
                }
            }
        }
        Ok(Self { background, parts, owner: owner.into() })
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The same after a rigid motion of the whole skin.
    ///
    /// # Errors
    /// As [`PreparedBody::moved`].
    pub fn moved(&self, motion: &Isometry3<f64>) -> Result<Self, ResponseError> {
        let move_part = |part: &Part| Ok(Part { prepared: part.prepared.moved(motion)?, ..part.clone() });
        let parts = self.parts.iter().map(move_part).collect::<Result<_, ResponseError>>()?;
        Ok(Self { parts, ..self.clone() })
    }

    /// Positions in `nodes` by owner: each part's, then those of the kernel.
    fn by_owner(&self, nodes: &[usize]) -> Vec<Vec<usize>> {
        let mut groups = vec![Vec::new(); self.parts.len() + 1];
        for (position, &vertex) in nodes.iter().enumerate() {
            groups[self.owner[vertex].unwrap_or(self.parts.len())].push(position);
        }
        groups
    }

    fn check_patches(&self, surface: &Surface, nodes: &[usize]) -> Result<(), ResponseError> {
        for patch in surface.patches(nodes) {
            let Some(&inside) = patch.iter().find(|&&vertex| self.owner[vertex].is_some()) else { continue };
            if let Some(&outside) = patch.iter().find(|&&vertex| self.owner[vertex] != self.owner[inside]) {
                let part = self.parts[self.owner[inside].expect("found so")].name.clone();
                return Err(ResponseError::StraddlingPatch { part, inside, outside, count: patch.len() });
            }
        }
        Ok(())
    }
}

fn picked<T: Copy>(values: &[T], positions: &[usize]) -> Vec<T> {
    positions.iter().map(|&position| values[position]).collect()
}

impl ElasticSkin for CombinedSkin {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        let background = self.background.traits(surface)?;
        self.parts.iter().try_for_each(|part| part.check(surface))?;
        Ok(if self.parts.is_empty() { background } else { Traits::of_matrix(true) })
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.owner[vertex].is_none_or(|number| {
            let part = &self.parts[number];
            part.prepared.is_prepared(part.moving(vertex).expect("an owned vertex moves"))
        })
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let nodes = asked.nodes;
        self.check_patches(asked.surface, nodes)?;
        let mut matrix = Mat::zeros(nodes.len(), nodes.len());
        for (number, positions) in self.by_owner(nodes).iter().enumerate() {
            if positions.is_empty() {
                continue;
            }
            let (own, along) = (picked(nodes, positions), picked(directions, positions));
            let block = match self.parts.get(number) {
                Some(part) => {
                    part.prepared.matrix(&Request { nodes: &part.all_moving(&own), ..*asked }, &along)?
                }
                None => self.background.matrix(&Request { nodes: &own, ..*asked }, &along)?,
            };
            for (j, &column) in positions.iter().enumerate() {
                for (i, &row) in positions.iter().enumerate() {
                    matrix[(row, column)] = block[(i, j)];
                }
            }
        }
        Ok(matrix)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Displacements, ResponseError> {
        let mut vectors = vec![Vector3::zeros(); vertices.len()];
        let mut along_normal = vec![None; vertices.len()];
        let targets = self.by_owner(vertices);
        for (number, positions) in self.by_owner(asked.nodes).iter().enumerate() {
            let (own, pushed) = (picked(asked.nodes, positions), picked(forces, positions));
            let wanted = &targets[number];
            let rows = picked(vertices, wanted);
            let moved = match self.parts.get(number) {
                Some(part) => {
                    let nodes = &part.all_moving(&own);
                    part.prepared.displace(&Request { nodes, ..*asked }, &pushed, &part.all_moving(&rows))?
                }
                None => self.background.displace(&Request { nodes: &own, ..*asked }, &pushed, &rows)?,
            };
            for ((&position, vector), along) in wanted.iter().zip(moved.vectors).zip(moved.along_normal) {
                vectors[position] = vector;
                along_normal[position] = along;
            }
        }
        Ok(Displacements { vectors, along_normal })
    }
}
