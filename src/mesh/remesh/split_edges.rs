//! Triangles cut at the middles of their long edges, flat as they are: finer ones of the same shape, whatever their form.

use nalgebra::Vector3;

use crate::mesh::edge_map::{EdgeMap, edge};

/// Rounds after which no edge is halved: a given one is down to a millionth of its length by then, but new ones across a
/// triangle with long sides that may stay can be as long as these, again and again.
const MOST_ROUNDS: usize = 20;

/// Halves edges until none is too long, but diagonals of the last quads; the mesh stays conforming.
///
/// Given vertices keep their numbers; what is added follows. A face that is cut keeps its number for its first part.
///
/// * `vertices`: positions (n, m)
/// * `faces`: (m)
/// * `is_too_long`: of an edge by its ends (m), the same either way; with an edge that is not, none of its parts is
pub(crate) fn split_long_edges(
    vertices: &mut Vec<Vector3<f64>>,
    faces: &mut Vec<[u32; 3]>,
    is_too_long: impl Fn(&Vector3<f64>, &Vector3<f64>) -> bool,
) {
    let mut pieces: Vec<Piece> = faces.iter().copied().map(Piece::Triangle).collect();
    // Parts of an edge that is short are short, so that only what was cut is looked at again.
    let mut open: Vec<usize> = (0..pieces.len()).collect();
    for _ in 0..MOST_ROUNDS {
        let mut middles = EdgeMap::default();
        for [a, b] in open.iter().flat_map(|&number| pieces[number].sides()) {
            let [from, to] = [a, b].map(|end| vertices[end as usize]);
            if !middles.contains_key(&edge(a, b)) && is_too_long(&from, &to) {
                middles.insert(edge(a, b), vertices.len() as u32);
                vertices.push(0.5 * (from + to));
            }
        }
        let middle = |a, b| middles.get(&edge(a, b)).copied();
        let mut cut = Vec::new();
        for number in open {
            let piece = pieces[number];
            if piece.sides().all(|[a, b]| middle(a, b).is_none()) {
                continue;
            }
            let mut parts = piece.parts(&middle, vertices).into_iter();
            pieces[number] = parts.next().expect("a piece has parts");
            cut.push(number);
            cut.extend(pieces.len()..pieces.len() + parts.len());
            pieces.extend(parts);
        }
        open = cut;
    }
    faces.clear();
    let mut others = Vec::new();
    for piece in pieces {
        match piece {
            Piece::Triangle(corners) => faces.push(corners),
            Piece::Quad(corners) => {
                let [one, other] = halves(corners, vertices);
                faces.push(one);
                others.push(other);
            }
        }
    }
    faces.append(&mut others);
}

/// A part of a face. Slender triangles leave slender quads, which are cut across again and again: the diagonals that would
/// make triangles of them at once would be cut as well, and the parts get ever more slender.
#[derive(Clone, Copy)]
enum Piece {
    Triangle([u32; 3]),
    /// Convex.
    Quad([u32; 4]),
}

impl Piece {
    /// Its sides, the first one from its first corner.
    fn sides(&self) -> impl Iterator<Item = [u32; 2]> + use<> {
        let (corners, count) = match *self {
            Self::Triangle([a, b, c]) => ([a, b, c, a], 3),
            Self::Quad(corners) => (corners, 4),
        };
        (0..count).map(move |side| [corners[side], corners[(side + 1) % count]])
    }

    /// What takes its place.
    ///
    /// * `middle`: vertex in the middle of a side
    fn parts(&self, middle: &impl Fn(u32, u32) -> Option<u32>, vertices: &[Vector3<f64>]) -> Vec<Piece> {
        match *self {
            Self::Triangle(corners) => parts_of_triangle(corners, middle),
            Self::Quad([a, b, c, d]) => match [middle(a, b), middle(b, c), middle(c, d), middle(d, a)] {
                [Some(ab), None, Some(cd), None] => {
                    vec![Self::Quad([a, ab, cd, d]), Self::Quad([ab, b, c, cd])]
                }
                [None, Some(bc), None, Some(da)] => {
                    vec![Self::Quad([a, b, bc, da]), Self::Quad([da, bc, c, d])]
                }
                _ => {
                    let halves = halves([a, b, c, d], vertices).into_iter();
                    halves.flat_map(|corners| parts_of_triangle(corners, middle)).collect()
                }
            },
        }
    }
}

fn parts_of_triangle([a, b, c]: [u32; 3], middle: &impl Fn(u32, u32) -> Option<u32>) -> Vec<Piece> {
    match [middle(a, b), middle(b, c), middle(c, a)] {
        [None, None, None] => vec![Piece::Triangle([a, b, c])],
        [Some(ab), Some(bc), Some(ca)] => {
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(Piece::Triangle).to_vec()
        }
        [Some(ab), Some(bc), None] => vec![Piece::Triangle([ab, b, bc]), Piece::Quad([a, ab, bc, c])],
        [Some(ab), None, None] => [[a, ab, c], [ab, b, c]].map(Piece::Triangle).to_vec(),
        // Turned until the first side is halved, or the first two of them.
        _ => parts_of_triangle([b, c, a], middle),
    }
}

/// A quad cut along its shorter diagonal.
fn halves([a, b, c, d]: [u32; 4], vertices: &[Vector3<f64>]) -> [[u32; 3]; 2] {
    let length = |from: u32, to: u32| (vertices[from as usize] - vertices[to as usize]).norm();
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Random, jittered_grid};
    use crate::surface::checked::Surface;

    #[test]
    fn a_sheet_of_slivers_stays_the_same_sheet_with_no_long_edge_where_asked() {
        let (mut vertices, mut faces) = jittered_grid(6, 1.0, 0.4, &mut Random(5));
        vertices.iter_mut().for_each(|vertex| vertex.x = 200.0 * vertex.x.round());
        let given = Surface::new(vertices.clone(), faces.clone()).expect("a valid surface");
        let near = |a: &Vector3<f64>, b: &Vector3<f64>| a.x.min(b.x) < 100.0;
        let too_long = |a: &Vector3<f64>, b: &Vector3<f64>| near(a, b) && (a - b).norm() > 1.5;
        split_long_edges(&mut vertices, &mut faces, too_long);
        assert_eq!(vertices[..given.vertices().len()], *given.vertices());
        let finer = Surface::new(vertices, faces).expect("a valid surface");
        for [a, b] in finer.faces().iter().flat_map(|&face| Piece::Triangle(face).sides()) {
            let [a, b] = [a, b].map(|end| finer.vertices()[end as usize]);
            // A diagonal of the last quads may be longer.
            assert!(!too_long(&a, &b) || (a - b).norm() < 1.5 * 2.0_f64.sqrt());
        }
        let area = |surface: &Surface| surface.face_areas().iter().sum::<f64>();
        assert!((area(&finer) / area(&given) - 1.0).abs() < 1e-12);
        assert!(finer.face_normals().iter().all(|normal| normal.z > 1.0 - 1e-12));
        // Not many times the area over that of an equilateral triangle of such edges.
        let least = 100.0 * 6.0 / (0.25 * 3.0_f64.sqrt() * 1.5 * 1.5);
        assert!((finer.faces().len() as f64) < 6.0 * least, "{} of {least}", finer.faces().len());
    }
}
