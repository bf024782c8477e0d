//! What stays as it is while a depth or a balance is looked for.

use crate::contact::error::ContactError;
use crate::contact::options::ContactOptions;
use crate::contact::reach::search::Search;
use crate::contact::reach::target::Target;
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

    /// The search for the way past the touch to a target.
    ///
    /// * `first`: the way that is tried first (m)
    pub fn search(&self, Target { quantity, value }: Target, first: f64) -> Search {
        let (power, limit) = (quantity.power(), self.limit());
        Search { value, first, power, limit, known: None, tolerance: Search::TOLERANCE }
    }

    /// Whether a finer mesh may follow the given one.
    pub fn may_refine(&self) -> Result<bool, ContactError> {
        Ok(self.options.target_error.is_some() && self.skin.traits(self.surface)?.refines)
    }

    /// The skin on a mesh that the given one was refined to.
    pub fn refined_skin(&self, part: &RefinedSurface) -> Result<Box<dyn ElasticSkin + 'a>, ContactError> {
        Ok(self.skin.refined(part)?.expect("a skin that was refined before"))
    }
}
