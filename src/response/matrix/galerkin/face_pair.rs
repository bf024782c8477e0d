//! The nine averages of 1/r against the hats of two triangles.

use std::sync::OnceLock;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::load::LoadedFace;
use crate::response::integral::frame::TriangleFrame;
use crate::response::integral::hat::hat_integrals_within;
use crate::response::integral::hat_simd::NearHats;
use crate::response::integral::rule_lists::RuleLists;
use crate::response::matrix::galerkin::near_faces::NodeFace;
use crate::response::matrix::galerkin::outer_rule::{OuterRules, SLENDER};
use crate::response::simd::lanes::{Lanes, dot};
use crate::surface::checked::Surface;

/// `∫∫ hat_a(x) hat_b(y) / |x - y| dA dA` (m³) of the corners a of one triangle and b of another.
pub(crate) type Products = [[f64; 3]; 3];

fn transposed(products: &Products) -> Products {
    std::array::from_fn(|a| std::array::from_fn(|b| products[b][a]))
}

/// What all pairs of some triangles share.
pub(crate) struct FacePairs<'a> {
    surface: &'a Surface,
    faces: &'a [NodeFace],
    /// Of those that have been in a pair.
    hats: Vec<OnceLock<Box<Hats>>>,
    tolerance: f64,
    rules: &'a OuterRules,
    /// Whether there is a slender triangle around each vertex of the surface.
    is_slender: Vec<bool>,
}

impl<'a> FacePairs<'a> {
    /// * `around`: triangles around each vertex of the surface
    pub(crate) fn new(
        surface: &'a Surface,
        faces: &'a [NodeFace],
        around: &[Vec<u32>],
        rules: &'a OuterRules,
        tolerance: f64,
    ) -> Self {
        let is_slender = |face: &u32| faces[*face as usize].slenderness() > SLENDER;
        Self {
            surface,
            faces,
            hats: faces.iter().map(|_| OnceLock::new()).collect(),
            tolerance,
            rules,
            is_slender: around.iter().map(|faces| faces.iter().any(is_slender)).collect(),
        }
    }

    fn hats(&self, index: usize) -> &Hats {
        self.hats[index].get_or_init(|| Box::new(Hats::new(self.surface, &self.faces[index])))
    }

    /// Of two triangles, by their indices.
    pub(crate) fn products(&self, pair: [usize; 2]) -> Products {
        let [first, second] = pair.map(|index| &self.faces[index]);
        let hats = pair.map(|index| self.hats(index));
        if first.vertices.iter().any(|vertex| second.vertices.contains(vertex)) {
            return self.touching([first, second], hats);
        }
        // The potential of the larger triangle is the smoother one.
        let is_swapped = second.radius < first.radius;
        let (outer, inner, hats) =
            if is_swapped { (second, first, hats[0]) } else { (first, second, hats[1]) };
        let distance = (outer.center - inner.center).norm() - inner.radius;
        let rule = if distance < outer.radius {
            &self.rules.close
        } else {
            self.rules.apart(outer.radius, distance)
        };
        let reach = distance + 2.0 * inner.radius + outer.radius;
        let found = hats.averages(outer, rule, reach, self.tolerance);
        let found = found.map(|row| row.map(|average| outer.area * average));
        if is_swapped { transposed(&found) } else { found }
    }

    /// Of triangles with a corner in common: the mean over such corners.
    ///
    /// Seen from there 1/r is homogeneous of degree -1, a hat of another corner of degree 1, and the sum of all three of
    /// degree 0. By the theorems of Euler and Gauss the integral of a product of degree d is 1/(d + 4) of its flow out of
    /// both triangles, which is through the edges opposite to the common corner alone (as in Lenoir, Salles 2012).
    fn touching(&self, [first, second]: [&NodeFace; 2], hats: [&Hats; 2]) -> Products {
        let reach = 2.0 * (first.radius + second.radius);
        let mut sums = [[0.0; 3]; 3];
        let mut count = 0.0;
        for (k, &vertex) in first.vertices.iter().enumerate() {
            let Some(l) = second.vertices.iter().position(|&other| other == vertex) else { continue };
            let is_slender = self.is_slender[vertex as usize];
            let [on_first, on_second] =
                [(hats[1], first, k), (hats[0], second, l)].map(|(hats, outer, corner)| {
                    hats.averages(outer, self.rules.edge(corner, is_slender), reach, self.tolerance)
                });
            let on_second = transposed(&on_second);
            let flow = std::array::from_fn(|a| {
                std::array::from_fn(|b| 2.0 * (first.area * on_first[a][b] + second.area * on_second[a][b]))
            });
            for (row, found) in sums.iter_mut().zip(products_of_flow(flow, [k, l])) {
                row.iter_mut().zip(found).for_each(|(sum, one)| *sum += one);
            }
            count += 1.0;
        }
        sums.map(|row| row.map(|sum| sum / count))
    }
}

/// The products by the flow of each where the common corner is k of the first and l of the second triangle.
fn products_of_flow(flow: Products, [k, l]: [usize; 2]) -> Products {
    let sum = |numbers: &[f64; 3]| numbers.iter().sum::<f64>();
    // of two other hats; of one with the sum of all three; of both sums
    let mut found = flow.map(|row| row.map(|one| one / 5.0));
    let rows = flow.map(|row| sum(&row) / 4.0);
    let mut columns = transposed(&flow).map(|column| sum(&column) / 4.0);
    let all = flow.iter().map(sum).sum::<f64>() / 3.0;
    for a in (0..3).filter(|&a| a != k) {
        found[a][l] = 0.0;
        found[a][l] = rows[a] - sum(&found[a]);
    }
    columns[l] = 0.0;
    columns[l] = all - sum(&columns);
    for b in 0..3 {
        found[k][b] = 0.0;
        found[k][b] = columns[b] - found.iter().map(|row| row[b]).sum::<f64>();
    }
    found
}

/// The hats of a triangle as a load.
struct Hats {
    vertices: [Vector3<f64>; 3],
    near: NearHats,
    loaded: LoadedFace,
}

impl Hats {
    fn new(surface: &Surface, face: &NodeFace) -> Self {
        let share = |&v: &u32| 1.0 / surface.vertex_areas()[v as usize];
        let density = [face.vertices.iter().map(share).fold(0.0, f64::max); 3];
        let loaded = LoadedFace { frame: TriangleFrame::new(face.corners), density };
        Self { vertices: face.corners, near: NearHats::new(&loaded.frame), loaded }
    }

    /// Averages over `outer` (m) of its hats, the rows, times the potentials of these.
    ///
    /// * `reach`: no point of `outer` is farther (m) from this triangle
    fn averages(&self, outer: &NodeFace, rule: &RuleLists, reach: f64, tolerance: f64) -> Products {
        match self.loaded.error_beyond_closed_form(reach, tolerance) {
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

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::sample::Random;

    #[test]
    fn a_triangle_on_itself_has_the_closed_form() {
        let mut random = Random(11);
        for _ in 0..20 {
            let corners = [0, 1, 2].map(|_| Vector3::from_fn(|_, _| random.signed()));
            let surface = Surface::new(corners.to_vec(), vec![[0, 1, 2]]).expect("a triangle");
            let faces = NodeFace::around(&surface, &[0, 1, 2], &[0, 1, 2]);
            let rules = OuterRules::new(1e-9);
            let pairs = FacePairs::new(&surface, &faces, &vec![vec![0]; 3], &rules, 1e-9);
            let found: f64 = pairs.products([0, 0]).iter().flatten().sum();
            // Eibert, Hansen 1995: the mean of 1/r by the edges and half of their sum
            let [a, b, c] = corners;
            let edges = [b - a, c - b, a - c].map(|edge| edge.norm());
            let half = 0.5 * edges.iter().sum::<f64>();
            let mean = -4.0 / 3.0 * edges.iter().map(|edge| (1.0 - edge / half).ln() / edge).sum::<f64>();
            assert_relative_eq!(found, mean * faces[0].area.powi(2), max_relative = 1e-7);
        }
    }
}
