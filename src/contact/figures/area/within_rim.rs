//! Contact area within the rim, which is found between the vertices.

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::area::beside::Beside;
use crate::contact::figures::area::rim::RimOnEdges;
use crate::contact::gap::initial::Gaps;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// Power of the gap that grows with the distance from the rim of a smooth contact.
const SMOOTH_RIM: f64 = 2.0 / 3.0;

/// Edges in thicknesses of a layer, to the power 3/2, at which its rim is half-way between that of a smooth contact and that
/// of springs, at ν = 1/2, and what is added per 1 - 2ν: fitted to areas under spheres.
const HALF_SPRINGS: [f64; 2] = [0.35, 2.6];

/// Contact area at each vertex (n, m²), within the rim that sharp edges and the gaps beside it place.
///
/// * `obstacle_share`: of the work that goes into the obstacle
pub(crate) fn areas_within_rim(
    gaps: &Gaps,
    response: &Compliance,
    obstacle_share: Option<f64>,
    forces: &NodeForces,
    beside: &Beside,
    on_edges: &RimOnEdges,
) -> Result<Vec<f64>, ContactError> {
    let rim_shift = response.traits.discretization.rim_shift();
    let mut gap = forces.gap.clone();
    let (vertices, at_rim) = beside.rim(gaps)?;
    vertices.iter().zip(at_rim).for_each(|(&vertex, at_rim)| gap[vertex] = at_rim);
    let mut is_across = vec![false; gap.len()];
    for across in &on_edges.across {
        (gap[across.vertex], is_across[across.vertex]) = (across.distance, true);
    }
    let (touches, active) = (forces.touching(), &forces.active);
    let power_on = |side: &dyn ElasticSkin, vertex: usize| {
        let layer = side.kernel_at(vertex).and_then(|kernel| Some((kernel, kernel.layer_at(vertex)?)));
        layer.map_or(SMOOTH_RIM, |(kernel, thickness)| {
            rim_on_layer(gaps.surface.shortest_edge(vertex) / thickness, kernel.poisson_ratio())
        })
    };
    let power = |vertex: usize| {
        let of_skin = power_on(response.skin, vertex);
        response
            .product()
            .zip(obstacle_share)
            .map_or(of_skin, |(product, share)| of_skin + share * (power_on(product, vertex) - of_skin))
    };
    let beside = GapsBeside { gap: &gap, is_across: &is_across, power: &power };
    Ok(contact_areas(gaps.surface, rim_shift, &beside, &touches, &forces.force, active))
}

/// Power of the gap that grows with the distance from the rim on a layer: that of a smooth contact near it, and 1 where the
/// layer gives way as springs do.
///
/// * `cell`: length of the edges at the rim in thicknesses
fn rim_on_layer(cell: f64, poisson_ratio: f64) -> f64 {
    let [incompressible, compressible] = HALF_SPRINGS;
    let half = incompressible + compressible * (1.0 - 2.0 * poisson_ratio);
    let cell = cell.powf(1.5);
    SMOOTH_RIM + (1.0 - SMOOTH_RIM) * cell / (cell + half)
}

/// The gaps that place the rim.
struct GapsBeside<'a> {
    /// (n, m).
    gap: &'a [f64],
    /// Free vertices whose gap is to the other side of a sharp edge (n).
    is_across: &'a [bool],
    /// Power of the gap that grows with the distance from the rim around a vertex.
    power: &'a dyn Fn(usize) -> f64,
}

/// Contact area at each vertex (n, m²), from the rim that the gaps beside it place; zero without force.
///
/// Outside a smooth contact the gap grows as the 3/2 power of the distance from the rim (Johnson 1985, §4.2 and §5.1).
/// So `g^(2/3) / |∇ g^(2/3)|`, over the free triangles around a free vertex, is its distance from the rim for any
/// skin; beyond the thickness of a layer, where it gives way as springs do, the gap grows as the distance itself. Across a
/// sharp edge of the obstacle the gap to the other side is that distance. It is continued with
/// slope one to the touching vertices of the triangles that the rim cuts, and the area of a triangle within the rim is
/// shared by its loaded vertices. A rim that is not smooth leaves the area between that of the triangles with all
/// corners touching and that of all loaded triangles. The area of a patch is at least its force over its largest
/// `f_i / S_i`: a vertex alone has its S_i.
///
/// * `rim_shift`: how far the rim lies outside of where the gaps put it, in edge lengths
/// * `gaps`: beside the contact, read up to two rings around it
/// * `touches`: (n,) vertices that carry force or whose gap is closed
/// * `node_force`: (n, N)
/// * `active`: vertices with f > 0
fn contact_areas(
    surface: &Surface,
    rim_shift: f64,
    gaps: &GapsBeside,
    touches: &[bool],
    node_force: &[f64],
    active: &[usize],
) -> Vec<f64> {
    let GapsBeside { gap, is_across, .. } = gaps;
    // Distance inside the rim (m), negative outside. Vertices off the loaded triangles keep 0: their own distances shift
    // the rim inward by 0.03 cells.
    let mut depth = vec![0.0; gap.len()];
    let around = surface.k_ring(active, 1);
    for &vertex in around.iter().filter(|&&vertex| !touches[vertex]) {
        if is_across[vertex] {
            depth[vertex] = -gap[vertex].max(0.0);
            continue;
        }
        let shift = rim_shift * surface.shortest_edge(vertex);
        depth[vertex] = -(distance_outside(surface, gaps, touches, vertex) - shift).max(0.0);
    }
    for &vertex in around.iter().filter(|&&vertex| touches[vertex]) {
        depth[vertex] = depth_inside(surface, touches, &depth, vertex);
    }
    let mut areas = vec![0.0; gap.len()];
    for face in surface.faces_at(active) {
        let corners = surface.faces()[face as usize].map(|corner| corner as usize);
        let loaded = corners.iter().filter(|&&corner| node_force[corner] > 0.0).count() as f64;
        let within = share_within(corners.map(|corner| (touches[corner], depth[corner].abs())));
        for &corner in corners.iter().filter(|&&corner| node_force[corner] > 0.0) {
            areas[corner] += surface.face_areas()[face as usize] * within / loaded;
        }
    }
    for patch in surface.patches(active) {
        let force: f64 = patch.iter().map(|&vertex| node_force[vertex]).sum();
        let pressure = patch.iter().map(|&vertex| node_force[vertex] / surface.vertex_areas()[vertex]);
        let missing = force / pressure.fold(0.0, f64::max) - patch.iter().map(|&v| areas[v]).sum::<f64>();
        if missing > 0.0 {
            patch.iter().for_each(|&vertex| areas[vertex] += missing * node_force[vertex] / force);
        }
    }
    areas
}

/// Distance of a free vertex from the rim (m); half the way to the closest touching neighbour where no triangle is free.
fn distance_outside(surface: &Surface, gaps: &GapsBeside, touches: &[bool], vertex: usize) -> f64 {
    let power = (gaps.power)(vertex);
    let root = |vertex: u32| gaps.gap[vertex as usize].max(0.0).powf(power);
    let (mut slope, mut area) = (0.0, 0.0);
    for &face in surface.faces_around(vertex) {
        let corners = surface.faces()[face as usize];
        if corners.iter().any(|&corner| touches[corner as usize]) {
            continue;
        }
        let [a, b, c] = corners.map(|corner| surface.vertices()[corner as usize]);
        let [at_a, at_b, at_c] = corners.map(root);
        // area times |∇|
        slope += 0.5 * (at_a * (c - b) + at_b * (a - c) + at_c * (b - a)).norm();
        area += surface.face_areas()[face as usize];
    }
    let distance = root(vertex as u32) * area / slope;
    if distance.is_finite() {
        return distance;
    }
    let position = surface.vertices()[vertex];
    let touching = surface.neighbours(vertex).iter().filter(|&&other| touches[other as usize]);
    0.5 * touching
        .map(|&other| (surface.vertices()[other as usize] - position).norm())
        .fold(f64::INFINITY, f64::min)
}

/// How far a touching vertex lies inside the rim (m, ≥ 0), from the free vertices beside it; 0 where there are none.
fn depth_inside(surface: &Surface, touches: &[bool], depth: &[f64], vertex: usize) -> f64 {
    let own = surface.vertices()[vertex];
    let (mut sum, mut weight, mut bound) = (0.0, 0.0, f64::INFINITY);
    for &face in surface.faces_around(vertex) {
        let free = |corner: &u32| !touches[*corner as usize];
        let place = |corner: u32| surface.vertices()[corner as usize] - own;
        let mut free = surface.faces()[face as usize].into_iter().filter(free);
        match (free.next(), free.next()) {
            // The plane of slope one through the depths of both free corners.
            (Some(a), Some(b)) => {
                let area = surface.face_areas()[face as usize];
                let edge = place(b) - place(a);
                let length = edge.norm();
                let rise = ((depth[b as usize] - depth[a as usize]) / length).clamp(-1.0, 1.0);
                let middle = 0.5 * (depth[a as usize] + depth[b as usize]);
                // From the middle of the free edge; across it, the triangle's height.
                let along = -0.5 * (place(a) + place(b)).dot(&edge) / length;
                sum += area * (middle + rise * along + (1.0 - rise * rise).sqrt() * 2.0 * area / length);
                weight += area;
            }
            (Some(a), None) => bound = bound.min(depth[a as usize] + place(a).norm()),
            _ => {}
        }
    }
    let depth = if weight > 0.0 { sum / weight } else { bound };
    if depth.is_finite() { depth.max(0.0) } else { 0.0 }
}

/// Share of a triangle within the rim, by whether its corners touch and their distances from the rim (m).
fn share_within(corners: [(bool, f64); 3]) -> f64 {
    let touching = corners.iter().filter(|(touches, _)| *touches).count();
    // The corner that is alone on its side cuts off a triangle.
    let cut_off = |alone: bool| {
        let own = corners.iter().find(|(touches, _)| *touches == alone).expect("one is alone").1;
        let others = corners.iter().filter(|(touches, _)| *touches != alone);
        others.map(|(_, other)| if own + other > 0.0 { own / (own + other) } else { 0.5 }).product::<f64>()
    };
    match touching {
        0 => 0.0,
        1 => cut_off(true),
        2 => 1.0 - cut_off(false),
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use nalgebra::Vector3;

    use super::{GapsBeside, SMOOTH_RIM, contact_areas};
    use crate::sample::one_diagonal_grid;
    use crate::surface::checked::Surface;

    /// Squares of edge 1 with one diagonal, about the origin.
    fn squares(half: usize) -> Surface {
        let (mut vertices, faces) = one_diagonal_grid(2 * half);
        let middle = Vector3::new(half as f64, half as f64, 0.0);
        vertices.iter_mut().for_each(|vertex| *vertex -= middle);
        Surface::new(vertices, faces).expect("a valid surface")
    }

    /// The areas within the rim of a smooth contact.
    fn areas(surface: &Surface, gap: &[f64], touches: &[bool], force: &[f64], active: &[usize]) -> Vec<f64> {
        let is_across = vec![false; gap.len()];
        let gaps = GapsBeside { gap, is_across: &is_across, power: &|_| SMOOTH_RIM };
        contact_areas(surface, 0.0, &gaps, touches, force, active)
    }

    /// The area found for a rim at distance 0 of `outside`, with a gap of `stiffness` times its 3/2 power.
    fn area(surface: &Surface, stiffness: f64, outside: impl Fn(&Vector3<f64>) -> f64) -> f64 {
        let distance: Vec<f64> = surface.vertices().iter().map(outside).collect();
        let gap: Vec<f64> = distance.iter().map(|s| stiffness * s.max(0.0).powf(1.5)).collect();
        let touches: Vec<bool> = distance.iter().map(|&s| s <= 0.0).collect();
        let active: Vec<usize> = (0..gap.len()).filter(|&vertex| distance[vertex] < 0.0).collect();
        let force: Vec<f64> = distance.iter().map(|&s| f64::from(s < 0.0)).collect();
        areas(surface, &gap, &touches, &force, &active).iter().sum()
    }

    #[test]
    fn a_straight_rim_is_found_wherever_it_passes() {
        let surface = squares(6);
        for (angle, shift) in [(0.0, 0.37), (0.2, -0.61), (0.0, 0.999), (0.4, 0.25)] {
            let (sin, cos) = f64::sin_cos(angle);
            // The half of the square, 12 wide, on one side of x cos + y sin = shift, which leaves by top and bottom.
            let expected = 12.0 * (6.0 + shift / cos);
            let found = area(&surface, 3e-4, |p| p.x * cos + p.y * sin - shift);
            assert_relative_eq!(found, expected, max_relative = 1e-2);
        }
        let level = area(&surface, 3e-4, |p| p.x - 0.37);
        assert_relative_eq!(level, 12.0 * 6.37, max_relative = 1e-12);
    }

    #[test]
    fn the_area_of_a_disc_is_right_to_the_square_of_the_cell_anywhere_on_the_mesh() {
        for cells in [4, 8, 16] {
            let (radius, surface) = (cells as f64, squares(cells + 3));
            for k in 0..10 {
                let center = Vector3::new(0.1 * f64::from(k) - 0.43, 0.07 * f64::from(k * k % 11) - 0.3, 0.0);
                let found = area(&surface, 1.0, |p| (p - center).norm() - radius);
                // Chords as long as the diagonal √2 cut off 1 / 3 radius² of the disc, the slopes' curvature as much.
                let error = found / (PI * radius * radius) - 1.0;
                assert!(error.abs() < 2.0 / (3.0 * radius * radius), "{cells} cells, place {k}: {error:.2e}");
            }
        }
    }

    #[test]
    fn without_a_smooth_rim_the_area_stays_between_the_touching_triangles_and_those_around_them() {
        let surface = squares(3);
        // One vertex under force; beside it the gap jumps, or is closed all around.
        let center = surface.vertices().iter().position(|p| p.norm() == 0.0).expect("a vertex in the middle");
        let touches: Vec<bool> = (0..49).map(|vertex| vertex == center).collect();
        let around: f64 =
            surface.faces_around(center).iter().map(|&face| surface.face_areas()[face as usize]).sum();
        let force: Vec<f64> = (0..49).map(|vertex| f64::from(vertex == center)).collect();
        let found = |gap: &[f64], touches: &[bool]| -> f64 {
            areas(&surface, gap, touches, &force, &[center]).iter().sum()
        };
        let jump: Vec<f64> = (0..49).map(|vertex| if vertex == center { 0.0 } else { 1.0 }).collect();
        for gap in [&jump, &vec![0.0; 49]] {
            let area = found(gap, &touches);
            assert!(0.0 < area && area < around, "{area} of {around}");
        }
        // A gap that hardly grows puts the rim beyond the vertex: its vertex area, a third of the triangles, is left.
        let level: Vec<f64> = surface.vertices().iter().map(|p| 1.0 + 1e-6 * p.x).collect();
        assert_relative_eq!(found(&level, &touches), around / 3.0, max_relative = 1e-12);
        assert_relative_eq!(found(&jump, &[true; 49]), around, max_relative = 1e-12);
    }

    #[test]
    fn the_area_does_not_depend_on_which_corner_of_a_triangle_comes_first() {
        let surface = squares(4);
        // Gaps no rim would leave, so that distances beside each other differ by more than an edge.
        let gap: Vec<f64> = (0..81).map(|k| 1.5 + f64::sin(f64::from(k * k % 89))).collect();
        let active: Vec<usize> = (0..81).filter(|k| surface.vertices()[*k].norm() < 1.6).collect();
        let touches: Vec<bool> = (0..81).map(|k| active.contains(&k)).collect();
        let force: Vec<f64> = touches.iter().map(|&touches| f64::from(touches)).collect();
        let found = |turns: usize| {
            let turned = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]][turns];
            let faces = surface.faces().iter().map(turned).collect();
            let surface = Surface::new(surface.vertices().to_vec(), faces).expect("a valid surface");
            areas(&surface, &gap, &touches, &force, &active)
        };
        for turns in [1, 2] {
            for (turned, first) in found(turns).into_iter().zip(found(0)) {
                assert_relative_eq!(turned, first, max_relative = 1e-12);
            }
        }
    }
}
