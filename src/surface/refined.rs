//! A skin with more vertices where somebody wants them, on the smooth surface that its normals imply.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::mesh::distinct::distinct;
use crate::mesh::remesh::red_green::RedGreen;
use crate::mesh::remesh::smooth::SmoothMesh;
use crate::surface::checked::Surface;

/// Ends of an edge are equally near to a vertex within this share of its length.
const EQUALLY_NEAR: f64 = 1e-9;

/// A refinement of a surface, in the making: the faces around a contact, cut again and again.
#[derive(Debug, Clone)]
pub(crate) struct MeshRefinement {
    given: Surface,
    mesh: RedGreen,
}

/// A refined surface, the whole of it or the part around a contact.
///
/// Its first vertices are given ones, ascending; those added follow, in the same order in the part and in the whole.
#[derive(Debug, Clone)]
pub struct RefinedSurface {
    /// The mesh; a part of a whole has borders where it was cut out.
    pub surface: Surface,
    /// Vertex of the given surface for each of the first vertices (k), ascending.
    given_vertices: Vec<usize>,
    /// Number of vertices of the given surface.
    given_count: usize,
    /// For each added vertex the two vertices here that it lies between.
    parents: Vec<[usize; 2]>,
}

/// Where curved edges are looked at, from one end to the other.
pub(crate) const PLACES_ON_EDGE: [f64; 3] = [0.25, 0.5, 0.75];

/// How far a curved edge stands out there, over how far its middle does.
pub(crate) fn height_on_edge(place: f64) -> f64 {
    4.0 * place * (1.0 - place)
}

impl MeshRefinement {
    /// Nothing refined yet; only `faces` can be.
    pub fn new(given: &Surface, faces: impl IntoIterator<Item = u32>) -> Self {
        let mut none = Self { given: given.clone(), mesh: RedGreen::new(&smooth(given)) };
        none.take(faces);
        none
    }

    /// The surface that is refined.
    pub fn given(&self) -> &Surface {
        &self.given
    }

    /// Number of triangles that can be cut in four.
    pub fn leaf_count(&self) -> usize {
        self.mesh.leaves.len()
    }

    /// Number of vertices added.
    pub fn added_count(&self) -> usize {
        self.mesh.middles.len()
    }

    /// Corners of a triangle, by their numbers in the whole refined surface.
    pub fn corners(&self, leaf: usize) -> [usize; 3] {
        self.mesh.leaves[leaf].corners.map(|corner| corner as usize)
    }

    /// Face of the given surface that a triangle is a part of.
    pub fn face(&self, leaf: usize) -> u32 {
        self.mesh.leaves[leaf].face
    }

    /// Mean length of the edges of a triangle (m).
    pub fn mean_edge(&self, leaf: usize) -> f64 {
        let [a, b, c] =
            self.mesh.leaves[leaf].corners.map(|corner| self.mesh.point(&smooth(&self.given), corner));
        ((a - b).norm() + (b - c).norm() + (c - a).norm()) / 3.0
    }

    /// Takes in more faces; whether there was one that was not.
    pub fn take(&mut self, faces: impl IntoIterator<Item = u32>) -> bool {
        let before = self.leaf_count();
        faces.into_iter().for_each(|face| self.mesh.take(&smooth(&self.given), face));
        self.leaf_count() > before
    }

    /// Middles that the edges of a triangle have or would have (m).
    pub fn curved_middles(&self, leaf: usize) -> [Vector3<f64>; 3] {
        let [a, b, c] = self.mesh.leaves[leaf].corners;
        let middle = |from, to| self.mesh.middle_point(&smooth(&self.given), from, to);
        [middle(a, b), middle(b, c), middle(c, a)]
    }

    /// Points at [`PLACES_ON_EDGE`] of each curved edge of a triangle, along the quadratic through its ends and its middle (m).
    pub fn on_curved_edges(&self, leaf: usize) -> [Vector3<f64>; 9] {
        let (mesh, corners) = (smooth(&self.given), self.mesh.leaves[leaf].corners);
        let (ends, middles) = (corners.map(|end| self.mesh.point(&mesh, end)), self.curved_middles(leaf));
        std::array::from_fn(|at| {
            let (side, place) = (at / 3, PLACES_ON_EDGE[at % 3]);
            let (from, to) = (ends[side], ends[(side + 1) % 3]);
            from.lerp(&to, place) + height_on_edge(place) * (middles[side] - 0.5 * (from + to))
        })
    }

    /// How far the middles stand out from the straight edges along the outward normals (m).
    pub fn bulges(&self, leaf: usize) -> [f64; 3] {
        let (mesh, corners) = (smooth(&self.given), self.mesh.leaves[leaf].corners);
        let middles = self.curved_middles(leaf);
        [0, 1, 2].map(|side| {
            let ends = [corners[side], corners[(side + 1) % 3]];
            let [a, b] = ends.map(|end| self.mesh.point(&mesh, end));
            let [at_a, at_b] = ends.map(|end| self.mesh.normal(&mesh, end));
            let outward = at_a + at_b;
            (middles[side] - 0.5 * (a + b)).dot(&outward) / outward.norm()
        })
    }

    /// The two vertices that each added one lies between, by their numbers in the whole refined surface.
    pub fn parents(&self) -> Vec<[usize; 2]> {
        self.mesh.middles.iter().map(|middle| middle.ends.map(|end| end as usize)).collect()
    }

    /// Cuts the marked triangles in four and closes the mesh around them.
    ///
    /// * `marked`: one entry a triangle
    pub fn refine(&mut self, marked: &[bool]) {
        self.mesh.refine(&smooth(&self.given), marked);
    }

    /// The faces taken in, refined: a surface with borders.
    pub fn part(&self) -> RefinedSurface {
        let triangles = self.mesh.triangles(&smooth(&self.given));
        let given_count = self.given.vertices().len() as u32;
        let corners = triangles.iter().flat_map(|(_, corners)| *corners);
        let given = distinct(corners.filter(|&vertex| vertex < given_count));
        let rows: HashMap<u32, u32> = given.iter().zip(0..).map(|(&vertex, row)| (vertex, row)).collect();
        let row = |vertex: u32| match vertex.checked_sub(given_count) {
            None => rows[&vertex],
            Some(added) => given.len() as u32 + added,
        };
        let faces = triangles.iter().map(|(_, corners)| corners.map(row)).collect();
        self.build(given.iter().map(|&vertex| vertex as usize).collect(), faces, |vertex| {
            row(vertex) as usize
        })
    }

    /// The whole surface, refined: a face that is cut keeps its number for its first part, the others follow.
    pub fn whole(&self) -> RefinedSurface {
        let mut faces = self.given.faces().to_vec();
        let mut is_taken = vec![false; faces.len()];
        for (face, corners) in self.mesh.triangles(&smooth(&self.given)) {
            if is_taken[face] {
                faces.push(corners);
            } else {
                (faces[face], is_taken[face]) = (corners, true);
            }
        }
        self.build((0..self.given.vertices().len()).collect(), faces, |vertex| vertex as usize)
    }

    fn build(
        &self,
        given_vertices: Vec<usize>,
        faces: Vec<[u32; 3]>,
        row: impl Fn(u32) -> usize,
    ) -> RefinedSurface {
        let given = &self.given;
        let mut vertices: Vec<Vector3<f64>> =
            given_vertices.iter().map(|&vertex| given.vertices()[vertex]).collect();
        let mut mask: Vec<bool> = given_vertices.iter().map(|&vertex| given.skin_mask()[vertex]).collect();
        let mut parents = Vec::with_capacity(self.mesh.middles.len());
        for middle in &self.mesh.middles {
            let ends = middle.ends.map(&row);
            vertices.push(middle.point);
            mask.push(mask[ends[0]] && mask[ends[1]]);
            parents.push(ends);
        }
        RefinedSurface {
            surface: Surface::from_sound_mesh(vertices, faces, mask),
            given_count: given.vertices().len(),
            given_vertices,
            parents,
        }
    }
}

/// The surface as its vertex normals bend it.
pub(super) fn smooth(surface: &Surface) -> SmoothMesh<'_> {
    SmoothMesh {
        vertices: surface.vertices(),
        faces: surface.faces(),
        face_normals: surface.face_normals(),
        topology: surface.topology(),
    }
}

impl RefinedSurface {
    /// Vertices of the given surface that are here, ascending; they come first.
    pub fn given_vertices(&self) -> &[usize] {
        &self.given_vertices
    }

    /// For each added vertex the two vertices here that it lies between.
    pub fn parents(&self) -> &[[usize; 2]] {
        &self.parents
    }

    /// Number in the whole refined surface of a vertex here.
    pub fn number(&self, vertex: usize) -> usize {
        match vertex.checked_sub(self.given_vertices.len()) {
            None => self.given_vertices[vertex],
            Some(added) => self.given_count + added,
        }
    }

    /// The vertex here of one of the whole, if it is one.
    pub(crate) fn row(&self, number: usize) -> Option<usize> {
        match number.checked_sub(self.given_count) {
            None => self.given_vertices.binary_search(&number).ok(),
            Some(added) => Some(self.given_vertices.len() + added).filter(|_| added < self.parents.len()),
        }
    }

    /// Numbers in the whole refined surface of vertices here.
    pub(crate) fn numbers(&self, vertices: &[usize]) -> Vec<usize> {
        vertices.iter().map(|&vertex| self.number(vertex)).collect()
    }

    /// For each vertex here the given one whose entry it takes: its own, or that of the nearer end of the edge that an
    /// added one lies on, of two equally near ones the lower number.
    pub fn nearest_given(&self) -> Vec<usize> {
        let vertices = self.surface.vertices();
        let mut nearest = self.given_vertices.clone();
        for (&[a, b], place) in self.parents.iter().zip(&vertices[self.given_vertices.len()..]) {
            let (lower, higher) = (a.min(b), a.max(b));
            let nearer_to_lower = (place - vertices[higher]).norm() - (place - vertices[lower]).norm();
            let rounding = EQUALLY_NEAR * (vertices[a] - vertices[b]).norm();
            nearest.push(nearest[if nearer_to_lower < -rounding { higher } else { lower }]);
        }
        nearest
    }

    /// Values at the vertices from those of the given surface: an added vertex has what its parents have together.
    ///
    /// * `given`: value of a given vertex
    /// * `joined`: value between two
    pub fn inherit<T>(&self, given: impl FnMut(usize) -> T, joined: impl Fn(&T, &T) -> T) -> Vec<T> {
        let mut values: Vec<T> = self.given_vertices.iter().copied().map(given).collect();
        for &[a, b] in &self.parents {
            values.push(joined(&values[a], &values[b]));
        }
        values
    }

    /// Values of vertices from those known, by their numbers in the whole refined surface: an added vertex without has what its
    /// parents have together.
    pub fn inherit_known<T: Copy>(
        &self,
        known: &HashMap<usize, T>,
        joined: impl Fn(T, T) -> T,
    ) -> Vec<Option<T>> {
        let given_count = self.given_vertices.len();
        let mut values: Vec<Option<T>> = Vec::with_capacity(given_count + self.parents.len());
        for vertex in 0..given_count + self.parents.len() {
            let own = known.get(&self.number(vertex)).copied();
            let from_parents = || {
                let [a, b] = self.parents[vertex.checked_sub(given_count)?];
                Some(joined(values[a]?, values[b]?))
            };
            values.push(own.or_else(from_parents));
        }
        values
    }
}
