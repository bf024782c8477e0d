//! What stays as it is while a depth or a balance is looked for.

use crate::contact::error::ContactError;
use crate::contact::options::ContactOptions;
use crate::contact::reach::on_mesh::OnMesh;
use crate::contact::refine::meshes::Meshes;
use crate::contact::scene::{Approach, Placement};
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// A skin, an obstacle and the way that the one comes to the other.
#[derive(Clone, Copy)]
pub(crate) struct Setup<'a> {
    pub surface: &'a Surface,
    pub obstacle: &'a Obstacle,
    pub skin: &'a dyn ElasticSkin,
    pub options: &'a ContactOptions<'a>,
    pub approach: Approach,
}

impl<'a> Setup<'a> {
    /// The press to a depth (m).
    pub fn at(&self, depth: f64) -> Placement<'a> {
        Placement { obstacle: self.obstacle, press: Some((self.approach, depth)) }
    }

    /// Beyond this way past the touch, obstacle and skin are apart again, or no skin is left (m).
    pub fn limit(&self) -> f64 {
        let of_obstacle = self.obstacle.bounding_box().map_or(0.0, |bounds| bounds.diagonal());
        self.surface.bounding_box().diagonal() + of_obstacle
    }

    /// The press on the given mesh.
    pub fn on_given(&self) -> Result<OnMesh<'a>, ContactError> {
        self.approach.check_start(self.surface, self.obstacle)?;
        let touch = self.approach.touch(self.surface, self.obstacle)?;
        Ok(OnMesh { setup: *self, inherited: None, touch })
    }

    /// The press on a mesh that the given one was refined to.
    ///
    /// * `skin`: of that mesh, as [`refined_skin`](Self::refined_skin) gives it
    pub fn on_refined<'b>(
        &self,
        meshes: &Meshes,
        part: &'b RefinedSurface,
        skin: &'b dyn ElasticSkin,
    ) -> Result<OnMesh<'b>, ContactError>
    where
        'a: 'b,
    {
        let touch = self.approach.touch(&part.surface, self.obstacle)?;
        let inherited = Some(meshes.inherited_by(part, self.skin));
        Ok(OnMesh { setup: Setup { surface: &part.surface, skin, ..*self }, inherited, touch })
    }

    /// The skin on a mesh that the given one was refined to.
    pub fn refined_skin(&self, part: &RefinedSurface) -> Result<Box<dyn ElasticSkin + 'a>, ContactError> {
        Ok(self.skin.refined(part)?.expect("a skin that was refined before"))
    }
}
