//! Rows of a response, one a loaded vertex.

/// Why a list of nodes was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NodesError {
    /// A node is no vertex of the surface.
    #[error("entry {index} of nodes is vertex {vertex}, but the surface has {vertex_count} vertices")]
    OutOfRange {
        /// Position in the list of nodes.
        index: usize,
        /// The vertex it names.
        vertex: usize,
        /// Number of vertices of the surface.
        vertex_count: usize,
    },
    /// A vertex occurs twice among the nodes, so the matrix would be singular.
    #[error("vertex {vertex} occurs twice in nodes, at {first} and {second}")]
    Repeated {
        /// The vertex.
        vertex: usize,
        /// Position of its first occurrence.
        first: usize,
        /// Position of its second occurrence.
        second: usize,
    },
}

/// No row: the vertex is no node.
pub(crate) const NO_ROW: usize = usize::MAX;

/// Row of each of `vertex_count` vertices, [`NO_ROW`] for none.
pub(crate) fn rows_of_vertices(vertex_count: usize, nodes: &[usize]) -> Result<Vec<usize>, NodesError> {
    let mut row_of = vec![NO_ROW; vertex_count];
    for (index, &vertex) in nodes.iter().enumerate() {
        let row = row_of.get_mut(vertex);
        let row = row.ok_or(NodesError::OutOfRange { index, vertex, vertex_count })?;
        if *row != NO_ROW {
            return Err(NodesError::Repeated { vertex, first: *row, second: index });
        }
        *row = index;
    }
    Ok(row_of)
}
