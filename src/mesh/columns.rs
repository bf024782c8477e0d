//! Placing points inside, on or outside a closed component, through columns of its faces.

use nalgebra::{Rotation3, Vector3};
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::geometry::triangle_distance::triangle_distance_squared;

/// Where a point lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Location {
    /// The component goes around it.
    Inside,
    /// The component does not go around it.
    Outside,
    /// On the component, at this distance (m) from it.
    On(f64),
    /// The column of the point passes exactly through an edge.
    Unclear,
}

/// The faces of a closed component, by the square cells that their shadows meet.
///
/// The component is turned first, so that edges along the axes of a drawing do not line up with the columns.
pub(super) struct Columns {
    turn: Rotation3<f64>,
    corners: Vec<[Vector3<f64>; 3]>,
    low: [f64; 2],
    cell: f64,
    size: [usize; 2],
    offsets: Vec<u32>,
    faces: Vec<u32>,
}

impl Columns {
    pub(super) fn new(vertices: &[Vector3<f64>], faces: &[[u32; 3]]) -> Columns {
        // any turn without simple ratios
        let turn = Rotation3::from_scaled_axis(Vector3::new(0.734_1, -0.412_7, 1.193_9));
        let corners: Vec<[Vector3<f64>; 3]> =
            faces.iter().map(|face| face.map(|vertex| turn * vertices[vertex as usize])).collect();
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        let mut squares = 0.0;
        for face in &corners {
            let (face_low, face_high) = shadow(face);
            low = low.inf(&face_low);
            high = high.sup(&face_high);
            squares += (face_high - face_low).xy().norm_squared();
        }
        let extent = (high - low).xy();
        let count = corners.len() as f64;
        // About one face a cell, and no more than a few cells a face (root mean square of their boxes).
        let cell = (extent.max() / count.sqrt()).max((squares / count).sqrt()).max(f64::MIN_POSITIVE);
        let size = [extent.x, extent.y].map(|length| (length / cell).floor() as usize + 1);
        let mut columns = Columns {
            turn,
            corners,
            low: [low.x, low.y],
            cell,
            size,
            offsets: vec![0; size[0] * size[1] + 1],
            faces: Vec::new(),
        };
        columns.fill();
        columns
    }

    /// Lists the faces of each cell by counting.
    fn fill(&mut self) {
        let mut counts = vec![0u32; self.offsets.len()];
        let boxes: Vec<_> = self.corners.iter().map(shadow).collect();
        for (low, high) in &boxes {
            self.for_each_cell(low, high, |cell| counts[cell + 1] += 1);
        }
        for i in 1..counts.len() {
            counts[i] += counts[i - 1];
        }
        let mut faces = vec![0u32; counts[counts.len() - 1] as usize];
        self.offsets.copy_from_slice(&counts);
        for (face, (low, high)) in boxes.iter().enumerate() {
            self.for_each_cell(low, high, |cell| {
                faces[counts[cell] as usize] = face as u32;
                counts[cell] += 1;
            });
        }
        self.faces = faces;
    }

    /// Calls `visit` with the cells that a box in the plane meets.
    fn for_each_cell(&self, low: &Vector3<f64>, high: &Vector3<f64>, mut visit: impl FnMut(usize)) {
        let index = |value: f64, axis: usize| {
            let scaled = ((value - self.low[axis]) / self.cell).floor();
            scaled.clamp(0.0, (self.size[axis] - 1) as f64) as usize
        };
        for i in index(low.x, 0)..=index(high.x, 0) {
            for j in index(low.y, 1)..=index(high.y, 1) {
                visit(i + j * self.size[0]);
            }
        }
    }

    /// Places a point by the faces above it: each counts 1 if it faces up and -1 if down, and the sum is the
    /// winding number. The signs are exact (Shewchuk 1997).
    ///
    /// * `tolerance`: points up to this far from a face lie on it (m)
    pub(super) fn locate(&self, point: &Vector3<f64>, tolerance: f64) -> Location {
        let point = self.turn * point;
        let margin = Vector3::repeat(tolerance);
        let mut nearest = f64::INFINITY;
        self.for_each_cell(&(point - margin), &(point + margin), |cell| {
            for face in self.faces_of(cell) {
                let (low, high) = shadow(face);
                if point >= low - margin && point <= high + margin {
                    let [a, b, c] = face;
                    nearest = nearest.min(triangle_distance_squared(&point, [a, b, c]));
                }
            }
        });
        if nearest.sqrt() <= tolerance {
            return Location::On(nearest.sqrt());
        }
        let mut winding = 0;
        let mut is_unclear = false;
        self.for_each_cell(&point, &point, |cell| {
            for face in self.faces_of(cell) {
                let (low, high) = shadow(face);
                if point.xy() >= low.xy() && point.xy() <= high.xy() && point.z <= high.z {
                    match crossing(face, &point) {
                        Some(sign) => winding += sign,
                        None => is_unclear = true,
                    }
                }
            }
        });
        if is_unclear {
            Location::Unclear
        } else if winding != 0 {
            Location::Inside
        } else {
            Location::Outside
        }
    }

    fn faces_of(&self, cell: usize) -> impl Iterator<Item = &[Vector3<f64>; 3]> {
        let range = self.offsets[cell] as usize..self.offsets[cell + 1] as usize;
        self.faces[range].iter().map(|face| &self.corners[*face as usize])
    }
}

/// Lowest and highest coordinates of a face.
fn shadow([a, b, c]: &[Vector3<f64>; 3]) -> (Vector3<f64>, Vector3<f64>) {
    (a.inf(b).inf(c), a.sup(b).sup(c))
}

/// 1 or -1 if a face that looks up or down lies above the point, else 0; `None` if an edge does.
fn crossing([a, b, c]: &[Vector3<f64>; 3], point: &Vector3<f64>) -> Option<i32> {
    let flat = |v: &Vector3<f64>| Coord { x: v.x, y: v.y };
    let solid = |v: &Vector3<f64>| Coord3D { x: v.x, y: v.y, z: v.z };
    let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| orient2d(flat(from), flat(to), flat(point)));
    let (left, right) = (sides.iter().any(|side| *side > 0.0), sides.iter().any(|side| *side < 0.0));
    if left && right {
        return Some(0);
    }
    if sides.contains(&0.0) {
        return None;
    }
    let below = orient3d(solid(a), solid(b), solid(c), solid(point));
    if left { Some(i32::from(below > 0.0)) } else { Some(-i32::from(below < 0.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::solid_angle::winding_number;

    /// Unit box whose lid rises along x.
    fn box_with_slanted_lid() -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
        let corner = |i: usize| {
            let (x, y, top) = ((i & 1) as f64, (i >> 1 & 1) as f64, i >> 2 & 1);
            Vector3::new(x, y, if top == 1 { 1.0 + 0.5 * x } else { 0.0 })
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        ((0..8).map(corner).collect(), faces)
    }

    proptest::proptest! {
        #[test]
        fn locations_equal_those_of_the_winding_number(point in proptest::array::uniform3(-0.3..1.8)) {
            let (vertices, faces) = box_with_slanted_lid();
            let point = Vector3::from(point);
            let winding = winding_number(&point, &vertices, faces.iter().copied());
            let expected = if winding > 0.5 { Location::Inside } else { Location::Outside };
            proptest::prop_assert_eq!(Columns::new(&vertices, &faces).locate(&point, 0.0), expected);
        }
    }

    #[test]
    fn points_within_the_tolerance_lie_on_the_component() {
        let (vertices, faces) = box_with_slanted_lid();
        let columns = Columns::new(&vertices, &faces);
        for (point, distance) in [
            (Vector3::new(0.3, 0.4, -1e-3), 1e-3),
            (Vector3::new(0.3, 0.4, 2e-3), 2e-3),
            (Vector3::new(-2e-3, 1.0, 0.5), 2e-3),
        ] {
            let Location::On(found) = columns.locate(&point, 3e-3) else { panic!("not on it") };
            assert!((found - distance).abs() < 1e-15);
        }
        assert_eq!(columns.locate(&Vector3::new(0.3, 0.4, 4e-3), 3e-3), Location::Inside);
        assert_eq!(columns.locate(&Vector3::new(0.3, 0.4, -4e-3), 3e-3), Location::Outside);
        assert_eq!(columns.locate(&Vector3::new(9.0, -7.0, 3.0), 3e-3), Location::Outside);
    }
}
