//! The response matrix over the candidate nodes.

use faer::Mat;
use nalgebra::Vector3;

use crate::response::column::border::displacement_point;
use crate::response::column::half_space::ColumnScratch;
use crate::response::column::kernel::KernelColumns;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::KernelSkin;
use crate::response::kernel::thickness::InverseThickness;
use crate::response::matrix::fill::filled_columns;
use crate::response::matrix::galerkin::galerkin_block;
use crate::response::matrix::options::{AssemblyOptions, check_directions, check_memory, rows_of_vertices};
use crate::response::simd::points::{Targets, gather};
use crate::surface::checked::Surface;

/// Response matrix over the candidate nodes.
///
/// `R_ij = Σ_T ∫_T p_j(y) u(|x_i - y|) dA` with p_j the pressure of a unit force at node j, spread as
/// [`PressureBasis`](crate::response::PressureBasis) says (eq. 7 and 8 of Xie, Kanai, Date 2011), and u the kernel of the skin.
///
/// * `surface`: the skin's mesh
/// * `skin`: material and kernel
/// * `nodes`: (k,) vertices of the mesh, no two equal
/// * `directions`: (k,) outward normals of the obstacle, or `None`; the scalar kernels do not depend on them
/// * `options`: tolerance, threads, memory
///
/// Returns R (k × k, m/N): column j is the displacement of all nodes per newton at node j.
///
/// # Errors
/// A constant out of range, a node that is out of range or repeated, directions that do not fit, too large
/// a matrix, or an interruption: see [`ResponseError`].
pub fn assemble(
    surface: &Surface,
    skin: &KernelSkin,
    nodes: &[usize],
    directions: Option<&[Vector3<f64>]>,
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    if let Some(directions) = directions {
        check_directions(directions, nodes.len())?;
    }
    assemble_block(surface, skin, nodes, nodes, options)
}

/// Displacement of `rows` per newton at each of `columns`: [`assemble`] for two sets of vertices.
///
/// Returns a block of R (rows × columns, m/N).
///
/// # Errors
/// As [`assemble`].
pub fn assemble_block(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    options.validate()?;
    rows_of_vertices(surface, rows)?;
    rows_of_vertices(surface, columns)?;
    check_memory(rows.len(), columns.len(), options)?;
    skin.check_against(surface)?;
    if skin.discretization() == Discretization::Galerkin {
        return galerkin_block(surface, skin, rows, columns, options);
    }
    let kernel = KernelColumns::new(surface, skin, options);
    let point = |&v: &usize| match &kernel.layer {
        Some((_, thickness)) => displacement_point(surface, v, thickness.at(v)),
        None => surface.vertices()[v],
    };
    let targets = Targets::new(&rows.iter().map(point).collect::<Vec<_>>());
    let mut inverse_thickness = InverseThickness::default();
    if let Some((_, thickness)) = &kernel.layer {
        let of_rows: Vec<f64> = rows.iter().map(|&v| 1.0 / thickness.at(v)).collect();
        gather(&targets.rows, &of_rows, &mut inverse_thickness.of_targets);
        inverse_thickness.largest = of_rows.into_iter().fold(0.0, f64::max);
    }
    let scratch = || ColumnScratch::new(&targets);
    filled_columns([rows.len(), columns.len()], options, scratch, |scratch: &mut ColumnScratch, j, column| {
        kernel.fill(scratch, &targets, &inverse_thickness, columns[j]);
        targets.scatter(&scratch.values, column);
    })
}
