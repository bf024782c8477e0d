//! How fine the mesh of a contact is.

use std::f64::consts::PI;

use crate::surface::checked::Surface;

/// Twice the area over the length of the rim, in mean edges.
///
/// The rim runs across the triangles that only some corners of carry force: as high as an equilateral one, `√3/2` edges,
/// they are as long as it together, so that edges cancel. Where rims end at those of the mesh, the cells are those of a
/// circle of that area, which has the shortest rim.
pub(crate) fn cells_per_radius(surface: &Surface, active: &[usize], contact_area: f64) -> f64 {
    if active.is_empty() {
        return 0.0;
    }
    let mut is_active = vec![false; surface.vertices().len()];
    active.iter().for_each(|&vertex| is_active[vertex] = true);
    // Each triangle as often as it has corners under force.
    let share_across = |&face: &u32| {
        let count =
            surface.faces()[face as usize].iter().filter(|&&corner| is_active[corner as usize]).count();
        if count < 3 { surface.face_areas()[face as usize] / count as f64 } else { 0.0 }
    };
    let across: f64 = active.iter().flat_map(|&vertex| surface.faces_around(vertex)).map(share_across).sum();
    let of_circle = (contact_area / PI).sqrt() / mean_edge(surface, active);
    of_circle.min(3.0_f64.sqrt() * contact_area / across)
}

/// Mean length of the edges at some vertices (m).
pub(crate) fn mean_edge(surface: &Surface, vertices: &[usize]) -> f64 {
    mean(vertices.iter().flat_map(|&vertex| surface.edge_lengths(vertex)))
}

/// Mean height of the smooth surface over the triangles at some vertices, from the vertex normals (m): what a quadratic
/// function is above its linear interpolation in the mean, an eighth of its second difference along an edge.
pub(crate) fn mean_bulge(surface: &Surface, vertices: &[usize]) -> f64 {
    let (positions, normals) = (surface.vertices(), surface.vertex_normals());
    let height = |a: usize, b: usize| (normals[b] - normals[a]).dot(&(positions[b] - positions[a])) / 8.0;
    let neighbours = |vertex| surface.neighbours(vertex).iter().map(move |&other| (vertex, other as usize));
    mean(vertices.iter().flat_map(|&vertex| neighbours(vertex)).map(|(a, b)| height(a, b)))
}

/// 0 of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    sum / f64::from(count.max(1))
}
