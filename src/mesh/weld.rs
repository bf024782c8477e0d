//! Clusters of vertices that lie close together.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::mesh::grid::{finest_cell, sorted_by_cell};

/// Cells on either side of a cell that may hold points within the tolerance of its own.
const CELL_REACH: i64 = 2;

/// The lowest vertex of the cluster of each vertex: clusters are joined by steps of at most `tolerance` (m).
///
/// The diagonal of a cell is the tolerance, so that all points of a cell are one cluster and the work stays near
/// the number of points, however wide the tolerance.
pub(super) fn weld(vertices: &[Vector3<f64>], tolerance: f64) -> Vec<u32> {
    let bounds = Bounds::around(vertices);
    let cell = (tolerance / 3f64.sqrt() * (1.0 - 1e-12)).max(finest_cell(&bounds));
    let is_one_cluster = tolerance >= 3f64.sqrt() * cell;
    let keyed = sorted_by_cell(vertices, &bounds.low, cell);
    let groups: Vec<&[([i64; 3], u32)]> = keyed.chunk_by(|a, b| a.0 == b.0).collect();
    let numbers: HashMap<[i64; 3], usize> =
        groups.iter().enumerate().map(|(number, group)| (group[0].0, number)).collect();

    let mut root: Vec<u32> = (0..vertices.len() as u32).collect();
    for group in &groups {
        let first = if is_one_cluster { &group[..1] } else { group };
        join_near(vertices, tolerance, first, group, is_one_cluster, &mut root);
        let [x, y, z] = group[0].0;
        for dx in 0..=CELL_REACH {
            for dy in -CELL_REACH..=CELL_REACH {
                for dz in -CELL_REACH..=CELL_REACH {
                    // each pair of cells once
                    if (dx, dy, dz) <= (0, 0, 0) {
                        continue;
                    }
                    if let Some(other) = numbers.get(&[x + dx, y + dy, z + dz]) {
                        join_near(vertices, tolerance, group, groups[*other], is_one_cluster, &mut root);
                    }
                }
            }
        }
    }
    for i in 0..vertices.len() as u32 {
        root[i as usize] = find(&mut root, i);
    }
    root
}

/// Joins the points of two cells that are within the tolerance; one pair is enough where cells are one cluster.
fn join_near(
    vertices: &[Vector3<f64>],
    tolerance: f64,
    first: &[([i64; 3], u32)],
    second: &[([i64; 3], u32)],
    is_one_cluster: bool,
    root: &mut [u32],
) {
    let is_same_cell = first[0].0 == second[0].0;
    for &(_, i) in first {
        for &(_, j) in second {
            if (vertices[i as usize] - vertices[j as usize]).norm() <= tolerance {
                let (a, b) = (find(root, i), find(root, j));
                root[a.max(b) as usize] = a.min(b);
                if is_one_cluster && !is_same_cell {
                    return;
                }
            }
        }
    }
}

/// Root of a union-find tree whose parents have lower indices; halves the path.
fn find(root: &mut [u32], mut i: u32) -> u32 {
    while root[i as usize] != i {
        root[i as usize] = root[root[i as usize] as usize];
        i = root[i as usize];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joins all pairs, one by one.
    fn weld_all_pairs(vertices: &[Vector3<f64>], tolerance: f64) -> Vec<u32> {
        let mut root: Vec<u32> = (0..vertices.len() as u32).collect();
        let mut is_done = false;
        while !is_done {
            is_done = true;
            for (i, a) in vertices.iter().enumerate() {
                for (j, b) in vertices.iter().enumerate() {
                    if root[j] < root[i] && (a - b).norm() <= tolerance {
                        root[i] = root[j];
                        is_done = false;
                    }
                }
            }
        }
        root
    }

    proptest::proptest! {
        #[test]
        fn clusters_equal_those_of_all_pairs(
            points in proptest::collection::vec(proptest::array::uniform3(0.0..1.0), 1..60),
            tolerance in 0.0..0.3,
        ) {
            let vertices: Vec<Vector3<f64>> = points.into_iter().map(Vector3::from).collect();
            proptest::prop_assert_eq!(weld(&vertices, tolerance), weld_all_pairs(&vertices, tolerance));
        }
    }

    #[test]
    fn equal_points_weld_at_tolerance_zero_and_near_ones_do_not() {
        let x = |x: f64| Vector3::new(x, 0.0, 0.0);
        let vertices = [x(1.0), x(0.0), x(1.0), x(-0.0), x(1.0 + 1e-15)];
        assert_eq!(weld(&vertices, 0.0), [0, 1, 0, 1, 4]);
    }

    #[test]
    fn a_tolerance_wider_than_the_mesh_joins_everything_and_a_tiny_one_nothing() {
        let vertices: Vec<Vector3<f64>> =
            (0..20_000).map(|i| Vector3::new(f64::from(i), 0.5, -1.0)).collect();
        assert!(weld(&vertices, 1e300).iter().all(|root| *root == 0));
        assert!(weld(&vertices, 1e6).iter().all(|root| *root == 0));
        assert!(weld(&vertices, f64::MIN_POSITIVE).iter().enumerate().all(|(i, root)| *root == i as u32));
        assert!(weld(&vertices[..1], 0.0) == [0]);
    }
}
