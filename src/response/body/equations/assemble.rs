//! The boundary-element equations, one collocation point after another.
//!
//! For a force along `a` at collocation point `i`, Somigliana's identity over skin and bone reads
//!
//! ```text
//! sum_j T_ij u_j  -  sum_j U_ij t_j  =  sum_j U_ij f_j / S_j
//! ```
//!
//! with `u_j` on the free skin, `t_j` on fixed skin and bone, both against hat functions, and node forces
//! `f_j` spread over their hats. A fixed node's traction lives on the fixed faces around it only: on the free
//! faces of the border the traction is known, so it jumps there. The diagonal of `T` with the free term follows from
//! rigid translation. `T` over the bone is never needed: it does not move, and seen from the skin its rigid
//! translation adds nothing.
//!
//! Each point fills three contiguous columns of the transposed matrices, so the result is equal to the bit
//! for any number of threads.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::linalg::factor::Real;
use crate::response::body::equations::blocks::{PACKED_ENTRY, displacement_blocks, traction_blocks};
use crate::response::body::equations::element::{Element, NO_COLUMN};
use crate::response::body::equations::kelvin::Kelvin;
use crate::response::body::equations::quadrature::{AddMoments, HatMoments, RuleReach, TriangleScratch};

/// The discretised body in units of its own length, with a shear modulus of 1.
#[derive(Debug, Clone)]
pub(crate) struct DiscreteBody {
    pub kelvin: Kelvin,
    /// Collocation points: bone vertices, then skin vertices.
    pub points: Vec<Vector3<f64>>,
    /// Whether a point's own displacement is unknown (skin that is not fixed).
    pub is_moving: Vec<bool>,
    /// Those of the skin, then those of the bones.
    pub elements: Vec<Element>,
    /// Number of loaded nodes.
    pub load_count: usize,
}

/// Transposed matrix and transposed right-hand sides; column `3 i + a` belongs to point `i`, direction `a`.
pub(crate) struct Equations<T = f64> {
    /// `(3 n, 3 n)`, column-major.
    pub matrix: Vec<T>,
    /// `(3 k, 3 n)`, column-major.
    pub loads: Vec<T>,
}

/// Writes the hats of elements seen from one point into that point's columns.
struct Row<'a> {
    point: usize,
    body: &'a DiscreteBody,
    /// Columns of the transposed matrix and of the transposed loads, one per direction of the force.
    matrix: [&'a mut [f64]; 3],
    loads: [&'a mut [f64]; 3],
    /// Sum of all traction blocks but the point's own.
    off_diagonal: [f64; 9],
    displacement_factors: (f64, f64),
    traction_factors: (f64, f64, f64),
}

#[inline(always)]
fn add_block(columns: &mut [&mut [f64]; 3], block: u32, factor: f64, value: impl Fn(usize) -> f64) {
    let at = 3 * block as usize;
    for (a, column) in columns.iter_mut().enumerate() {
        let target = &mut column[at..at + 3];
        target[0] += factor * value(3 * a);
        target[1] += factor * value(3 * a + 1);
        target[2] += factor * value(3 * a + 2);
    }
}

impl<'a> Row<'a> {
    /// The point's own block from rigid translation, which needs no force.
    fn finish(&mut self) {
        if self.body.is_moving[self.point] {
            let sum = self.off_diagonal;
            add_block(&mut self.matrix, self.point as u32, -1.0, |c| sum[c]);
        }
    }
}

impl AddMoments for Row<'_> {
    #[inline(always)]
    fn add<const L: usize>(&mut self, elements: &[u32], normal: &[[f64; L]; 3], moments: &HatMoments<L>) {
        let first = &self.body.elements[elements[0] as usize];
        for (corner, moments) in moments.iter().enumerate() {
            // Elements around the point come one by one; `finish` finds the traction of the point itself.
            if first.is_skin && first.nodes[corner] as usize != self.point {
                let traction = traction_blocks(self.traction_factors, moments, normal);
                for (sum, values) in self.off_diagonal.iter_mut().zip(&traction) {
                    *sum += values.iter().sum::<f64>();
                }
                for (lane, &element) in elements.iter().enumerate() {
                    let moving = self.body.elements[element as usize].moving[corner];
                    if moving != NO_COLUMN {
                        add_block(&mut self.matrix, moving, 1.0, |c| traction[c][lane]);
                    }
                }
            }
            let displacement = displacement_blocks(self.displacement_factors, moments);
            for (lane, &element) in elements.iter().enumerate() {
                let element = &self.body.elements[element as usize];
                let block = |c: usize| displacement[PACKED_ENTRY[c]][lane];
                if element.supported[corner] != NO_COLUMN {
                    add_block(&mut self.matrix, element.supported[corner], -1.0, block);
                }
                if element.loaded[corner] != NO_COLUMN {
                    add_block(&mut self.loads, element.loaded[corner], element.load_scales[corner], block);
                }
            }
        }
    }
}

fn fill_row(row: &mut Row, reach: &RuleReach, scratch: &mut TriangleScratch) {
    let body = row.body;
    let point = &body.points[row.point];
    let triangle = |element: u32| &body.elements[element as usize].triangle;
    let skin_count = body.elements.partition_point(|element| element.is_skin) as u32;
    reach.integrate::<true>(point, 0..skin_count, triangle, scratch, row);
    reach.integrate::<false>(point, skin_count..body.elements.len() as u32, triangle, scratch, row);
    row.finish();
}

fn in_three(columns: &mut [f64]) -> [&mut [f64]; 3] {
    let height = columns.len() / 3;
    let (first, rest) = columns.split_at_mut(height);
    let (second, third) = rest.split_at_mut(height);
    [first, second, third]
}

/// Assembles the equations with integrals to `tolerance`, rounded to the precision T; `advance` is called after each point
/// and stops the assembly (`None`) by returning false.
pub(crate) fn assemble_equations<T: Real>(
    body: &DiscreteBody,
    tolerance: f64,
    advance: &(dyn Fn() -> bool + Sync),
) -> Option<Equations<T>> {
    let height = 3 * body.points.len();
    let load_height = 3 * body.load_count;
    let reach = RuleReach::new(tolerance);
    let zero = T::from(0.0);
    let mut equations =
        Equations { matrix: vec![zero; height * height], loads: vec![zero; load_height * height] };
    let sums = || [vec![0.0; 3 * height], vec![0.0; 3 * load_height]];
    let finished = equations
        .matrix
        .par_chunks_mut(3 * height)
        .zip(equations.loads.par_chunks_mut(3 * load_height))
        .enumerate()
        .map_init(
            || (TriangleScratch::default(), sums()),
            |(scratch, [matrix, loads]), (point, results)| {
                matrix.fill(0.0);
                loads.fill(0.0);
                let mut row = Row {
                    point,
                    body,
                    matrix: in_three(matrix),
                    loads: in_three(loads),
                    off_diagonal: [0.0; 9],
                    displacement_factors: body.kelvin.displacement_factors(),
                    traction_factors: body.kelvin.traction_factors(),
                };
                fill_row(&mut row, &reach, scratch);
                for (result, sums) in [(results.0, matrix), (results.1, loads)] {
                    result.iter_mut().zip(sums).for_each(|(entry, sum)| *entry = T::nearest(*sum));
                }
                advance()
            },
        )
        .all(|go_on| go_on);
    finished.then_some(equations)
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::response::body::equations::triangle::Triangle;

    /// A lopsided ball of 80 faces, each of whose corners carries a load of its own.
    fn body(poisson_ratio: f64) -> DiscreteBody {
        let (points, faces) = crate::sample::icosphere(1.0, 1);
        let stretch = Matrix3::new(1.1, 0.1, 0.0, 0.2, 1.05, 0.1, 0.0, -0.1, 0.9);
        let points: Vec<Vector3<f64>> =
            points.iter().map(|x| stretch * x * (1.0 - 0.2 * x.z) + Vector3::new(0.1, 0.05, -0.2)).collect();
        let elements = faces.iter().enumerate().map(|(index, face)| Element {
            triangle: Triangle::new(face.map(|v| points[v as usize])),
            nodes: *face,
            moving: *face,
            supported: [NO_COLUMN; 3],
            loaded: [0, 1, 2].map(|c| 3 * index as u32 + c),
            load_scales: [1.0; 3],
            is_skin: true,
        });
        DiscreteBody {
            kelvin: Kelvin::new(poisson_ratio),
            elements: elements.collect(),
            is_moving: vec![true; points.len()],
            load_count: 3 * faces.len(),
            points,
        }
    }

    /// A linear displacement lies in the space of hats and its traction is constant on each face, so the equations
    /// hold to the tolerance of the integrals.
    #[test]
    fn a_homogeneous_strain_and_a_rotation_are_met_exactly() {
        let gradient = Matrix3::new(0.3, -0.8, 0.1, 0.5, -0.4, 0.7, 0.2, -0.1, 0.6);
        for poisson_ratio in [0.0, 0.3, 0.49, 0.5] {
            let body = body(poisson_ratio);
            let e = body.kelvin.compressibility();
            let gradient =
                if e == 0.0 { gradient - Matrix3::identity() * gradient.trace() / 3.0 } else { gradient };
            // at nu = 0.5 any pressure goes with it
            let isotropic = if e == 0.0 { 0.9 } else { (1.0 - e) / e * gradient.trace() };
            let stress = gradient + gradient.transpose() + Matrix3::identity() * isotropic;
            let displacement: Vec<f64> =
                body.points.iter().flat_map(|x| <[f64; 3]>::from(gradient * x)).collect();
            let traction: Vec<f64> = body
                .elements
                .iter()
                .flat_map(|element| [<[f64; 3]>::from(stress * element.triangle.normal); 3])
                .flatten()
                .collect();
            let equations = assemble_equations::<f64>(&body, 1e-9, &|| true).expect("not interrupted");
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let (height, load_height) = (displacement.len(), traction.len());
            for row in 0..height {
                let left = dot(&equations.matrix[row * height..(row + 1) * height], &displacement);
                let right = dot(&equations.loads[row * load_height..(row + 1) * load_height], &traction);
                assert!((left - right).abs() < 1e-8, "nu {poisson_ratio}, row {row}: {left} {right}");
            }
        }
    }

    #[test]
    fn the_number_of_threads_changes_no_bit() {
        let body = body(0.4);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| assemble_equations::<f64>(&body, 1e-4, &|| true)).expect("not interrupted")
        };
        let one = with(1);
        for threads in [2, 3] {
            let more = with(threads);
            assert!(one.matrix == more.matrix && one.loads == more.loads);
        }
    }

    #[test]
    fn a_refusal_to_advance_ends_the_assembly() {
        assert!(assemble_equations::<f64>(&body(0.5), 1e-4, &|| false).is_none());
    }
}
