//! A kernel that is evaluated when a contact asks.

use faer::Mat;
use nalgebra::Vector3;

use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::collocation::{assemble, assemble_block};
use crate::response::matrix::displaced::displaced;
use crate::response::matrix::options::check_directions;
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Rows handled at a time where displacements are wanted over the whole surface, so that memory stays small.
pub(crate) const ROWS_AT_ONCE: usize = 4096;

impl ElasticSkin for KernelSkin {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.check_against(surface)?;
        Ok(Traits {
            negative_entries: self.has_negative_entries(),
            refines: self.basis() == PressureBasis::Linear,
            reach: self.reach(),
            is_kernel: true,
            basis: self.basis(),
            discretization: self.discretization(),
        })
    }

    fn is_prepared(&self, _: usize) -> bool {
        true
    }

    fn as_kernel(&self) -> Option<&KernelSkin> {
        Some(self)
    }

    fn kernel_at(&self, _: usize) -> Option<&KernelSkin> {
        Some(self)
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        Ok(self.on_refined(mesh).map(|skin| Box::new(skin) as Box<dyn ElasticSkin>))
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        check_directions(directions, asked.nodes.len())?;
        assemble(asked.surface, self, asked.nodes, asked.options)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        // Displacements are those of the vertices, in either discretization.
        let at_vertices = self.clone().with_discretization(Discretization::Collocation)?;
        let mut moved = Vec::with_capacity(vertices.len());
        // A contact whose matrix there was room for can be drawn.
        let row = asked.nodes.len().max(1) * size_of::<f64>();
        let affordable = asked.options.memory_limit.map_or(ROWS_AT_ONCE, |limit| limit / row);
        for rows in vertices.chunks(affordable.clamp(1, ROWS_AT_ONCE)) {
            let block = assemble_block(asked.surface, &at_vertices, rows, asked.nodes, asked.options)?;
            moved.extend(displaced(&block, forces));
        }
        Ok(moved)
    }
}
