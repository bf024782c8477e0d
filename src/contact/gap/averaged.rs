//! Initial gaps averaged against the pressures of the nodes, for the Galerkin form.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::entry::{WayIn, measure_entries};
use crate::contact::gap::measured::Measured;
use crate::contact::scene::Scene;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::average::AveragePoints;
use crate::surface::checked::Surface;

/// Average of the initial gap (m) against the pressure of each node, from the vertices and the middles of the edges
/// around it.
///
/// From the vertices alone a round obstacle's gap would be overrated by some h²/6R on edges of length h, which
/// costs more force than all else in the Galerkin form.
///
/// A gap above `highest` counts as that. Beside a sharp rim the distance is that to the side of the obstacle, which says
/// nothing of its gap: there the average is closed where half of the pressure is over the obstacle. A smooth contact has
/// such gaps beyond twice its radius.
///
/// * `highest`: deepest penetration of a vertex (m)
/// * `at_vertices`: the initial gap (m) of some vertices
/// * `shift_at`: the displacement (m) that a vertex was measured at
/// * `is_on_line`: whether the gap of a vertex is that to a plane through a line of the obstacle
pub(crate) fn measure(
    surface: &Surface,
    scene: &Scene,
    basis: PressureBasis,
    nodes: &[usize],
    highest: f64,
    at_vertices: impl FnOnce(&[usize]) -> Result<Vec<f64>, ContactError>,
    shift_at: impl Fn(usize) -> Vector3<f64>,
    is_on_line: impl Fn(usize) -> bool,
) -> Result<Vec<f64>, ContactError> {
    let around = AveragePoints::around(surface, nodes);
    let at_vertices = at_vertices(&around.vertices)?;
    let gap_at = |vertex: usize| {
        at_vertices[around.vertices.binary_search(&vertex).expect("the edges join the vertices")]
    };
    // A distance changes by no more than the way, so no middle is beyond the reach.
    let mut reach: f64 = 0.0;
    let mut middles = around.middles(surface);
    let mut shifts = Vec::with_capacity(middles.len());
    for (&[a, b], middle) in around.edges.iter().zip(&mut middles) {
        let [a, b] = [a as usize, b as usize];
        let length = (surface.vertices()[a] - surface.vertices()[b]).norm();
        let shift = 0.5 * (shift_at(a) + shift_at(b));
        reach = reach.max(gap_at(a).abs() + length + shift_at(a).norm() + shift.norm());
        *middle += shift;
        shifts.push(shift);
    }
    let found = scene.obstacle.signed_distance(&middles, Some(reach))?;
    let mut at_middles = Measured { distance: found.distance, normal: found.normal };
    let normals = surface.vertex_normals();
    let between = around.edges.iter().map(|ends| {
        let [a, b] = ends.map(|end| normals[end as usize]);
        (a + b).try_normalize(0.0).unwrap_or(a)
    });
    let way_in = WayIn::new(scene, between, reach);
    measure_entries(&middles, |_| true, &scene.obstacle, &way_in, &mut at_middles)?;
    for (row, shift) in shifts.iter().enumerate().filter(|(_, shift)| **shift != Vector3::zeros()) {
        at_middles.distance[row] -= at_middles.normal[row].dot(shift);
    }
    for (&ends, gap) in around.edges.iter().zip(&mut at_middles.distance) {
        let [a, b] = ends.map(|end| end as usize);
        if is_on_line(a) && is_on_line(b) {
            *gap = 0.5 * (gap_at(a) + gap_at(b));
        }
    }
    let lowered = |gaps: &[f64]| gaps.iter().map(|gap| gap.min(highest)).collect::<Vec<f64>>();
    let (at_vertices, at_middles) = (lowered(&at_vertices), lowered(&at_middles.distance));
    Ok(around.averages(surface, basis, nodes, &at_vertices, &at_middles))
}
