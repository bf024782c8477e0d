//! The average of 1/r over two loads far from each other, by the moments of both.
//!
//! With `R_lm` the regular and `I_lm` the irregular solid harmonics (Epton, Dembart 1995, doi 10.1137/0916051), a and b the
//! places in the two loads seen from their centers, and d the way from the second center to the first,
//!
//! ```text
//! 1/|d + a - b| = Σ_l Σ_m conj(R_lm(b - a)) I_lm(d),   R_lm(b - a) = Σ R_l'm'(b) (-1)^(l-l') R_(l-l')(m-m')(a)
//! ```
//!
//! About their centers of force loads have no moment of degree 1, so that up to degree 3 the means of the two loads add up,
//! and from there on few products of them join.

use nalgebra::Complex;
use pulp::{Simd, WithSimd};

use crate::response::column::load::{LoadedFace, loaded_faces};
use crate::response::error::ResponseError;
use crate::response::kernel::basis::PressureBasis;
use crate::response::matrix::fill::fill_items;
use crate::response::matrix::galerkin::node_load::{HIGHEST_DEGREE, MOMENT_COUNT, NodeLoad};
use crate::response::matrix::options::AssemblyOptions;
use crate::response::series::point_loads::PointLoads;
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::POINTS_PER_BLOCK;
use crate::surface::checked::Surface;

/// Degrees that a sum can end at, and of each the share of `((s + s') / r)^(degree + 2)` that it leaves out, s the means of
/// that power of the places in the two loads and r their distance: as measured on meshes of all shapes.
const SUM_DEGREES: [(usize, f64); 2] = [(4, 0.9), (6, 0.9)];
/// Distance over the sum of two such means below which that share says little.
const LEAST_RATIO: f64 = 2.5;

/// Unit forces at nodes, each spread over the triangles around it, and laid out for vector code.
#[derive(Debug)]
pub(crate) struct LoadMoments {
    /// Center of force (m).
    center: [Vec<f64>; 3],
    /// Means of the regular harmonics about it (m^l).
    moments: [Vec<f64>; MOMENT_COUNT],
    /// Sixth root of the mean sixth power of the distance from it (m).
    sizes: Vec<f64>,
    /// Distance over the sum of two sizes from which on each of [`SUM_DEGREES`] keeps the tolerance.
    farther: [f64; SUM_DEGREES.len()],
}

impl LoadMoments {
    /// The loads of some nodes.
    pub(crate) fn new(
        surface: &Surface,
        nodes: &[usize],
        pressure: PressureBasis,
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let mut loads = vec![NodeLoad::default(); nodes.len()];
        let scratch = || (Vec::<LoadedFace>::new(), PointLoads::default());
        fill_items(&mut loads, options, scratch, |(faces, forces), at, load| {
            faces.clear();
            loaded_faces(surface, nodes[at], pressure, faces);
            *load = NodeLoad::new(faces, forces);
        })?;
        let padded = nodes.len().next_multiple_of(POINTS_PER_BLOCK);
        let list = |of: &dyn Fn(&NodeLoad) -> f64| {
            let mut list: Vec<f64> = loads.iter().map(of).collect();
            list.resize(padded, list.last().copied().unwrap_or_default());
            list
        };
        let farther = SUM_DEGREES.map(|(degree, left_out)| {
            (left_out / options.tolerance.max(f64::EPSILON)).powf(1.0 / (degree + 2) as f64).max(LEAST_RATIO)
        });
        Ok(Self {
            center: std::array::from_fn(|k| list(&|load| load.center[k])),
            moments: std::array::from_fn(|k| list(&|load| load.moments[k])),
            sizes: list(&|load| load.size),
            farther,
        })
    }

    /// Whether a load is so far from one of others that their moments of all degrees keep the tolerance.
    pub(crate) fn are_far(&self, one: usize, others: &Self, other: usize) -> bool {
        let reach = self.farther[SUM_DEGREES.len() - 1] * (self.sizes[one] + others.sizes[other]);
        let squared = |k: usize| (self.center[k][one] - others.center[k][other]).powi(2);
        squared(0) + squared(1) + squared(2) >= reach * reach
    }

    /// Sets `values` to the mean of 1/r (1/m) of the load `column` of others and each of the loads from `first` on, a
    /// multiple of the vectors' length.
    pub(crate) fn means(&self, others: &Self, column: usize, first: usize, values: &mut [f64]) {
        pulp::Arch::new().dispatch(Means { rows: self, others, column, first, values });
    }
}

/// The moments of one degree by their orders, of which 0 stands in the middle; 0 of an order that there is not.
type Orders = [Complex<f64>; 4 * HIGHEST_DEGREE + 1];

fn by_order(moments: &[f64; MOMENT_COUNT], l: usize) -> Orders {
    let mut orders = [Complex::new(0.0, 0.0); 4 * HIGHEST_DEGREE + 1];
    orders[2 * HIGHEST_DEGREE] = Complex::new(moments[l * l], 0.0);
    for m in 1..=l {
        let positive = Complex::new(moments[l * l + 2 * m - 1], moments[l * l + 2 * m]);
        orders[2 * HIGHEST_DEGREE + m] = positive;
        orders[2 * HIGHEST_DEGREE - m] = if m % 2 == 0 { positive.conj() } else { -positive.conj() };
    }
    orders
}

/// Adds what takes the moments of degree `own` of a first load, with those of degree `rest` of a second one, to those of the
/// pair, row by row.
fn add_products(second: &Orders, rest: usize, own: usize, factors: &mut Vec<f64>) {
    // seen from the other side
    let sign = if own.is_multiple_of(2) { 1.0 } else { -1.0 };
    for m in 0..=rest + own {
        let mut row = [Complex::new(0.0, 0.0); 2 * HIGHEST_DEGREE + 1];
        row[0] = second[2 * HIGHEST_DEGREE + m];
        // of the real and the imaginary part of the first load's moment of order o
        for o in 1..=own {
            let (plus, minus) = (second[2 * HIGHEST_DEGREE + m - o], second[2 * HIGHEST_DEGREE + m + o]);
            let mirrored = if o % 2 == 0 { minus } else { -minus };
            (row[2 * o - 1], row[2 * o]) = (plus + mirrored, Complex::<f64>::i() * (plus - mirrored));
        }
        let row = &row[..=2 * own];
        factors.extend(row.iter().map(|factor| sign * factor.re));
        if m > 0 {
            factors.extend(row.iter().map(|factor| sign * factor.im));
        }
    }
}

struct Means<'a> {
    rows: &'a LoadMoments,
    others: &'a LoadMoments,
    column: usize,
    first: usize,
    values: &'a mut [f64],
}

impl WithSimd for Means<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { rows, others, column, first, values } = self;
        let own: [f64; MOMENT_COUNT] = std::array::from_fn(|k| others.moments[k][column]);
        let mut factors = Vec::with_capacity(512);
        for l in 4..=HIGHEST_DEGREE {
            for first in 2..=l - 2 {
                add_products(&by_order(&own, l - first), l - first, first, &mut factors);
            }
        }
        let center = others.center.each_ref().map(|list| list[column]);
        let any = Lanes::splat(simd, 0.0);
        for (place, at) in (first..first + values.len()).step_by(S::F64_LANES).enumerate() {
            // no closures here: they would not be compiled for the machine's vectors
            let mut way = [any; 3];
            for k in 0..3 {
                way[k] = Lanes::load(simd, &rows.center[k], at) - any.all(center[k]);
            }
            let sizes = Lanes::load(simd, &rows.sizes, at) + any.all(others.sizes[column]);
            let reach = any.all(rows.farther[0]) * sizes;
            let is_far = (dot(&way, &way) - reach * reach).least() >= 0.0;
            let degree = if is_far { SUM_DEGREES[0].0 } else { HIGHEST_DEGREE };
            let mut moments = [any; MOMENT_COUNT];
            moments[0] = any.all(1.0);
            for l in 2..=degree {
                for k in l * l..(l + 1) * (l + 1) {
                    let (mine, theirs) = (Lanes::load(simd, &rows.moments[k], at), any.all(own[k]));
                    moments[k] = if l % 2 == 1 { theirs - mine } else { theirs + mine };
                }
            }
            let mut next = 0;
            for l in 4..=degree {
                for own in 2..=l - 2 {
                    let lists = &rows.moments[own * own..(own + 1) * (own + 1)];
                    let moments = &mut moments[l * l..(l + 1) * (l + 1)];
                    // each list at all moments, which do not wait for each other
                    for (k, list) in lists.iter().enumerate() {
                        let mine = Lanes::load(simd, list, at);
                        for (row, moment) in moments.iter_mut().enumerate() {
                            let factor = factors[next + row * lists.len() + k];
                            *moment = mine.mul_add(any.all(factor), *moment);
                        }
                    }
                    next += lists.len() * moments.len();
                }
            }
            expansion(&way, &moments, degree).store(values, place * S::F64_LANES);
        }
    }
}

/// The sum up to a degree at the way d between the centers.
#[inline(always)]
fn expansion<S: Simd>(way: &[Lanes<S>; 3], moments: &[Lanes<S>; MOMENT_COUNT], degree: usize) -> Lanes<S> {
    let any = way[0];
    let inverse_squared = any.all(1.0) / dot(way, way);
    let (x, y, z) = (way[0] * inverse_squared, way[1] * inverse_squared, way[2] * inverse_squared);
    // I_mm, from order to order
    let (mut re, mut im) = (inverse_squared.sqrt(), any.all(0.0));
    let mut sum = any.all(0.0);
    for m in 0..=degree {
        if m > 0 {
            let factor = any.all(-((2 * m - 1) as f64));
            (re, im) = (factor * (re * x - im * y), factor * (re * y + im * x));
        }
        // I_lm = q_l I_mm with q real
        let (mut before, mut q) = (any.all(0.0), any.all(1.0));
        let (mut real, mut imaginary) = (any.all(0.0), any.all(0.0));
        for l in m..=degree {
            if l > m {
                let pull = any.all(((l - 1) * (l - 1)) as f64 - (m * m) as f64) * inverse_squared;
                (before, q) = (q, any.all((2 * l - 1) as f64) * z * q - pull * before);
            }
            if m > 0 {
                real = moments[l * l + 2 * m - 1].mul_add(q, real);
                imaginary = moments[l * l + 2 * m].mul_add(q, imaginary);
            } else {
                real = moments[l * l].mul_add(q, real);
            }
        }
        let twice = any.all(if m == 0 { 1.0 } else { 2.0 });
        sum = twice.mul_add(real * re + imaginary * im, sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::response::column::load::weighted;
    use crate::response::integral::gauss::triangle_rule;
    use crate::sample::{Random, jittered_grid};

    /// The load of a node about its center of force.
    fn point_forces(surface: &Surface, node: usize) -> Vec<(Vector3<f64>, f64)> {
        let mut faces = Vec::new();
        loaded_faces(surface, node, PressureBasis::Linear, &mut faces);
        let mut forces = Vec::new();
        for face in &faces {
            let [a, b, c] = face.frame.vertices;
            for (l, weight) in triangle_rule(8) {
                let place = a * l[0] + b * l[1] + c * l[2];
                forces.push((place, weight * face.frame.area * weighted(&face.density, l)));
            }
        }
        let center: Vector3<f64> = forces.iter().map(|(place, force)| place * *force).sum();
        forces.iter_mut().for_each(|(place, _)| *place -= center);
        forces
    }

    #[test]
    fn pairs_of_rough_drawn_out_loads_keep_the_tolerance_from_where_on_they_are_far() {
        let mut random = Random(7);
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let options = AssemblyOptions { tolerance, ..AssemblyOptions::default() };
            let mut worst = [0.0_f64; SUM_DEGREES.len()];
            for _ in 0..30 {
                let stretch = 1.0 + 2.0 * random.next();
                let (mut vertices, faces) = jittered_grid(5, 1.0, 0.4, &mut random);
                vertices
                    .iter_mut()
                    .for_each(|v| *v = Vector3::new(stretch * v.x, v.y, 0.5 * random.signed()));
                let surface = Surface::new(vertices, faces).unwrap();
                let nodes: Vec<usize> = (0..surface.vertices().len()).collect();
                let loads =
                    || LoadMoments::new(&surface, &nodes, PressureBasis::Linear, &options).expect("vertices");
                let (rows, mut others) = (loads(), loads());
                let forces: Vec<_> = nodes.iter().map(|&node| point_forces(&surface, node)).collect();
                for (worst, farther) in worst.iter_mut().zip(rows.farther) {
                    let [one, other] = [0, 1].map(|_| (random.next() * nodes.len() as f64) as usize);
                    let way = Vector3::from_fn(|_, _| random.signed()).normalize();
                    let distance = 1.0001 * farther * (rows.sizes[one] + rows.sizes[other]);
                    for k in 0..3 {
                        others.center[k][other] = rows.center[k][one] - distance * way[k];
                    }
                    assert!(rows.are_far(one, &others, other));
                    let mut values = vec![0.0; rows.sizes.len()];
                    rows.means(&others, other, 0, &mut values);
                    let exact: f64 = forces[one]
                        .iter()
                        .flat_map(|(a, f)| forces[other].iter().map(move |(b, g)| (a - b, f * g)))
                        .map(|(apart, force)| force / (distance * way + apart).norm())
                        .sum();
                    *worst = worst.max((values[one] / exact - 1.0).abs() / tolerance);
                }
            }
            assert!(worst.iter().all(|&worst| worst < 1.0), "{tolerance:e}: {worst:?} tolerances");
        }
    }
}
