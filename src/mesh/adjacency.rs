//! Which face lies across each edge, and the fan of faces around each vertex.

use super::csr::Csr;

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

/// First face of the fan around `vertex` in counter-clockwise order: the one behind a border, else the lowest.
fn fan_start(vertex: u32, faces: &[[u32; 3]], across: &[[u32; 3]], incident: &[u32]) -> u32 {
    let behind_border = |face: &&u32| {
        let face = **face as usize;
        across[face][corner_of(&faces[face], vertex)] == NO_FACE
    };
    *incident.iter().find(behind_border).unwrap_or(&incident[0])
}

/// Walks counter-clockwise around `vertex` from `start`, calling `visit(face, corner)`; returns the vertex
/// behind the last face where the fan is open.
///
/// The mesh has manifold, consistently oriented edges.
fn walk_fan(
    vertex: u32,
    start: u32,
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    mut visit: impl FnMut(u32, usize),
) -> Option<u32> {
    let mut face = start;
    loop {
        let corners = &faces[face as usize];
        let k = corner_of(corners, vertex);
        visit(face, k);
        let behind = (k + 2) % 3;
        face = across[face as usize][behind];
        if face == NO_FACE {
            return Some(corners[behind]);
        }
        if face == start {
            return None;
        }
    }
}

/// Puts the faces around each vertex into counter-clockwise order and lists the neighbours likewise.
///
/// Returns the neighbours, or the first pinched vertex with its number of fans, and how many are pinched.
pub(super) fn order_fans(
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    incident: &mut Csr,
) -> Result<Csr, (usize, usize, usize)> {
    let mut neighbours = Csr::with_capacity(incident.rows(), 3 * faces.len());
    let mut pinched: Option<(usize, usize, usize)> = None;
    let mut fan: Vec<u32> = Vec::new();
    for vertex in 0..incident.rows() {
        let around = incident.row_mut(vertex);
        if !around.is_empty() {
            fan.clear();
            let start = fan_start(vertex as u32, faces, across, around);
            let end = walk_fan(vertex as u32, start, faces, across, |face, k| {
                fan.push(face);
                neighbours.push(faces[face as usize][(k + 1) % 3]);
            });
            if let Some(last) = end {
                neighbours.push(last);
            }
            if fan.len() == around.len() {
                around.copy_from_slice(&fan);
            } else {
                let first = pinched
                    .get_or_insert_with(|| (vertex, count_fans(vertex as u32, faces, across, around), 0));
                first.2 += 1;
            }
        }
        neighbours.end_row();
    }
    pinched.map_or(Ok(neighbours), Err)
}

fn count_fans(vertex: u32, faces: &[[u32; 3]], across: &[[u32; 3]], around: &[u32]) -> usize {
    let mut left = around.to_vec();
    let mut fans = 0;
    while !left.is_empty() {
        let start = fan_start(vertex, faces, across, &left);
        walk_fan(vertex, start, faces, across, |face, _| left.retain(|other| *other != face));
        fans += 1;
    }
    fans
}
