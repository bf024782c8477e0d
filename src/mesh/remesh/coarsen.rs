//! Edge collapse: the same closed surface with fewer of its own vertices.
//!
//! Short edges go first (Hoppe 1996, doi:10.1145/237170.237216, with edge length in place of an energy). A collapse
//! moves one end of an edge onto the other.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::Vector3;

use crate::geometry::closest_point::closest_on_triangle;
use crate::mesh::distinct::distinct;

/// Edges longer than this share of the wanted length stay.
const LONG_EDGE: f64 = 1.0;
/// No collapse makes an edge longer than this share of the wanted length.
const LONGEST_EDGE: f64 = 1.5;
/// Least cosine between a new face and the skin's normals at its corners, or the face that it replaces.
pub(crate) const LEAST_COSINE: f64 = 0.5;
/// A collapse makes no face of a worse shape, 1 for an equilateral one, unless the face was worse before.
const LEAST_SHAPE: f64 = 0.3;
/// A vertex that goes lies no farther from the new faces than this share of the wanted length: an edge of 0.4 of the
/// radius that the surface bends with.
const MOST_HEIGHT: f64 = 0.2;
/// Differences below this are none.
const NO_DIFFERENCE: f64 = 1e-6;

/// A point of the surface that a mesh stands for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfacePoint {
    /// Position (m).
    pub point: Vector3<f64>,
    /// Unit normal.
    pub normal: Vector3<f64>,
    /// Wanted length of the edges there (m).
    pub edge_length: f64,
}

/// A mesh to coarsen.
pub(crate) struct FineMesh {
    /// Vertices (n).
    pub vertices: Vec<SurfacePoint>,
    /// Faces, closed and manifold.
    pub faces: Vec<[u32; 3]>,
    /// Vertices of two kinds (n): faces with three of the second kind keep their outline.
    pub is_held: Vec<bool>,
    /// Vertices that stay where they are (n).
    pub is_still: Vec<bool>,
}

impl FineMesh {
    /// Whether each face belongs to the held outline.
    pub fn held_faces(&self) -> Vec<bool> {
        self.faces.iter().map(|face| face.iter().all(|&vertex| self.is_held[vertex as usize])).collect()
    }
}

/// Collapses edges shorter than wanted, the shortest first.
///
/// Lengths and shapes count in steps of a millionth, so that rounding moves no choice.
///
/// Returns the vertices kept, ascending, and the faces in their numbers.
pub(crate) fn collapse_short_edges(mesh: &FineMesh) -> (Vec<usize>, Vec<[u32; 3]>) {
    let mut work = Collapse::new(mesh);
    let mut queue: BinaryHeap<Reverse<(u64, u32, u32)>> = BinaryHeap::new();
    let offer = |work: &Collapse, queue: &mut BinaryHeap<_>, a: u32, b: u32| {
        let length = work.relative_length(a, b);
        if length < LONG_EDGE {
            queue.push(Reverse(((length / NO_DIFFERENCE) as u64, a.min(b), a.max(b))));
        }
    };
    for face in &mesh.faces {
        for k in 0..3 {
            if face[k] < face[(k + 1) % 3] {
                offer(&work, &mut queue, face[k], face[(k + 1) % 3]);
            }
        }
    }
    while let Some(Reverse((_, a, b))) = queue.pop() {
        let shape = |(gone, kept)| work.shape_after(gone, kept).map(|shape| (shape, gone, kept));
        let best = [(a, b), (b, a)]
            .into_iter()
            .filter_map(shape)
            .max_by_key(|found| (found.0 / NO_DIFFERENCE) as u64);
        if let Some((_, gone, kept)) = best {
            work.collapse(gone, kept);
            // What stood in the way of an edge nearby may be gone.
            for &face in &work.around[kept as usize] {
                let [a, b, c] = work.faces[face as usize];
                [[a, b], [b, c], [c, a]].into_iter().for_each(|[a, b]| offer(&work, &mut queue, a, b));
            }
        }
    }
    work.finish()
}

struct Collapse<'a> {
    mesh: &'a FineMesh,
    faces: Vec<[u32; 3]>,
    /// Faces around each vertex; none around one that is gone.
    around: Vec<Vec<u32>>,
    /// Whether a face, by its first corners, belongs to the held outline.
    is_held_face: Vec<bool>,
}

impl<'a> Collapse<'a> {
    fn new(mesh: &'a FineMesh) -> Self {
        let mut around = vec![Vec::new(); mesh.vertices.len()];
        for (face, corners) in mesh.faces.iter().enumerate() {
            corners.iter().for_each(|&vertex| around[vertex as usize].push(face as u32));
        }
        Self { mesh, faces: mesh.faces.clone(), around, is_held_face: mesh.held_faces() }
    }

    fn point(&self, vertex: u32) -> Vector3<f64> {
        self.mesh.vertices[vertex as usize].point
    }

    fn relative_length(&self, a: u32, b: u32) -> f64 {
        let [wanted, other] = [a, b].map(|vertex| self.mesh.vertices[vertex as usize].edge_length);
        let wanted = wanted.min(other);
        (self.point(a) - self.point(b)).norm() / wanted
    }

    fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let faces = self.around[vertex as usize].iter();
        distinct(faces.flat_map(|&face| self.faces[face as usize]).filter(|&other| other != vertex))
    }

    /// Faces on both sides of the outline of the held faces meet at the vertex.
    fn is_on_outline(&self, vertex: u32) -> bool {
        let mut kinds = self.around[vertex as usize].iter().map(|&face| self.is_held_face[face as usize]);
        let first = kinds.next();
        kinds.any(|kind| Some(kind) != first)
    }

    /// Shape of the worst face that moving `gone` onto `kept` makes; `None` where it may not.
    fn shape_after(&self, gone: u32, kept: u32) -> Option<f64> {
        if self.mesh.is_still[gone as usize] {
            return None;
        }
        let has = |face: u32, vertex: u32| self.faces[face as usize].contains(&vertex);
        let shared: Vec<u32> =
            self.around[gone as usize].iter().copied().filter(|&face| has(face, kept)).collect();
        let &[one, two] = &shared[..] else { return None };
        // A vertex of the outline may only move along it.
        let is_along = self.is_held_face[one as usize] != self.is_held_face[two as usize];
        if self.is_on_outline(gone) && !is_along {
            return None;
        }
        // The link of an edge has two vertices, else the surface would pinch (Dey et al. 1999).
        let (ring, other_ring) = (self.neighbours(gone), self.neighbours(kept));
        if ring.iter().filter(|vertex| other_ring.binary_search(vertex).is_ok()).count() != 2 {
            return None;
        }
        let is_too_long = |&vertex: &u32| vertex != kept && self.relative_length(kept, vertex) > LONGEST_EDGE;
        if ring.iter().any(is_too_long) {
            return None;
        }
        let (mut worst, mut off_squared) = (f64::INFINITY, f64::INFINITY);
        for &face in self.around[gone as usize].iter().filter(|&&face| !has(face, kept)) {
            let corners = self.faces[face as usize];
            let moved = corners.map(|vertex| if vertex == gone { kept } else { vertex });
            let (before, after) = (self.measured(corners), self.measured(moved));
            let turns = |normal: &Vector3<f64>| normal.dot(&after.0) < LEAST_COSINE;
            let is_turned = turns(&before.0)
                || !self.is_held_face[face as usize]
                    && moved.iter().any(|&vertex| turns(&self.mesh.vertices[vertex as usize].normal));
            if is_turned || after.1 < LEAST_SHAPE.min(before.1) {
                return None;
            }
            worst = worst.min(after.1);
            let [a, b, c] = moved.map(|vertex| self.point(vertex));
            off_squared = off_squared
                .min(closest_on_triangle(&self.point(gone), [&a, &b, &c], &after.0).distance_squared);
        }
        let wanted = self.mesh.vertices[gone as usize].edge_length;
        (off_squared <= (MOST_HEIGHT * wanted).powi(2)).then_some(worst)
    }

    fn measured(&self, corners: [u32; 3]) -> (Vector3<f64>, f64) {
        normal_and_shape(corners.map(|vertex| self.point(vertex)))
    }

    fn collapse(&mut self, gone: u32, kept: u32) {
        for face in std::mem::take(&mut self.around[gone as usize]) {
            let corners = self.faces[face as usize];
            if corners.contains(&kept) {
                for vertex in corners.into_iter().filter(|&vertex| vertex != gone) {
                    self.around[vertex as usize].retain(|&other| other != face);
                }
            } else {
                self.faces[face as usize] = corners.map(|vertex| if vertex == gone { kept } else { vertex });
                self.around[kept as usize].push(face);
            }
        }
    }

    fn finish(self) -> (Vec<usize>, Vec<[u32; 3]>) {
        let kept: Vec<usize> = (0..self.around.len()).filter(|&v| !self.around[v].is_empty()).collect();
        let mut number = vec![0; self.around.len()];
        kept.iter().enumerate().for_each(|(new, &old)| number[old] = new as u32);
        let is_there = |face: usize| self.around[self.faces[face][0] as usize].contains(&(face as u32));
        let faces = (0..self.faces.len()).filter(|&face| is_there(face));
        (kept, faces.map(|face| self.faces[face].map(|vertex| number[vertex as usize])).collect())
    }
}

/// Unit normal of a triangle and `4 √3 area / Σ edge²`.
pub(crate) fn normal_and_shape([a, b, c]: [Vector3<f64>; 3]) -> (Vector3<f64>, f64) {
    let cross = (b - a).cross(&(c - a));
    let edges = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    let twice_area = cross.norm();
    (cross / twice_area.max(f64::MIN_POSITIVE), 2.0 * 3.0_f64.sqrt() * twice_area / edges)
}
