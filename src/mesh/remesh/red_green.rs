//! Red-green refinement: marked triangles are cut into four similar ones, their neighbours close the mesh.
//!
//! A triangle cut in four is red; [`green`] says what becomes of one with one or two halved edges. Green cuts are undone
//! before the next round, so that shapes stay what they were (Bank, Sherman, Weiser 1983).
//!
//! [`green`]: super::green

use std::collections::HashSet;

use nalgebra::Vector3;

use crate::mesh::distinct::distinct;
use crate::mesh::edge_map::{EdgeMap, edge};
use crate::mesh::remesh::green::Fate;
use crate::mesh::remesh::smooth::{SmoothMesh, curved_middle};

/// A triangle that is not cut in four.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Leaf {
    /// Its vertices.
    pub corners: [u32; 3],
    /// The given face that it is a part of.
    pub face: u32,
}

/// Where the halves of an edge meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Middle {
    /// Ends of the edge, the lower number first.
    pub ends: [u32; 2],
    /// Its position (m).
    pub point: Vector3<f64>,
    /// Unit normal of the skin there.
    pub normal: Vector3<f64>,
}

/// Triangles of some faces of a mesh, cut again and again.
#[derive(Debug, Clone)]
pub(crate) struct RedGreen {
    /// Triangles of every face taken in so far.
    pub leaves: Vec<Leaf>,
    /// Vertices added, in the order of their numbers.
    pub middles: Vec<Middle>,
    given_count: u32,
    sides: EdgeMap<Side>,
    taken: HashSet<u32>,
    sharp_vertices: HashSet<u32>,
}

/// No vertex, no leaf.
const NO_INDEX: u32 = u32::MAX;

/// An edge of leaves.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Vertex where its halves meet; [`NO_INDEX`] if it is whole.
    middle: u32,
    /// Leaves that it is or was a whole edge of.
    leaves: [u32; 2],
    /// The edge that it is a half of; 0 for none.
    whole: u64,
    is_sharp: bool,
}

impl RedGreen {
    /// No face yet.
    pub fn new(mesh: &SmoothMesh) -> Self {
        Self {
            leaves: Vec::new(),
            middles: Vec::new(),
            given_count: mesh.vertices.len() as u32,
            sides: EdgeMap::default(),
            taken: HashSet::new(),
            sharp_vertices: HashSet::new(),
        }
    }

    /// Takes in a face of the mesh.
    pub fn take(&mut self, mesh: &SmoothMesh, face: u32) {
        if self.taken.insert(face) {
            let corners = mesh.faces[face as usize];
            self.add_leaf(Leaf { corners, face });
            for side in (0..3).filter(|&side| mesh.is_sharp(face, side)) {
                self.side(edge(corners[side], corners[(side + 1) % 3])).is_sharp = true;
            }
            // Faces that are not taken in may be sharp at a corner.
            self.sharp_vertices.extend(corners.into_iter().filter(|&corner| mesh.is_on_sharp_edge(corner)));
        }
    }

    fn side(&mut self, edge: u64) -> &mut Side {
        let unknown = Side { middle: NO_INDEX, leaves: [NO_INDEX; 2], whole: 0, is_sharp: false };
        self.sides.entry(edge).or_insert(unknown)
    }

    fn add_leaf(&mut self, leaf: Leaf) {
        let number = self.leaves.len();
        self.leaves.push(leaf);
        self.join_sides(number);
    }

    fn join_sides(&mut self, leaf: usize) {
        let [a, b, c] = self.leaves[leaf].corners;
        for ends in [edge(a, b), edge(b, c), edge(c, a)] {
            let leaves = &mut self.side(ends).leaves;
            leaves[usize::from(leaves[0] != NO_INDEX)] = leaf as u32;
        }
    }

    /// Position of a vertex (m).
    pub fn point(&self, mesh: &SmoothMesh, vertex: u32) -> Vector3<f64> {
        match self.added(vertex) {
            None => mesh.vertices[vertex as usize],
            Some(middle) => middle.point,
        }
    }

    pub fn normal(&self, mesh: &SmoothMesh, vertex: u32) -> Vector3<f64> {
        match self.added(vertex) {
            None => mesh.normal(vertex),
            Some(middle) => middle.normal,
        }
    }

    fn added(&self, vertex: u32) -> Option<&Middle> {
        vertex.checked_sub(self.given_count).map(|own| &self.middles[own as usize])
    }

    /// Where the halves of an edge meet or would meet (m).
    pub fn middle_point(&self, mesh: &SmoothMesh, a: u32, b: u32) -> Vector3<f64> {
        match self.middle_of(a, b) {
            Some(middle) => self.point(mesh, middle),
            None => self.curved_middle(mesh, [a.min(b), a.max(b)]).0,
        }
    }

    /// Vertex in the middle of an edge, if it is halved.
    pub(super) fn middle_of(&self, a: u32, b: u32) -> Option<u32> {
        self.sides.get(&edge(a, b)).map(|side| side.middle).filter(|&middle| middle != NO_INDEX)
    }

    /// Cuts the marked leaves in four, and others as far as the mesh must be closed again; faces across are taken in.
    ///
    /// * `marked`: (leaves)
    pub fn refine(&mut self, mesh: &SmoothMesh, marked: &[bool]) {
        let mut beside = Vec::new();
        for leaf in (0..marked.len()).filter(|&leaf| marked[leaf]) {
            self.cut_in_four(mesh, leaf, &mut beside);
        }
        while !beside.is_empty() {
            let leaves = distinct(std::mem::take(&mut beside));
            // All of them as the mesh is now, so that none hangs on which comes first.
            let fates: Vec<Fate> = leaves.iter().map(|&leaf| self.fate(mesh, leaf as usize)).collect();
            for (leaf, fate) in leaves.into_iter().zip(fates) {
                match fate {
                    Fate::Stays(_) => {}
                    Fate::HalvesToo(ends) => {
                        self.take_across(mesh, leaf as usize);
                        self.halve(mesh, ends, &mut beside);
                    }
                    Fate::TurnsRed => self.cut_in_four(mesh, leaf as usize, &mut beside),
                }
            }
        }
    }

    /// * `beside`: gets the leaves to look at: the parts, and those at the edges that are halved
    fn cut_in_four(&mut self, mesh: &SmoothMesh, leaf: usize, beside: &mut Vec<u32>) {
        self.take_across(mesh, leaf);
        let Leaf { corners: [a, b, c], face } = self.leaves[leaf];
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|ends| self.halve(mesh, ends, beside));
        // Edges of the parts may be halved already.
        beside.push(leaf as u32);
        beside.extend(self.leaves.len() as u32..self.leaves.len() as u32 + 3);
        self.leaves[leaf].corners = [ab, bc, ca];
        self.join_sides(leaf);
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c]] {
            self.add_leaf(Leaf { corners, face });
        }
    }

    /// Takes in the faces across a leaf that is a given face, as they may get a hanging vertex.
    fn take_across(&mut self, mesh: &SmoothMesh, leaf: usize) {
        let Leaf { corners, face } = self.leaves[leaf];
        if mesh.faces[face as usize] == corners {
            let across = (0..3).filter_map(|side| mesh.topology.across(face as usize, side));
            across.for_each(|other| self.take(mesh, other as u32));
        }
    }

    fn halve(&mut self, mesh: &SmoothMesh, [a, b]: [u32; 2], beside: &mut Vec<u32>) -> u32 {
        let Side { middle, leaves, whole, is_sharp } = *self.side(edge(a, b));
        if middle != NO_INDEX {
            return middle;
        }
        // A leaf across may be twice as large.
        let across = self.sides.get(&whole).map_or([NO_INDEX; 2], |side| side.leaves);
        beside.extend(leaves.into_iter().chain(across).filter(|&leaf| leaf != NO_INDEX));
        let number = self.given_count + self.middles.len() as u32;
        let ends = [a.min(b), a.max(b)];
        let (point, normal) = self.curved_middle(mesh, ends);
        self.middles.push(Middle { ends, point, normal });
        self.side(edge(a, b)).middle = number;
        if is_sharp {
            self.sharp_vertices.insert(number);
        }
        for end in ends {
            let half = self.side(edge(end, number));
            (half.whole, half.is_sharp) = (edge(a, b), is_sharp);
        }
        number
    }

    fn curved_middle(&self, mesh: &SmoothMesh, ends: [u32; 2]) -> (Vector3<f64>, Vector3<f64>) {
        let is_smooth = |end: &u32| !self.sharp_vertices.contains(end);
        let normal = |end| Some(end).filter(is_smooth).map(|end| self.normal(mesh, end));
        let of_faces = || {
            let side = self.sides.get(&edge(ends[0], ends[1]));
            let leaves = side.into_iter().flat_map(|side| side.leaves).filter(|&leaf| leaf != NO_INDEX);
            leaves.map(|leaf| mesh.face_normals[self.leaves[leaf as usize].face as usize]).sum()
        };
        curved_middle(ends.map(|end| (self.point(mesh, end), normal(end))), of_faces)
    }

    /// The triangles with their green cuts, each with the given face that it is a part of; conforming.
    pub fn triangles(&self, mesh: &SmoothMesh) -> Vec<(usize, [u32; 3])> {
        let mut all = Vec::with_capacity(self.leaves.len() + self.leaves.len() / 4);
        for (number, leaf) in self.leaves.iter().enumerate() {
            let Fate::Stays(cuts) = self.fate(mesh, number) else { unreachable!("the mesh was closed") };
            all.extend(cuts.triangles().map(|corners| (leaf.face as usize, corners)));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use crate::sample::{Random, jittered_grid};
    use crate::surface::checked::Surface;
    use crate::surface::refined::MeshRefinement;

    /// Middles of the triangles after three rounds around a corner of slender triangles.
    fn middles(surface: &Surface) -> Vec<[i64; 3]> {
        let mut mesh = MeshRefinement::new(surface, []);
        for round in 0..3 {
            mesh.take(0..surface.faces().len() as u32);
            let whole = mesh.whole().surface;
            let is_near = |leaf: usize| {
                let corners = mesh.corners(leaf).map(|corner| whole.vertices()[corner]);
                let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
                (middle - Vector3::new(5.1, 1.3, 0.0)).norm() < 2.5 - 0.6 * f64::from(round)
            };
            let marked: Vec<bool> = (0..mesh.leaf_count()).map(is_near).collect();
            mesh.refine(&marked);
        }
        let whole = mesh.whole().surface;
        let middle = |face: &[u32; 3]| {
            let sum: Vector3<f64> = face.iter().map(|&corner| whole.vertices()[corner as usize]).sum();
            [sum.x, sum.y, sum.z].map(|x| (1e7 * x).round() as i64)
        };
        let mut middles: Vec<[i64; 3]> = whole.faces().iter().map(middle).collect();
        middles.sort_unstable();
        middles
    }

    #[test]
    fn no_cut_hangs_on_the_numbering() {
        let mut random = Random(11);
        for _ in 0..20 {
            let (mut vertices, faces) = jittered_grid(12, 1.0, 0.45, &mut random);
            vertices.iter_mut().for_each(|vertex| vertex.y *= 0.3);
            let given = Surface::new(vertices.clone(), faces.clone()).expect("a valid surface");
            let numbers = random.permutation(vertices.len());
            let mut renumbered = vertices.clone();
            numbers.iter().zip(&vertices).for_each(|(&number, vertex)| renumbered[number] = *vertex);
            let order = random.permutation(faces.len());
            let faces = order.iter().map(|&face| faces[face].map(|vertex| numbers[vertex as usize] as u32));
            let other = Surface::new(renumbered, faces.collect()).expect("a valid surface");
            assert_eq!(middles(&given), middles(&other));
        }
    }
}
