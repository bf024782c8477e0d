//! What a contact asks of a skin.

use faer::Mat;
use nalgebra::Vector3;

use crate::linalg::block_factor::KeptFactors;
use crate::response::body::levels::coarseness::BodyDoubt;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// What a contact may rely on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Traits {
    /// Whether a force somewhere can pull the skin towards the obstacle elsewhere, so that vertices outside the obstacle
    /// may come to touch.
    pub negative_entries: bool,
    /// Distance beyond which a force is not felt (m); `None`: felt everywhere.
    pub reach: Option<f64>,
    /// Whether it answers on a refined mesh too ([`ElasticSkin::refined`]).
    pub refines: bool,
    /// Whether a displacement follows from the straight line to the force, whatever the body's shape.
    pub is_kernel: bool,
    /// How a node's force is spread.
    pub basis: PressureBasis,
    /// How the gap of a node is taken.
    pub discretization: Discretization,
}

impl Traits {
    /// Those of a matrix that no kernel stands behind: nodes at vertices, hats, felt everywhere.
    pub(crate) fn of_matrix(negative_entries: bool, refines: bool) -> Self {
        Self {
            negative_entries,
            refines,
            reach: None,
            is_kernel: false,
            basis: PressureBasis::Linear,
            discretization: Discretization::Collocation,
        }
    }

    /// Whether forces may push skin out beside them and it is known at the nodes alone, as of a given matrix.
    pub(crate) fn moves_nodes_alone(&self) -> bool {
        self.negative_entries && !self.refines && !self.is_kernel
    }
}

/// What a skin is asked about.
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// The skin's mesh.
    pub surface: &'a Surface,
    /// Vertices (k) that forces act on, no two equal.
    pub nodes: &'a [usize],
    /// Tolerance, threads, memory, interrupt.
    pub options: &'a AssemblyOptions<'a>,
}

/// A skin that answers contact forces: a [`KernelSkin`](crate::response::KernelSkin) computes what is asked, prepared ones
/// look it up.
pub trait ElasticSkin: Sync {
    /// What a contact on `surface` may rely on.
    ///
    /// # Errors
    /// [`ResponseError`] naming what does not fit the surface.
    fn traits(&self, surface: &Surface) -> Result<Traits, ResponseError>;

    /// Whether the response to a force at `vertex` is known.
    fn is_prepared(&self, vertex: usize) -> bool;

    /// Whether the response at `vertex` is one number a pair, whatever the directions: the skin moves along the force, as it
    /// does under a kernel.
    fn is_scalar(&self, vertex: usize) -> bool {
        self.kernel_at(vertex).is_some()
    }

    /// Where matrices that were asked for are kept for the next time: the place for factors of their blocks.
    fn kept_factors(&self) -> Option<&KeptFactors> {
        None
    }

    /// The kernel that computes what is asked each time anew, where there is no other response.
    fn as_kernel(&self) -> Option<&KernelSkin> {
        None
    }

    /// Hears of vertices that are expected to be asked of together, in lists that share none.
    fn expect(&self, _lists: Vec<Vec<usize>>) {}

    /// Whether a body holds `vertex` in place; asked on the given mesh alone.
    fn is_held(&self, _vertex: usize) -> bool {
        false
    }

    /// The kernel that answers at `vertex`.
    fn kernel_at(&self, _vertex: usize) -> Option<&KernelSkin> {
        None
    }

    /// Shear modulus at `vertex` (Pa), where one is known.
    fn shear_modulus_at(&self, vertex: usize) -> Option<f64> {
        self.kernel_at(vertex).map(KernelSkin::shear_modulus)
    }

    /// Tissue between `vertex` and the bone (m), where a bone or a layer is known; asked on the given mesh alone.
    fn tissue_at(&self, vertex: usize) -> Option<f64> {
        self.kernel_at(vertex)?.layer_at(vertex)
    }

    /// What speaks against a compliance that somebody else computed or measured, in words that follow its name.
    fn misfit(&self) -> Option<&str> {
        None
    }

    /// The same skin on a refinement of its surface; `None` where it takes the mesh as it is.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn refined(&self, _mesh: &RefinedSurface) -> Result<Option<Box<dyn ElasticSkin + '_>>, ResponseError> {
        Ok(None)
    }

    /// What the mesh that a body was solved on costs a contact of depth `depth` (m) with `forces` (N) at the nodes;
    /// `None` of a kernel or a matrix.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn doubt(
        &self,
        _asked: &Request,
        _forces: &[Vector3<f64>],
        _depth: f64,
    ) -> Result<Option<BodyDoubt>, ResponseError> {
        Ok(None)
    }

    /// R over the nodes (k × k, m/N): along `directions`, and without them where the response is scalar.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn matrix(&self, asked: &Request, directions: &[Vector3<f64>]) -> Result<Mat<f64>, ResponseError>;

    /// Displacement (m) of `vertices` under `forces` (N) at the nodes.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn displace(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError>;
}

/// Shear modulus (Pa) of a skin at the first of some vertices where one is known, or else at its first.
pub(crate) fn shear_modulus_under(
    skin: &dyn ElasticSkin,
    vertices: impl IntoIterator<Item = usize>,
) -> Option<f64> {
    vertices.into_iter().chain([0]).find_map(|vertex| skin.shear_modulus_at(vertex))
}
