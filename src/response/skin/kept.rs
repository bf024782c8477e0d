//! A skin that keeps the response matrices that it was asked for.

use std::sync::{Arc, Mutex};

use faer::Mat;
use nalgebra::Vector3;

use crate::geometry::direction::{are_one, is_same};
use crate::linalg::block_factor::KeptFactors;
use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::collocation::assemble_columns;
use crate::response::matrix::kept_block::{Assemble, KeptBlock};
use crate::response::matrix::options::{AssemblyOptions, check_memory};
use crate::response::skin::elastic::{ElasticSkin, Request, Traits};
use crate::response::skin::kernel::ROWS_AT_ONCE;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// A skin asked again and again about nearly the same nodes of one surface, as the trials of a search do.
///
/// Its entries are right to the tolerance asked for, and not to the bit those of the skin: quadrature depends on which
/// nodes are evaluated together.
pub(crate) struct KeptSkin<'a> {
    skin: &'a dyn ElasticSkin,
    kept: Arc<KeptMatrices>,
}

/// What is kept of one skin on one surface.
#[derive(Default)]
pub(crate) struct KeptMatrices {
    /// Of groups of nodes that share none.
    matrices: Mutex<Vec<KeptMatrix>>,
    /// Of a kernel.
    entries: KeptBlock,
    factors: KeptFactors,
}

/// A matrix over more nodes than were asked for.
struct KeptMatrix {
    /// Ascending, as a contact asks for them; of others some may not be found, and are assembled again.
    nodes: Vec<usize>,
    /// The directions that it holds for; `None` where it depends on none.
    directions: Option<Vec<Vector3<f64>>>,
    matrix: Mat<f64>,
}

impl KeptMatrix {
    /// The entries of some nodes, where they are known.
    fn among(&self, nodes: &[usize], directions: &[Vector3<f64>]) -> Option<Mat<f64>> {
        let row = |node: &usize| self.nodes.binary_search(node).ok();
        let rows: Vec<usize> = nodes.iter().map(row).collect::<Option<_>>()?;
        if let Some(known) = &self.directions
            && rows.iter().zip(directions).any(|(&row, direction)| !is_same(&known[row], direction))
        {
            return None;
        }
        let mut matrix = Mat::zeros(rows.len(), rows.len());
        for (j, &column) in rows.iter().enumerate() {
            let from = self.matrix.col_as_slice(column);
            let to = matrix.col_as_slice_mut(j);
            to.iter_mut().zip(&rows).for_each(|(entry, &row)| *entry = from[row]);
        }
        Some(matrix)
    }

    fn shares(&self, nodes: &[usize]) -> bool {
        nodes.iter().any(|node| self.nodes.binary_search(node).is_ok())
    }
}

impl<'a> KeptSkin<'a> {
    pub fn new(skin: &'a dyn ElasticSkin) -> Self {
        Self::with(skin, Arc::default())
    }

    /// With what was kept before of the same skin on the same surface.
    pub fn with(skin: &'a dyn ElasticSkin, kept: Arc<KeptMatrices>) -> Self {
        Self { skin, kept }
    }

    /// How the columns of a kernel that answers at vertices are assembled; `None` of other skins.
    fn assembly<'b>(&self, surface: &'b Surface) -> Option<impl Assemble + use<'b, '_, 'a>> {
        let kernel = self.skin.as_kernel()?;
        let assemble = move |rows: &[usize], columns: &[usize], options: &AssemblyOptions| {
            assemble_columns(surface, kernel, rows, columns, options)
        };
        (kernel.discretization() == Discretization::Collocation).then_some(assemble)
    }

    /// The matrix over some nodes and those around them, which may be asked for next; `None` where it cannot be had.
    fn around(
        &self,
        asked: &Request,
        direction: Vector3<f64>,
        is_kernel: bool,
    ) -> Result<Option<KeptMatrix>, ResponseError> {
        let may_touch = asked.surface.skin_mask();
        let mut nodes = asked.surface.k_ring(asked.nodes, 1);
        nodes.retain(|&node| may_touch[node] && self.skin.is_prepared(node));
        let directions = vec![direction; nodes.len()];
        match self.skin.matrix(&Request { nodes: &nodes, ..*asked }, &directions) {
            Ok(matrix) => {
                Ok(Some(KeptMatrix { nodes, directions: (!is_kernel).then_some(directions), matrix }))
            }
            Err(error) if error.is_interruption() => Err(error),
            // Another part of a combined skin.
            Err(_) => Ok(None),
        }
    }
}

impl ElasticSkin for KeptSkin<'_> {
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError> {
        self.skin.traits(surface)
    }

    fn is_scalar(&self, vertex: usize) -> bool {
        self.skin.is_scalar(vertex)
    }

    fn is_prepared(&self, vertex: usize) -> bool {
        self.skin.is_prepared(vertex)
    }

    fn kept_factors(&self) -> Option<&KeptFactors> {
        Some(&self.kept.factors)
    }

    fn expect(&self, lists: Vec<Vec<usize>>) {
        match self.skin.as_kernel() {
            Some(_) => self.kept.entries.expect(lists),
            None => self.skin.expect(lists),
        }
    }

    fn is_held(&self, vertex: usize) -> bool {
        self.skin.is_held(vertex)
    }

    fn kernel_at(&self, vertex: usize) -> Option<&KernelSkin> {
        self.skin.kernel_at(vertex)
    }

    fn shear_modulus_at(&self, vertex: usize) -> Option<f64> {
        self.skin.shear_modulus_at(vertex)
    }

    fn tissue_at(&self, vertex: usize) -> Option<f64> {
        self.skin.tissue_at(vertex)
    }

    fn misfit(&self) -> Option<&str> {
        self.skin.misfit()
    }

    fn refined(&self, mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        self.skin.refined(mesh)
    }

    fn doubt(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        self.skin.doubt(asked, forces, depth)
    }

    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError> {
        // A second copy would not be within the limit, or what is free.
        let count = asked.nodes.len();
        let is_scarce =
            asked.options.memory_limit.is_some() || check_memory(2 * count, count, asked.options).is_err();
        if is_scarce || asked.nodes.is_empty() {
            return self.skin.matrix(asked, directions);
        }
        if let Some(assemble) = self.assembly(asked.surface) {
            return self.kept.entries.entries(asked.nodes, asked.nodes, asked.options, assemble);
        }
        let mut kept = self.kept.matrices.lock().expect("no thread panics while it holds the lock");
        if let Some(matrix) = kept.iter().find_map(|kept| kept.among(asked.nodes, directions)) {
            return Ok(matrix);
        }
        let is_kernel = self.skin.traits(asked.surface)?.is_kernel;
        let is_one_direction = are_one(directions);
        let around =
            if is_kernel || is_one_direction { self.around(asked, directions[0], is_kernel)? } else { None };
        let with_wanted = around.and_then(|new| Some((new.among(asked.nodes, directions)?, new)));
        let (wanted, new) = match with_wanted {
            Some(both) => both,
            None => {
                let matrix = self.skin.matrix(asked, directions)?;
                let directions = (!is_kernel).then(|| directions.to_vec());
                (matrix.clone(), KeptMatrix { nodes: asked.nodes.to_vec(), directions, matrix })
            }
        };
        kept.retain(|known| !known.shares(&new.nodes));
        kept.push(new);
        Ok(wanted)
    }

    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        // The skin as it is drawn is asked for once.
        let is_few = vertices.len() <= ROWS_AT_ONCE && asked.options.memory_limit.is_none();
        match self.assembly(asked.surface) {
            Some(assemble) if is_few => {
                self.kept.entries.displaced(vertices, (asked.nodes, forces), asked.options, assemble)
            }
            _ => self.skin.displace(asked, forces, vertices),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::kernel::skin::Kernel;
    use crate::sample::grid;

    #[test]
    fn a_matrix_picked_from_a_larger_one_is_the_skins_own_to_the_tolerance() {
        let (vertices, faces) = grid(12, 12, 1e-3);
        let surface = Surface::new(vertices, faces).expect("a valid surface");
        let skin = KernelSkin::new(60e3, 0.5, Kernel::HalfSpace)
            .and_then(|skin| skin.with_discretization(Discretization::Galerkin))
            .expect("valid constants");
        let kept = KeptSkin::new(&skin);
        let options = AssemblyOptions::default();
        let ask = |skin: &dyn ElasticSkin, nodes: &[usize]| {
            let asked = Request { surface: &surface, nodes, options: &options };
            skin.matrix(&asked, &vec![Vector3::z(); nodes.len()]).expect("known nodes")
        };
        let middle: Vec<usize> = surface.k_ring(&[84], 2);
        let wider = surface.k_ring(&[84], 3);
        let inner = surface.k_ring(&[84], 1);
        for nodes in [&middle, &wider, &inner] {
            let (own, found) = (ask(&skin, nodes), ask(&kept, nodes));
            let largest = own.norm_max();
            assert!((&own - &found).norm_max() <= 2.0 * options.tolerance * largest);
        }
        // The ring around the first was assembled with it, and serves all three.
        assert_eq!(kept.kept.matrices.lock().expect("free")[0].nodes, wider);
    }
}
