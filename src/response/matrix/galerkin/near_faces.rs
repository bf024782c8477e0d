//! Pairs of triangles close to each other, shared by all pairs of nodes.

use nalgebra::Vector3;

use crate::response::error::ResponseError;
use crate::response::integral::frame::ball_around;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::fill::fill_items;
use crate::response::matrix::galerkin::face_pair::{FacePairs, Products};
use crate::response::matrix::galerkin::outer_rule::OuterRules;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::rows::NO_ROW;
use crate::surface::checked::Surface;

/// Rings around a vertex whose triangles are near it: with 2 and with 4 an assembly takes a tenth longer.
const NEAR_RINGS: usize = 3;
/// Edges are equally long within this share of their square.
const EQUALLY_LONG: f64 = 1e-9;

/// A triangle around some nodes.
pub(crate) struct NodeFace {
    pub(crate) corners: [Vector3<f64>; 3],
    /// Vertices of the surface.
    pub(crate) vertices: [u32; 3],
    /// Row and column of each corner; [`NO_ROW`] where it is no such node.
    pub(crate) rows: [usize; 3],
    pub(crate) columns: [usize; 3],
    pub(crate) center: Vector3<f64>,
    pub(crate) radius: f64,
    pub(crate) area: f64,
}

impl NodeFace {
    /// The triangles around the nodes of a matrix, by the row and the column of each vertex; those with a column first.
    pub(crate) fn around(surface: &Surface, row_of: &[usize], column_of: &[usize]) -> Vec<Self> {
        let is_node = |&v: &u32| row_of[v as usize] != NO_ROW || column_of[v as usize] != NO_ROW;
        let face = |(vertices, &area): (&[u32; 3], &f64)| {
            if !vertices.iter().any(is_node) {
                return None;
            }
            let vertices = from_widest_corner(surface, *vertices);
            let rows = vertices.map(|v| row_of[v as usize]);
            let columns = vertices.map(|v| column_of[v as usize]);
            let corners = vertices.map(|v| surface.vertices()[v as usize]);
            let (center, radius) = ball_around(&corners);
            Some(Self { corners, vertices, rows, columns, center, radius, area })
        };
        let mut faces: Vec<Self> =
            surface.faces().iter().zip(surface.face_areas()).filter_map(face).collect();
        faces.sort_by_key(|face| !face.has_column());
        faces
    }

    /// The longest edge over the height on it.
    pub(crate) fn slenderness(&self) -> f64 {
        let [a, b, c] = self.corners;
        let longest = [b - a, c - b, a - c].map(|edge| edge.norm_squared()).into_iter().fold(0.0, f64::max);
        0.5 * longest / self.area
    }

    fn has_row(&self) -> bool {
        self.rows != [NO_ROW; 3]
    }

    fn has_column(&self) -> bool {
        self.columns != [NO_ROW; 3]
    }

    /// The corner at a vertex of the surface.
    fn corner(&self, vertex: u32) -> usize {
        self.vertices.iter().position(|&own| own == vertex).expect("a corner")
    }
}

/// The corners of a triangle from that opposite to its longest edge on: rules for it are collapsed at the first, and what they
/// leave must not hang on which comes first in the mesh.
fn from_widest_corner(surface: &Surface, mut vertices: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = vertices.map(|v| surface.vertices()[v as usize]);
    let opposite = [b - c, c - a, a - b].map(|edge| edge.norm_squared());
    let longest = opposite.into_iter().fold(0.0, f64::max);
    let widest = opposite.iter().position(|edge| *edge >= (1.0 - EQUALLY_LONG) * longest);
    vertices.rotate_left(widest.expect("one of the three"));
    vertices
}

/// The averages of all pairs of near triangles.
pub(crate) struct NearFaces {
    /// Triangles around each vertex of the surface, and those near it, if one around it has a column.
    around: Vec<Vec<u32>>,
    near: Vec<Vec<u32>>,
    /// Of each triangle with a column, with the near ones that have no lower number.
    products: Vec<Vec<Products>>,
    /// The near triangles of each, and where in the list of the lower of both their products are. Triangles around a vertex
    /// touch each other, so that one near it is as many rings from each of them as they are from it: every pair is there.
    places: Vec<Vec<(u32, u32)>>,
}

impl NearFaces {
    pub(crate) fn new(
        surface: &Surface,
        faces: &[NodeFace],
        rules: &OuterRules,
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let mut around: Vec<Vec<u32>> = vec![Vec::new(); surface.vertices().len()];
        for (index, face) in (0_u32..).zip(faces) {
            face.vertices.iter().for_each(|&v| around[v as usize].push(index));
        }
        let near = near_vertices(faces, &around, options)?;
        let averages = FacePairs::new(surface, faces, &around, rules, options.tolerance);
        let with_columns = faces.partition_point(NodeFace::has_column);
        let mut pairs = vec![(Vec::new(), Vec::new()); with_columns];
        let unmet = || vec![usize::MAX; faces.len()];
        fill_items(&mut pairs, options, unmet, |met_at: &mut Vec<usize>, first, (seconds, all)| {
            let face = &faces[first];
            let is_asked = |other: &NodeFace| other.has_row() || face.has_row() && other.has_column();
            for &second in face.vertices.iter().flat_map(|&v| &near[v as usize]) {
                if second as usize >= first
                    && is_first_at(first, met_at, second)
                    && is_asked(&faces[second as usize])
                {
                    seconds.push(second);
                    all.push(averages.products([first, second as usize]));
                }
            }
        })?;
        let mut places = vec![Vec::new(); faces.len()];
        for (first, (seconds, _)) in pairs.iter().enumerate() {
            for (place, &second) in (0_u32..).zip(seconds) {
                places[second as usize].push((first as u32, place));
                if second as usize != first {
                    places[first].push((second, place));
                }
            }
        }
        Ok(Self { around, near, products: pairs.into_iter().map(|(_, all)| all).collect(), places })
    }

    /// Triangles around a vertex.
    pub(crate) fn around(&self, vertex: usize) -> &[u32] {
        &self.around[vertex]
    }

    /// Near triangles of a vertex.
    pub(crate) fn of(&self, vertex: usize) -> &[u32] {
        &self.near[vertex]
    }

    /// Adds, to those triangles near a vertex that are `asked` for, the averages (m³) of their hats times the potential of the
    /// vertex's pressure of 1 Pa m² per vertex area.
    pub(crate) fn add_averages(
        &self,
        faces: &[NodeFace],
        vertex: usize,
        pressure: PressureBasis,
        asked: impl Fn(u32) -> bool,
        averages: &mut [[f64; 3]],
    ) {
        for &other in &self.around[vertex] {
            let corner = faces[other as usize].corner(vertex as u32);
            for &(at, place) in &self.places[other as usize] {
                if !asked(at) {
                    continue;
                }
                let products = &self.products[at.min(other) as usize][place as usize];
                for (a, average) in averages[at as usize].iter_mut().enumerate() {
                    let product = |b: usize| if at <= other { products[a][b] } else { products[b][a] };
                    *average += match pressure {
                        PressureBasis::Linear => product(corner),
                        // the area of the one-ring is three vertex areas
                        PressureBasis::OneRing => (0..3).map(product).sum::<f64>() / 3.0,
                    };
                }
            }
        }
    }
}

/// Triangles in the near rings of each vertex around which `around` lists one with a column.
fn near_vertices(
    faces: &[NodeFace],
    around: &[Vec<u32>],
    options: &AssemblyOptions,
) -> Result<Vec<Vec<u32>>, ResponseError> {
    let has_column = |near: &Vec<u32>| near.iter().any(|&face| faces[face as usize].has_column());
    let mut found: Vec<(usize, Vec<u32>)> =
        around.iter().cloned().enumerate().filter(|(_, near)| has_column(near)).collect();
    let unmet = || vec![usize::MAX; faces.len()];
    fill_items(&mut found, options, unmet, |met_at: &mut Vec<usize>, _, (vertex, near)| {
        near.iter().for_each(|&face| met_at[face as usize] = *vertex);
        let mut front = 0;
        for _ in 0..NEAR_RINGS {
            for k in std::mem::replace(&mut front, near.len())..near.len() {
                let touching = faces[near[k] as usize].vertices.iter().flat_map(|&v| &around[v as usize]);
                near.extend(touching.filter(|&&face| is_first_at(*vertex, met_at, face)));
            }
        }
    })?;
    let mut near = vec![Vec::new(); around.len()];
    found.into_iter().for_each(|(vertex, list)| near[vertex] = list);
    Ok(near)
}

/// Whether a triangle is met for the first time at a place; notes it.
fn is_first_at(place: usize, met_at: &mut [usize], face: u32) -> bool {
    std::mem::replace(&mut met_at[face as usize], place) != place
}
