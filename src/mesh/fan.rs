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
/// has its fans one after the other.
pub(super) fn order_fans(
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    incident: &mut Csr,
) -> (Csr, Option<(usize, usize, usize)>) {
    let mut neighbours = Csr::with_capacity(incident.rows(), 3 * faces.len());
    let mut pinched: Option<(usize, usize, usize)> = None;
    let (mut ordered, mut left): (Vec<u32>, Vec<u32>) = (Vec::new(), Vec::new());
    for vertex in 0..incident.rows() {
        let around = incident.row_mut(vertex);
        ordered.clear();
        left.clear();
        left.extend_from_slice(around);
        let mut fans = 0;
        while !left.is_empty() {
            let start = fan_start(vertex as u32, faces, across, &left);
            let end = walk_fan(vertex as u32, start, faces, across, |face, k| {
                ordered.push(face);
                neighbours.push(faces[face as usize][(k + 1) % 3]);
            });
            if let Some(last) = end {
                neighbours.push(last);
            }
            fans += 1;
            if ordered.len() == around.len() {
                break;
            }
            left.retain(|face| !ordered.contains(face));
        }
        around.copy_from_slice(&ordered);
        if fans > 1 {
            pinched.get_or_insert((vertex, fans, 0)).2 += 1;
        }
        neighbours.end_row();
    }
    (neighbours, pinched)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinched_vertex_has_the_neighbours_of_all_its_fans() {
        let faces = [[0, 1, 2], [3, 4, 0]];
        let mut incident = Csr::faces_of_vertices(5, &faces);
        let (neighbours, pinched) = order_fans(&faces, &[[NO_FACE; 3]; 2], &mut incident);
        assert_eq!(neighbours.row(0), [1, 2, 3, 4]);
        assert_eq!((neighbours.row(1), neighbours.row(4)), (&[2, 0][..], &[0, 3][..]));
        assert_eq!(pinched, Some((0, 2, 1)));
    }
}
