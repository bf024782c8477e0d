//! Which face lies across each edge.

use crate::mesh::csr::Csr;

/// No face: the edge is on a border.
pub(super) const NO_FACE: u32 = u32::MAX;

/// An edge with two faces, or with more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EdgeFault {
    pub vertices: [usize; 2],
    pub faces: [usize; 2],
    pub face_count: usize,
}

/// Faces across edges, and the edges at which that is not well defined.
pub(super) struct EdgePairs {
    /// `across[f][k]`: face on the other side of the edge from corner `k` to `k + 1` of face `f`; `NO_FACE` on
    /// borders and at edges with more than two faces.
    pub across: Vec<[u32; 3]>,
    /// Number of edges.
    pub edge_count: usize,
    /// Number of edges with one face.
    pub border_edge_count: usize,
    /// First edge with more than two faces, and how many there are.
    pub non_manifold: Option<(EdgeFault, usize)>,
    /// First edge that two faces traverse in the same direction, and how many there are.
    pub same_direction: Option<(EdgeFault, usize)>,
}

/// Position of `vertex` in `corners`, which holds it.
pub(super) fn corner_of(corners: &[u32; 3], vertex: u32) -> usize {
    if corners[0] == vertex {
        0
    } else if corners[1] == vertex {
        1
    } else {
        2
    }
}

/// Finds the faces on each edge, visiting an edge at its lower vertex; no face repeats a vertex.
pub(super) fn pair_edges(faces: &[[u32; 3]], incident: &Csr) -> EdgePairs {
    let mut pairs = EdgePairs {
        across: vec![[NO_FACE; 3]; faces.len()],
        edge_count: 0,
        border_edge_count: 0,
        non_manifold: None,
        same_direction: None,
    };
    // (upper vertex, face, edge of the face, leaves the lower vertex)
    let mut edges: Vec<(u32, u32, u8, bool)> = Vec::new();
    for lower in 0..incident.rows() as u32 {
        edges.clear();
        for &face in incident.row(lower as usize) {
            let corners = &faces[face as usize];
            let k = corner_of(corners, lower);
            let (next, previous) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            if next > lower {
                edges.push((next, face, k as u8, true));
            }
            if previous > lower {
                edges.push((previous, face, ((k + 2) % 3) as u8, false));
            }
        }
        edges.sort_unstable_by_key(|edge| (edge.0, edge.1));
        for group in edges.chunk_by(|a, b| a.0 == b.0) {
            pairs.edge_count += 1;
            let fault = || EdgeFault {
                vertices: [lower as usize, group[0].0 as usize],
                faces: [group[0].1 as usize, group[1].1 as usize],
                face_count: group.len(),
            };
            match group {
                [_] => pairs.border_edge_count += 1,
                [a, b] => {
                    pairs.across[a.1 as usize][a.2 as usize] = b.1;
                    pairs.across[b.1 as usize][b.2 as usize] = a.1;
                    if a.3 == b.3 {
                        pairs.same_direction.get_or_insert_with(|| (fault(), 0)).1 += 1;
                    }
                }
                _ => pairs.non_manifold.get_or_insert_with(|| (fault(), 0)).1 += 1,
            }
        }
    }
    pairs
}
