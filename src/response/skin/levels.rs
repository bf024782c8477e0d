//! What a body's compliance is made of.

use std::sync::Arc;

use crate::response::body::check::parts::{Range, check_counts, check_numbers, check_order};
use crate::response::body::compliance::BodyCompliance;
use crate::response::body::error::BodyError;
use crate::response::body::levels::one_level::OneLevel;
use crate::response::body::levels::two_levels::TwoLevels;

/// What the compliance is made of.
#[derive(Debug, Clone)]
pub enum Levels {
    /// The skin itself.
    One(OneLevel),
    /// A near kernel, and the remainder on a coarse skin.
    Two(TwoLevels),
}

impl Levels {
    /// The blocks of it.
    pub(crate) fn compliance(&self) -> &BodyCompliance {
        match self {
            Self::One(one) => &one.compliance,
            Self::Two(two) => &two.remainder,
        }
    }

    /// Thickness of the tissue at each vertex of the skin (n, m), where a bone is known.
    pub(crate) fn thickness(&self) -> Option<&Arc<[f64]>> {
        match self {
            Self::One(one) => one.thickness.as_ref(),
            Self::Two(two) => two.thickness.as_ref(),
        }
    }

    /// Checks that it is of a skin of so many vertices and answers forces at `nodes`.
    pub(crate) fn check(&self, vertex_count: usize, nodes: &[usize]) -> Result<(), BodyError> {
        let (thickness, compliance) = (self.thickness().map(AsRef::as_ref), self.compliance());
        let skin_count = match self {
            Self::Two(two) => two.places.len(),
            Self::One(_) => compliance.vertex_count(),
        };
        check_counts(&[
            ("skin vertices", skin_count, vertex_count),
            ("thickness", thickness.map_or(vertex_count, <[f64]>::len), vertex_count),
        ])?;
        let thickness = thickness.unwrap_or_default().iter().copied().enumerate();
        check_numbers("thickness", Range::Positive, thickness)?;
        match self {
            Self::Two(two) => two.check_columns(nodes),
            Self::One(_) => check_order(compliance.nodes(), nodes),
        }
    }
}
