//! First touch of the obstacle with the skin between its vertices.

use nalgebra::{Matrix3, Vector3};
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
    let [across, up] = tangents(direction);
    let turn = Matrix3::from_columns(&[across, up, *direction]).transpose();
    let vertices = surface.vertices().par_iter().with_min_len(CHECKED_PER_TASK);
    let seen: Vec<Vector3<f64>> = vertices.map(|vertex| turn * vertex).collect();
    let may_touch = |face: &&[u32; 3]| {
        let corners = face.map(|corner| corner as usize);
        corners.iter().any(|&corner| seen[corner].z - latest <= farthest)
            && corners.iter().all(|&corner| surface.skin_mask()[corner])
    };
    let faces = surface.faces().par_iter().with_min_len(CHECKED_PER_TASK);
    let faces: Vec<&[u32; 3]> = faces.filter(may_touch).collect();
    let of_line = touch_of_line(surface, &faces, obstacle, direction, earliest);
    of_line.min(Seen { turn, vertices: &seen, faces: &faces }.touch_of_edges(obstacle, [earliest, latest]))
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

/// Triangles of a skin as seen along the direction, which is the third axis.
struct Seen<'a> {
    turn: Matrix3<f64>,
    vertices: &'a [Vector3<f64>],
    faces: &'a [&'a [u32; 3]],
}

impl Seen<'_> {
    fn corners(&self, face: &[u32; 3]) -> [Vector3<f64>; 3] {
        face.map(|corner| self.vertices[corner as usize])
    }

    /// Where an edge is that touches a triangle by `latest` (m).
    fn reach(&self, face: &[u32; 3], latest: f64) -> Bounds {
        let mut reach = Bounds::around_each(self.corners(face));
        (reach.low.z, reach.high.z) = (reach.low.z - latest, f64::INFINITY);
        reach
    }

    /// The same of sharp edges and corners.
    fn touch_of_edges(&self, obstacle: &Obstacle, [earliest, latest]: [f64; 2]) -> f64 {
        let reaches = self.faces.par_iter().with_min_len(CHECKED_PER_TASK);
        let reaches = reaches.map(|face| self.reach(face, latest));
        let Some(all) = reaches.reduce_with(|one, other| one.union(&other)) else { return f64::INFINITY };
        let direction = self.turn.row(2).transpose();
        let corners = obstacle.corners_beyond(&direction, all.low.z).map(|corner| [corner; 2]);
        let (edges, boxes): (Vec<[Vector3<f64>; 2]>, Vec<Bounds>) =
            (obstacle.sharp_edges().map(|edge| edge.ends))
                .chain(corners)
                .map(|ends| ends.map(|end| self.turn * end))
                .map(|ends| (ends, Bounds::around(&ends)))
                .filter(|(_, bounds)| bounds.meets(&all))
                .unzip();
        if edges.is_empty() {
            return f64::INFINITY;
        }
        let tree = box_tree(boxes.into_iter());
        let travel = |face: &&[u32; 3]| {
            let (reach, triangle) = (self.reach(face, latest), self.corners(face));
            let over = tree.leaves(|node| node_bounds(node).meets(&reach));
            let travel =
                |edge: u32| Some(-depth_along(&edges[edge as usize], &triangle, &Vector3::z())?.depth);
            over.filter_map(travel).filter(|travel| *travel >= earliest).fold(f64::INFINITY, f64::min)
        };
        self.faces.par_iter().with_min_len(FACES_PER_TASK).map(travel).reduce(|| f64::INFINITY, f64::min)
    }
}

fn corners_of(surface: &Surface, face: &[u32; 3]) -> [Vector3<f64>; 3] {
    face.map(|corner| surface.vertices()[corner as usize])
}
