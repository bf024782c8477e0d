//! Averages of a field against the pressure of a node.

use nalgebra::Vector3;

use crate::mesh::distinct::distinct;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::surface::checked::Surface;

/// Where a field is needed for its averages against the pressures of some nodes: the vertices around them, and the
/// middles of the edges of their triangles.
pub(crate) struct AveragePoints {
    /// Vertices of the triangles around the nodes, ascending.
    pub vertices: Vec<usize>,
    /// Edges of these triangles, the lower vertex first, ascending.
    pub edges: Vec<[u32; 2]>,
}

impl AveragePoints {
    pub(crate) fn around(surface: &Surface, nodes: &[usize]) -> Self {
        let faces = nodes.iter().flat_map(|&vertex| surface.faces_around(vertex));
        let sides = |&face: &u32| {
            let [a, b, c] = surface.faces()[face as usize];
            [edge(a, b), edge(b, c), edge(c, a)]
        };
        Self { vertices: surface.k_ring(nodes, 1), edges: distinct(faces.flat_map(sides)) }
    }

    /// Middles of the edges (m).
    pub(crate) fn middles(&self, surface: &Surface) -> Vec<Vector3<f64>> {
        let position = |vertex: u32| surface.vertices()[vertex as usize];
        self.edges.iter().map(|&[a, b]| 0.5 * (position(a) + position(b))).collect()
    }

    /// Average at each of the nodes that the points were chosen for.
    ///
    /// * `at_vertex`, `at_middle`: the field as a row of `nodes` takes it, at a row of [`Self::vertices`] and of [`Self::middles`]
    pub(crate) fn averages(
        &self,
        surface: &Surface,
        basis: PressureBasis,
        nodes: &[usize],
        at_vertex: impl Fn(usize, usize) -> f64,
        at_middle: impl Fn(usize, usize) -> f64,
    ) -> Vec<f64> {
        let known = "a point around the nodes";
        let vertex_row = |v: u32| self.vertices.binary_search(&(v as usize)).expect(known);
        let middle_row = |a: u32, b: u32| self.edges.binary_search(&edge(a, b)).expect(known);
        let average = |(row, &node): (usize, &usize)| {
            let at_vertex = |v| at_vertex(row, vertex_row(v));
            pressure_average(surface, basis, node, at_vertex, |a, b| at_middle(row, middle_row(a, b)))
        };
        nodes.iter().enumerate().map(average).collect()
    }
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Initial gap (m) of each of `nodes` as a response matrix takes it: at the node in collocation, averaged against the
/// node's pressure in Galerkin form.
///
/// * `distance`: the gap (m) at each of some points (m), negative inside the obstacle; asked once
///
/// # Errors
/// Those of `distance`.
pub fn initial_gaps<E>(
    surface: &Surface,
    basis: PressureBasis,
    discretization: Discretization,
    nodes: &[usize],
    distance: impl FnOnce(&[Vector3<f64>]) -> Result<Vec<f64>, E>,
) -> Result<Vec<f64>, E> {
    let at = |vertices: &[usize]| vertices.iter().map(|&vertex| surface.vertices()[vertex]).collect();
    if discretization == Discretization::Collocation {
        let positions: Vec<Vector3<f64>> = at(nodes);
        return distance(&positions);
    }
    let around = AveragePoints::around(surface, nodes);
    let mut points: Vec<Vector3<f64>> = at(&around.vertices);
    points.extend(around.middles(surface));
    let found = distance(&points)?;
    let (at_vertices, at_middles) = found.split_at(around.vertices.len());
    Ok(around.averages(surface, basis, nodes, |_, row| at_vertices[row], |_, row| at_middles[row]))
}

/// Average of a field against the pressure that a force at a vertex stands for, `∫ p g dA / ∫ p dA`.
///
/// On each triangle the field is the quadratic through its values at the corners and at the middles of the edges;
/// the integral over that is exact, so the error falls with the third power of the edges.
///
/// * `at_vertex`: the field at a vertex, in any unit; asked for the vertex and its neighbours
/// * `at_middle`: the field in the middle of the edge between two vertices, asked for the edges of the triangles
///   around the vertex
///
/// With [`Discretization::Galerkin`](crate::response::Discretization) the initial gap of a node is this average.
pub fn pressure_average(
    surface: &Surface,
    basis: PressureBasis,
    vertex: usize,
    at_vertex: impl Fn(u32) -> f64,
    at_middle: impl Fn(u32, u32) -> f64,
) -> f64 {
    let mut sum = 0.0;
    for &face in surface.faces_around(vertex) {
        let [a, b, c] = from_corner(surface.faces()[face as usize], vertex as u32);
        let (beside, across) = (at_middle(a, b) + at_middle(c, a), at_middle(b, c));
        let mean = match basis {
            PressureBasis::Linear => {
                // ∫ l_a (quadratic shape function) dA / area, l_a the hat: corners 1/30, -1/60, -1/60, middles
                // 2/15 on the edges at a, 1/15 across
                let [at_a, at_b, at_c] = [a, b, c].map(&at_vertex);
                (2.0 * at_a - at_b - at_c + 8.0 * beside + 4.0 * across) / 60.0
            }
            // the pressure is the same over the one-ring, whose area is three vertex areas
            PressureBasis::OneRing => (beside + across) / 9.0,
        };
        sum += surface.face_areas()[face as usize] * mean;
    }
    sum / surface.vertex_areas()[vertex]
}

/// The corners of a face, turned so that `first` comes first.
fn from_corner([a, b, c]: [u32; 3], first: u32) -> [u32; 3] {
    match first {
        _ if first == b => [b, c, a],
        _ if first == c => [c, a, b],
        _ => [a, b, c],
    }
}
