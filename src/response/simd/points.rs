//! The points at which a column is evaluated, laid out for vector code.

use nalgebra::Vector3;
use pulp::Simd;

use crate::geometry::bounds::Bounds;
use crate::response::simd::lanes::Lanes;

/// Coordinates in separate lists, in an order that keeps neighbours together (a Z-order curve) so that points
/// of a vector lie at similar distances from any load.
#[derive(Debug, Default)]
pub(crate) struct Targets {
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
    /// Row of each point in the matrix; shorter than the coordinates, which are padded by repeating the last.
    pub(crate) rows: Vec<u32>,
    /// Place of each row in the coordinates, of targets by [`Targets::new`].
    places: Vec<u32>,
    /// A box around the points, where one is known.
    around: Option<Bounds>,
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
            let point = &points[row as usize];
            targets.rows.push(row);
            targets.x.push(point.x);
            targets.y.push(point.y);
            targets.z.push(point.z);
        }
        targets.places = vec![0; points.len()];
        targets.rows.iter().zip(0..).for_each(|(&row, place)| targets.places[row as usize] = place);
        targets.pad();
        targets.around = Some(Bounds { low, high });
        targets
    }

    /// A distance (m) from a place that no point exceeds.
    pub(crate) fn farthest(&self, place: &Vector3<f64>) -> f64 {
        let farthest = |around: &Bounds| (place - around.low).sup(&(around.high - place)).norm();
        self.around.as_ref().map_or(f64::INFINITY, farthest)
    }

    /// Empties the lists, to be filled by [`Targets::push_on_triangle`] in place of [`Targets::new`].
    pub(crate) fn clear(&mut self) {
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            list.clear();
        }
        self.rows.clear();
        self.around = None;
    }

    /// Adds points of a triangle by their shares of its corners, one list a corner.
    pub(crate) fn push_on_triangle(&mut self, corners: &[Vector3<f64>; 3], shares: [&[f64]; 3]) {
        let [a, b, c] = corners;
        for (axis, list) in [&mut self.x, &mut self.y, &mut self.z].into_iter().enumerate() {
            let places = shares[0].iter().zip(shares[1]).zip(shares[2]);
            list.extend(places.map(|((l0, l1), l2)| l0 * a[axis] + l1 * b[axis] + l2 * c[axis]));
        }
        let first = self.rows.len() as u32;
        self.rows.extend(first..self.x.len() as u32);
    }

    /// Fills up to whole blocks.
    pub(crate) fn pad(&mut self) {
        let padded = self.rows.len().next_multiple_of(POINTS_PER_BLOCK);
        for list in [&mut self.x, &mut self.y, &mut self.z] {
            if let Some(&last) = list.last() {
                list.resize(padded, last);
            }
        }
    }

    /// A target, by its place in the lists.
    pub(crate) fn point(&self, place: usize) -> Vector3<f64> {
        Vector3::new(self.x[place], self.y[place], self.z[place])
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
    /// Places in the lists of [`Targets`]; shorter than the coordinates, which are padded to whole blocks.
    pub(crate) index: Vec<u32>,
    pub(crate) x: Vec<f64>,
    pub(crate) y: Vec<f64>,
    pub(crate) z: Vec<f64>,
    /// A value for each, 0 after [`Selection::gather`].
    pub(crate) values: Vec<f64>,
}

impl Selection {
    /// Copies the coordinates of the targets in `index`.
    pub(crate) fn gather(&mut self, targets: &Targets) {
        for (list, from) in [(&mut self.x, &targets.x), (&mut self.y, &targets.y), (&mut self.z, &targets.z)]
        {
            gather(&self.index, from, list);
        }
        self.values.clear();
        self.values.resize(self.x.len(), 0.0);
    }

    /// Coordinates from the given one on.
    #[inline(always)]
    pub(crate) fn place<S: Simd>(&self, simd: S, first: usize) -> [Lanes<S>; 3] {
        [
            Lanes::load(simd, &self.x, first),
            Lanes::load(simd, &self.y, first),
            Lanes::load(simd, &self.z, first),
        ]
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
