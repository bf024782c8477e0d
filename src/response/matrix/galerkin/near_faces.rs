//! Pairs of triangles close to each other: the nine averages of 1/r against the hats of both, shared by all pairs of nodes.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::load::LoadedFace;
use crate::response::error::ResponseError;
use crate::response::integral::frame::{TriangleFrame, ball_around};
use crate::response::integral::hat::hat_integrals_within;
use crate::response::integral::hat_simd::NearHats;
use crate::response::integral::rule_lists::RuleLists;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::fill::fill_items;
use crate::response::matrix::galerkin::outer_rule::OuterRules;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::rows::NO_ROW;
use crate::response::simd::lanes::{Lanes, dot};
use crate::surface::checked::Surface;

/// Rings around a vertex whose triangles are near it.
const NEAR_RINGS: usize = 2;
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
    /// The triangles around the nodes of a matrix, by the row and the column of each vertex.
    pub(crate) fn around(surface: &Surface, row_of: &[usize], column_of: &[usize]) -> Vec<Self> {
        let face = |(vertices, &area): (&[u32; 3], &f64)| {
            let vertices = from_widest_corner(surface, *vertices);
            let rows = vertices.map(|v| row_of[v as usize]);
            let columns = vertices.map(|v| column_of[v as usize]);
            if rows == [NO_ROW; 3] && columns == [NO_ROW; 3] {
                return None;
            }
            let corners = vertices.map(|v| surface.vertices()[v as usize]);
            let (center, radius) = ball_around(&corners);
            Some(Self { corners, vertices, rows, columns, center, radius, area })
        };
        surface.faces().iter().zip(surface.face_areas()).filter_map(face).collect()
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

/// `∫∫ hat_a(x) hat_b(y) / |x - y| dA dA` (m³) of the corners a of one triangle and b of another.
type Products = [[f64; 3]; 3];

/// The averages of all pairs of near triangles.
pub(crate) struct NearFaces {
    /// Triangles around each vertex of the surface, and those near it, ascending.
    around: Vec<Vec<u32>>,
    near: Vec<Vec<u32>>,
    /// Near triangles of each that have no lower number, ascending.
    pairs: Vec<Vec<(u32, Products)>>,
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
        let near = near_vertices(surface, &around);
        let hats: Vec<Hats> = faces.iter().map(|face| Hats::new(surface, face, options.tolerance)).collect();
        let mut pairs: Vec<Vec<(u32, Products)>> = vec![Vec::new(); faces.len()];
        fill_items(&mut pairs, options, Vec::new, |close: &mut Vec<u32>, first, pairs| {
            let face = &faces[first];
            close.clear();
            let lists = face.vertices.iter().flat_map(|&v| &near[v as usize]);
            close.extend(lists.filter(|&&second| second as usize >= first));
            close.sort_unstable();
            close.dedup();
            let is_asked = |second: &u32| {
                let other = &faces[*second as usize];
                face.has_row() && other.has_column() || face.has_column() && other.has_row()
            };
            let asked = close.iter().copied().filter(is_asked);
            pairs.extend(
                asked.map(|second| (second, products([first, second as usize], faces, &hats, rules))),
            );
        })?;
        Ok(Self { around, near, pairs })
    }

    /// Triangles around a vertex, ascending.
    pub(crate) fn around(&self, vertex: usize) -> &[u32] {
        &self.around[vertex]
    }

    /// Near triangles of a vertex, ascending.
    pub(crate) fn of(&self, vertex: usize) -> &[u32] {
        &self.near[vertex]
    }

    /// Averages (m³) of the hats of triangle `at` times the potential of a vertex's pressure of 1 Pa m² per vertex area.
    pub(crate) fn averages(
        &self,
        faces: &[NodeFace],
        at: u32,
        vertex: usize,
        pressure: PressureBasis,
    ) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for &other in &self.around[vertex] {
            let products = self.products_of(at, other);
            let corner = faces[other as usize].corner(vertex as u32);
            for (sum, row) in sums.iter_mut().zip(products) {
                *sum += match pressure {
                    PressureBasis::Linear => row[corner],
                    // the area of the one-ring is three vertex areas
                    PressureBasis::OneRing => row.iter().sum::<f64>() / 3.0,
                };
            }
        }
        sums
    }

    /// Those of two near triangles.
    fn products_of(&self, one: u32, other: u32) -> Products {
        let list = &self.pairs[one.min(other) as usize];
        let place = list.binary_search_by_key(&one.max(other), |(second, _)| *second);
        let (_, found) = &list[place.expect("a near pair")];
        if one <= other { *found } else { transposed(found) }
    }
}

fn transposed(products: &Products) -> Products {
    std::array::from_fn(|a| std::array::from_fn(|b| products[b][a]))
}

fn products(pair: [usize; 2], faces: &[NodeFace], hats: &[Hats], rules: &OuterRules) -> Products {
    let [first, second] = pair.map(|index| &faces[index]);
    let touches = first.vertices.iter().any(|vertex| second.vertices.contains(vertex));
    // The potential of the larger triangle is the smoother one.
    let is_swapped = second.radius < first.radius;
    let (outer, inner, hats) =
        if is_swapped { (second, first, &hats[pair[0]]) } else { (first, second, &hats[pair[1]]) };
    let distance = (outer.center - inner.center).norm() - inner.radius;
    let rule = if touches || distance < outer.radius {
        &rules.touching
    } else {
        rules.apart(outer.radius, distance)
    };
    let found = hats.averages(outer, rule, distance + 2.0 * inner.radius + outer.radius);
    let found = found.map(|row| row.map(|average| outer.area * average));
    if is_swapped { transposed(&found) } else { found }
}

/// Triangles in the near rings of each vertex that `around` lists triangles of, ascending.
fn near_vertices(surface: &Surface, around: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let near = |vertex: usize| {
        let mut near = around[vertex].clone();
        if near.is_empty() {
            return near;
        }
        let mut ring = vec![vertex as u32];
        for _ in 0..NEAR_RINGS {
            let beside: Vec<u32> =
                ring.iter().flat_map(|&v| surface.neighbours(v as usize)).copied().collect();
            ring.extend(beside);
            ring.sort_unstable();
            ring.dedup();
        }
        near.extend(ring.into_iter().flat_map(|v| &around[v as usize]));
        near.sort_unstable();
        near.dedup();
        near
    };
    (0..around.len()).map(near).collect()
}

/// The hats of a triangle as a load.
struct Hats {
    vertices: [Vector3<f64>; 3],
    near: NearHats,
    loaded: LoadedFace,
    tolerance: f64,
}

impl Hats {
    fn new(surface: &Surface, face: &NodeFace, tolerance: f64) -> Self {
        let share = |&v: &u32| 1.0 / surface.vertex_areas()[v as usize];
        let density = [face.vertices.iter().map(share).fold(0.0, f64::max); 3];
        let loaded = LoadedFace { frame: TriangleFrame::new(face.corners), density };
        Self { vertices: face.corners, near: NearHats::new(&loaded.frame), loaded, tolerance }
    }

    /// Averages over `outer` (m) of its hats, the rows, times the potentials of these.
    ///
    /// * `reach`: no point of `outer` is farther (m) from this triangle
    fn averages(&self, outer: &NodeFace, rule: &RuleLists, reach: f64) -> Products {
        match self.loaded.error_beyond_closed_form(reach, self.tolerance) {
            None => pulp::Arch::new().dispatch(Averages { hats: self, outer, rule }),
            Some(allowed) => {
                let mut sums = [[0.0; 3]; 3];
                for q in 0..rule.count {
                    let shares = rule.shares.each_ref().map(|list| list[q]);
                    let point = outer.corners.iter().zip(shares).map(|(corner, l)| corner * l).sum();
                    let found = hat_integrals_within(&point, &self.vertices, allowed);
                    for (row, share) in sums.iter_mut().zip(shares) {
                        (0..3).for_each(|b| row[b] += rule.weights[q] * share * found[b]);
                    }
                }
                sums
            }
        }
    }
}

struct Averages<'a> {
    hats: &'a Hats,
    outer: &'a NodeFace,
    rule: &'a RuleLists,
}

impl WithSimd for Averages<'_> {
    type Output = Products;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Products {
        let Self { hats, outer, rule } = self;
        let zero = Lanes::splat(simd, 0.0);
        let mut sums = [[zero; 3]; 3];
        for first in (0..rule.count).step_by(S::F64_LANES) {
            let mut shares = [zero; 3];
            for (share, list) in shares.iter_mut().zip(&rule.shares) {
                *share = Lanes::load(simd, list, first);
            }
            let [a, b, c] = &outer.corners;
            let place = [
                dot(&shares, &[zero.all(a.x), zero.all(b.x), zero.all(c.x)]),
                dot(&shares, &[zero.all(a.y), zero.all(b.y), zero.all(c.y)]),
                dot(&shares, &[zero.all(a.z), zero.all(b.z), zero.all(c.z)]),
            ];
            let weight = Lanes::load(simd, &rule.weights, first);
            let found = hats.near.at(place);
            for a in 0..3 {
                let share = weight * shares[a];
                for b in 0..3 {
                    sums[a][b] = share.mul_add(found[b], sums[a][b]);
                }
            }
        }
        let mut totals = [[0.0; 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                totals[a][b] = sums[a][b].total();
            }
        }
        totals
    }
}
