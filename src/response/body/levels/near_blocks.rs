//! The near kernel between coarse vertices, as blocks along any direction.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

use crate::response::body::equations::moments::{Triangle, exact_moments};
use crate::response::body::equations::quadrature::{
    LANES, MomentLanes, RULES, RuleReach, TriangleLanes, far_moments,
};
use crate::response::body::levels::near::{LEAST_TOLERANCE, NearKernel};
use crate::response::error::ResponseError;
use crate::response::matrix::collocation::assemble_block;
use crate::response::matrix::fill::filled_columns;
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;

/// Components of a symmetric 3 × 3 block: xx, xy, xz, yy, yz, zz.
const PACKED: usize = 6;

/// Blocks N_ij (m/N) of displacement of rows per newton at columns.
pub(crate) struct NearBlocks {
    /// `(6 m, k)`.
    packed: Mat<f64>,
}

impl NearKernel {
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

impl NearBlocks {
    pub fn block(&self, row: usize, column: usize) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.packed.col_as_slice(column).as_chunks().0[row];
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
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
