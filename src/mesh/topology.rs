//! Neighbourhoods, borders and components of a checked mesh.

use crate::mesh::adjacency::{NO_FACE, corner_of};
use crate::mesh::csr::Csr;

/// Neighbourhoods, borders and components of a mesh that passed [`check`](crate::mesh::check::check).
#[derive(Debug, Clone)]
pub struct Topology {
    pub(super) faces_around: Csr,
    pub(super) neighbours: Csr,
    pub(super) across: Vec<[u32; 3]>,
    pub(super) boundary_loops: Vec<Vec<u32>>,
    pub(super) face_components: Vec<u32>,
    pub(super) components_closed: Vec<bool>,
    pub(super) edge_count: usize,
}

impl Topology {
    /// Faces around a vertex, counter-clockwise; on a border from border to border.
    pub fn faces_around(&self, vertex: usize) -> &[u32] {
        self.faces_around.row(vertex)
    }

    /// Vertices joined to a vertex by an edge (its one-ring), counter-clockwise; on a border from border to
    /// border.
    pub fn neighbours(&self, vertex: usize) -> &[u32] {
        self.neighbours.row(vertex)
    }

    /// The face across the edge from corner `edge` to the next corner of `face`; `None` on a border.
    pub fn across(&self, face: usize, edge: usize) -> Option<usize> {
        let other = self.across[face][edge];
        (other != NO_FACE).then_some(other as usize)
    }

    /// Borders as vertex cycles, each in the direction of its faces (so the surface lies to the left, seen from
    /// outside) and from its lowest vertex on; ordered by that vertex.
    pub fn boundary_loops(&self) -> &[Vec<u32>] {
        &self.boundary_loops
    }

    /// Whether every edge has two faces.
    pub fn is_closed(&self) -> bool {
        self.boundary_loops.is_empty()
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.faces_around.rows()
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.across.len()
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.edge_count
    }

    /// Number of components: parts that no edge joins.
    pub fn component_count(&self) -> usize {
        self.components_closed.len()
    }

    /// Component of each face, numbered from 0 in the order of their first faces.
    pub fn face_components(&self) -> &[u32] {
        &self.face_components
    }

    /// Component of a vertex.
    pub fn vertex_component(&self, vertex: usize) -> usize {
        self.face_components[self.faces_around(vertex)[0] as usize] as usize
    }

    /// Whether a component has no border.
    pub fn is_component_closed(&self, component: usize) -> bool {
        self.components_closed[component]
    }
}

/// Labels the components of faces joined `across` edges: component of each face, and whether each is closed.
pub(super) fn label_components(across: &[[u32; 3]]) -> (Vec<u32>, Vec<bool>) {
    let unseen = u32::MAX;
    let mut labels = vec![unseen; across.len()];
    let mut closed = Vec::new();
    let mut stack: Vec<u32> = Vec::new();
    for seed in 0..across.len() {
        if labels[seed] != unseen {
            continue;
        }
        let label = closed.len() as u32;
        let mut is_closed = true;
        labels[seed] = label;
        stack.push(seed as u32);
        while let Some(face) = stack.pop() {
            for &other in &across[face as usize] {
                if other == NO_FACE {
                    is_closed = false;
                } else if labels[other as usize] == unseen {
                    labels[other as usize] = label;
                    stack.push(other);
                }
            }
        }
        closed.push(is_closed);
    }
    (labels, closed)
}

/// Follows the borders of a mesh without pinched vertices.
pub(super) fn boundary_loops(faces: &[[u32; 3]], across: &[[u32; 3]], vertex_count: usize) -> Vec<Vec<u32>> {
    let sides = faces.iter().zip(across).flat_map(|(corners, others)| {
        (0..3).filter(|&k| others[k] == NO_FACE).map(|k| [corners[k], corners[(k + 1) % 3]])
    });
    loops_of(sides, vertex_count)
}

/// The loops of directed edges, of which one at most leaves a vertex; each from its lowest vertex.
pub(crate) fn loops_of(edges: impl Iterator<Item = [u32; 2]>, vertex_count: usize) -> Vec<Vec<u32>> {
    let none = u32::MAX;
    let mut next = vec![none; vertex_count];
    edges.for_each(|[from, to]| next[from as usize] = to);
    let mut loops = Vec::new();
    for start in 0..vertex_count as u32 {
        let mut cycle = Vec::new();
        let mut vertex = start;
        while next[vertex as usize] != none {
            cycle.push(vertex);
            vertex = std::mem::replace(&mut next[vertex as usize], none);
        }
        if !cycle.is_empty() {
            loops.push(cycle);
        }
    }
    loops
}

/// Whether an edge joins two vertices, by the faces around one of them.
pub(super) fn are_joined(a: u32, b: u32, faces: &[[u32; 3]], incident: &Csr) -> bool {
    incident.row(a as usize).iter().any(|face| {
        let corners = &faces[*face as usize];
        corners[corner_of(corners, b)] == b
    })
}
