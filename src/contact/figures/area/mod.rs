//! The contact's area and where it ends: at the rim between vertices, or at a sharp edge.

pub(crate) mod beside;
pub(crate) mod cells;
pub(crate) mod loaded_edge;
pub(crate) mod rim;
pub(crate) mod within_rim;
