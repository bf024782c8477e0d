//! First touch of the obstacle with the skin between its vertices.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::gap::edge::depth_along;
use crate::geometry::bounds::Bounds;
use crate::geometry::direction::tangents;
use crate::geometry::face_tree::{box_tree, node_bounds};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Fewest triangles that are worth a task of their own.
const FACES_PER_TASK: usize = 512;

/// The same only to be found too late.
const CHECKED_PER_TASK: usize = 16_384;

/// Travel (m) at which a sharp edge, a corner of a mesh or the line of a round primitive first touches a triangle that may
/// touch; infinite, or any after the latest, where none does so before.
///
/// * `[earliest, latest]`: travel (m) between which to look
pub(crate) fn touch_between(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
    [earliest, latest]: [f64; 2],
) -> f64 {
    let Some(bounds) = obstacle.bounding_box() else {
        // A half-space has no edge, corner or line.
        return f64::INFINITY;
    };
    let farthest = bounds.farthest_along(direction);
    let depths: Vec<f64> = surface.vertices().iter().map(|vertex| vertex.dot(direction)).collect();
    let may_touch = |face: &&[u32; 3]| {
        let corners = face.map(|corner| corner as usize);
        corners.iter().any(|&corner| depths[corner] - latest <= farthest)
            && corners.iter().all(|&corner| surface.skin_mask()[corner])
    };
    let faces = surface.faces().par_iter().with_min_len(CHECKED_PER_TASK);
    let faces: Vec<&[u32; 3]> = faces.filter(may_touch).collect();
    touch_of_line(surface, &faces, obstacle, direction, earliest).min(touch_of_edges(
        surface,
        &faces,
        obstacle,
        direction,
        [earliest, latest],
    ))
}

/// The same of the line of a round primitive.
fn touch_of_line(
    surface: &Surface,
    faces: &[&[u32; 3]],
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
    earliest: f64,
) -> f64 {
    if !obstacle.is_round() {
        return f64::INFINITY;
    }
    let travel = |face: &&[u32; 3]| {
        let triangle = corners_of(surface, face);
        let [a, b, c] = &triangle;
        let inward = (c - a).cross(&(b - a)).try_normalize(0.0)?;
        Some(-depth_along(&obstacle.line_towards(&inward)?, &triangle, direction)?.depth)
    };
    let in_time = |travel: &f64| *travel >= earliest;
    faces
        .par_iter()
        .with_min_len(FACES_PER_TASK)
        .filter_map(travel)
        .filter(in_time)
        .reduce(|| f64::INFINITY, f64::min)
}

/// The same of sharp edges and corners.
fn touch_of_edges(
    surface: &Surface,
    faces: &[&[u32; 3]],
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
    [earliest, latest]: [f64; 2],
) -> f64 {
    // Both as seen along the direction, which is the third axis.
    let [across, up] = tangents(direction);
    let seen = |x: &Vector3<f64>| Vector3::new(x.dot(&across), x.dot(&up), x.dot(direction));
    // Where an edge is that touches some of the skin in time.
    let in_time = |mut skin: Bounds| {
        (skin.low.z, skin.high.z) = (skin.low.z - latest, f64::INFINITY);
        skin
    };
    let bounds_of = |face: &[u32; 3]| Bounds::around_each(corners_of(surface, face).map(|x| seen(&x)));
    let all = faces.iter().map(|face| bounds_of(face)).reduce(|all, face| all.union(&face));
    let Some(reach) = all.map(in_time) else { return f64::INFINITY };
    let place = |ends: &[Vector3<f64>; 2]| Bounds::around_each(ends.map(|end| seen(&end)));
    let corners = obstacle.corners_beyond(direction, reach.low.z).map(|corner| [corner; 2]);
    let edges: Vec<([Vector3<f64>; 2], Bounds)> = (obstacle.sharp_edges().map(|edge| edge.ends))
        .chain(corners)
        .map(|ends| (ends, place(&ends)))
        .filter(|(_, bounds)| bounds.meets(&reach))
        .collect();
    if edges.is_empty() {
        return f64::INFINITY;
    }
    let tree = box_tree(edges.iter().map(|(_, bounds)| *bounds));
    let travel = |face: &&[u32; 3]| {
        let reach = in_time(bounds_of(face));
        let triangle = corners_of(surface, face);
        let over = tree.leaves(|node| node_bounds(node).meets(&reach));
        let travel = |edge: u32| Some(-depth_along(&edges[edge as usize].0, &triangle, direction)?.depth);
        over.filter_map(travel).filter(|travel| *travel >= earliest).fold(f64::INFINITY, f64::min)
    };
    faces.par_iter().with_min_len(FACES_PER_TASK).map(travel).reduce(|| f64::INFINITY, f64::min)
}

fn corners_of(surface: &Surface, face: &[u32; 3]) -> [Vector3<f64>; 3] {
    face.map(|corner| surface.vertices()[corner as usize])
}
