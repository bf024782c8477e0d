//! A skin that follows joints: each vertex moves with a blend of their rigid motions.
//!
//! Blended as dual quaternions (Kavan, Collins, Žára, O'Sullivan 2008, "Geometric skinning with approximate dual quaternion
//! blending", ACM Trans. Graph. 27(4), 105) the skin keeps its volume where a joint bends; blended as matrices it
//! collapses there.

use nalgebra::{Isometry3, Quaternion, Vector3};
use rayon::prelude::*;

/// Sums of weights farther from 1 are refused; the others are normalised.
const SUM_TOLERANCE: f64 = 1e-3;
/// Vertices that one thread takes at a time.
const VERTICES_PER_TASK: usize = 2048;

/// Why weights were refused, or do not fit what they are asked about.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkinningError {
    /// Joints and weights have not as many rows.
    #[error("joints has {joints} entries and weights {weights}, expected as many")]
    Lengths {
        /// Entries of `joints`.
        joints: usize,
        /// Entries of `weights`.
        weights: usize,
    },
    /// The number of rows is another than that of vertices.
    #[error("the weights are of {found} vertices, but the surface has {expected}")]
    Vertices {
        /// Rows of weights.
        found: usize,
        /// Vertices of the surface.
        expected: usize,
    },
    /// A joint does not exist.
    #[error("joints[{vertex}] names joint {joint}, but there are {count}")]
    Joint {
        /// Row.
        vertex: usize,
        /// The joint named.
        joint: usize,
        /// Number of joints.
        count: usize,
    },
    /// A weight is negative or not finite.
    #[error("weights[{vertex}] holds {weight}, expected finite weights >= 0")]
    Weight {
        /// Row.
        vertex: usize,
        /// The weight.
        weight: f64,
    },
    /// Weights do not sum to 1.
    #[error(
        "weights[{vertex}] sums to {sum}, expected 1 to within {SUM_TOLERANCE} (of {count} such vertices the first)"
    )]
    Sum {
        /// The first such row.
        vertex: usize,
        /// Its sum.
        sum: f64,
        /// How many there are.
        count: usize,
    },
    /// The number of motions is another than that of joints.
    #[error("there are {found} motions, but {expected} joints")]
    Motions {
        /// Motions given.
        found: usize,
        /// Joints.
        expected: usize,
    },
}

/// How the motions of several joints make one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Blending {
    /// As dual quaternions, of the hemisphere of the joint with the largest weight.
    #[default]
    DualQuaternion,
    /// As matrices.
    Linear,
}

/// By which joints each vertex of a skin is moved, and how much.
#[derive(Debug, Clone)]
pub struct SkinWeights {
    /// Joints and weights of a vertex, the largest weight first, none of them 0.
    influences: Vec<(u32, f64)>,
    /// Where those of each vertex begin; one more at the end.
    starts: Vec<usize>,
    joint_count: usize,
}

impl SkinWeights {
    /// Checks weights and normalises sums that are within 1e-3 of 1.
    ///
    /// * `joints`, `weights`: row by row (n × k)
    /// * `per_vertex`: k, at least 1
    ///
    /// # Errors
    /// [`SkinningError`] by variant.
    pub fn new(
        joints: &[usize],
        weights: &[f64],
        per_vertex: usize,
        joint_count: usize,
    ) -> Result<Self, SkinningError> {
        if joints.len() != weights.len() || per_vertex == 0 || !joints.len().is_multiple_of(per_vertex) {
            return Err(SkinningError::Lengths { joints: joints.len(), weights: weights.len() });
        }
        let rows = joints.chunks(per_vertex).zip(weights.chunks(per_vertex));
        let mut influences = Vec::with_capacity(joints.len());
        let mut starts = vec![0];
        let mut off = None;
        for (vertex, (joints, weights)) in rows.enumerate() {
            if let Some(&joint) = joints.iter().find(|&&joint| joint >= joint_count) {
                return Err(SkinningError::Joint { vertex, joint, count: joint_count });
            }
            if let Some(&weight) = weights.iter().find(|weight| !(**weight >= 0.0 && weight.is_finite())) {
                return Err(SkinningError::Weight { vertex, weight });
            }
            let sum: f64 = weights.iter().sum();
            if (sum - 1.0).abs() > SUM_TOLERANCE {
                off.get_or_insert(((vertex, sum), 0)).1 += 1;
            }
            let first = influences.len();
            let pairs = joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
            influences.extend(pairs.map(|(&joint, weight)| (joint as u32, weight / sum)));
            influences[first..].sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            starts.push(influences.len());
        }
        match off {
            Some(((vertex, sum), count)) => Err(SkinningError::Sum { vertex, sum, count }),
            None => Ok(Self { influences, starts, joint_count }),
        }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Joints of a vertex with their weights, the largest first.
    pub fn of(&self, vertex: usize) -> &[(u32, f64)] {
        &self.influences[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// The skin after its joints have moved.
    ///
    /// * `vertices`: at rest (m)
    /// * `motions`: of each joint, from its place at rest to where it is
    ///
    /// # Errors
    /// [`SkinningError::Vertices`] and [`SkinningError::Motions`] where the numbers do not fit.
    pub fn move_vertices(
        &self,
        vertices: &[Vector3<f64>],
        motions: &[Isometry3<f64>],
        blending: Blending,
    ) -> Result<Vec<Vector3<f64>>, SkinningError> {
        if vertices.len() != self.vertex_count() {
            return Err(SkinningError::Vertices { found: self.vertex_count(), expected: vertices.len() });
        }
        if motions.len() != self.joint_count {
            return Err(SkinningError::Motions { found: motions.len(), expected: self.joint_count });
        }
        let duals: Vec<DualQuaternion> = motions.iter().map(DualQuaternion::from_motion).collect();
        let moved = |vertex: usize| match (self.of(vertex), blending) {
            ([(joint, _)], _) => {
                let motion = &motions[*joint as usize];
                motion.rotation * vertices[vertex] + motion.translation.vector
            }
            (influences, Blending::DualQuaternion) => {
                DualQuaternion::blend(influences, &duals).moved(&vertices[vertex])
            }
            (influences, Blending::Linear) => {
                let place = |joint: u32| motions[joint as usize] * nalgebra::Point3::from(vertices[vertex]);
                influences.iter().map(|&(joint, weight)| weight * place(joint).coords).sum()
            }
        };
        Ok((0..vertices.len()).into_par_iter().with_min_len(VERTICES_PER_TASK).map(moved).collect())
    }
}

/// A rigid motion as a unit dual quaternion, or a weighted sum of such.
#[derive(Debug, Clone, Copy)]
struct DualQuaternion {
    real: Quaternion<f64>,
    dual: Quaternion<f64>,
}

impl DualQuaternion {
    fn from_motion(motion: &Isometry3<f64>) -> Self {
        let real = *motion.rotation.quaternion();
        Self { real, dual: Quaternion::from_imag(motion.translation.vector) * real * 0.5 }
    }

    /// The weighted sum, each in the hemisphere of the first.
    fn blend(influences: &[(u32, f64)], of_joint: &[Self]) -> Self {
        let first = of_joint[influences[0].0 as usize].real.coords;
        let none = Quaternion::new(0.0, 0.0, 0.0, 0.0);
        influences.iter().fold(Self { real: none, dual: none }, |sum, &(joint, weight)| {
            let one = of_joint[joint as usize];
            let weight = if first.dot(&one.real.coords) < 0.0 { -weight } else { weight };
            Self { real: sum.real + one.real * weight, dual: sum.dual + one.dual * weight }
        })
    }

    fn moved(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let length = self.real.norm();
        let (real, dual) = (self.real / length, self.dual / length);
        // q p q*, by two cross products.
        let (axis, w) = (real.imag(), real.w);
        let twice = 2.0 * axis.cross(point);
        let turned = point + w * twice + axis.cross(&twice);
        turned + 2.0 * (dual * real.conjugate()).imag()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use nalgebra::{Translation3, UnitQuaternion};

    use super::*;

    /// A tube along y of radius 8 mm, half of it on each of two joints, and its points at a height.
    fn ring(height: f64) -> Vec<Vector3<f64>> {
        let angles = (0..24).map(|i| f64::from(i) * std::f64::consts::TAU / 24.0);
        angles.map(|angle| Vector3::new(8e-3 * angle.cos(), height, 8e-3 * angle.sin())).collect()
    }

    fn two_joints(count: usize, second: f64) -> SkinWeights {
        SkinWeights::new(&[0, 1].repeat(count), &[1.0 - second, second].repeat(count), 2, 2)
            .expect("valid weights")
    }

    #[test]
    fn a_joint_that_bends_by_a_right_angle_keeps_the_section_of_the_skin() {
        let points = ring(0.0);
        let bent = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2);
        let motions = [Isometry3::identity(), Isometry3::from_parts(Translation3::identity(), bent)];
        let weights = two_joints(points.len(), 0.5);
        let radius = |blending| -> f64 {
            let moved = weights.move_vertices(&points, &motions, blending).expect("numbers that fit");
            moved.iter().map(Vector3::norm).fold(f64::INFINITY, f64::min)
        };
        assert!((radius(Blending::DualQuaternion) - 8e-3).abs() < 1e-15);
        // Half of a point and half of its image after 90 degrees are cos 45 degrees from the axis.
        assert!((radius(Blending::Linear) - 8e-3 * FRAC_PI_2.sin() / 2.0_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn joints_that_move_as_one_move_the_skin_rigidly() {
        let points = ring(0.02);
        let turn = UnitQuaternion::from_euler_angles(2.0, -1.0, 3.0);
        let motion = Isometry3::from_parts(Translation3::new(0.3, -0.2, 0.1), turn);
        // The same motion, of the other hemisphere.
        let other = UnitQuaternion::new_unchecked(-turn.into_inner());
        let motions = [motion, Isometry3::from_parts(motion.translation, other)];
        for blending in [Blending::DualQuaternion, Blending::Linear] {
            let moved = two_joints(points.len(), 0.3).move_vertices(&points, &motions, blending);
            for (point, moved) in points.iter().zip(moved.expect("numbers that fit")) {
                assert!((turn * point + motion.translation.vector - moved).norm() < 1e-15);
            }
        }
    }

    #[test]
    fn weights_that_are_no_partition_are_named() {
        let sum = SkinWeights::new(&[0, 1, 0, 1], &[0.5, 0.5, 0.5, 0.4], 2, 2).expect_err("a sum of 0.9");
        assert_eq!(sum, SkinningError::Sum { vertex: 1, sum: 0.9, count: 1 });
        let joint = SkinWeights::new(&[0, 7], &[0.5, 0.5], 2, 2).expect_err("no joint 7");
        assert_eq!(joint, SkinningError::Joint { vertex: 0, joint: 7, count: 2 });
        let negative = SkinWeights::new(&[0, 1], &[1.5, -0.5], 2, 2).expect_err("a negative weight");
        assert_eq!(negative, SkinningError::Weight { vertex: 0, weight: -0.5 });
        let near = SkinWeights::new(&[0, 1], &[0.5, 0.5005], 2, 2).expect("within 1e-3");
        assert!((near.of(0).iter().map(|(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
