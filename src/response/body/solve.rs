//! From skin, bone and fixed vertices to the compliance at chosen nodes.

use std::sync::atomic::{AtomicUsize, Ordering};

use faer::prelude::{Reborrow, ReborrowMut};
use faer::{ColMut, Mat, MatRef, Par};
use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::dense::Dense;
use crate::linalg::factor::{NoFactor, Real};
use crate::linalg::lu::{Blocking, Lu};
use crate::linalg::memory::free_memory;
use crate::response::body::check::tissue::{check_fixed, check_nodes, check_tissue, check_uncrossed};
use crate::response::body::compliance::{BodyCompliance, BodyParts};
use crate::response::body::cost::{BodyCost, solve_width};
use crate::response::body::equations::assemble::assemble_equations;
use crate::response::body::equations::incompressible::impose_flux_identities;
use crate::response::body::error::BodyError;
use crate::response::body::options::BodyOptions;
use crate::response::body::watch::Watch;
use crate::response::kernel::skin::SHEAR_MODULI;
use crate::surface::checked::Surface;
use crate::surface::cut_out::CutOut;

/// Columns of a panel of the factor; wide enough for full-speed products.
const FACTOR_PANEL: usize = 384;
/// Columns right of a panel that one thread updates.
const FACTOR_STRIP: usize = 256;

/// The body under a skin: what holds it.
#[derive(Debug, Clone, Default)]
pub struct Body {
    /// Rigid, immobile bones: closed surfaces inside the skin, one connected component each.
    pub bone: Option<Surface>,
    /// Skin vertices that do not move, such as those of the cut face of a finger; one entry per vertex. Only whole faces are
    /// held: a vertex of none that is fixed at all three corners stays free.
    pub fixed: Option<Vec<bool>>,
    /// Wanted length of the edges of the coarse skin that [`PreparedBody`](crate::response::PreparedBody) solves on (m):
    /// `None` lets the thickness of the tissue decide, 0 is the skin itself.
    pub coarse_edge_length: Option<f64>,
}

impl Body {
    /// The body of a part that is held at its cut, with `bone` inside if there is one.
    pub fn of_part(part: &CutOut, bone: Option<Surface>) -> Body {
        Body { bone, fixed: Some(part.fixed.clone()), ..Body::default() }
    }

    /// Checks the body without solving anything; which vertices of the skin it holds: those of faces that are fixed at all
    /// three corners.
    ///
    /// # Errors
    /// Whatever is wrong with skin, bones or fixed vertices, as in [`Body::prepare`].
    pub fn held_vertices(&self, skin: &Surface) -> Result<Vec<bool>, BodyError> {
        if self.bone.is_none() && self.fixed.is_none() {
            return Err(BodyError::Unsupported);
        }
        check_tissue(skin, self.bone.as_ref())?;
        match &self.fixed {
            Some(mask) => check_fixed(skin, mask),
            None => Ok(vec![false; skin.vertices().len()]),
        }
    }

    /// What preparing `node_count` nodes on the skin's own mesh costs.
    pub fn estimate(&self, skin: &Surface, node_count: usize) -> BodyCost {
        self.estimate_in::<f64>(skin, node_count)
    }

    fn estimate_in<T>(&self, skin: &Surface, node_count: usize) -> BodyCost {
        BodyCost::estimate_in::<T>(skin.vertices().len(), self.bone_count(), node_count)
    }

    pub(crate) fn bone_count(&self) -> usize {
        self.bone.as_ref().map_or(0, |bone| bone.vertices().len())
    }

    /// Displacement of the whole skin per unit force at each of `nodes`, by boundary elements on the skin's own mesh.
    ///
    /// * `skin`: the closed skin of one body
    /// * `shear_modulus`: G (Pa), 1e-60 ..= 1e60
    /// * `poisson_ratio`: ν, 0 to 0.5, both included
    /// * `nodes`: skin vertices that may be loaded, each once, none fixed
    ///
    /// A force at node `j` acts as a traction `f / S_j` times the hat function of `j`.
    ///
    /// # Errors
    /// - constants or tolerance out of range; nodes empty, repeated, out of range or fixed
    /// - [`BodyError::Unsupported`], `Fixed…`: nothing or too little holds the body, or everything is held
    /// - `Skin…`, `Bone…`: the surfaces bound no tissue
    /// - [`BodyError::MemoryLimit`], [`BodyError::Interrupted`], [`BodyError::Singular`]
    pub fn prepare(
        &self,
        skin: &Surface,
        shear_modulus: f64,
        poisson_ratio: f64,
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<BodyCompliance, BodyError> {
        let parts = self.prepare_in::<f64>(skin, [shear_modulus, poisson_ratio], nodes, nodes, options)?;
        Ok(BodyCompliance::new(parts))
    }

    /// The same, with the equations solved to a precision.
    ///
    /// * `columns`: vertices that get columns: the nodes in their order, and among them others that no force moves
    pub(crate) fn prepare_in<T: Real>(
        &self,
        skin: &Surface,
        constants @ [shear_modulus, poisson_ratio]: [f64; 2],
        nodes: &[usize],
        columns: &[usize],
        options: &BodyOptions,
    ) -> Result<BodyParts, BodyError> {
        if !SHEAR_MODULI.contains(&shear_modulus) {
            return Err(BodyError::ShearModulus { value: shear_modulus });
        }
        if !(0.0..=0.5).contains(&poisson_ratio) {
            return Err(BodyError::PoissonRatio { value: poisson_ratio });
        }
        if !(1e-9..=1e-2).contains(&options.tolerance) {
            return Err(BodyError::Tolerance { value: options.tolerance });
        }
        self.check_memory::<T>(skin, nodes.len(), options.memory_limit)?;
        let fixed = self.held_vertices(skin)?;
        check_nodes(skin.vertices().len(), &fixed, nodes)?;
        check_uncrossed(skin)?;
        options.with_threads(|options| self.solve::<T>(skin, constants, &fixed, nodes, columns, options))
    }

    fn check_memory<T>(
        &self,
        skin: &Surface,
        node_count: usize,
        limit: Option<usize>,
    ) -> Result<(), BodyError> {
        let needed = self.estimate_in::<T>(skin, node_count).peak_bytes;
        let Some(limit) = limit.or_else(free_memory).filter(|&limit| needed > limit) else { return Ok(()) };
        Err(BodyError::MemoryLimit {
            needed,
            limit,
            skin_count: skin.vertices().len(),
            bone_count: self.bone_count(),
            node_count,
            affordable: BodyCost::affordable_vertices::<T>(limit, node_count),
        })
    }

    fn solve<T: Real>(
        &self,
        skin: &Surface,
        [shear_modulus, poisson_ratio]: [f64; 2],
        fixed: &[bool],
        nodes: &[usize],
        columns: &[usize],
        options: &BodyOptions,
    ) -> Result<BodyParts, BodyError> {
        // Lengths in mean edges and G = 1: the same numbers in every unit system.
        let length = skin.mean_edge_length();
        let (body, surfaces) = self.discretize(skin, length, poisson_ratio, fixed, nodes);
        let cost = self.estimate_in::<T>(skin, nodes.len());
        let watch = Watch::new(options, cost);

        let advance = watch.by_rows("assembly", body.points.len());
        let mut equations = assemble_equations::<T>(&body, options.tolerance, &advance)
            .ok_or_else(|| watch.interrupted("assembly"))?;
        impose_flux_identities(&mut equations, &body, &surfaces);

        let unknowns = 3 * body.points.len();
        let factor = factorize(equations.matrix, unknowns, &watch)?;

        let loads = MatRef::from_column_major_slice(&equations.loads, 3 * nodes.len(), unknowns);
        let (skin_rows, bone_rows) = (3 * skin.vertices().len(), 3 * self.bone_count());
        let mut displacement = Mat::zeros(skin_rows, 3 * columns.len());
        let bone_normals = self.bone.as_ref().filter(|_| options.bone_pressure).map(Surface::vertex_normals);
        let mut pressure = Mat::zeros(bone_normals.map_or(0, <[_]>::len), 3 * columns.len());
        let per_newton = 1.0 / (shear_modulus * length);
        let width = solve_width(loads.nrows());
        let mut solved_columns =
            [&mut displacement, &mut pressure].map(|all| columns_of(all, nodes, columns));
        let [displacements, pressures] = &mut solved_columns;
        let results = displacements.par_chunks_mut(width).zip(pressures.par_chunks_mut(width));
        let wanted = if bone_normals.is_some() { unknowns } else { skin_rows };
        solve_columns(&factor, wanted, loads, &watch, results, |solved, (displacements, pressures)| {
            for ((solved, displacement), pressure) in solved.col_iter().zip(displacements).zip(pressures) {
                for row in (0..skin_rows).filter(|row| !fixed[row / 3]) {
                    displacement[row] = solved[bone_rows + row].into() * per_newton;
                }
                for (vertex, normal) in bone_normals.into_iter().flatten().enumerate() {
                    let traction = Vector3::from_fn(|axis, _| solved[3 * vertex + axis].into());
                    pressure[vertex] = traction.dot(normal) / (length * length);
                }
            }
        })?;
        Ok(BodyParts {
            nodes: columns.to_vec(),
            displacement,
            bone_pressure: bone_normals.map(|_| pressure),
            rotation: nalgebra::Matrix3::identity(),
            shear_modulus,
            poisson_ratio,
        })
    }
}

/// Of three columns for each of some vertices those of the nodes among them.
fn columns_of<'a>(matrix: &'a mut Mat<f64>, nodes: &[usize], vertices: &[usize]) -> Vec<ColMut<'a, f64>> {
    let mut left = nodes.iter().peekable();
    let is_node: Vec<bool> = vertices.iter().map(|vertex| left.next_if_eq(&vertex).is_some()).collect();
    let all = matrix.col_iter_mut().enumerate();
    all.filter(|(column, _)| is_node[column / 3]).map(|(_, entries)| entries).collect()
}

/// As many threads as the pool at hand has.
fn parallelism() -> Par {
    match rayon::current_num_threads() {
        1 => Par::Seq,
        threads => Par::rayon(threads),
    }
}

/// Factor of the equations, refused where it is singular to rounding.
///
/// * `transposed`: their matrix by rows
fn factorize<T: Real>(transposed: Vec<T>, unknowns: usize, watch: &Watch) -> Result<Lu<T>, BodyError> {
    let mut matrix = Dense::from_columns(transposed, unknowns, unknowns);
    matrix.transpose();
    let blocking = Blocking { panel: FACTOR_PANEL, strip: FACTOR_STRIP, par: parallelism() };
    let stop = &mut |done| match done {
        0.0 => watch.is_interrupted(),
        _ => !watch.advance("factorization", done),
    };
    let factor = Lu::with_blocking(matrix, blocking, stop).map_err(|reason| match reason {
        NoFactor::Interrupted => watch.interrupted("factorization"),
        NoFactor::Singular => BodyError::Singular { pivot_ratio: 0.0 },
    })?;
    let pivot_ratio = factor.pivot_ratio();
    if pivot_ratio < T::EPSILON { Err(BodyError::Singular { pivot_ratio }) } else { Ok(factor) }
}

/// Solves for every row of `loads`, a block of them on each thread, and hands `take` the solutions of each block with its
/// part of `results`.
///
/// * `wanted`: how many of the unknowns, the last ones
fn solve_columns<T: Real, Part: Send>(
    factor: &Lu<T>,
    wanted: usize,
    loads: MatRef<'_, T>,
    watch: &Watch,
    results: impl IndexedParallelIterator<Item = Part>,
    take: impl Fn(MatRef<'_, T>, Part) + Sync,
) -> Result<(), BodyError> {
    let (columns, unknowns) = (loads.nrows(), loads.ncols());
    let solved = AtomicUsize::new(0);
    let most = solve_width(columns);
    let scratch = || Mat::zeros(unknowns, most);
    let finished = results.enumerate().map_init(scratch, |scratch, (block, part)| {
        let start = block * most;
        let width = most.min(columns - start);
        let mut block = scratch.as_mut().subcols_mut(0, width);
        block.copy_from(loads.subrows(start, width).transpose());
        // Halfway and at the end of each block.
        let advance = || {
            let halves = width + solved.fetch_add(width, Ordering::Relaxed);
            watch.advance("solution", 0.5 * halves as f64 / columns as f64)
        };
        factor.solve_last(block.rb_mut(), wanted, &|| !advance());
        take(block.rb(), part);
        advance()
    });
    if finished.all(|go_on| go_on) { Ok(()) } else { Err(watch.interrupted("solution")) }
}
