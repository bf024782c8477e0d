//! The fan of faces around each vertex.

use crate::mesh::adjacency::{NO_FACE, corner_of};
use crate::mesh::csr::Csr;

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
/// Returns the neighbours, and the first pinched vertex with its number of fans, and how many are pinched: such a vertex
/// keeps the order of its faces, and has the neighbours of one fan.
pub(super) fn order_fans(
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    incident: &mut Csr,
) -> (Csr, Option<(usize, usize, usize)>) {
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
    (neighbours, pinched)
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
