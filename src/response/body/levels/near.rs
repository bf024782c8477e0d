//! The near kernel in vectors: a half-space that answers along any direction, less what the layer is stiffer.
//!
//! Per newton at distance r, with `r^` the unit vector along r, K = (1-ν)/(2πG) and φ the layer's smooth part,
//!
//! ```text
//! N = 1/(2πG r) { (1-ν) I + [ν r^ r^' + (1/2 - ν) (r^ n' - n r^')] / (1 + r⁶/ρ⁶) }  -  K φ(r/h)/h I
//! ```
//!
//! But for its denominator the first term is the displacement of a half-space's surface (Boussinesq, Cerruti; Johnson 1985,
//! §3.2, 3.6), n the mean of the outward normals at both ends; at ν = 1/2 it is twice Kelvin's solution. h is the thickness of
//! the tissue at hand.
//!
//! What is alike along every direction ends with the tissue's thickness, by φ. The rest would not: around a finger it would
//! push the far side outward, and under a pressure all round it would be as large as what one force does, where tissue that
//! keeps its volume moves by next to nothing; what a coarse mesh errs in it is more. It ends at a reach ρ that goes with h.
//! Without anything behind the tissue it has no end.

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::linalg::columns::par_columns;
use crate::linalg::vectorized::vectorized;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::kernel::thickness::Thickness;
use crate::response::matrix::collocation::assemble_columns;
use crate::response::matrix::kept_block::KeptBlock;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::Request;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Least relative error of the integrals: far below what the remainder's coarse mesh costs.
pub(crate) const NEAR_TOLERANCE: f64 = 1e-4;
/// Rows that one task sums.
const ROWS_PER_TASK: usize = 128;
/// What an even load gives a node at 1/r beyond what all other nodes give as points, times the square root of their areas,
/// on a regular triangular mesh: the lattice constant of Bonsall and Maradudin (1977, doi 10.1103/PhysRevB.15.1959). On
/// squares it is 3.900.
const EVEN_LOAD: f64 = 3.921;

/// ρ over the thickness of the tissue. Up to 1 the compliance of incompressible fingers is definite on their coarse mesh; the
/// shorter it is, the more that mesh has to carry where normals lean.
const REACH_OVER_THICKNESS: f64 = 0.8;

/// The near kernel of one body.
#[derive(Debug, Clone)]
pub(crate) struct NearKernel {
    /// What is alike along every direction: the layer over what does not move, or the half-space without any.
    pub(super) scalar: KernelSkin,
}

/// `1 / (1 + r⁶/ρ⁶)` at a distance squared (m²), ρ² the product of ρ at both ends, of which 1/ρ is given (1/m).
#[inline(always)]
pub(super) fn fade(distance_squared: f64, [to, from]: [f64; 2]) -> f64 {
    let share = distance_squared * (to * from);
    1.0 / (1.0 + share * share * share)
}

impl NearKernel {
    /// * `thickness`: of the tissue at every vertex of the surface (n, m), if there is a bone
    pub fn new(
        shear_modulus: f64,
        poisson_ratio: f64,
        thickness: Option<Arc<[f64]>>,
    ) -> Result<Self, ResponseError> {
        let layer = |list| Kernel::Layer { thickness: Thickness::PerVertex(list) };
        let kernel = thickness.map_or(Kernel::HalfSpace, layer);
        Ok(Self { scalar: KernelSkin::new(shear_modulus, poisson_ratio, kernel)? })
    }

    /// In Pa.
    pub fn shear_modulus(&self) -> f64 {
        self.scalar.shear_modulus()
    }

    /// 1/ρ at a vertex (1/m).
    pub(super) fn per_reach(&self, vertex: usize) -> f64 {
        let thickness = self.scalar.layer_at(vertex);
        thickness.map_or(0.0, |thickness| 1.0 / (REACH_OVER_THICKNESS * thickness))
    }

    /// The same on a refinement of the surface, or of one that it is a part of: the thickness is linear along edges.
    ///
    /// * `own`: vertex of this surface for a given vertex
    pub fn on_refined(
        &self,
        mesh: &RefinedSurface,
        own: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self, ResponseError> {
        let Kernel::Layer { thickness } = self.scalar.kernel() else { return Ok(self.clone()) };
        // Outside the part nothing is loaded, so that any thickness will do there.
        let given = |vertex| own(vertex).map_or(thickness.largest(), |own| thickness.at(own));
        let thickness = mesh.inherit(given, |a, b| 0.5 * (a + b)).into();
        Self::new(self.scalar.shear_modulus(), self.scalar.poisson_ratio(), Some(thickness))
    }

    /// R of the kernel over the nodes along `directions` (k × k, m/N).
    ///
    /// What is alike along every direction is a scalar kernel's. The rest is taken at the nodes in either discretization: along
    /// the skin's own normals it vanishes with r. Where the obstacle's lean from these it does not, and what the sum over the
    /// other nodes lacks of an even load is the node's own.
    ///
    /// * `kept`: what is known of the scalar kernel on this mesh, in that discretization
    pub fn along(
        &self,
        asked: &Request,
        directions: &[Vector3<f64>],
        discretization: Discretization,
        kept: &KeptBlock,
    ) -> Result<Mat<f64>, ResponseError> {
        let mut response = self.scalar_rows(asked, asked.nodes, discretization, kept)?;
        let [x, y, z] = coordinates(asked.nodes.iter().map(|&vertex| &asked.surface.vertices()[vertex]));
        let [along_x, along_y, along_z] = coordinates(directions.iter());
        let normals = asked.nodes.iter().map(|&vertex| &asked.surface.vertex_normals()[vertex]);
        let [normal_x, normal_y, normal_z] = coordinates(normals);
        let per_reach: Vec<f64> = asked.nodes.iter().map(|&vertex| self.per_reach(vertex)).collect();
        let (factor, skew) = (self.outer_factor(), 0.5 * self.skew_factor());
        par_columns(&mut response).enumerate().for_each(|(j, entries)| {
            let count = entries.len();
            let per_reach = &per_reach[..count];
            let [x, y, z] = [&x[..count], &y[..count], &z[..count]];
            let [along_x, along_y, along_z] = [&along_x[..count], &along_y[..count], &along_z[..count]];
            let [normal_x, normal_y, normal_z] = [&normal_x[..count], &normal_y[..count], &normal_z[..count]];
            let (to, load) = ([x[j], y[j], z[j]], [along_x[j], along_y[j], along_z[j]]);
            let own = [normal_x[j], normal_y[j], normal_z[j]];
            vectorized(
                #[inline(always)]
                || {
                    for (i, entry) in entries.iter_mut().enumerate() {
                        let way = [x[i] - to[0], y[i] - to[1], z[i] - to[2]];
                        let along = [along_x[i], along_y[i], along_z[i]];
                        // Twice the mean normal.
                        let normal = [normal_x[i] + own[0], normal_y[i] + own[1], normal_z[i] + own[2]];
                        let (row, column) = (dot(&along, &way), dot(&load, &way));
                        let turned = row * dot(&load, &normal) - column * dot(&along, &normal);
                        let squared = squared(&way);
                        let rest = factor * row * column / squared.sqrt() + skew * turned;
                        let faded = fade(squared, [per_reach[i], per_reach[j]]) * rest / squared;
                        *entry = *entry * dot(&along, &load) + faded;
                    }
                },
            );
        });
        for (j, (&vertex, direction)) in asked.nodes.iter().zip(directions).enumerate() {
            response[(j, j)] += direction.dot(&(self.own_outer(asked.surface, vertex) * direction));
        }
        Ok(response)
    }

    /// What stands for the second term of a vertex at itself (m/N).
    fn own_outer(&self, surface: &Surface, vertex: usize) -> Matrix3<f64> {
        let normal = surface.vertex_normals()[vertex];
        let tangential = Matrix3::identity() - normal * normal.transpose();
        tangential * (0.5 * self.outer_factor() * EVEN_LOAD / surface.vertex_areas()[vertex].sqrt())
    }

    /// Displacement (m) of `vertices` under `forces` (N) at the nodes, the second term as [`along`](Self::along) takes it.
    ///
    /// * `kept`: what is known of the scalar kernel at vertices of this mesh
    pub fn displacements(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
        kept: &KeptBlock,
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let scalar = self.scalar_rows(asked, vertices, Discretization::Collocation, kept)?;
        let (points, normals) = (asked.surface.vertices(), asked.surface.vertex_normals());
        let [x, y, z] = coordinates(vertices.iter().map(|&vertex| &points[vertex]));
        let [normal_x, normal_y, normal_z] = coordinates(vertices.iter().map(|&vertex| &normals[vertex]));
        let per_reach: Vec<f64> = vertices.iter().map(|&vertex| self.per_reach(vertex)).collect();
        let (factor, skew) = (self.outer_factor(), 0.5 * self.skew_factor());
        let moved = |first: usize| {
            let rows = first..vertices.len().min(first + ROWS_PER_TASK);
            let count = rows.len();
            let per_reach = &per_reach[rows.clone()];
            let [x, y, z] = [&x[rows.clone()], &y[rows.clone()], &z[rows.clone()]];
            let [normal_x, normal_y, normal_z] =
                [&normal_x[rows.clone()], &normal_y[rows.clone()], &normal_z[rows.clone()]];
            let mut sums = [[0.0; ROWS_PER_TASK]; 3];
            vectorized(
                #[inline(always)]
                || {
                    let [sum_x, sum_y, sum_z] = &mut sums;
                    let [sum_x, sum_y, sum_z] =
                        [&mut sum_x[..count], &mut sum_y[..count], &mut sum_z[..count]];
                    for (j, (&node, force)) in asked.nodes.iter().zip(forces).enumerate() {
                        let (to, own) = (&points[node], &normals[node]);
                        let (load, from) = ([force.x, force.y, force.z], self.per_reach(node));
                        let scalar = &scalar.col_as_slice(j)[first..][..count];
                        for i in 0..count {
                            let way = [x[i] - to.x, y[i] - to.y, z[i] - to.z];
                            let normal = [normal_x[i] + own.x, normal_y[i] + own.y, normal_z[i] + own.z];
                            let squared = squared(&way);
                            let column = dot(&load, &way);
                            let along = factor * column / squared.sqrt() + skew * dot(&load, &normal);
                            let across = skew * column;
                            // Multiplied last: 0 at the node itself, however soft the tissue.
                            let inverse = fade(squared, [per_reach[i], from]) / squared;
                            sum_x[i] += scalar[i] * load[0] + (along * way[0] - across * normal[0]) * inverse;
                            sum_y[i] += scalar[i] * load[1] + (along * way[1] - across * normal[1]) * inverse;
                            sum_z[i] += scalar[i] * load[2] + (along * way[2] - across * normal[2]) * inverse;
                        }
                    }
                },
            );
            (0..count).map(move |i| Vector3::new(sums[0][i], sums[1][i], sums[2][i]))
        };
        let tasks = (0..vertices.len().div_ceil(ROWS_PER_TASK)).into_par_iter();
        let mut moved: Vec<Vector3<f64>> = tasks.flat_map_iter(|task| moved(task * ROWS_PER_TASK)).collect();
        let row_of: HashMap<usize, usize> = vertices.iter().enumerate().map(|(row, &v)| (v, row)).collect();
        for (node, force) in asked.nodes.iter().zip(forces) {
            if let Some(&row) = row_of.get(node) {
                moved[row] += self.own_outer(asked.surface, *node) * force;
            }
        }
        Ok(moved)
    }

    /// ν / (2πG) (m²/N).
    pub(super) fn outer_factor(&self) -> f64 {
        self.scalar.poisson_ratio() / (TAU * self.scalar.shear_modulus())
    }

    /// (1 - 2ν) / (4πG) (m²/N).
    pub(super) fn skew_factor(&self) -> f64 {
        (1.0 - 2.0 * self.scalar.poisson_ratio()) / (2.0 * TAU * self.scalar.shear_modulus())
    }

    /// The scalar kernel's displacement of `rows` per newton at the nodes.
    fn scalar_rows(
        &self,
        asked: &Request,
        rows: &[usize],
        discretization: Discretization,
        kept: &KeptBlock,
    ) -> Result<Mat<f64>, ResponseError> {
        let options =
            &AssemblyOptions { tolerance: asked.options.tolerance.max(NEAR_TOLERANCE), ..*asked.options };
        let kernel = self.scalar.clone().with_discretization(discretization)?;
        let assemble = |rows: &[usize], columns: &[usize], options: &AssemblyOptions| {
            assemble_columns(asked.surface, &kernel, rows, columns, options)
        };
        kept.entries(rows, asked.nodes, options, assemble)
    }
}

/// Coordinates of vectors in separate lists, for vector code.
fn coordinates<'a>(vectors: impl Iterator<Item = &'a Vector3<f64>> + Clone) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|axis| vectors.clone().map(|vector| vector[axis]).collect())
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The length of a way squared, or next to nothing where it has none: what is along it is 0 then.
#[inline(always)]
fn squared(way: &[f64; 3]) -> f64 {
    dot(way, way).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat skin of regular triangles around the origin.
    fn flat(cells: i32, edge: f64) -> Surface {
        let side = 2 * cells + 1;
        let place = |row: i32, column: i32| {
            let (x, y) = (column - cells, row - cells);
            Vector3::new(f64::from(x) + 0.5 * f64::from(y), 0.75_f64.sqrt() * f64::from(y), 0.0) * edge
        };
        let vertices = (0..side * side).map(|at| place(at / side, at % side)).collect();
        let corner = |row: i32, column: i32| (row * side + column) as u32;
        let faces = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| (row, column)));
        let faces = faces.flat_map(|(row, column)| {
            let (a, b) = (corner(row, column), corner(row, column + 1));
            let (c, d) = (corner(row + 1, column), corner(row + 1, column + 1));
            [[a, b, c], [b, d, c]]
        });
        Surface::new(vertices, faces.collect()).expect("a valid surface")
    }

    /// Shear `1 - (r / a)²` in one direction moves the middle of a half-space by `∫ (1 - (r/a)²) (1 - ν + ν cos²) dr dφ / (2πG)`,
    /// which is `(2 - ν) a / (3 G)`.
    #[test]
    fn shear_moves_the_skin_as_in_closed_form() {
        let (modulus, ratio, radius) = (60e3, 0.45, 1e-3);
        let kernel = NearKernel::new(modulus, ratio, None).expect("valid constants");
        let errors = [8, 16].map(|cells| {
            let edge = radius / f64::from(cells);
            let surface = flat(2 * cells, edge);
            let share = |vertex: &usize| 1.0 - (surface.vertices()[*vertex].norm() / radius).powi(2);
            let nodes: Vec<usize> =
                (0..surface.vertices().len()).filter(|vertex| share(vertex) > 1e-9).collect();
            let middle = nodes.iter().position(|&vertex| surface.vertices()[vertex].norm() < 0.1 * edge);
            let middle = middle.expect("a vertex in the middle");
            let options = AssemblyOptions::default();
            let asked = Request { surface: &surface, nodes: &nodes, options: &options };
            let area = 0.75_f64.sqrt() * edge * edge;
            let forces: Vec<Vector3<f64>> =
                nodes.iter().map(|vertex| Vector3::x() * (area * share(vertex))).collect();
            let expected = (2.0 - ratio) * radius / (3.0 * modulus);
            let kept = KeptBlock::default();
            let moved = kernel.displacements(&asked, &forces, &nodes, &kept).expect("known nodes");
            let along = vec![Vector3::x(); nodes.len()];
            let response =
                kernel.along(&asked, &along, Discretization::Collocation, &kept).expect("known nodes");
            let of_matrix: f64 = (0..nodes.len()).map(|j| response[(middle, j)] * forces[j].x).sum();
            assert!((moved[middle].x / of_matrix - 1.0).abs() < 1e-12);
            (moved[middle].x / expected - 1.0).abs()
        });
        // Of second order: without what a node gives itself 3.2 and 1.6 %.
        assert!(errors[0] < 5e-3 && errors[1] < 0.3 * errors[0], "{errors:?}");
    }
}
