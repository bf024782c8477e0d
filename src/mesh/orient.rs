//! Turning faces so that neighbours agree.

use crate::mesh::adjacency::{EdgeFault, NO_FACE};

/// Faces to flip so that neighbours agree, or where that fails.
pub(super) struct Orientation {
    /// Whether to flip each face; per component the smaller part is flipped.
    pub flip: Vec<bool>,
    /// First edge that stays in conflict (the surface is one-sided), and how many do.
    pub conflict: Option<(EdgeFault, usize)>,
}

/// Spreads the orientation of each component's first face over `across`, breadth first.
pub(super) fn orient(faces: &[[u32; 3]], across: &[[u32; 3]]) -> Orientation {
    let mut seen = vec![false; faces.len()];
    let mut flip = vec![false; faces.len()];
    let mut members: Vec<u32> = Vec::new();
    let mut conflict: Option<(EdgeFault, usize)> = None;
    for seed in 0..faces.len() {
        if seen[seed] {
            continue;
        }
        members.clear();
        members.push(seed as u32);
        seen[seed] = true;
        let mut head = 0;
        while head < members.len() {
            let face = members[head] as usize;
            head += 1;
            for k in 0..3 {
                let other = across[face][k];
                if other == NO_FACE {
                    continue;
                }
                let other = other as usize;
                let (a, b) = (faces[face][k], faces[face][(k + 1) % 3]);
                let wanted = flip[face] ^ traverses(&faces[other], a, b);
                if !seen[other] {
                    seen[other] = true;
                    flip[other] = wanted;
                    members.push(other as u32);
                } else if flip[other] != wanted && face < other {
                    let fault = EdgeFault {
                        vertices: [a.min(b) as usize, a.max(b) as usize],
                        faces: [face, other],
                        face_count: 2,
                    };
                    conflict.get_or_insert((fault, 0)).1 += 1;
                }
            }
        }
        let flipped = members.iter().filter(|face| flip[**face as usize]).count();
        if 2 * flipped > members.len() {
            for face in &members {
                flip[*face as usize] ^= true;
            }
        }
    }
    Orientation { flip, conflict }
}

/// Whether the face runs from `a` to `b` along an edge.
fn traverses(corners: &[u32; 3], a: u32, b: u32) -> bool {
    (0..3).any(|k| corners[k] == a && corners[(k + 1) % 3] == b)
}
