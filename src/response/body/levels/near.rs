//! The near kernel in vectors: a half-space that answers along any direction, less what the layer is stiffer.
//!
//! Per newton at distance r, with `r^` the unit vector along r, K = (1-ν)/(2πG) and φ the layer's smooth part,
//!
//! ```text
//! N = 1/(2πG r) [(1-ν) I + ν r^ r^']  -  K φ(r/h)/h I
//! ```
//!
//! The first term is the symmetric part of the displacement of a half-space's surface (Boussinesq, Cerruti; Johnson
//! 1985, §3.2, 3.6); at ν = 1/2 it is twice Kelvin's solution. h is the thickness of the tissue at hand.

use std::f64::consts::TAU;
use std::sync::Arc;

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::linalg::threads::columns_per_task;
use crate::linalg::vectorized::vectorized;
use crate::response::body::equations::moments::{Triangle, exact_moments};
use crate::response::body::equations::quadrature::{
    LANES, MomentLanes, RULES, RuleReach, TriangleLanes, far_moments,
};
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::kernel::thickness::Thickness;
use crate::response::matrix::collocation::{assemble_block, assemble_columns};
use crate::response::matrix::fill::filled_columns;
use crate::response::matrix::kept_block::KeptBlock;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::Request;
use crate::surface::checked::Surface;
use crate::surface::refined::RefinedSurface;

/// Least relative error of the integrals: far below what the remainder's coarse mesh costs.
pub(crate) const LEAST_TOLERANCE: f64 = 1e-4;
/// Rows that one task sums.
const ROWS_PER_TASK: usize = 128;
/// Components of a symmetric 3 × 3 block: xx, xy, xz, yy, yz, zz.
const PACKED: usize = 6;

/// The near kernel of one body.
#[derive(Debug, Clone)]
pub(crate) struct NearKernel {
    half_space: KernelSkin,
    /// The layer over the bone; `None` without bone.
    layer: Option<KernelSkin>,
}

/// Blocks N_ij (m/N) of displacement of rows per newton at columns.
pub(crate) struct NearBlocks {
    /// `(6 m, k)`.
    packed: Mat<f64>,
}

impl NearKernel {
    /// * `thickness`: of the tissue at every vertex of the surface (n, m), if there is a bone
    pub fn new(
        shear_modulus: f64,
        poisson_ratio: f64,
        thickness: Option<Arc<[f64]>>,
    ) -> Result<Self, ResponseError> {
        let kernel = |kernel| KernelSkin::new(shear_modulus, poisson_ratio, kernel);
        let layer = thickness.map(|list| kernel(Kernel::Layer { thickness: Thickness::PerVertex(list) }));
        Ok(Self { half_space: kernel(Kernel::HalfSpace)?, layer: layer.transpose()? })
    }

    /// The same on a refinement of the surface, or of one that it is a part of: the thickness is linear along edges.
    ///
    /// * `own`: vertex of this surface for a given vertex
    pub fn on_refined(
        &self,
        mesh: &RefinedSurface,
        own: impl Fn(usize) -> Option<usize>,
    ) -> Result<Self, ResponseError> {
        let (modulus, ratio) = (self.half_space.shear_modulus(), self.half_space.poisson_ratio());
        let Some(Kernel::Layer { thickness }) = self.layer.as_ref().map(KernelSkin::kernel) else {
            return Self::new(modulus, ratio, None);
        };
        // Outside the part nothing is loaded, so that any thickness will do there.
        let given = |vertex| own(vertex).map_or(thickness.largest(), |own| thickness.at(own));
        Self::new(modulus, ratio, Some(mesh.inherit(given, |a, b| 0.5 * (a + b)).into()))
    }

    /// Blocks of the displacement of `rows` per newton at `columns`, vertices of `surface`.
    pub fn blocks(
        &self,
        surface: &Surface,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
    ) -> Result<NearBlocks, ResponseError> {
        let options = &AssemblyOptions { tolerance: options.tolerance.max(LEAST_TOLERANCE), ..*options };
        let points: Vec<Vector3<f64>> = rows.iter().map(|&vertex| surface.vertices()[vertex]).collect();
        let per_modulus = 1.0 / (TAU * self.half_space.shear_modulus());
        let ratio = self.half_space.poisson_ratio();
        let factors = [(1.0 - ratio) * per_modulus, ratio * per_modulus];
        let reach = RuleReach::new(options.tolerance);
        let size = [PACKED * rows.len(), columns.len()];
        let mut packed = filled_columns(size, options, Scratch::default, |scratch, j, column| {
            let column = column.as_chunks_mut::<PACKED>().0;
            let vertex = columns[j];
            for &face in surface.faces_around(vertex) {
                let corners = surface.faces()[face as usize];
                let load = Load {
                    triangle: Triangle::new(corners.map(|v| surface.vertices()[v as usize])),
                    corner: corners
                        .iter()
                        .position(|&v| v as usize == vertex)
                        .expect("a face around its vertex"),
                    factors: factors.map(|factor| factor / surface.vertex_areas()[vertex]),
                };
                load.add(&points, &reach, scratch, column);
            }
        })?;
        if let Some(layer) = &self.layer {
            let bonded = assemble_block(surface, layer, rows, columns, options)?;
            let free = assemble_block(surface, &self.half_space, rows, columns, options)?;
            for j in 0..columns.len() {
                let difference = bonded.col(j) - free.col(j);
                let blocks = packed.col_as_slice_mut(j).as_chunks_mut::<PACKED>().0;
                for (block, difference) in blocks.iter_mut().zip(difference.iter()) {
                    [0, 3, 5].into_iter().for_each(|diagonal| block[diagonal] += difference);
                }
            }
        }
        Ok(NearBlocks { packed })
    }
}

impl NearKernel {
    /// R of the kernel over the nodes along `directions` (k × k, m/N).
    ///
    /// Along the normals of one surface `n_i·r^` and `n_j·r^` vanish with r, so that the second term has no singularity and is
    /// taken at the nodes in either discretization; the first is a scalar kernel's.
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
        let factor = self.outer_factor();
        let at_once = columns_per_task(asked.nodes.len());
        response.par_col_chunks_mut(1).enumerate().with_min_len(at_once).for_each(|(j, column)| {
            let entries = column.col_mut(0).try_as_col_major_mut().expect("a column is contiguous");
            let entries = entries.as_slice_mut();
            let count = entries.len();
            let [x, y, z] = [&x[..count], &y[..count], &z[..count]];
            let [along_x, along_y, along_z] = [&along_x[..count], &along_y[..count], &along_z[..count]];
            let (to, load) = ([x[j], y[j], z[j]], [along_x[j], along_y[j], along_z[j]]);
            vectorized(
                #[inline(always)]
                || {
                    for (i, entry) in entries.iter_mut().enumerate() {
                        let way = [x[i] - to[0], y[i] - to[1], z[i] - to[2]];
                        let along = [along_x[i], along_y[i], along_z[i]];
                        let leans = dot(&along, &way) * dot(&load, &way);
                        *entry = *entry * dot(&along, &load) + factor * leans / cubed(&way);
                    }
                },
            );
        });
        Ok(response)
    }

    /// Displacement (m) of `vertices` under `forces` (N) at the nodes, the second term at the nodes too.
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
        let points = asked.surface.vertices();
        let [x, y, z] = coordinates(vertices.iter().map(|&vertex| &points[vertex]));
        let factor = self.outer_factor();
        let moved = |first: usize| {
            let rows = first..vertices.len().min(first + ROWS_PER_TASK);
            let count = rows.len();
            let [x, y, z] = [&x[rows.clone()], &y[rows.clone()], &z[rows.clone()]];
            let mut sums = [[0.0; ROWS_PER_TASK]; 3];
            vectorized(
                #[inline(always)]
                || {
                    let [sum_x, sum_y, sum_z] = &mut sums;
                    let [sum_x, sum_y, sum_z] =
                        [&mut sum_x[..count], &mut sum_y[..count], &mut sum_z[..count]];
                    for (j, (&node, force)) in asked.nodes.iter().zip(forces).enumerate() {
                        let (to, load) = (&points[node], [force.x, force.y, force.z]);
                        let scalar = &scalar.col_as_slice(j)[first..][..count];
                        for i in 0..count {
                            let way = [x[i] - to.x, y[i] - to.y, z[i] - to.z];
                            let leans = factor * dot(&load, &way) / cubed(&way);
                            sum_x[i] += scalar[i] * load[0] + leans * way[0];
                            sum_y[i] += scalar[i] * load[1] + leans * way[1];
                            sum_z[i] += scalar[i] * load[2] + leans * way[2];
                        }
                    }
                },
            );
            (0..count).map(move |i| Vector3::new(sums[0][i], sums[1][i], sums[2][i]))
        };
        let tasks = (0..vertices.len().div_ceil(ROWS_PER_TASK)).into_par_iter();
        Ok(tasks.flat_map_iter(|task| moved(task * ROWS_PER_TASK)).collect())
    }

    /// ν / (2πG) (m²/N).
    fn outer_factor(&self) -> f64 {
        self.half_space.poisson_ratio() / (TAU * self.half_space.shear_modulus())
    }

    /// The layer, or the half-space without bone, of `rows` per newton at the nodes.
    fn scalar_rows(
        &self,
        asked: &Request,
        rows: &[usize],
        discretization: Discretization,
        kept: &KeptBlock,
    ) -> Result<Mat<f64>, ResponseError> {
        let options =
            &AssemblyOptions { tolerance: asked.options.tolerance.max(LEAST_TOLERANCE), ..*asked.options };
        let kernel = self.layer.as_ref().unwrap_or(&self.half_space);
        let kernel = kernel.clone().with_discretization(discretization)?;
        let assemble = |rows: &[usize], columns: &[usize], options: &AssemblyOptions| {
            assemble_columns(asked.surface, &kernel, rows, columns, options)
        };
        kept.entries(rows, asked.nodes, options, assemble)
    }
}

impl NearBlocks {
    pub fn block(&self, row: usize, column: usize) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.packed.col_as_slice(column).as_chunks().0[row];
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
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

/// The length of a way cubed, or next to nothing where it has none: what leans along it is 0 then.
#[inline(always)]
fn cubed(way: &[f64; 3]) -> f64 {
    let squared = dot(way, way);
    (squared * squared.sqrt()).max(f64::MIN_POSITIVE)
}

#[derive(Default)]
struct Scratch {
    lanes: TriangleLanes,
    moments: MomentLanes,
}

/// The hat of one corner of a triangle.
struct Load {
    triangle: Triangle,
    corner: usize,
    /// Of `I / r` and `r^ r^' / r`, per area of the vertex.
    factors: [f64; 2],
}

impl Load {
    /// Adds the displacement of all points, those that share a rule together.
    #[inline(always)]
    fn add(
        &self,
        points: &[Vector3<f64>],
        reach: &RuleReach,
        scratch: &mut Scratch,
        blocks: &mut [[f64; PACKED]],
    ) {
        let mut waiting = [[0usize; LANES]; RULES.len()];
        let mut counts = [0usize; RULES.len()];
        let radius_squared = self.triangle.radius * self.triangle.radius;
        for (row, point) in points.iter().enumerate() {
            let distance_squared = (self.triangle.centroid - point).norm_squared() / radius_squared;
            let Some(rule) = reach.rule(distance_squared) else {
                let moments = exact_moments(&self.triangle, point)[self.corner];
                self.add_block(&mut blocks[row], |c| moments.b[c]);
                continue;
            };
            waiting[rule][counts[rule]] = row;
            counts[rule] += 1;
            if counts[rule] == LANES {
                counts[rule] = 0;
                self.add_together(points, &waiting[rule], rule, scratch, blocks);
            }
        }
        for rule in 0..RULES.len() {
            if counts[rule] > 0 {
                self.add_together(points, &waiting[rule][..counts[rule]], rule, scratch, blocks);
            }
        }
    }

    #[inline(always)]
    fn add_together(
        &self,
        points: &[Vector3<f64>],
        rows: &[usize],
        rule: usize,
        scratch: &mut Scratch,
        blocks: &mut [[f64; PACKED]],
    ) {
        for lane in 0..LANES {
            scratch.lanes.set(lane, &self.triangle, &points[rows[lane.min(rows.len() - 1)]]);
        }
        far_moments::<false>(&scratch.lanes, RULES[rule], &mut scratch.moments);
        let moments = &scratch.moments[self.corner];
        for (lane, &row) in rows.iter().enumerate() {
            self.add_block(&mut blocks[row], |c| moments[c][lane]);
        }
    }

    #[inline(always)]
    fn add_block(&self, block: &mut [f64; PACKED], moment: impl Fn(usize) -> f64) {
        let [isotropic, outer] = self.factors;
        let trace = isotropic * (moment(0) + moment(3) + moment(5));
        for (c, entry) in block.iter_mut().enumerate() {
            *entry += outer * moment(c) + if matches!(c, 0 | 3 | 5) { trace } else { 0.0 };
        }
    }
}
