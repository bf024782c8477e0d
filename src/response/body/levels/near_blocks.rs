//! The near kernel between coarse vertices, as blocks along any direction.

use faer::Mat;
use nalgebra::{Matrix3, Vector3};

use crate::response::body::equations::element::NO_COLUMN;
use crate::response::body::equations::quadrature::{AddMoments, HatMoments, RuleReach, TriangleScratch};
use crate::response::body::equations::triangle::Triangle;
use crate::response::body::levels::near::{NEAR_TOLERANCE, NearKernel, fade};
use crate::response::error::ResponseError;
use crate::response::matrix::collocation::assemble_block;
use crate::response::matrix::fill::filled_columns;
use crate::response::matrix::options::AssemblyOptions;
use crate::surface::checked::Surface;

/// Components of a symmetric 3 × 3 block: xx, xy, xz, yy, yz, zz.
const PACKED_ENTRIES: usize = 6;

/// Blocks N_ij (m/N) of displacement of m rows per newton at k columns.
pub(crate) struct NearBlocks {
    /// What is alike along every direction (m × k).
    scalar: Mat<f64>,
    /// What is along the way between them, packed (6 k × m).
    outer: Mat<f64>,
    /// Of the rows and of the columns.
    ends: [Vec<End>; 2],
    skew_factor: f64,
}

/// Place (m), normal and 1/ρ (1/m) of a vertex.
type End = (Vector3<f64>, Vector3<f64>, f64);

impl NearKernel {
    /// Blocks of the displacement of `rows` per newton at `columns`, vertices of `surface`, against the hats but
    /// for the skew part: of a hat on itself that vanishes, and others are some edges away.
    pub fn blocks(
        &self,
        surface: &Surface,
        rows: &[usize],
        columns: &[usize],
        options: &AssemblyOptions,
    ) -> Result<NearBlocks, ResponseError> {
        let options = &AssemblyOptions { tolerance: options.tolerance.max(NEAR_TOLERANCE), ..*options };
        let scalar = assemble_block(surface, &self.scalar, rows, columns, options)?;
        let loads = self.loads(surface, columns);
        let reach = RuleReach::new(options.tolerance);
        let size = [PACKED_ENTRIES * columns.len(), rows.len()];
        let outer = filled_columns(size, options, TriangleScratch::default, |scratch, row, column| {
            let point = &surface.vertices()[rows[row]];
            let mut sums = OuterRow { loads: &loads, blocks: column.as_chunks_mut().0 };
            let triangle = |index: u32| &loads[index as usize].triangle;
            reach.integrate::<false>(point, 0..loads.len() as u32, triangle, scratch, &mut sums);
        })?;
        let end = |&vertex: &usize| {
            (surface.vertices()[vertex], surface.vertex_normals()[vertex], self.per_reach(vertex))
        };
        let ends = [rows, columns].map(|vertices| vertices.iter().map(end).collect());
        Ok(NearBlocks { scalar, outer, ends, skew_factor: self.skew_factor() })
    }

    /// The faces around `columns`.
    fn loads(&self, surface: &Surface, columns: &[usize]) -> Vec<Load> {
        let mut places = vec![NO_COLUMN; surface.vertices().len()];
        columns.iter().enumerate().for_each(|(place, &vertex)| places[vertex] = place as u32);
        let factor = self.outer_factor();
        let load = |face: &[u32; 3]| Load {
            triangle: Triangle::new(face.map(|vertex| surface.vertices()[vertex as usize])),
            columns: face.map(|vertex| places[vertex as usize]),
            factors: face.map(|vertex| factor / surface.vertex_areas()[vertex as usize]),
        };
        surface.faces().iter().map(load).filter(|load| load.columns != [NO_COLUMN; 3]).collect()
    }
}

impl NearBlocks {
    pub fn block(&self, row: usize, column: usize) -> Matrix3<f64> {
        let [xx, xy, xz, yy, yz, zz] = self.outer.col_as_slice(row).as_chunks().0[column];
        let outer = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let [(to, normal, per_reach), (from, other, per_other)] = [self.ends[0][row], self.ends[1][column]];
        let way = to - from;
        let turned = way * (0.5 * (normal + other)).transpose();
        // 0 at the vertex itself, however soft the tissue.
        let squared = way.norm_squared();
        let skew = self.skew_factor * (turned - turned.transpose()) / squared.max(f64::MIN_POSITIVE);
        (outer + skew) * fade(squared, [per_reach, per_other])
            + Matrix3::from_diagonal_element(self.scalar[(row, column)])
    }
}

/// A face with forces at its corners.
struct Load {
    triangle: Triangle,
    /// Columns of the corners, [`NO_COLUMN`] where there is no force.
    columns: [u32; 3],
    /// Of `r^ r^' / r`, per area of the corners (1/N).
    factors: [f64; 3],
}

/// Blocks of one row, what is along the way alone.
struct OuterRow<'a> {
    loads: &'a [Load],
    blocks: &'a mut [[f64; PACKED_ENTRIES]],
}

impl AddMoments for OuterRow<'_> {
    #[inline(always)]
    fn add<const L: usize>(&mut self, numbers: &[u32], _: &[[f64; L]; 3], moments: &HatMoments<L>) {
        for (corner, moments) in moments.iter().enumerate() {
            for (lane, &index) in numbers.iter().enumerate() {
                let Load { columns, factors, .. } = &self.loads[index as usize];
                if columns[corner] != NO_COLUMN {
                    let block = &mut self.blocks[columns[corner] as usize];
                    let entries = block.iter_mut().zip(moments);
                    entries.for_each(|(entry, moment)| *entry += factors[corner] * moment[lane]);
                }
            }
        }
    }
}
