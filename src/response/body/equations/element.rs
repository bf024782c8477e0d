//! A face of the body, and where it stands in the equations.

use crate::response::body::equations::triangle::Triangle;

/// A node without an entry.
pub(crate) const NO_COLUMN: u32 = u32::MAX;

/// A face of skin or bone and where its hats go.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    pub triangle: Triangle,
    /// Nodes at the corners: bone vertices, then skin vertices.
    pub nodes: [u32; 3],
    /// Columns (in blocks of 3) of unknown displacements, [`NO_COLUMN`] where the displacement is zero.
    pub moving: [u32; 3],
    /// Columns (in blocks of 3) of unknown tractions, [`NO_COLUMN`] where the traction is known.
    pub supported: [u32; 3],
    /// Right-hand sides (in blocks of 3) of loaded nodes and one over their vertex areas.
    pub loaded: [u32; 3],
    pub load_scales: [f64; 3],
    pub is_skin: bool,
}
