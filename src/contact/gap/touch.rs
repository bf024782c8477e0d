//! First touch of the obstacle with the skin between its vertices.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::gap::edge::depth_along;
use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::{face_tree, node_bounds};
use crate::obstacle::posed::Obstacle;
use crate::obstacle::primitive::perpendicular;
use crate::surface::checked::Surface;

/// Travel (m) at which a sharp edge or the line of a round primitive, coming from infinity, first touches a triangle that
/// may touch; infinite where none comes in its way.
pub(crate) fn touch_between(surface: &Surface, obstacle: &Obstacle, direction: &Vector3<f64>) -> f64 {
    let may_touch = |face: &&[u32; 3]| face.iter().all(|&corner| surface.skin_mask()[corner as usize]);
    let faces: Vec<&[u32; 3]> = surface.faces().iter().filter(may_touch).collect();
    touch_of_line(surface, &faces, obstacle, direction)
        .min(touch_of_edges(surface, &faces, obstacle, direction))
}

/// The same of the line of a round primitive.
fn touch_of_line(
    surface: &Surface,
    faces: &[&[u32; 3]],
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> f64 {
    let travel = |face: &&[u32; 3]| {
        let triangle = corners(surface, face);
        let [a, b, c] = &triangle;
        let inward = (c - a).cross(&(b - a)).try_normalize(0.0)?;
        Some(-depth_along(&obstacle.line_towards(&inward)?, &triangle, direction)?.depth)
    };
    faces.par_iter().filter_map(travel).reduce(|| f64::INFINITY, f64::min)
}

/// The same of sharp edges.
fn touch_of_edges(
    surface: &Surface,
    faces: &[&[u32; 3]],
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> f64 {
    let edges = obstacle.sharp_edges();
    // Both as seen along the direction.
    let across = perpendicular(direction);
    let up = direction.cross(&across);
    let seen = |x: &Vector3<f64>| Vector3::new(x.dot(&across), x.dot(&up), 0.0);
    let shadows: Vec<Bounds> =
        edges.iter().map(|edge| Bounds::around(&edge.ends.map(|end| seen(&end)))).collect();
    let Some(around) = shadows.iter().copied().reduce(|all, one| all.union(&one)) else {
        return f64::INFINITY;
    };
    let points: Vec<Vector3<f64>> = surface.vertices().iter().map(seen).collect();
    let shadow = |face: &[u32; 3]| Bounds::around(face.map(|corner| &points[corner as usize]));
    let met: Vec<[u32; 3]> =
        faces.iter().filter(|face| shadow(face).meets(&around)).map(|face| **face).collect();
    if met.is_empty() {
        return f64::INFINITY;
    }
    let tree = face_tree(&points, &met);
    let travel = |edge: usize| {
        let under = tree.leaves(|node| node_bounds(node).meets(&shadows[edge]));
        let travel = |face: u32| {
            Some(-depth_along(&edges[edge].ends, &corners(surface, &met[face as usize]), direction)?.depth)
        };
        under.filter_map(travel).fold(f64::INFINITY, f64::min)
    };
    (0..edges.len()).into_par_iter().map(travel).reduce(|| f64::INFINITY, f64::min)
}

fn corners(surface: &Surface, face: &[u32; 3]) -> [Vector3<f64>; 3] {
    face.map(|corner| surface.vertices()[corner as usize])
}
