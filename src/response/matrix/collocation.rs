//! The response matrix over the candidate nodes.

use faer::Mat;
use nalgebra::Vector3;

use crate::response::column::border::displacement_point;
use crate::response::column::gaussian::Corrected;
use crate::response::column::half_space::{Scratch, half_space_values};
use crate::response::column::layer::PreparedLayer;
use crate::response::column::load::loaded_faces;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::kernel::skin::{Kernel, KernelSkin};
use crate::response::matrix::fill::fill_columns;
use crate::response::matrix::galerkin::weighted_block;
use crate::response::matrix::options::{AssemblyOptions, check_request};
use crate::response::simd::points::Targets;
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
    check_request(surface, nodes, nodes.len(), directions, options)?;
    fill_block(surface, skin, nodes, nodes, options)
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
    check_request(surface, rows, columns.len(), None, options)?;
    check_request(surface, columns, rows.len(), None, options)?;
    fill_block(surface, skin, rows, columns, options)
}

fn fill_block(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    skin.check_against(surface)?;
    if skin.discretization() == Discretization::Galerkin {
        return weighted_block(surface, skin, rows, columns, options);
    }
    let mut matrix = Mat::zeros(rows.len(), columns.len());
    let kernel = Columns::new(surface, skin, rows, options)?;
    let scratch = || Scratch::new(&kernel.targets);
    fill_columns(&mut matrix, options, scratch, |scratch: &mut Scratch, j, column| {
        kernel.fill(scratch, columns[j]);
        kernel.targets.scatter(&scratch.values, column);
    })?;
    Ok(matrix)
}

/// What all columns of the node form over the same rows share.
pub(crate) struct Columns<'a> {
    surface: &'a Surface,
    skin: &'a KernelSkin,
    tolerance: f64,
    layer: Option<PreparedLayer>,
    /// 1/thickness of the targets of a layer (1/m).
    inverse_thickness: Vec<f64>,
    pub(crate) targets: Targets,
}

impl<'a> Columns<'a> {
    pub(crate) fn new(
        surface: &'a Surface,
        skin: &'a KernelSkin,
        rows: &[usize],
        options: &AssemblyOptions,
    ) -> Result<Self, ResponseError> {
        let point = |&v: &usize| match skin.kernel() {
            Kernel::Layer { thickness } => displacement_point(surface, v, thickness.at(v)),
            _ => surface.vertices()[v],
        };
        let points: Vec<_> = rows.iter().map(point).collect();
        let targets = Targets::new(&points);
        let mut inverse_thickness = Vec::new();
        let mut layer = None;
        if let Kernel::Layer { thickness } = skin.kernel() {
            let places = targets.rows.iter().map(|&row| 1.0 / thickness.at(rows[row as usize]));
            inverse_thickness.extend(places);
            if let Some(&last) = inverse_thickness.last() {
                inverse_thickness.resize(targets.x.len(), last);
            }
            layer = Some(PreparedLayer::new(skin, options)?);
        }
        Ok(Self { surface, skin, tolerance: options.tolerance, layer, inverse_thickness, targets })
    }

    /// Sets `scratch.values` to the displacement of the targets per newton at `vertex`.
    pub(crate) fn fill(&self, scratch: &mut Scratch, vertex: usize) {
        let (targets, tolerance) = (&self.targets, self.tolerance);
        let constant = self.skin.kernel_constant();
        scratch.faces.clear();
        loaded_faces(self.surface, vertex, self.skin.basis(), &mut scratch.faces);
        match self.skin.kernel() {
            Kernel::Layer { thickness } => {
                let layer = self.layer.as_ref().expect("prepared for a layer");
                layer.values(targets, &self.inverse_thickness, scratch, thickness.at(vertex));
            }
            Kernel::HalfSpace => {
                half_space_values(targets, scratch, constant, tolerance, f64::INFINITY);
            }
            &Kernel::GaussianCorrected { height, width, cutoff } => {
                Corrected { constant, height, cutoff, width }.values(targets, scratch, tolerance);
            }
        }
    }
}
