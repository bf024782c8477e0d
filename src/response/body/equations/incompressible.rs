//! What the discrete equations miss near incompressibility, put back exactly.
//!
//! Let `e = 1 - 2 nu`, `S` a closed surface (the skin or one bone) and `F_j = ∮_S n(x) / |x - y| dS_x` weighed with
//! the hat of node `j`. Integrating Kelvin's kernels over `S` with its normal gives, for `y` off it,
//!
//! ```text
//! ∮ n·U = e / (4 pi (1 + e)) F,        ∮ n·T = -e / (2 pi (1 + e)) (grad grad ∫_V 1/r) n(y)
//! ```
//!
//! Both vanish as `e -> 0`: pressures on a closed bone are then invisible to the equations, and the flux of the
//! displacement through the skin must be zero. Discretised, they vanish only up to the mesh error, so near
//! `nu = 0.5` that error would decide the level of the bone's pressure. Hence, for each bone: the columns of a
//! uniform pressure are set to the right-hand side above; the sum of the bone's equations along `n` is replaced
//! by the same identity divided by `e`, which has a limit (the balance of the pressure, harmonic in the
//! tissue). For the skin: the sum along `n` is replaced by its identity, so that at `nu = 0.5` the mesh keeps
//! its volume to rounding. Each is a rank-one change; `F` and its gradient are traces of the blocks.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::factor::Real;
use crate::response::body::equations::assemble::{DiscreteBody, Equations};

/// A closed surface among the nodes.
#[derive(Debug, Clone)]
pub(crate) struct ClosedSurface {
    /// Nodes on it.
    pub nodes: Vec<u32>,
    /// Their area vectors: a third of the outward area vectors of the faces around each.
    pub area_vectors: Vec<Vector3<f64>>,
    pub is_bone: bool,
}

/// Block columns that a thread takes at once.
const BLOCKS_PER_CHUNK: usize = 64;

/// Puts the identities of every closed surface into the equations.
pub(crate) fn impose_flux_identities<T: Real>(
    equations: &mut Equations<T>,
    body: &DiscreteBody,
    surfaces: &[ClosedSurface],
) {
    let height = 3 * body.points.len();
    let load_height = 3 * body.load_count;
    let e = body.kelvin.compressibility();

    // The identities, from the blocks as integrated.
    let identities: Vec<(Vec<f64>, Vec<f64>)> = surfaces
        .iter()
        .map(|surface| {
            let share = if surface.is_bone { 1.0 } else { e };
            let (on_traction, on_displacement) = (share / (2.0 + 3.0 * e), share * 2.0 / (3.0 * (1.0 + e)));
            let mut row = trace_sums(&equations.matrix, height, surface);
            for (node, is_moving) in body.is_moving.iter().enumerate() {
                let factor = if *is_moving { on_displacement } else { on_traction };
                row[3 * node..3 * node + 3].iter_mut().for_each(|value| *value *= factor);
            }
            if !surface.is_bone {
                for (&node, area) in surface.nodes.iter().zip(&surface.area_vectors) {
                    let node = node as usize;
                    if body.is_moving[node] {
                        for axis in 0..3 {
                            row[3 * node + axis] += (1.0 - e) / (1.0 + e) * area[axis];
                        }
                    }
                }
            }
            if surface.is_bone {
                set_pressure_product(&mut row, surface, body, e);
            }
            let mut loads = trace_sums(&equations.loads, load_height, surface);
            loads.iter_mut().for_each(|value| *value *= on_traction);
            (row, loads)
        })
        .collect();

    for bone in surfaces.iter().filter(|surface| surface.is_bone) {
        set_uniform_pressure_columns(&mut equations.matrix, height, bone, e);
    }
    for (surface, (row, loads)) in surfaces.iter().zip(&identities) {
        replace_normal_sum(&mut equations.matrix, height, surface, row);
        replace_normal_sum(&mut equations.loads, load_height, surface, loads);
    }
}

/// `sum_i w_i tr(block_ij)` over the surface's nodes `i`, for every block row `j` of a transposed matrix.
fn trace_sums<T: Real>(transposed: &[T], height: usize, surface: &ClosedSurface) -> Vec<f64> {
    let mut sums = vec![0.0; height];
    sums.par_chunks_mut(3 * BLOCKS_PER_CHUNK).enumerate().for_each(|(chunk, sums)| {
        for (&node, area) in surface.nodes.iter().zip(&surface.area_vectors) {
            let start = 3 * node as usize * height + 3 * BLOCKS_PER_CHUNK * chunk;
            for (block, sum) in sums.chunks_exact_mut(3).enumerate() {
                let at = start + 3 * block;
                let trace: f64 =
                    [at, at + height + 1, at + 2 * height + 2].map(|at| transposed[at].into()).iter().sum();
                for axis in 0..3 {
                    sum[axis] += area[axis] * trace;
                }
            }
        }
    });
    sums
}

/// Under a uniform pressure `n` the bone's own balance is `-V / (1 + e)`, with `V` its volume, exactly.
fn set_pressure_product(row: &mut [f64], bone: &ClosedSurface, body: &DiscreteBody, e: f64) {
    let volume: f64 =
        bone.area_vectors.iter().zip(&bone.nodes).map(|(s, &i)| s.dot(&body.points[i as usize]) / 3.0).sum();
    let pressure: Vec<Vector3<f64>> = bone.area_vectors.iter().map(|area| area.normalize()).collect();
    let found: f64 = bone
        .nodes
        .iter()
        .zip(&pressure)
        .map(|(&i, p)| (0..3).map(|axis| row[3 * i as usize + axis] * p[axis]).sum::<f64>())
        .sum();
    let share = (-volume / (1.0 + e) - found) / pressure.len() as f64;
    for (&i, p) in bone.nodes.iter().zip(&pressure) {
        (0..3).for_each(|axis| row[3 * i as usize + axis] += share * p[axis]);
    }
}

/// A uniform pressure on the bone displaces every point by `e / (2 + 3 e)` times its traces, exactly.
fn set_uniform_pressure_columns<T: Real>(matrix: &mut [T], height: usize, bone: &ClosedSurface, e: f64) {
    let pressure: Vec<Vector3<f64>> = bone.area_vectors.iter().map(|area| area.normalize()).collect();
    let norm_squared: f64 = pressure.iter().map(Vector3::norm_squared).sum();
    let factor = e / (2.0 + 3.0 * e);
    matrix.par_chunks_mut(3 * height).for_each(|rows| {
        let mut excess = [0.0; 3];
        for (&node, pressure) in bone.nodes.iter().zip(&pressure) {
            let at = 3 * node as usize;
            let block = |a: usize| [0, 1, 2].map(|b| rows[a * height + at + b].into());
            let trace: f64 = block(0)[0] + block(1)[1] + block(2)[2];
            for a in 0..3 {
                let block: [f64; 3] = block(a);
                let moved = block[0] * pressure[0] + block[1] * pressure[1] + block[2] * pressure[2];
                excess[a] += moved - factor * trace * pressure[a];
            }
        }
        for (&node, pressure) in bone.nodes.iter().zip(&pressure) {
            for a in 0..3 {
                for b in 0..3 {
                    let entry = &mut rows[a * height + 3 * node as usize + b];
                    *entry = T::nearest((*entry).into() - excess[a] * pressure[b] / norm_squared);
                }
            }
        }
    });
}

/// Replaces the weighted sum of the surface's equations along its normal by `identity`.
fn replace_normal_sum<T: Real>(
    transposed: &mut [T],
    height: usize,
    surface: &ClosedSurface,
    identity: &[f64],
) {
    let norm_squared: f64 = surface.area_vectors.iter().map(Vector3::norm_squared).sum();
    let mut change = vec![0.0; height];
    let read = &*transposed;
    change.par_chunks_mut(3 * BLOCKS_PER_CHUNK).enumerate().for_each(|(chunk, change)| {
        let from = 3 * BLOCKS_PER_CHUNK * chunk;
        change.copy_from_slice(&identity[from..from + change.len()]);
        for (&node, area) in surface.nodes.iter().zip(&surface.area_vectors) {
            for axis in 0..3 {
                let start = (3 * node as usize + axis) * height + from;
                for (change, &value) in change.iter_mut().zip(&read[start..]) {
                    *change -= area[axis] * value.into();
                }
            }
        }
    });
    let mut weights = vec![Vector3::zeros(); transposed.len() / (3 * height)];
    for (&node, area) in surface.nodes.iter().zip(&surface.area_vectors) {
        weights[node as usize] = area / norm_squared;
    }
    transposed
        .par_chunks_mut(3 * height)
        .zip(&weights)
        .filter(|(_, weight)| weight.norm_squared() > 0.0)
        .for_each(|(rows, weight)| {
            for axis in 0..3 {
                for (value, change) in rows[axis * height..(axis + 1) * height].iter_mut().zip(&change) {
                    *value = T::nearest((*value).into() + weight[axis] * change);
                }
            }
        });
}
