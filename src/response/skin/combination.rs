//! Who answers for which vertices of a combined skin, and the answers put together.

use std::sync::Arc;

use faer::Mat;
use nalgebra::Vector3;

use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::error::ResponseError;
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::body_part::BodyPart;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Bodies on parts of a skin, a kernel elsewhere.
#[derive(Debug, Clone)]
pub struct Combination<P> {
    pub(super) background: KernelSkin,
    pub(super) parts: Vec<P>,
    /// Number of the part that each vertex moves with.
    pub(super) owner: Arc<[Option<usize>]>,
}

impl<P: BodyPart> Combination<P> {
    /// The body that a vertex moves with, and its vertex there.
    fn body_at(&self, vertex: usize) -> Option<(&dyn ElasticSkin, usize)> {
        let part = &self.parts[self.owner[vertex]?];
        Some((part.body(), part.moving(vertex)?))
    }

    /// Positions in `nodes` by owner: each part's, then those of the kernel.
    fn by_owner(&self, nodes: &[usize]) -> Vec<Vec<usize>> {
        let mut groups = vec![Vec::new(); self.parts.len() + 1];
        for (position, &vertex) in nodes.iter().enumerate() {
            groups[self.owner[vertex].unwrap_or(self.parts.len())].push(position);
        }
        groups
    }

    /// Who answers for a group, and the numbers of its vertices there.
    fn ask(&self, number: usize, vertices: &[usize]) -> (&dyn ElasticSkin, Vec<usize>) {
        match self.parts.get(number) {
            Some(part) => (part.body(), vertices.iter().filter_map(|&vertex| part.moving(vertex)).collect()),
            None => (&self.background, vertices.to_vec()),
        }
    }

    fn check_patches(&self, surface: &Surface, nodes: &[usize]) -> Result<(), ResponseError> {
        for patch in surface.patches(nodes) {
            let Some(&inside) = patch.iter().find(|&&vertex| self.owner[vertex].is_some()) else { continue };
            if let Some(&outside) = patch.iter().find(|&&vertex| self.owner[vertex] != self.owner[inside]) {
                let part = self.parts[self.owner[inside].expect("found so")].name().to_string();
                return Err(ResponseError::StraddlingPatch { part, inside, outside, count: patch.len() });
            }
        }
        Ok(())
    }
}

impl<P: BodyPart> ElasticSkin for Combination<P> {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        let (found, expected) = (surface.vertices().len(), self.owner.len());
        if found != expected {
            return Err(ResponseError::OtherSurface { what: "number of vertices", found, expected });
        }
        let background = self.background.traits(surface)?;
        self.parts.iter().try_for_each(|part| part.check(surface))?;
        let refines = self.parts.iter().all(P::refines);
        Ok(if self.parts.is_empty() { background } else { Traits::of_matrix(true, refines) })
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.body_at(vertex).is_none_or(|(body, own)| body.is_prepared(own))
    }

    fn is_held(&self, vertex: usize) -> bool {
        self.parts.iter().any(|part| part.is_held(vertex))
    }

    fn as_kernel(&self) -> Option<&KernelSkin> {
        self.parts.is_empty().then_some(&self.background)
    }

    fn kernel_at(&self, vertex: usize) -> Option<&KernelSkin> {
        self.owner[vertex].is_none().then_some(&self.background)
    }

    fn shear_modulus_at(&self, vertex: usize) -> Option<f64> {
        self.body_at(vertex)
            .map_or(Some(self.background.shear_modulus()), |(body, own)| body.shear_modulus_at(own))
    }

    fn tissue_at(&self, vertex: usize) -> Option<f64> {
        match self.body_at(vertex) {
            Some((body, own)) => body.tissue_at(own),
            None => self.background.layer_at(vertex),
        }
    }

    fn expect(&self, lists: Vec<Vec<usize>>) {
        for (number, part) in self.parts.iter().enumerate() {
            let is_own = |vertex: &&usize| self.owner[**vertex] == Some(number);
            let own = |list: &Vec<usize>| -> Vec<usize> {
                list.iter().filter(is_own).filter_map(|&vertex| part.moving(vertex)).collect()
            };
            part.body().expect(lists.iter().map(own).collect());
        }
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        let Some(background) = self.background.on_refined(mesh) else { return Ok(None) };
        let parts =
            self.parts.iter().map(|part| part.refined(mesh)).collect::<Result<Option<Vec<_>>, _>>()?;
        let Some(parts) = parts else { return Ok(None) };
        // A vertex between a part and the rest stays with the rest, as the cut's rim does.
        let owner = mesh.inherit(|vertex| self.owner[vertex], |a, b| a.filter(|a| Some(*a) == *b));
        Ok(Some(Box::new(Combination { background, parts, owner: owner.into() })))
    }

    /// The worst of the parts, and none where the kernel carries all.
    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        let groups = self.by_owner(asked.nodes).into_iter().enumerate();
        let mut worst: Option<BodyDoubt> = None;
        for (number, positions) in groups.filter(|(_, group)| !group.is_empty()) {
            let (skin, own) = self.ask(number, &picked(asked.nodes, &positions));
            let doubt = skin.doubt(&Request { nodes: &own, ..*asked }, &picked(forces, &positions), depth)?;
            let is_worse =
                |doubt: &BodyDoubt| worst.is_none_or(|worst| doubt.force_error > worst.force_error);
            worst = doubt.filter(is_worse).or(worst);
        }
        Ok(worst)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        let nodes = asked.nodes;
        self.check_patches(asked.surface, nodes)?;
        let mut matrix = Mat::zeros(nodes.len(), nodes.len());
        for (number, positions) in self.by_owner(nodes).iter().enumerate() {
            if positions.is_empty() {
                continue;
            }
            let (skin, own) = self.ask(number, &picked(nodes, positions));
            let block = skin.matrix(&Request { nodes: &own, ..*asked }, &picked(directions, positions))?;
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
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let mut vectors = vec![Vector3::zeros(); vertices.len()];
        let targets = self.by_owner(vertices);
        for (number, positions) in self.by_owner(asked.nodes).iter().enumerate() {
            let wanted = &targets[number];
            let (skin, own) = self.ask(number, &picked(asked.nodes, positions));
            let (_, rows) = self.ask(number, &picked(vertices, wanted));
            let moved =
                skin.displace(&Request { nodes: &own, ..*asked }, &picked(forces, positions), &rows)?;
            wanted.iter().zip(moved).for_each(|(&position, vector)| vectors[position] = vector);
        }
        Ok(vectors)
    }
}

fn picked<T: Copy>(values: &[T], positions: &[usize]) -> Vec<T> {
    positions.iter().map(|&position| values[position]).collect()
}
