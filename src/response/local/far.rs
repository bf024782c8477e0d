//! Entries of blocks whose loads are away from their nodes: the load of a node as a few point forces.

use super::super::border::displacement_point;
use super::super::elementary::exp_negative;
use super::super::lanes::Lanes;
use super::super::layer::LayerKernel;
use super::super::skin::{Pressure, Response, Skin};
use super::cross::Entries;
use super::points::{spread, with_same_moments};
use super::smooth::SmoothPart;
use crate::surface::Surface;
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Largest number of points in each direction of a triangle.
const MOST_POINTS: usize = 8;
/// Rows of a block that are looked at besides the first, over its places and over its thicknesses.
const CHECKS: usize = 3;
/// Nodes evaluated at a time.
const STRIP: usize = 32;

/// How a load is replaced by point forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Rule {
    /// Four of equal size with the load's centre and second moments.
    Moments,
    /// A Gauss rule of n x n points on each loaded triangle.
    Faces(usize),
}

/// A radial kernel.
#[derive(Debug)]
enum Kernel {
    Layer { smooth: SmoothPart, inverse_thickness: Vec<f64> },
    Gaussian { height: f64, width: f64 },
}

/// The nodes and loads of a matrix in the order of its tree.
pub(super) struct FarField<'a> {
    surface: &'a Surface,
    skin: &'a Skin,
    vertices: Vec<usize>,
    at: [Vec<f64>; 3],
    /// The four point forces of each load, which are equal.
    four: Vec<[Vector3<f64>; 4]>,
    kernel: Kernel,
    tolerance: f64,
}

impl<'a> FarField<'a> {
    /// * `vertices`: vertex at each place
    /// * `tolerance`: of an entry, relative to its K/r part
    pub(super) fn new(
        surface: &'a Surface,
        skin: &'a Skin,
        vertices: Vec<usize>,
        tolerance: f64,
    ) -> Result<Self, super::super::error::ResponseError> {
        let point = |&v: &usize| match &skin.response {
            Response::Layer { thickness, .. } => displacement_point(surface, v, thickness.at(v)),
            _ => surface.vertices()[v],
        };
        let points: Vec<Vector3<f64>> = vertices.iter().map(point).collect();
        let at = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect());
        let four = vertices.iter().map(|&vertex| with_same_moments(surface, skin, vertex)).collect();
        let kernel = match &skin.response {
            Response::Layer { thickness, .. } => {
                let inverse_thickness: Vec<f64> = vertices.iter().map(|&v| 1.0 / thickness.at(v)).collect();
                let smooth = SmoothPart::new(&*LayerKernel::new(skin.poisson_ratio)?);
                Kernel::Layer { smooth, inverse_thickness }
            }
            Response::GaussianCorrected { height, width, .. } => {
                Kernel::Gaussian { height: *height, width: *width }
            }
            Response::HalfSpace { .. } => unreachable!("the half-space is not local"),
        };
        Ok(Self { surface, skin, vertices, at, four, kernel, tolerance })
    }

    /// Vertex at a place.
    pub(super) fn vertex(&self, place: usize) -> usize {
        self.vertices[place]
    }

    /// Point of the node at a place (m).
    pub(super) fn point(&self, place: usize) -> Vector3<f64> {
        Vector3::new(self.at[0][place], self.at[1][place], self.at[2][place])
    }

    /// Rows of a block that tell of the others, counted from the first: the one that loads around `point` move most,
    /// some spread over the places, and some from the thickest to thinner ones where the thickness varies.
    pub(super) fn looks(&self, rows: Range<usize>, point: &Vector3<f64>) -> Vec<usize> {
        let inverse = |i: usize| match &self.kernel {
            Kernel::Layer { inverse_thickness, .. } => inverse_thickness[rows.start + i],
            Kernel::Gaussian { .. } => 1.0,
        };
        let thicknesses_away = |i: usize| {
            let place = rows.start + i;
            self.point(place).metric_distance(point) * inverse(i)
        };
        let count = rows.len();
        let first = (0..count).min_by(|&a, &b| thicknesses_away(a).total_cmp(&thicknesses_away(b)));
        let first = first.expect("a block has rows");
        let mut looks = vec![first];
        looks.extend((1..=CHECKS).rev().map(|k| (first + k * count / (CHECKS + 1)) % count));
        let mut by_thickness: Vec<usize> = (0..count).collect();
        by_thickness.sort_by(|&a, &b| inverse(a).total_cmp(&inverse(b)));
        if inverse(by_thickness[0]) < inverse(by_thickness[count - 1]) {
            looks.extend((0..=CHECKS).map(|k| by_thickness[k * count / (CHECKS + 1)]));
        }
        looks
    }

    /// The entries of one block.
    ///
    /// * `clearance`: distance between its nodes and its loads (m), at least, > 0
    /// * `load_radius`: how far these extend around their nodes (m), at most
    pub(super) fn block(
        &self,
        rows: Range<usize>,
        columns: Range<usize>,
        clearance: f64,
        load_radius: f64,
    ) -> FarBlock<'_> {
        self.block_by(rows, columns, self.rule(load_radius, clearance + load_radius))
    }

    fn block_by(&self, rows: Range<usize>, columns: Range<usize>, rule: Rule) -> FarBlock<'_> {
        let count = columns.len();
        let faces = |place: usize| self.surface.faces_around(self.vertices[place]);
        let points = match rule {
            Rule::Moments => 4,
            Rule::Faces(n) => n * n * columns.clone().map(|place| faces(place).len()).max().unwrap_or(0),
        };
        // Point after point, each for all columns; what a load has too few of lies at its node, without a share.
        let mut loads =
            Loads { at: [0, 1, 2].map(|_| vec![0.0; points * count]), share: vec![0.0; points * count] };
        for (j, place) in columns.clone().enumerate() {
            let mut number = j;
            let mut push = |point: Vector3<f64>, share: f64| {
                (0..3).for_each(|axis| loads.at[axis][number] = point[axis]);
                loads.share[number] = share;
                number += count;
            };
            match rule {
                Rule::Moments => self.four[place].iter().for_each(|&point| push(point, 0.25)),
                Rule::Faces(n) => spread(self.surface, self.skin, self.vertices[place], n, &mut push),
            }
            while number < points * count {
                (0..3).for_each(|axis| loads.at[axis][number] = self.at[axis][place]);
                number += count;
            }
        }
        FarBlock { field: self, rows, columns, loads }
    }

    /// The cheapest rule whose error relative to K/r is within the tolerance at a distance (m) from a load's node, at
    /// least two load radii.
    ///
    /// Errors fall with a power of load radius over distance, and for the Gaussian over its width; the factors were
    /// found on jittered meshes and are two to three times what was seen there. A layer's kernel, which fades, errs less.
    fn rule(&self, load_radius: f64, distance: f64) -> Rule {
        let near = load_radius / distance;
        let smooth = |power: i32| match self.kernel {
            Kernel::Layer { .. } => 0.0,
            Kernel::Gaussian { height, width } => {
                let share = 0.1 * height * distance / self.skin.kernel_constant();
                let least = (distance - load_radius) / width;
                share * (load_radius / width).powi(power) * hermite_bound(power, least)
            }
        };
        let error = |factor: f64, power: i32| factor * (near.powi(power) + smooth(power));
        let of_moments = match self.skin.pressure() {
            Pressure::Linear => 0.03,
            Pressure::OneRing => 0.1,
        };
        if error(of_moments, 3) <= self.tolerance {
            return Rule::Moments;
        }
        let of_faces = |n: i32| error(0.01 * 9f64.powi(2 - n), 2 * n);
        Rule::Faces((2..MOST_POINTS).find(|&n| of_faces(n as i32) <= self.tolerance).unwrap_or(MOST_POINTS))
    }
}

/// Bound of the derivative of order m of `exp(-t²/2)` beyond a distance t, over its largest value `√m!`.
///
/// The derivative is a Hermite polynomial times the Gaussian: below `t^m exp(-t²/2)` from √m on, where that falls.
fn hermite_bound(m: i32, t: f64) -> f64 {
    let root_of_factorial: f64 = (1..=m).map(|k| f64::from(k).sqrt()).product();
    if t * t < f64::from(m) { 1.0 } else { (t.powi(m) * (-0.5 * t * t).exp() / root_of_factorial).min(1.0) }
}

/// Point k of column j at `k * columns + j`: places (m) and shares of the unit force.
struct Loads {
    at: [Vec<f64>; 3],
    share: Vec<f64>,
}

/// Rows and columns of one block.
pub(super) struct FarBlock<'a> {
    field: &'a FarField<'a>,
    rows: Range<usize>,
    columns: Range<usize>,
    loads: Loads,
}

impl FarBlock<'_> {
    /// All entries, column by column.
    pub(super) fn dense(&mut self) -> Vec<f64> {
        let mut values = vec![0.0; self.rows.len() * self.columns.len()];
        for (j, column) in values.chunks_exact_mut(self.rows.len()).enumerate() {
            self.column(j, column);
        }
        values
    }
}

impl Entries for FarBlock<'_> {
    fn row(&mut self, i: usize, values: &mut [f64]) {
        values.fill(0.0);
        let place = self.rows.start + i;
        let point = [0, 1, 2].map(|axis| self.field.at[axis][place]);
        let count = self.columns.len();
        for k in 0..self.loads.share.len() / count {
            let range = k * count..(k + 1) * count;
            let others = [0, 1, 2].map(|axis| &self.loads.at[axis][range.clone()]);
            let shares = Shares::Each(&self.loads.share[range.clone()]);
            self.add(place, self.columns.start, Points { point, others, shares }, values);
        }
    }

    fn column(&mut self, j: usize, values: &mut [f64]) {
        values.fill(0.0);
        let count = self.columns.len();
        let others = [0, 1, 2].map(|axis| &self.field.at[axis][self.rows.clone()]);
        for k in (j..self.loads.share.len()).step_by(count) {
            let point = [0, 1, 2].map(|axis| self.loads.at[axis][k]);
            let shares = Shares::Same(self.loads.share[k]);
            self.add(self.columns.start + j, self.rows.start, Points { point, others, shares }, values);
        }
    }
}

impl FarBlock<'_> {
    fn add(&self, place: usize, first: usize, points: Points, values: &mut [f64]) {
        let FarField { kernel, skin, .. } = self.field;
        let constant = skin.kernel_constant();
        pulp::Arch::new().dispatch(Add { kernel, constant, place, first, points, values });
    }
}

#[derive(Clone, Copy)]
enum Shares<'a> {
    Each(&'a [f64]),
    Same(f64),
}

/// A point and those that it acts on, or that act on it.
struct Points<'a> {
    point: [f64; 3],
    others: [&'a [f64]; 3],
    shares: Shares<'a>,
}

/// Adds `share · kernel(distance)` to each value.
struct Add<'a> {
    kernel: &'a Kernel,
    constant: f64,
    /// Place of the point's node, and of the first other one's.
    place: usize,
    first: usize,
    points: Points<'a>,
    values: &'a mut [f64],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kernel, constant, place, first, points, values } = self;
        let Points { point, others, shares } = points;
        let mut strip_of_distances = [1.0; STRIP];
        for start in (0..values.len()).step_by(STRIP) {
            let strip = start..values.len().min(start + STRIP);
            let values = &mut values[strip.clone()];
            let [x, y, z] = others.map(|list| &list[strip.clone()]);
            let distance = &mut strip_of_distances[..values.len()];
            for i in 0..distance.len() {
                let (dx, dy, dz) = (x[i] - point[0], y[i] - point[1], z[i] - point[2]);
                distance[i] = (dx * dx + dy * dy + dz * dz).sqrt();
            }
            match kernel {
                Kernel::Layer { smooth, inverse_thickness } => {
                    let own = inverse_thickness[place];
                    let inverse = &inverse_thickness[first..][strip.clone()];
                    for (r, other) in distance.iter_mut().zip(inverse) {
                        let inverse = own.max(*other);
                        let rho = *r * inverse;
                        *r = inverse * (1.0 / rho - smooth.at(rho));
                    }
                    distance.iter_mut().for_each(|r| *r *= constant);
                }
                Kernel::Gaussian { height, width } => {
                    let falloff = Lanes::splat(simd, -0.5 / (width * width));
                    for i in (0..distance.len()).step_by(S::F64_LANES) {
                        let r = Lanes::load(simd, &strip_of_distances, i);
                        let gaussian = exp_negative(r * r * falloff);
                        let value = r.all(constant) / r - r.all(*height) * gaussian;
                        value.store(&mut strip_of_distances, i);
                    }
                }
            }
            let distance = &strip_of_distances[..values.len()];
            match shares {
                Shares::Each(shares) => {
                    let shares = &shares[strip.clone()];
                    values.iter_mut().zip(distance).zip(shares).for_each(|((v, u), s)| *v += s * u);
                }
                Shares::Same(share) => {
                    values.iter_mut().zip(distance).for_each(|(v, u)| *v += share * u);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::assemble::assemble_block;
    use super::super::super::options::AssemblyOptions;
    use super::super::super::skin::Gap;
    use super::*;

    /// A bent, jittered grid of cells of some 1 mm.
    fn bowl(cells: usize) -> Surface {
        let mut state = 5u64;
        let mut jitter = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            0.5 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
        };
        let mut vertices = Vec::new();
        for i in 0..=cells {
            for j in 0..=cells {
                let (x, y) = (1e-3 * (i as f64 + jitter()), 1e-3 * (j as f64 + jitter()));
                vertices.push(Vector3::new(x, y, 20.0 * (x * x + y * y)));
            }
        }
        let at = |i: usize, j: usize| (i * (cells + 1) + j) as u32;
        let mut faces = Vec::new();
        for i in 0..cells {
            for j in 0..cells {
                faces.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                faces.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        Surface::new(vertices, faces).expect("a grid is a valid surface")
    }

    #[test]
    fn point_forces_keep_the_tolerance_from_two_load_radii_on() {
        let surface = bowl(24);
        let nodes: Vec<usize> = (0..25 * 25).collect();
        let columns = [12 * 25 + 12, 6 * 25 + 7, 9 * 25 + 15, 13 * 25 + 4];
        let layer = |thickness: f64, pressure| Response::Layer {
            thickness: thickness.into(),
            pressure,
            gap: Gap::Node,
        };
        let gaussian = |width, pressure| Response::GaussianCorrected {
            height: 1e-3,
            width,
            cutoff: f64::INFINITY,
            pressure,
        };
        let both = [Pressure::Linear, Pressure::OneRing];
        let layers = both.into_iter().flat_map(|p| [layer(1.0, p), layer(4e-3, p), layer(1e-3, p)]);
        let gaussians = both.into_iter().flat_map(|p| [gaussian(3e-3, p), gaussian(1e-3, p)]);
        for response in layers.chain(gaussians) {
            let skin = Skin::new(60e3, 0.5, response).expect("valid constants");
            let options = AssemblyOptions { tolerance: 1e-10, ..Default::default() };
            let exact = assemble_block(&surface, &skin, &nodes, &columns, &options).expect("valid");
            for tolerance in [1e-2, 1e-3, 1e-4, 1e-6] {
                let field = FarField::new(&surface, &skin, nodes.clone(), tolerance).expect("valid");
                for (j, &column) in columns.iter().enumerate() {
                    let distance = |v: usize| (surface.vertices()[v] - surface.vertices()[column]).norm();
                    let ring = surface.neighbours(column).iter();
                    let radius = ring.map(|&other| distance(other as usize)).fold(0.0, f64::max);
                    for i in (0..nodes.len()).filter(|&i| distance(i) >= 2.0 * radius) {
                        let clearance = distance(i) - radius;
                        let mut block = field.block(i..i + 1, column..column + 1, clearance, radius);
                        let (mut row, mut values) = ([0.0], [0.0]);
                        block.row(0, &mut row);
                        block.column(0, &mut values);
                        let error = (values[0] - exact[(i, j)]).abs();
                        assert!(
                            error <= tolerance * skin.kernel_constant() / distance(i),
                            "{tolerance} {i} {column}"
                        );
                        assert!((row[0] - values[0]).abs() <= 1e-14 * skin.kernel_constant() / distance(i));
                    }
                }
            }
        }
    }
}
