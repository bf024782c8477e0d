//! First touch of the obstacle with the skin between its vertices.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::contact::gap::under::depth_along;
use crate::geometry::bounds::Bounds;
use crate::geometry::direction::tangents;
use crate::geometry::face_tree::{box_tree, node_bounds};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Fewest triangles that are worth a task of their own.
const FACES_PER_TASK: usize = 512;

/// The same only to be found out of the way.
const CHECKED_PER_TASK: usize = 16_384;

/// Share of the obstacle's size that its box may be too small by for rounding.
const OBSTACLE_ROUNDING: f64 = 1e-12;

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
    let [across, up] = tangents(direction);
    let turn = Matrix3::from_columns(&[across, up, *direction]).transpose();
    let bounds = bounds.turned(&turn).grown(OBSTACLE_ROUNDING * bounds.diagonal());
    let vertices = surface.vertices().par_iter().with_min_len(CHECKED_PER_TASK);
    let sides: Vec<u8> = vertices.map(|vertex| sides_beyond(&(turn * vertex), &bounds, latest)).collect();
    let mask = surface.skin_mask();
    let in_its_way = |corners: &[u32; 3]| {
        let beyond_one = corners.iter().fold(u8::MAX, |common, &corner| common & sides[corner as usize]);
        if beyond_one != 0 || !corners.iter().all(|&corner| mask[corner as usize]) {
            return None;
        }
        let seen = corners.map(|corner| turn * surface.vertices()[corner as usize]);
        let mut reach = Bounds::around(&seen);
        (reach.low.z, reach.high.z) = (reach.low.z - latest, f64::INFINITY);
        Some(Face { corners: *corners, reach })
    };
    let faces = surface.faces().par_iter().with_min_len(CHECKED_PER_TASK);
    let faces: Vec<Face> = faces.filter_map(in_its_way).collect();
    let of_line = touch_of_line(surface, &faces, obstacle, direction, earliest);
    of_line.min(Seen { turn, surface, faces: &faces }.touch_of_edges(obstacle, earliest))
}

/// Sides of the obstacle's box that a vertex is beyond, in bits: a triangle all of whose corners are beyond one is out of the way.
fn sides_beyond(seen: &Vector3<f64>, bounds: &Bounds, latest: f64) -> u8 {
    let Bounds { low, high } = bounds;
    let beyond = [seen.x < low.x, seen.x > high.x, seen.y < low.y, seen.y > high.y, seen.z - latest > high.z];
    beyond.iter().fold(0, |sides, &is_beyond| sides << 1 | u8::from(is_beyond))
}

/// A triangle of the skin in the way of the obstacle.
struct Face {
    corners: [u32; 3],
    /// As seen along the direction: where an edge is that touches it in time.
    reach: Bounds,
}

/// The same of the line of a round primitive.
fn touch_of_line(
    surface: &Surface,
    faces: &[Face],
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
    earliest: f64,
) -> f64 {
    if !obstacle.is_round() {
        return f64::INFINITY;
    }
    let travel = |face: &Face| {
        let triangle = face.corners.map(|corner| surface.vertices()[corner as usize]);
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
    surface: &'a Surface,
    faces: &'a [Face],
}

impl Seen<'_> {
    /// The same of sharp edges and corners.
    fn touch_of_edges(&self, obstacle: &Obstacle, earliest: f64) -> f64 {
        let reaches = self.faces.par_iter().with_min_len(CHECKED_PER_TASK).map(|face| face.reach);
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
        let travel = |face: &Face| {
            let triangle = face.corners.map(|corner| self.turn * self.surface.vertices()[corner as usize]);
            let over = tree.leaves(|node| node_bounds(node).meets(&face.reach));
            let travel =
                |edge: u32| Some(-depth_along(&edges[edge as usize], &triangle, &Vector3::z())?.depth);
            over.filter_map(travel).filter(|travel| *travel >= earliest).fold(f64::INFINITY, f64::min)
        };
        self.faces.par_iter().with_min_len(FACES_PER_TASK).map(travel).reduce(|| f64::INFINITY, f64::min)
    }
}
