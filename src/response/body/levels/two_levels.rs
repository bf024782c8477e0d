//! The compliance of a body from its near kernel and the remainder.

use std::sync::Arc;

use faer::Mat;
use faer::linalg::matmul::matmul;
use faer::{Accum, Par};
use nalgebra::{Matrix3, Vector3};

use crate::response::body::compliance::{BodyCompliance, BodyParts};
use crate::response::body::error::BodyError;
use crate::response::body::levels::near::{LEAST_TOLERANCE, NearKernel};
use crate::response::body::levels::sizing::{coarse_bone, tissue_thickness};
use crate::response::body::solve::{Body, BodyOptions};
use crate::response::error::ResponseError;
use crate::response::matrix::options::AssemblyOptions;
use crate::response::skin::elastic::Request;
use crate::surface::checked::Surface;
use crate::surface::coarse::{CoarsePlace, CoarseSkin};

/// Rows or columns of the near kernel at a time, so that memory stays small.
const AT_ONCE: usize = 256;

/// A body on two levels: everything in it, to store it and to build it again.
#[derive(Debug, Clone)]
pub struct TwoLevels {
    /// `B_coarse - N_coarse` at the vertices of the coarse skin, per newton at some of them.
    pub remainder: BodyCompliance,
    /// Where each vertex of the skin lies on the coarse one (n).
    pub places: Arc<[CoarsePlace]>,
    /// Thickness of the tissue at each vertex of the skin (n, m); `None` without bone.
    pub thickness: Option<Arc<[f64]>>,
    /// Vertices of the skin that do not move (n).
    pub fixed: Arc<[bool]>,
    near: NearKernel,
}

impl TwoLevels {
    /// Builds it from its parts.
    ///
    /// # Errors
    /// [`ResponseError`]: sizes that do not belong together, a thickness that is none.
    pub fn from_parts(
        remainder: BodyCompliance,
        places: Arc<[CoarsePlace]>,
        thickness: Option<Arc<[f64]>>,
        fixed: Arc<[bool]>,
    ) -> Result<Self, ResponseError> {
        let lengths =
            [("fixed", fixed.len()), ("thickness", thickness.as_ref().map_or(fixed.len(), |t| t.len()))];
        for (what, found) in lengths {
            if found != places.len() {
                return Err(BodyError::Parts { what, found, expected: places.len() }.into());
            }
        }
        let coarse_count = remainder.vertex_count();
        let corner = places.iter().flat_map(|place| place.corners).max().unwrap_or(0) as usize;
        if corner >= coarse_count {
            return Err(BodyError::Parts {
                what: "coarse vertices",
                found: coarse_count,
                expected: corner + 1,
            }
            .into());
        }
        let (modulus, ratio) = (remainder.parts().shear_modulus, remainder.parts().poisson_ratio);
        let near = NearKernel::new(modulus, ratio, thickness.clone())?;
        Ok(Self { remainder, places, thickness, fixed, near })
    }

    /// Solves `body` on its coarse skin.
    ///
    /// * `fixed`: vertices of the skin that do not move (n)
    /// * `nodes`: vertices of the skin that may be loaded
    pub(crate) fn solve(
        body: &Body,
        skin: &Surface,
        coarse: CoarseSkin,
        fixed: &[bool],
        [shear_modulus, poisson_ratio]: [f64; 2],
        nodes: &[usize],
        options: &BodyOptions,
    ) -> Result<Self, ResponseError> {
        let held: Vec<bool> = coarse.fine_vertices.iter().map(|&vertex| fixed[vertex]).collect();
        let mut columns: Vec<usize> =
            nodes.iter().flat_map(|&vertex| coarse.places[vertex].support()).collect();
        columns.sort_unstable();
        columns.dedup();
        let loaded: Vec<usize> = columns.iter().copied().filter(|&column| !held[column]).collect();
        let coarse_body = Body {
            bone: body.bone.as_ref().map(|bone| {
                // The pressure on a bone is wanted at its own vertices.
                if options.bone_pressure { bone.clone() } else { coarse_bone(bone, &coarse.surface) }
            }),
            fixed: body.fixed.as_ref().map(|_| held),
            coarse_edge_length: Some(0.0),
        };
        // Far below what the coarse mesh costs.
        let options = &BodyOptions { tolerance: options.tolerance.max(LEAST_TOLERANCE), ..*options };
        let solved = coarse_body.prepare(&coarse.surface, shear_modulus, poisson_ratio, &loaded, options)?;

        let thickness = body.bone.as_ref().map(|bone| tissue_thickness(skin, bone));
        let on_coarse = body.bone.as_ref().map(|bone| tissue_thickness(&coarse.surface, bone).into());
        let near = NearKernel::new(shear_modulus, poisson_ratio, on_coarse)?;
        let assembly = AssemblyOptions {
            tolerance: options.tolerance,
            num_threads: options.num_threads,
            interrupt: options.interrupt,
            ..AssemblyOptions::default()
        };
        let displacement = less_near_kernel(&coarse.surface, &columns, &solved, &near, &assembly)?;
        let parts = BodyParts {
            displacement,
            bone_pressure: solved.parts().bone_pressure.as_ref().map(|kept| {
                let column = |column: usize| loaded.binary_search(&columns[column]).ok();
                Mat::from_fn(kept.nrows(), 3 * columns.len(), |row, j| {
                    column(j / 3).map_or(0.0, |own| kept[(row, 3 * own + j % 3)])
                })
            }),
            nodes: columns,
            ..solved.parts().clone()
        };
        let remainder = BodyCompliance::new(parts, solved.report().clone());
        Self::from_parts(remainder, coarse.places.into(), thickness.map(Into::into), fixed.into())
    }

    /// The same after a turn of the skin.
    ///
    /// # Errors
    /// [`BodyError::Rotation`].
    pub(crate) fn moved(&self, rotation: &Matrix3<f64>) -> Result<Self, BodyError> {
        Ok(Self { remainder: self.remainder.moved(rotation)?, ..self.clone() })
    }

    /// R over the nodes along `directions` (k × k, m/N).
    ///
    /// * `asked`: with the skin where it stands now
    pub(crate) fn response(
        &self,
        asked: &Request,
        directions: &[Vector3<f64>],
    ) -> Result<Mat<f64>, ResponseError> {
        let &Request { surface: skin, nodes, options } = asked;
        let mut response = self.remainder_among(nodes, directions);
        for (turn, columns) in nodes.chunks(AT_ONCE).enumerate() {
            let near = self.near.blocks(skin, nodes, columns, options)?;
            for own in 0..columns.len() {
                let j = turn * AT_ONCE + own;
                for (i, entry) in response.col_as_slice_mut(j).iter_mut().enumerate() {
                    *entry += directions[i].dot(&(near.block(i, own) * directions[j]));
                }
            }
        }
        Ok(response)
    }

    /// `Q' (B_coarse - N_coarse) Q`, with a column of `Q = P' n` for each node.
    fn remainder_among(&self, nodes: &[usize], directions: &[Vector3<f64>]) -> Mat<f64> {
        let mut support: Vec<usize> =
            nodes.iter().flat_map(|&vertex| self.places[vertex].support()).collect();
        support.sort_unstable();
        support.dedup();
        let back = self.remainder.rotation().transpose();
        let mut spread = Mat::<f64>::zeros(3 * support.len(), nodes.len());
        for (j, (&vertex, direction)) in nodes.iter().zip(directions).enumerate() {
            let direction = back * direction;
            let place = self.places[vertex];
            for (corner, weight) in
                place.corners.into_iter().zip(place.weights).filter(|(_, weight)| *weight > 0.0)
            {
                let at = 3 * support.binary_search(&(corner as usize)).expect("a corner of its place");
                (0..3).for_each(|axis| spread[(at + axis, j)] += weight * direction[axis]);
            }
        }
        let stored = &self.remainder.parts().displacement;
        let columns: Vec<usize> = support.iter().map(|&vertex| self.column(vertex)).collect();
        let among = Mat::from_fn(3 * support.len(), 3 * support.len(), |i, j| {
            stored[(3 * support[i / 3] + i % 3, 3 * columns[j / 3] + j % 3)]
        });
        // Products of one thread, so that the result is the same to the bit for any number.
        let mut half = Mat::<f64>::zeros(3 * support.len(), nodes.len());
        matmul(half.as_mut(), Accum::Replace, among.as_ref(), spread.as_ref(), 1.0, Par::Seq);
        let mut response = Mat::<f64>::zeros(nodes.len(), nodes.len());
        matmul(response.as_mut(), Accum::Replace, spread.transpose(), half.as_ref(), 1.0, Par::Seq);
        response
    }

    /// Column (in blocks of 3) of a loaded vertex of the coarse skin.
    fn column(&self, vertex: usize) -> usize {
        self.remainder.nodes().binary_search(&vertex).expect("the coarse skin was solved around every node")
    }

    /// Displacement (m) of `vertices` under `forces` (N) at the nodes.
    ///
    /// * `asked`: with the skin where it stands now
    pub(crate) fn displacements(
        &self,
        asked: &Request,
        forces: &[Vector3<f64>],
        vertices: &[usize],
    ) -> Result<Vec<Vector3<f64>>, ResponseError> {
        let &Request { surface: skin, nodes, options } = asked;
        let smooth = self.remainder.displacements(&self.on_coarse(nodes, forces))?;
        let mut moved = Vec::with_capacity(vertices.len());
        for rows in vertices.chunks(AT_ONCE) {
            let near = self.near.blocks(skin, rows, nodes, options)?;
            for (row, &vertex) in rows.iter().enumerate() {
                if self.fixed[vertex] {
                    moved.push(Vector3::zeros());
                    continue;
                }
                let place = self.places[vertex];
                let far: Vector3<f64> = (place.corners.into_iter().zip(place.weights))
                    .map(|(corner, weight)| weight * smooth[corner as usize])
                    .sum();
                moved.push(
                    forces.iter().enumerate().fold(far, |u, (j, force)| u + near.block(row, j) * force),
                );
            }
        }
        Ok(moved)
    }

    /// Forces (N) at the loaded vertices of the coarse skin that stand for those at `nodes`.
    pub(crate) fn on_coarse(&self, nodes: &[usize], forces: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let mut spread = vec![Vector3::zeros(); self.remainder.nodes().len()];
        for (&vertex, force) in nodes.iter().zip(forces) {
            let place = self.places[vertex];
            for (corner, weight) in
                place.corners.into_iter().zip(place.weights).filter(|(_, weight)| *weight > 0.0)
            {
                spread[self.column(corner as usize)] += weight * force;
            }
        }
        spread
    }
}

/// `B - N` (3 n × 3 k, m/N) at every vertex of the coarse skin per newton at its vertices `columns`.
///
/// * `solved`: B at those of the columns that move; a force on any other moves nothing
fn less_near_kernel(
    coarse: &Surface,
    columns: &[usize],
    solved: &BodyCompliance,
    near: &NearKernel,
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    let everywhere: Vec<usize> = (0..coarse.vertices().len()).collect();
    let near = near.blocks(coarse, &everywhere, columns, options)?;
    let stored = &solved.parts().displacement;
    let mut remainder = Mat::zeros(3 * everywhere.len(), 3 * columns.len());
    for (column, vertex) in columns.iter().enumerate() {
        let own = solved.nodes().binary_search(vertex).ok();
        for b in 0..3 {
            let entries = remainder.col_as_slice_mut(3 * column + b);
            if let Some(own) = own {
                entries.copy_from_slice(stored.col_as_slice(3 * own + b));
            }
            for (row, entries) in entries.as_chunks_mut::<3>().0.iter_mut().enumerate() {
                let block = near.block(row, column);
                (0..3).for_each(|a| entries[a] -= block[(a, b)]);
            }
        }
    }
    Ok(remainder)
}
