//! Points in a uniform grid, for neighbours within a fixed distance.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;

/// Points sorted into cubic cells of the search radius.
pub(super) struct PointGrid<'a> {
    points: &'a [Vector3<f64>],
    radius: f64,
    cell: f64,
    origin: Vector3<f64>,
    cells: HashMap<[i64; 3], (u32, u32)>,
    order: Vec<u32>,
}

impl<'a> PointGrid<'a> {
    /// * `points`: finite
    /// * `radius`: search distance, >= 0
    pub(super) fn new(points: &'a [Vector3<f64>], radius: f64) -> PointGrid<'a> {
        let bounds = Bounds::around(points);
        let cell = radius.max(finest_cell(&bounds));
        let keyed = sorted_by_cell(points, &bounds.low, cell);
        let mut cells = HashMap::with_capacity(keyed.len());
        let mut start = 0;
        for run in keyed.chunk_by(|a, b| a.0 == b.0) {
            cells.insert(run[0].0, (start, start + run.len() as u32));
            start += run.len() as u32;
        }
        let order = keyed.into_iter().map(|(_, i)| i).collect();
        PointGrid { points, radius, cell, origin: bounds.low, cells, order }
    }

    /// Calls `visit(index, distance)` for every point within the radius of `point`.
    pub(super) fn for_each_near(&self, point: &Vector3<f64>, mut visit: impl FnMut(usize, f64)) {
        let center = key(point, &self.origin, self.cell);
        for dx in -1..=1 {
            for dy in -1..=1 {
                for dz in -1..=1 {
                    let cell = [center[0] + dx, center[1] + dy, center[2] + dz];
                    let Some(&(start, end)) = self.cells.get(&cell) else { continue };
                    for &i in &self.order[start as usize..end as usize] {
                        let distance = (self.points[i as usize] - point).norm();
                        if distance <= self.radius {
                            visit(i as usize, distance);
                        }
                    }
                }
            }
        }
    }
}

/// Edge of the finest cells (m): at 1e-12 of the extent their numbers stay far from the limits of i64.
pub(super) fn finest_cell(bounds: &Bounds) -> f64 {
    (1e-12 * (bounds.high - bounds.low).max()).max(f64::MIN_POSITIVE)
}

/// The cell and the index of each point, sorted.
pub(super) fn sorted_by_cell(
    points: &[Vector3<f64>],
    origin: &Vector3<f64>,
    cell: f64,
) -> Vec<([i64; 3], u32)> {
    let mut keyed: Vec<([i64; 3], u32)> =
        points.iter().enumerate().map(|(i, point)| (key(point, origin, cell), i as u32)).collect();
    keyed.sort_unstable();
    keyed
}

fn key(point: &Vector3<f64>, origin: &Vector3<f64>, cell: f64) -> [i64; 3] {
    let scaled = (point - origin) / cell;
    [scaled.x.floor() as i64, scaled.y.floor() as i64, scaled.z.floor() as i64]
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn neighbours_equal_those_of_all_pairs(
            points in proptest::collection::vec(proptest::array::uniform3(-1.0..1.0), 1..60),
            radius in 0.0..0.8,
        ) {
            let points: Vec<Vector3<f64>> = points.into_iter().map(Vector3::from).collect();
            let grid = PointGrid::new(&points, radius);
            for point in &points {
                let mut found = Vec::new();
                grid.for_each_near(point, |i, distance| found.push((i, distance)));
                found.sort_by_key(|entry| entry.0);
                let all = points.iter().enumerate().map(|(i, other)| (i, (other - point).norm()));
                proptest::prop_assert_eq!(found, all.filter(|entry| entry.1 <= radius).collect::<Vec<_>>());
            }
        }
    }
}
