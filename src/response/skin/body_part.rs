//! A part of a skin that moves with a body of its own, and what it becomes on a refined mesh.

use crate::response::body::levels::on_mesh::BodyOnMesh;
use crate::response::error::ResponseError;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// A part of a skin that moves with a body of its own.
pub trait BodyPart: Sync {
    /// For messages.
    fn name(&self) -> &str;

    /// The body.
    fn body(&self) -> &dyn ElasticSkin;

    /// Vertex of the body that a vertex of the whole skin moves with.
    fn moving(&self, vertex: usize) -> Option<usize>;

    /// Whether the body holds a vertex of the whole skin in place.
    fn is_held(&self, _vertex: usize) -> bool {
        false
    }

    /// Whether it answers on a refined mesh too.
    fn refines(&self) -> bool {
        false
    }

    /// The same on a refinement of the whole skin; `None` where it takes the mesh as it is.
    ///
    /// # Errors
    /// [`ResponseError`] by variant.
    fn refined(&self, _mesh: &RefinedSurface) -> Result<Option<RefinedPart>, ResponseError> {
        Ok(None)
    }

    /// # Errors
    /// [`ResponseError::PartMismatch`]: it does not fit the whole skin.
    fn check(&self, _whole: &Surface) -> Result<(), ResponseError> {
        Ok(())
    }
}

/// A part on a refinement of the whole skin.
pub struct RefinedPart {
    pub(super) name: String,
    pub(super) body: BodyOnMesh,
}

impl BodyPart for RefinedPart {
    fn name(&self) -> &str {
        &self.name
    }

    fn body(&self) -> &dyn ElasticSkin {
        &self.body
    }

    fn moving(&self, vertex: usize) -> Option<usize> {
        Some(vertex)
    }
}
