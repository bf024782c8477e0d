//! Whether a given compliance can belong to its nodes: the same both ways, stronger between neighbours than far apart, and
//! blocks that let a force along the normal dent the skin along it.

use nalgebra::{Matrix3, Vector3};

use crate::response::skin::nodes::PreparedNodes;

/// Nodes that are looked at, spread over all of them.
const MOST_NODES: usize = 64;
/// ‖R - Rᵀ‖ / ‖R + Rᵀ‖ from which it is told: up to 0.3 by collocation on scans with slivers, 0.4 to 1.1 where rows alone are in
/// another order, 1 where one half is empty.
const MOST_ONE_SIDED: f64 = 0.4;
/// Share of the nodes whose neighbour answers less than the farthest one from which it is told: none under kernels and bodies,
/// 0.3 to 1 in orders drawn at random.
const MOST_STRAYED: f64 = 0.1;
/// How far a force along the normal dents the skin sideways, as a share of the dent, from which it is told: up to 0.05 in bodies
/// with bones and without, of ν from 0.3 to 0.5, 0.09 and more with axes in another order, above 1 where rows alone have them so.
const MOST_SIDEWAYS: f64 = 0.08;
/// Relative difference up to which two answers are the same.
const ROUNDING: f64 = 1e-6;

/// What speaks against a compliance for these nodes, in words that follow its name.
///
/// * `entry`: of two rows, displacement along the force per newton (m/N), of blocks in the mean over its directions
pub(super) fn misfit(nodes: &PreparedNodes, entry: impl Fn(usize, usize) -> f64) -> Option<String> {
    let (mut difference, mut sum) = (0.0, 0.0);
    let (mut strayed, mut count) = (0_u32, 0_u32);
    for [row, near, far] in neighbours_and_farthest(nodes) {
        let mut coupling = |other: usize| {
            let ways = [entry(row, other), entry(other, row)];
            difference += (ways[0] - ways[1]).powi(2);
            sum += (ways[0] + ways[1]).powi(2);
            // As a correlation, as a whole finger may bend more than it is dented.
            (ways[0] + ways[1]).abs() / entry(other, other).abs().sqrt()
        };
        strayed += u32::from(coupling(near) < (1.0 - ROUNDING) * coupling(far));
        count += 1;
    }
    if difference > MOST_ONE_SIDED.powi(2) * sum {
        return Some(format!(
            "is not the same both ways: entries (i, j) and (j, i) differ by {:.0} % of their mean, where a force at j moves i as one at i moves j: are rows and columns in the order of the nodes, and both halves filled?",
            200.0 * (difference / sum).sqrt()
        ));
    }
    (f64::from(strayed) > MOST_STRAYED * f64::from(count)).then(|| {
        format!(
            "does not fit its nodes: {strayed} of {count} move less with the node beside them than with one far away: are its rows and columns in the order of the nodes, and the nodes numbered from 0?"
        )
    })
}

/// What speaks against the axes of blocks for these nodes, in words that follow the name of the compliance.
///
/// * `block`: of two rows, displacement per newton (m/N)
pub(super) fn misfit_of_axes(
    nodes: &PreparedNodes,
    block: impl Fn(usize, usize) -> Matrix3<f64>,
) -> Option<String> {
    let (mut dents, mut sideways) = (0.0, 0.0);
    for [row, near, _] in neighbours_and_farthest(nodes) {
        let normal = nodes.surface().vertex_normals()[nodes.list()[row]];
        // What bends the whole finger moves both.
        let dent = (block(row, row) + block(near, near) - block(row, near) - block(near, row)) * normal;
        let along = dent.dot(&normal);
        dents += along;
        sideways += (dent - along * normal).norm();
    }
    (sideways > MOST_SIDEWAYS * dents).then(|| {
        "does not fit the normals at its nodes: forces along these dent the skin sideways too: are the axes of its blocks in the order x, y, z, and those of the mesh?".to_string()
    })
}

/// Rows of some nodes, each with that of the nearest node around it and of the farthest of them.
fn neighbours_and_farthest(nodes: &PreparedNodes) -> Vec<[usize; 3]> {
    let (surface, list) = (nodes.surface(), nodes.list());
    let place = |row: usize| surface.vertices()[list[row]];
    let looked_at = || (0..list.len()).step_by(list.len().div_ceil(MOST_NODES).max(1));
    let with_both = |row: usize| {
        let distance = |other: &usize| Vector3::metric_distance(&place(row), &place(*other));
        let closer = |a: &usize, b: &usize| distance(a).total_cmp(&distance(b));
        let around = surface.neighbours(list[row]).iter();
        let near = around.filter_map(|&vertex| nodes.row(vertex as usize)).min_by(closer)?;
        Some([row, near, looked_at().max_by(closer)?])
    };
    looked_at().filter_map(with_both).collect()
}
