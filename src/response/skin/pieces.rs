//! Who answers for which vertices of a combined skin, and the answers put together.

use faer::Mat;
use nalgebra::Vector3;

use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::error::ResponseError;
use crate::response::kernel::skin::KernelSkin;
use crate::response::skin::elastic::{ElasticSkin, Request};
use crate::surface::checked::Surface;

/// Name of a part, its response, and its own vertex for one of the whole that moves with it.
pub(super) type Piece<'a> = (&'a str, &'a dyn ElasticSkin, Box<dyn Fn(usize) -> Option<usize> + 'a>);

/// Who answers where.
pub(super) struct Pieces<'a> {
    /// Number of the part that each vertex moves with.
    pub owner: &'a [Option<usize>],
    pub background: &'a KernelSkin,
    pub parts: Vec<Piece<'a>>,
}

impl Pieces<'_> {
    pub fn is_prepared(&self, vertex: usize) -> bool {
        self.owner[vertex].is_none_or(|number| {
            let (_, skin, own) = &self.parts[number];
            skin.is_prepared(own(vertex).expect("an owned vertex moves"))
        })
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
            Some((_, skin, own)) => (*skin, vertices.iter().filter_map(|&vertex| own(vertex)).collect()),
            None => (self.background, vertices.to_vec()),
        }
    }

    /// The worst of the parts, and none where the kernel carries all.
    pub fn doubt(
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

    fn check_patches(&self, surface: &Surface, nodes: &[usize]) -> Result<(), ResponseError> {
        for patch in surface.patches(nodes) {
            let Some(&inside) = patch.iter().find(|&&vertex| self.owner[vertex].is_some()) else { continue };
            if let Some(&outside) = patch.iter().find(|&&vertex| self.owner[vertex] != self.owner[inside]) {
                let part = self.parts[self.owner[inside].expect("found so")].0.to_string();
                return Err(ResponseError::StraddlingPatch { part, inside, outside, count: patch.len() });
            }
        }
        Ok(())
    }

    pub fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
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

    pub fn displace(
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
