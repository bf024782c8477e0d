//! Vertices under force, and what each adds to the figures.

use nalgebra::Vector3;

/// A vertex under force, and what it adds to the figures.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoadedVertex {
    pub vertex: usize,
    /// The given vertex whose entry it takes, where there is one entry a given vertex.
    pub given_vertex: usize,
    /// Number of its patch.
    pub patch: usize,
    /// Where it lies undeformed (m).
    pub position: Vector3<f64>,
    /// Where it lies under the forces (m).
    pub deformed: Vector3<f64>,
    /// Force on the skin (N).
    pub force: Vector3<f64>,
    /// The same along the obstacle's outward normal (N, > 0).
    pub node_force: f64,
    /// Its share of the contact area (m²).
    pub contact_area: f64,
    /// Largest pressure that it stands for (Pa).
    pub peak_pressure: f64,
}

/// All vertices under force, ascending.
#[derive(Debug, Clone)]
pub(crate) struct LoadedVertices {
    pub list: Vec<LoadedVertex>,
    /// Vertices of the given mesh, and of the one that was solved.
    pub vertex_counts: [usize; 2],
    /// Whether the contact solved, so that sums are its figures.
    pub is_known: bool,
}
