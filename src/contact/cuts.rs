//! Where the skin ends, or is held.

use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Vertices of a refined surface where the skin ends or is held, one entry each.
#[derive(Debug, Clone)]
pub(crate) struct Cuts {
    /// Held in place by a body, or between such a vertex and a free one.
    pub held: Vec<bool>,
    /// On an open border.
    pub border: Vec<bool>,
}

impl Cuts {
    /// Those of a skin on a refinement of its surface; where a part was cut out for it is no border.
    pub fn on_refined(given: &Surface, skin: &dyn ElasticSkin, mesh: &RefinedSurface) -> Self {
        let held = mesh.inherit(|vertex| skin.is_held(vertex), |a, b| *a || *b);
        let mut border = mesh.inherit(|vertex| is_on_border(given, vertex), |a, b| *a && *b);
        for (vertex, is_border) in border.iter_mut().enumerate() {
            *is_border &= is_on_border(&mesh.surface, vertex);
        }
        Self { held, border }
    }
}

/// Whether a vertex is on an open border: an inner vertex has as many neighbours as faces, one on a border more.
pub(crate) fn is_on_border(surface: &Surface, vertex: usize) -> bool {
    surface.neighbours(vertex).len() > surface.faces_around(vertex).len()
}
