//! The Galerkin discretization: gap and pressure both against the nodes' pressures.

use std::ops::Range;

use faer::Mat;
use nalgebra::Vector3;

use crate::response::column::half_space::ColumnScratch;
use crate::response::column::kernel::KernelColumns;
use crate::response::error::ResponseError;
use crate::response::integral::gauss::{MAX_GRADED_POINTS, RulePoint, graded_triangle_rule, triangle_rule};
use crate::response::kernel::basis::PressureBasis;
use crate::response::kernel::skin::KernelSkin;
use crate::response::kernel::thickness::{InverseThickness, Thickness};
use crate::response::matrix::fill::fill_columns;
use crate::response::matrix::options::{AssemblyOptions, NO_ROW, rows_of_vertices};
use crate::response::simd::points::Targets;
use crate::surface::checked::Surface;

/// Most points in each direction of the outer rule on triangles that do not touch the load.
const MOST_OUTER_POINTS: usize = 10;

/// The outer rule on a triangle, by its points in each direction.
#[derive(Debug, Clone, Copy)]
enum OuterRule {
    /// On triangles that touch the load, where the inner potential behaves like d log d at the distance d from edges.
    Touching(usize),
    /// On all others.
    Apart(usize),
}

impl OuterRule {
    fn points(self) -> &'static [RulePoint] {
        match self {
            Self::Touching(n) => graded_triangle_rule(n),
            Self::Apart(n) => triangle_rule(n),
        }
    }

    /// The graded rule that keeps the tolerance: its error falls with n⁻⁸.
    fn touching(tolerance: f64) -> Self {
        let n = (6.0 * (1e-3 / tolerance).powf(0.125)).ceil();
        Self::Touching(n.clamp(5.0, MAX_GRADED_POINTS as f64) as usize)
    }
}

/// A triangle around some row nodes.
struct RowFace {
    corners: [Vector3<f64>; 3],
    /// Vertices of the surface.
    vertices: [u32; 3],
    /// Row of each corner; `NO_ROW` where it is no row node.
    rows: [usize; 3],
    center: Vector3<f64>,
    radius: f64,
    area: f64,
}

/// What one thread needs for the outer rule.
struct Outer {
    scratch: ColumnScratch,
    targets: Targets,
    /// 1/thickness of the targets of a layer (1/m).
    inverse_thickness: InverseThickness,
    /// Faces used in this column with their rule and the corners that they are used for.
    used: Vec<(u32, OuterRule, Range<usize>)>,
}

/// What all columns of a Galerkin block share.
struct GalerkinColumns<'a> {
    surface: &'a Surface,
    kernel: KernelColumns<'a>,
    pressure: PressureBasis,
    tolerance: f64,
    faces: Vec<RowFace>,
    /// One over the vertex area of each row (1/m²).
    density: Vec<f64>,
}

/// `R_ij = ∫∫ p_i(x) k(|x - y|) p_j(y) dA dA` over row nodes i and column nodes j, for the half-space and the layer.
///
/// The inner integral is that of collocation; the outer one a Gauss rule whose order falls with distance. On
/// triangles that touch the load it is good to some 5e-7 of the 1/r part, 5e-6 on badly shaped ones, also for smaller
/// tolerances.
/// For equal rows and columns each pair is computed once and mirrored, so the matrix is symmetric to the bit.
pub(crate) fn galerkin_block(
    surface: &Surface,
    skin: &KernelSkin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    let symmetric = rows == columns;
    let shared = GalerkinColumns {
        surface,
        kernel: KernelColumns::new(surface, skin, options),
        pressure: skin.basis(),
        tolerance: options.tolerance,
        faces: row_faces(surface, &rows_of_vertices(surface, rows)?),
        density: rows.iter().map(|&v| 1.0 / surface.vertex_areas()[v]).collect(),
    };
    let mut matrix = Mat::zeros(rows.len(), columns.len());
    let outer = || Outer {
        scratch: ColumnScratch::new(&Targets::default()),
        targets: Targets::default(),
        inverse_thickness: InverseThickness::default(),
        used: Vec::with_capacity(shared.faces.len()),
    };
    fill_columns(&mut matrix, options, outer, |outer: &mut Outer, j, column| {
        let first = if symmetric { j } else { 0 };
        shared.place_points(outer, columns[j], first);
        let Outer { scratch, targets, inverse_thickness, .. } = outer;
        shared.kernel.fill(scratch, targets, inverse_thickness, columns[j]);
        shared.add_up(outer, first, column);
    })?;
    if symmetric {
        for j in 0..columns.len() {
            for i in 0..j {
                matrix[(i, j)] = matrix[(j, i)];
            }
        }
    }
    Ok(matrix)
}

impl GalerkinColumns<'_> {
    /// Sets the targets to the points of the outer rule on the faces of the rows from `first` on that feel `vertex`.
    fn place_points(&self, outer: &mut Outer, vertex: usize, first: usize) {
        let Outer { targets, inverse_thickness, used, .. } = outer;
        let (points, ring) = (self.surface.vertices(), self.surface.neighbours(vertex));
        let touches = |v: &u32| *v as usize == vertex || ring.contains(v);
        let center = points[vertex];
        let radius = ring.iter().map(|&v| (points[v as usize] - center).norm()).fold(0.0, f64::max);
        let layer = self.kernel.layer.as_ref();
        let own_thickness = layer.map_or(f64::INFINITY, |(_, thickness)| thickness.at(vertex));
        let silent = layer.map_or(f64::INFINITY, |(layer, _)| layer.reach * own_thickness);
        // Where the thickness varies, each pair of nodes has its own.
        let together = if matches!(layer, Some((_, Thickness::PerVertex(_)))) { 1 } else { 3 };
        targets.clear();
        inverse_thickness.of_targets.clear();
        used.clear();
        for (index, face) in self.faces.iter().enumerate() {
            let distance = (face.center - center).norm() - radius;
            if !face.rows.iter().any(|&r| r != NO_ROW && r >= first) || distance > silent + face.radius {
                continue;
            }
            let rule = if face.vertices.iter().any(touches) {
                OuterRule::touching(self.tolerance)
            } else {
                // a layer's smooth part is as good as singular at two thicknesses
                OuterRule::Apart(outer_points(face, distance.min(2.0 * own_thickness), self.tolerance))
            };
            for range in (0..3).step_by(together).map(|k| k..k + together) {
                for (l, _) in rule.points() {
                    targets.push(&(face.corners[0] * l[0] + face.corners[1] * l[1] + face.corners[2] * l[2]));
                    if let Some((_, thickness)) = layer {
                        inverse_thickness
                            .of_targets
                            .push(1.0 / thickness.at(face.vertices[range.start] as usize));
                    }
                }
                used.push((index as u32, rule, range));
            }
        }
        targets.pad();
        if layer.is_some() {
            let list = &mut inverse_thickness.of_targets;
            list.resize(targets.x.len(), 1.0 / own_thickness);
            inverse_thickness.largest = list.iter().copied().fold(0.0, f64::max);
        }
    }

    /// Sets the rows from `first` on of a column to the averages of the displacements at the points.
    fn add_up(&self, outer: &Outer, first: usize, column: &mut [f64]) {
        column.fill(0.0);
        let mut values = outer.scratch.values.iter();
        for (index, rule, corners) in &outer.used {
            let face = &self.faces[*index as usize];
            let mut hats = [0.0; 3];
            let mut even = 0.0;
            for ((l, weight), value) in rule.points().iter().zip(&mut values) {
                let share = weight * face.area * value;
                even += share;
                for k in 0..3 {
                    hats[k] += share * l[k];
                }
            }
            for k in corners.clone() {
                let row = face.rows[k];
                if row != NO_ROW && row >= first {
                    let share = if self.pressure == PressureBasis::Linear { hats[k] } else { even / 3.0 };
                    column[row] += self.density[row] * share;
                }
            }
        }
    }
}

/// Points in each direction that keep the outer error within the tolerance on a triangle at `distance` (m) from
/// the load: the best polynomial of degree 2n - 1 errs by some `(radius / 2 distance)^2n`.
fn outer_points(face: &RowFace, distance: f64, tolerance: f64) -> usize {
    let ratio = 0.5 * face.radius / distance.max(face.radius);
    let n = (0.25 * tolerance.max(1e-12)).ln() / (2.0 * ratio.ln());
    (n.ceil() as usize).clamp(2, MOST_OUTER_POINTS)
}

fn row_faces(surface: &Surface, row_of: &[usize]) -> Vec<RowFace> {
    let face = |(&vertices, &area): (&[u32; 3], &f64)| {
        let rows = vertices.map(|v| row_of[v as usize]);
        if rows == [NO_ROW; 3] {
            return None;
        }
        let corners = vertices.map(|v| surface.vertices()[v as usize]);
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = corners.iter().map(|c| (c - center).norm()).fold(0.0, f64::max);
        Some(RowFace { corners, vertices, rows, center, radius, area })
    };
    surface.faces().iter().zip(surface.face_areas()).filter_map(face).collect()
}
