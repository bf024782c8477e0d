//! The response matrix over the candidate nodes.

use faer::Mat;

use crate::response::column::border::displacement_point;
use crate::response::column::half_space::ColumnScratch;
use crate::response::column::kernel::KernelColumns;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::KernelSkin;
use crate::response::matrix::fill::{fill_items, filled_columns};
use crate::response::matrix::galerkin::block::galerkin_block;
use crate::response::matrix::options::{AssemblyOptions, check_memory};
use crate::response::rows::rows_of_vertices;
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
/// * `options`: tolerance, threads, memory
///
/// Returns R (k × k, m/N): column j is the displacement of all nodes per newton at node j.
///
/// # Errors
/// A constant out of range, a node that is out of range or repeated, too large a matrix, or an interruption: see
/// [`ResponseError`].
pub fn assemble(
    surface: &Surface,
    skin: &KernelSkin,
    nodes: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
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
    check(surface, skin, rows, columns, options)?;
    if skin.discretization() == Discretization::Galerkin {
        return galerkin_block(surface, skin, rows, columns, options);
    }
    let at_rows = AtRows::new(surface, skin, rows, options);
    filled_columns([rows.len(), columns.len()], options, ColumnScratch::default, |scratch, j, column| {
        at_rows.fill(scratch, columns[j], column);
    })
}

/// The columns of [`assemble_block`], each by itself.
pub(crate) fn assemble_columns(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Vec<Vec<f64>>, ResponseError> {
    if skin.discretization() == Discretization::Galerkin {
        let block = assemble_block(surface, skin, rows, columns, options)?;
        return Ok((0..columns.len()).map(|column| block.col_as_slice(column).to_vec()).collect());
    }
    check(surface, skin, rows, columns, options)?;
    let at_rows = AtRows::new(surface, skin, rows, options);
    let mut filled = vec![Vec::new(); columns.len()];
    fill_items(&mut filled, options, ColumnScratch::default, |scratch, j, column| {
        column.resize(rows.len(), 0.0);
        at_rows.fill(scratch, columns[j], column);
    })?;
    Ok(filled)
}

fn check(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<(), ResponseError> {
    options.validate()?;
    rows_of_vertices(surface.vertices().len(), rows)?;
    rows_of_vertices(surface.vertices().len(), columns)?;
    check_memory(rows.len(), columns.len(), options)?;
    skin.check_against(surface)
}

/// A kernel and the rows that its columns are asked at.
struct AtRows<'a> {
    kernel: KernelColumns<'a>,
    targets: Targets,
}

impl<'a> AtRows<'a> {
    fn new(surface: &'a Surface, skin: &'a KernelSkin, rows: &[usize], options: &AssemblyOptions) -> Self {
        let kernel = KernelColumns::new(surface, skin, options.tolerance);
        let point = |&v: &usize| match &kernel.layer {
            Some((_, thickness)) => displacement_point(surface, v, thickness.at(v)),
            None => surface.vertices()[v],
        };
        let mut targets = Targets::new(&rows.iter().map(point).collect::<Vec<_>>());
        if let Some((_, thickness)) = &kernel.layer {
            let of_rows: Vec<f64> = rows.iter().map(|&v| 1.0 / thickness.at(v)).collect();
            gather(&targets.rows, &of_rows, &mut targets.inverse_thickness);
            targets.largest_inverse = of_rows.into_iter().fold(0.0, f64::max);
        }
        Self { kernel, targets }
    }

    /// Sets a column to the displacement (m) of all rows per newton at a vertex.
    fn fill(&self, scratch: &mut ColumnScratch, vertex: usize, column: &mut [f64]) {
        self.kernel.fill(scratch, &self.targets, vertex);
        self.targets.in_rows(&scratch.values, column);
    }
}
