//! Where the obstacle meets the skin between its vertices: sharp edges, and what is round and smaller than a triangle.
//!
//! Where a sharp edge touches a triangle of the skin, the plane between them has the normal m of the skin, taken across
//! the edge and turned around, as long as that lies between the normals of the faces that meet at the edge. The line of a round
//! primitive does the same in a triangle that no corner has met it in, and so does the deepest edge of a mesh there, however
//! blunt.

use std::collections::HashMap;

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::contact::gap::under::{Under, depth_along};
use crate::geometry::bounds::Bounds;
use crate::geometry::face_tree::{Faces, box_tree, face_normals, face_tree, node_bounds};
use crate::obstacle::convex_edge::ConvexEdge;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Farthest that a point of a triangle lies from its nearest corner, in longest edges: 1/√3.
const FARTHEST_IN_PLANE: f64 = 0.58;

/// Triangles that one task looks under.
const TRIANGLES_PER_TASK: usize = 64;

/// Share of a box' size that rounding may move it.
const BOX_ROUNDING: f64 = 1e-6;

/// Share of a triangle's size that rounding may move a corner into an obstacle.
const DISTANCE_ROUNDING: f64 = 1e-9;

/// Triangles of the skin, as corners among some points.
pub(crate) struct SkinPart<'a> {
    /// Positions (k, m).
    pub points: &'a [Vector3<f64>],
    /// Corners of each triangle, counter-clockwise seen from outside.
    pub triangles: &'a [[u32; 3]],
}

/// A line of the obstacle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    /// Its ends (m).
    pub ends: [Vector3<f64>; 2],
    /// Outward normals of its faces where it is a sharp edge, not the side of a round primitive.
    pub faces: Option<[Vector3<f64>; 2]>,
}

/// A line of the obstacle over or under a triangle.
pub(super) struct Meeting {
    /// Number of the triangle.
    pub(super) triangle: usize,
    pub(super) line: Line,
    /// The deepest point of the line (m).
    deepest: Vector3<f64>,
    /// Depth of the line under the triangle (m), negative over it.
    pub(super) depth: f64,
    /// Largest barycentric coordinates of the line within the triangle.
    pub(super) shares: [f64; 3],
    /// Normal of the plane between them, out of the obstacle.
    pub(super) normal: Vector3<f64>,
    /// Cosine between that and the inward normal of the triangle.
    pub(super) cosine: f64,
}

/// A triangle of the skin with an area.
struct Facet {
    corners: [Vector3<f64>; 3],
    /// Unit normal into the skin.
    inward: Vector3<f64>,
    /// Length of the longest edge (m).
    width: f64,
}

impl Facet {
    fn new(corners: [Vector3<f64>; 3]) -> Option<Self> {
        let [a, b, c] = &corners;
        let inward = (c - a).cross(&(b - a)).try_normalize(0.0)?;
        let width = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        Some(Self { corners, inward, width })
    }

    /// Corners of the prism under the triangle, down to `deepest` (m).
    fn under(&self, deepest: f64) -> impl Iterator<Item = Vector3<f64>> + Clone {
        let below = self.inward * deepest;
        self.corners.iter().flat_map(move |corner| [*corner, corner + below])
    }

    /// Box around that, and over the triangle, as high as it is wide.
    fn reach(&self, deepest: f64) -> Bounds {
        let over = self.corners.iter().map(|corner| corner - self.inward * self.width);
        Bounds::around_each(self.under(deepest).chain(over)).grown(BOX_ROUNDING * (self.width + deepest))
    }

    /// A line of the obstacle within that, with the normal of the plane between line and triangle.
    fn meeting(&self, triangle: usize, line: Line, normal: Vector3<f64>, deepest: f64) -> Option<Meeting> {
        let Under { depth, shares, deepest: point } = depth_along(&line.ends, &self.corners, &self.inward)?;
        let cosine = self.inward.dot(&normal);
        (depth > -self.width && depth <= deepest).then_some(Meeting {
            triangle,
            line,
            deepest: point,
            depth,
            shares,
            normal,
            cosine,
        })
    }
}

impl SkinPart<'_> {
    /// The sharp edges of the obstacle over or under the triangles, no higher than the triangle is wide.
    ///
    /// * `deepest`: under a triangle (m)
    /// * `with_faces`: whether an edge that a triangle touches with a face of it counts
    pub(super) fn edges_of(
        &self,
        obstacle: &Obstacle,
        deepest: impl Fn(usize) -> f64,
        with_faces: impl Fn(usize) -> bool,
    ) -> Vec<Meeting> {
        let corners = self.triangles.iter().flatten();
        let most = (0..self.triangles.len()).map(&deepest).fold(0.0, f64::max);
        let around = Bounds::around(corners.map(|&corner| &self.points[corner as usize])).grown(most);
        let (edges, boxes): (Vec<ConvexEdge>, Vec<Bounds>) = (obstacle.sharp_edges())
            .map(|edge| (edge, Bounds::around(&edge.ends)))
            .filter(|(_, bounds)| bounds.meets(&around))
            .unzip();
        if edges.is_empty() {
            return Vec::new();
        }
        let mut found = Vec::new();
        let tree = box_tree(boxes.into_iter());
        for (triangle, corners) in self.triangles.iter().enumerate() {
            let Some(facet) = Facet::new(corners.map(|corner| self.points[corner as usize])) else {
                continue;
            };
            let deepest = deepest(triangle);
            let reach = facet.reach(deepest);
            for edge in tree.leaves(|node| node_bounds(node).meets(&reach)) {
                let sharp = &edges[edge as usize];
                let line = Line { ends: sharp.ends, faces: Some(sharp.normals) };
                let Some(normal) = sharp.between(&facet.inward, with_faces(triangle)) else { continue };
                found.extend(facet.meeting(triangle, line, normal, deepest).map(|met| (edge, met)));
            }
        }
        // Of edges that meet at a point the first one holds it.
        found.sort_by_key(|(edge, _)| *edge);
        found.into_iter().map(|(_, met)| met).collect()
    }

    /// How deep (m, ≥ 0) the obstacle stands in the skin between its vertices at the most, with a sharp edge or what no vertex
    /// meets; `least` (m) where nothing is deeper.
    ///
    /// * `distance`: of the points from the obstacle (m)
    pub fn deepest_between(&self, obstacle: &Obstacle, deepest: f64, least: f64, distance: &[f64]) -> f64 {
        let mut met = self.edges_of(obstacle, |_| deepest, |_| true);
        met.extend(self.lines_of(obstacle, |_| deepest, distance));
        self.deepest_of(met, least)
    }

    /// The same of what first touch looks at: sharp edges, and the line of a round primitive.
    pub fn deepest_edge(&self, obstacle: &Obstacle, deepest: f64, least: f64, distance: &[f64]) -> f64 {
        if obstacle.is_round() {
            return self.deepest_between(obstacle, deepest, least, distance);
        }
        self.deepest_of(self.edges_of(obstacle, |_| deepest, |_| true), least)
    }

    fn deepest_of(&self, mut met: Vec<Meeting>, least: f64) -> f64 {
        met.retain(|under| under.depth > least);
        met.sort_by(|one, other| other.depth.total_cmp(&one.depth));
        if met.is_empty() {
            return least;
        }
        let tree = face_tree(self.points, self.triangles);
        let normals = face_normals(self.points, self.triangles);
        let faces = Faces { vertices: self.points, corners: self.triangles, normals: &normals };
        let mut depth = least;
        for under in met {
            if under.depth <= depth {
                break;
            }
            // Deep under one triangle it may be near another.
            let Some((face, closest)) = faces.closest_to_point(&tree, &under.deepest, under.depth) else {
                continue;
            };
            let out = closest.point - under.deepest;
            if out.dot(&normals[face]) > 0.0 {
                depth = f64::max(depth, out.norm());
            }
        }
        depth
    }

    /// Of each triangle whose corners are outside the obstacle, the line of a round primitive under it, or the deepest edge of
    /// a mesh.
    ///
    /// * `distance`: of the points from the obstacle (m)
    pub(super) fn lines_of(
        &self,
        obstacle: &Obstacle,
        deepest: impl Fn(usize) -> f64 + Sync,
        distance: &[f64],
    ) -> Vec<Meeting> {
        let meeting = |face: usize| {
            let deepest = deepest(face);
            let facet = Facet::new(self.triangles[face].map(|corner| self.points[corner as usize]))?;
            // No point of it is farther from the nearest corner.
            let farthest = FARTHEST_IN_PLANE * facet.width;
            let nearest = self.triangles[face].iter().map(|&corner| distance[corner as usize]);
            if nearest.fold(f64::INFINITY, f64::min) > farthest {
                return None;
            }
            let met = |ends, normal| facet.meeting(face, Line { ends, faces: None }, normal, deepest);
            let own = obstacle.line_towards(&facet.inward).and_then(|ends| met(ends, facet.inward));
            let edges = obstacle.blunt_edges(&facet.inward, facet.under(deepest)).into_iter();
            let of_mesh = edges.filter_map(|edge| met(edge.ends, edge.between(&facet.inward, false)?));
            let under = own.into_iter().chain(of_mesh).filter(|met| met.depth > 0.0);
            under.max_by(|one, other| one.depth.total_cmp(&other.depth))
        };
        let is_unmet = |&face: &usize| self.is_unmet(face, distance);
        let triangles = (0..self.triangles.len()).into_par_iter().with_min_len(TRIANGLES_PER_TASK);
        triangles.filter(is_unmet).filter_map(meeting).collect()
    }

    /// Whether no corner of a triangle is in the obstacle by more than rounding: one may lie on a side of it.
    pub(super) fn is_unmet(&self, triangle: usize, distance: &[f64]) -> bool {
        let corners = self.triangles[triangle].map(|corner| corner as usize);
        let [a, b, c] = corners.map(|corner| self.points[corner]);
        let least = -DISTANCE_ROUNDING * (b - a).norm().max((c - a).norm());
        corners.iter().all(|&corner| distance[corner] >= least)
    }
}

/// Triangles of the skin whose corners are all among `vertices`, as positions in that list.
pub(crate) fn triangles_among(surface: &Surface, vertices: &[usize]) -> Vec<[u32; 3]> {
    let row_of: HashMap<usize, u32> = vertices.iter().copied().zip(0..).collect();
    let corners = |face: u32| {
        let [a, b, c] = surface.faces()[face as usize].map(|vertex| row_of.get(&(vertex as usize)).copied());
        Some([a?, b?, c?])
    };
    surface.faces_at(vertices).into_iter().filter_map(corners).collect()
}
