//! Initial gaps averaged against the pressures of the nodes, for the Galerkin form.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::entry::{OTHER_SIDE, WayIn, measure_entries};
use crate::contact::gap::measured::Measured;
use crate::contact::scene::Scene;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::average::AveragePoints;
use crate::surface::checked::Surface;

/// What is known of a vertex.
pub(crate) struct VertexGap {
    /// Initial gap (m).
    pub distance: f64,
    /// Outward unit normal of the obstacle there.
    pub normal: Vector3<f64>,
    /// The displacement (m) that it was measured at.
    pub shift: Vector3<f64>,
    /// Whether the gap is that to a plane through a line of the obstacle.
    pub is_on_line: bool,
}

/// Average of the initial gap (m) against the pressure of each node, from the vertices and the middles of the edges
/// around it.
///
/// From the vertices alone a round obstacle's gap would be overrated by some h²/6R on edges of length h, which
/// costs more force than all else in the Galerkin form.
///
/// A gap to another side of the obstacle than the node's says nothing of the way to the node's side: across a sharp edge
/// the node's own gap stands for it.
///
/// * `normals`: along which the rows of R of the nodes are (k)
/// * `at_vertices`: what is known of some vertices
pub(crate) fn measure(
    surface: &Surface,
    scene: &Scene,
    basis: PressureBasis,
    nodes: &[usize],
    normals: &[Vector3<f64>],
    at_vertices: impl FnOnce(&[usize]) -> Result<Vec<VertexGap>, ContactError>,
) -> Result<Vec<f64>, ContactError> {
    let around = AveragePoints::around(surface, nodes);
    let at_vertices = at_vertices(&around.vertices)?;
    let at = |vertex: u32| {
        let row = around.vertices.binary_search(&(vertex as usize)).expect("the edges join the vertices");
        &at_vertices[row]
    };
    let at_middles = measure_middles(surface, scene, &around, at)?;
    // A node's row of R is of displacements along its own normal, all around it.
    let taken = |node: usize, there: &VertexGap| {
        let own = at(nodes[node] as u32);
        let there = if there.normal.dot(&own.normal) < OTHER_SIDE { own } else { there };
        there.distance + (there.normal - normals[node]).dot(&there.shift)
    };
    let at_vertex = |node, row: usize| taken(node, &at_vertices[row]);
    let at_middle = |node, row: usize| taken(node, &at_middles[row]);
    Ok(around.averages(surface, basis, nodes, at_vertex, at_middle))
}

/// Initial gaps at the middles of the edges, where the skin moves as it does at their ends in the mean.
fn measure_middles<'a>(
    surface: &Surface,
    scene: &Scene,
    around: &AveragePoints,
    at: impl Fn(u32) -> &'a VertexGap,
) -> Result<Vec<VertexGap>, ContactError> {
    // A distance changes by no more than the way, so no middle is beyond the reach.
    let mut reach = Vec::with_capacity(around.edges.len());
    let mut middles = around.middles(surface);
    let mut shifts = Vec::with_capacity(middles.len());
    for (&[a, b], middle) in around.edges.iter().zip(&mut middles) {
        let length = (surface.vertices()[a as usize] - surface.vertices()[b as usize]).norm();
        let [a, b] = [at(a), at(b)];
        // Between skin that moves along one side of the obstacle and skin that moves along another nobody knows the way.
        let is_one_side = a.normal.dot(&b.normal) >= OTHER_SIDE;
        let shift = if is_one_side { 0.5 * (a.shift + b.shift) } else { Vector3::zeros() };
        reach.push(a.distance.abs() + length + a.shift.norm() + shift.norm());
        *middle += shift;
        shifts.push(shift);
    }
    let found = scene.obstacle.signed_distance(&middles, reach.iter().copied().reduce(f64::max))?;
    let mut measured = Measured { distance: found.distance, normal: found.normal };
    let normals = surface.vertex_normals();
    let between = around.edges.iter().map(|ends| {
        let [a, b] = ends.map(|end| normals[end as usize]);
        (a + b).try_normalize(0.0).unwrap_or(a)
    });
    let way_in = WayIn::new(scene, between, |row| reach[row]);
    measure_entries(&middles, |_| true, &scene.obstacle, &way_in, &mut measured)?;
    let gaps = around.edges.iter().zip(shifts).enumerate().map(|(row, (&ends, shift))| {
        let [a, b] = ends.map(&at);
        let normal = measured.normal[row];
        let is_on_line = a.is_on_line && b.is_on_line;
        let distance = if is_on_line {
            0.5 * (a.distance + b.distance)
        } else {
            measured.distance[row] - normal.dot(&shift)
        };
        VertexGap { distance, normal, shift, is_on_line }
    });
    Ok(gaps.collect())
}
