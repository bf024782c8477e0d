//! Points laid out for vector code: those at which a column is evaluated, and some of them.

use nalgebra::Vector3;
use pulp::Simd;

use crate::geometry::bounds::Bounds;
use crate::response::simd::lanes::Lanes;

/// Points (m), a list for each coordinate.
#[derive(Debug, Default)]
pub(crate) struct Points([Vec<f64>; 3]);

impl Points {
    pub(crate) fn len(&self) -> usize {
        self.0[0].len()
    }

    pub(crate) fn clear(&mut self) {
        self.0.iter_mut().for_each(Vec::clear);
    }

    pub(crate) fn push(&mut self, point: &Vector3<f64>) {
        self.0.iter_mut().zip(point.iter()).for_each(|(list, &coordinate)| list.push(coordinate));
    }

    /// Adds points of a triangle by their shares of its corners, a list for each corner.
    #[inline(always)]
    pub(crate) fn push_on_triangle(&mut self, [a, b, c]: &[Vector3<f64>; 3], [l0, l1, l2]: [&[f64]; 3]) {
        let (first, count) = (self.len(), l0.len());
        let (l1, l2) = (&l1[..count], &l2[..count]);
        for (axis, list) in self.0.iter_mut().enumerate() {
            list.resize(first + count, 0.0);
            for (k, place) in list[first..].iter_mut().enumerate() {
                *place = a[axis] * l0[k] + b[axis] * l1[k] + c[axis] * l2[k];
            }
        }
    }

    /// Repeats the last point up to a multiple of `lanes`.
    pub(crate) fn pad(&mut self, lanes: usize) {
        let padded = self.len().next_multiple_of(lanes);
        for list in &mut self.0 {
            if let Some(&last) = list.last() {
                list.resize(padded, last);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn at(&self, place: usize) -> Vector3<f64> {
        Vector3::new(self.0[0][place], self.0[1][place], self.0[2][place])
    }

    /// The points from `first` on.
    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self, simd: S, first: usize) -> [Lanes<S>; 3] {
        [
            Lanes::load(simd, &self.0[0], first),
            Lanes::load(simd, &self.0[1], first),
            Lanes::load(simd, &self.0[2], first),
        ]
    }
}

/// The points at which a column is evaluated, in an order that keeps neighbours together (a Z-order curve) so that those
/// of a vector lie at similar distances from any load.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    /// Padded to whole blocks.
    pub(crate) points: Points,
    /// Row of each point in the matrix, but for the padding.
    pub(crate) rows: Vec<u32>,
    /// Place of each row among the points, of targets by [`Targets::new`].
    places: Vec<u32>,
    /// A box around the points, where one is known.
    around: Option<Bounds>,
    /// On a layer: 1/thickness of each point (1/m), padded as they are, and the largest of these.
    pub(crate) inverse_thickness: Vec<f64>,
    pub(crate) largest_inverse: f64,
}

/// Points in a vector block, a multiple of every vector length.
pub(crate) const POINTS_PER_BLOCK: usize = 16;

impl Targets {
    pub(crate) fn new(points: &[Vector3<f64>]) -> Self {
        let Bounds { low, high } = Bounds::around(points);
        let scale = 1023.0 / (high - low).max().max(f64::MIN_POSITIVE);
        let key = |p: &Vector3<f64>| {
            let cell = (p - low) * scale;
            spread(cell.x as u32) | spread(cell.y as u32) << 1 | spread(cell.z as u32) << 2
        };
        let mut keyed: Vec<(u32, u32)> = points.iter().zip(0..).map(|(p, row)| (key(p), row)).collect();
        keyed.sort_unstable();
        let mut targets = Self::default();
        for (_, row) in keyed {
            targets.rows.push(row);
            targets.points.push(&points[row as usize]);
        }
        targets.places = vec![0; points.len()];
        targets.rows.iter().zip(0..).for_each(|(&row, place)| targets.places[row as usize] = place);
        targets.points.pad(POINTS_PER_BLOCK);
        targets.around = Some(Bounds { low, high });
        targets
    }

    /// A distance (m) from a place that no point exceeds.
    pub(crate) fn farthest(&self, place: &Vector3<f64>) -> f64 {
        let farthest = |around: &Bounds| (place - around.low).sup(&(around.high - place)).norm();
        self.around.as_ref().map_or(f64::INFINITY, farthest)
    }

    /// Leaves no target, to be filled by [`Targets::push_on_triangle`] in place of [`Targets::new`], and padded.
    pub(crate) fn clear(&mut self) {
        self.points.clear();
        self.rows.clear();
        self.inverse_thickness.clear();
        self.around = None;
    }

    /// Adds points of a triangle by their shares of its corners, one list a corner.
    pub(crate) fn push_on_triangle(&mut self, corners: &[Vector3<f64>; 3], shares: [&[f64]; 3]) {
        self.points.push_on_triangle(corners, shares);
        let first = self.rows.len() as u32;
        self.rows.extend(first..self.points.len() as u32);
    }

    /// Copies the values of a column, in the order of the points, to their rows: these one after another, as they are not in
    /// the cache.
    pub(crate) fn in_rows(&self, values: &[f64], column: &mut [f64]) {
        for (entry, &place) in column.iter_mut().zip(&self.places) {
            *entry = values[place as usize];
        }
    }
}

/// Some of the targets, gathered for vector code.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    /// Places among [`Targets`].
    pub(crate) index: Vec<u32>,
    /// Padded to whole blocks.
    pub(crate) points: Points,
    /// A value for each, 0 after [`Selection::gather`].
    pub(crate) values: Vec<f64>,
}

impl Selection {
    /// Copies the targets in `index`.
    pub(crate) fn gather(&mut self, targets: &Targets) {
        for (list, from) in self.points.0.iter_mut().zip(&targets.points.0) {
            gather(&self.index, from, list);
        }
        self.values.clear();
        self.values.resize(self.points.len(), 0.0);
    }
}

/// The values of a list at `index`, padded to whole blocks by repeating the last.
pub(crate) fn gather(index: &[u32], from: &[f64], list: &mut Vec<f64>) {
    list.clear();
    list.extend(index.iter().map(|&i| from[i as usize]));
    if let Some(&last) = list.last() {
        list.resize(index.len().next_multiple_of(POINTS_PER_BLOCK), last);
    }
}

/// Every bit of a 10-bit number moved to every third place.
fn spread(v: u32) -> u32 {
    let v = (v | v << 16) & 0x0300_00ff;
    let v = (v | v << 8) & 0x0300_f00f;
    let v = (v | v << 4) & 0x030c_30c3;
    (v | v << 2) & 0x0924_9249
}
