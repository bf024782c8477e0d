//! Initial gaps averaged against the pressures of the nodes, for the Galerkin form.

use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::average::AveragePoints;

/// Average of the initial gap (m) against the pressure of each node, from the vertices and the middles of the edges
/// around it.
///
/// From the vertices alone a round obstacle's gap would be overrated by some h²/6R on edges of length h, which
/// costs more force than all else in the Galerkin form.
pub(crate) fn measure(gaps: &Gaps, basis: PressureBasis, nodes: &[usize]) -> Result<Vec<f64>, ContactError> {
    let surface = gaps.surface;
    let around = AveragePoints::around(surface, nodes);
    let at_vertices = gaps.at(&around.vertices)?.distance;
    // A distance changes by no more than the way, so no middle is beyond the reach.
    let mut reach: f64 = 0.0;
    for &[a, b] in &around.edges {
        let [a, b] = [a as usize, b as usize];
        let length = (surface.vertices()[a] - surface.vertices()[b]).norm();
        let row = around.vertices.binary_search(&a).expect("the edges join the vertices");
        reach = reach.max(at_vertices[row].abs() + length);
    }
    let at_middles = gaps.scene.obstacle.signed_distance(&around.middles(surface), Some(reach))?.distance;
    Ok(around.averages(surface, basis, nodes, &at_vertices, &at_middles))
}
