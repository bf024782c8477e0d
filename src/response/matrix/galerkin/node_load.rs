//! The load of a node by its moments: means of the regular solid harmonics about its center of force.

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::response::column::load::LoadedFace;
use crate::response::integral::rule_lists::RuleLists;
use crate::response::series::point_loads::{LoadBall, PointLoads};
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::POINTS_PER_BLOCK;

/// Highest degree of the harmonics.
pub(crate) const HIGHEST_DEGREE: usize = 6;
/// Real numbers of the moments: of each degree l from l² on, of each order m its real and, for m > 0, its imaginary part.
pub(crate) const MOMENT_COUNT: usize = (HIGHEST_DEGREE + 1) * (HIGHEST_DEGREE + 1);
/// Points in each direction of a triangle that give the moments exactly.
const MOMENT_POINTS: usize = 4;

/// A unit force at a node.
#[derive(Debug, Clone)]
pub(crate) struct NodeLoad {
    /// Center of force (m).
    pub(crate) center: Vector3<f64>,
    /// Means of the regular harmonics about it (m^l).
    pub(crate) moments: [f64; MOMENT_COUNT],
    /// Sixth root of the mean sixth power of the distance from it (m).
    pub(crate) size: f64,
}

impl Default for NodeLoad {
    fn default() -> Self {
        Self { center: Vector3::zeros(), moments: [0.0; MOMENT_COUNT], size: 0.0 }
    }
}

impl NodeLoad {
    /// Of a load that sums to 1.
    ///
    /// * `forces`: scratch, for point forces that have the same moments
    pub(crate) fn new(faces: &[LoadedFace], forces: &mut PointLoads) -> Self {
        forces.clear();
        for LoadedFace { frame, density } in faces {
            let corners = density.map(|density| density * frame.area);
            forces.spread(&frame.vertices, &corners, RuleLists::gauss(MOMENT_POINTS));
        }
        forces.pad(POINTS_PER_BLOCK);
        pulp::Arch::new().dispatch(Moments { forces })
    }
}

struct Moments<'a> {
    forces: &'a PointLoads,
}

impl WithSimd for Moments<'_> {
    type Output = NodeLoad;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> NodeLoad {
        let Self { forces } = self;
        // in metres
        let ball = LoadBall { radius: 1.0, ..forces.ball(std::iter::empty()) };
        let zero = Lanes::splat(simd, 0.0);
        let (mut sums, mut sixth) = ([zero; MOMENT_COUNT], zero);
        for at in (0..forces.share.len()).step_by(S::F64_LANES) {
            let ([x, y, z], force) = forces.vector(simd, &ball, at);
            let squared = dot(&[x, y, z], &[x, y, z]);
            sixth = force.mul_add(squared * squared * squared, sixth);
            // R_mm, from order to order
            let (mut re, mut im) = (force, zero);
            for m in 0..=HIGHEST_DEGREE {
                if m > 0 {
                    let factor = zero.all(-0.5 / m as f64);
                    (re, im) = (factor * (re * x - im * y), factor * (re * y + im * x));
                }
                // R_lm = q_l R_mm with q real
                let (mut before, mut q) = (zero, zero.all(1.0));
                for l in m..=HIGHEST_DEGREE {
                    if l > m {
                        let top = zero.all((2 * l - 1) as f64) * z * q - squared * before;
                        (before, q) = (q, zero.all(1.0 / ((l + m) * (l - m)) as f64) * top);
                    }
                    let (real, imaginary) = (l * l + (2 * m).saturating_sub(1), l * l + 2 * m);
                    sums[real] = re.mul_add(q, sums[real]);
                    if m > 0 {
                        sums[imaginary] = im.mul_add(q, sums[imaginary]);
                    }
                }
            }
        }
        // no closures here: they would not be compiled for the machine's vectors
        let mut moments = [0.0; MOMENT_COUNT];
        for (moment, sum) in moments.iter_mut().zip(sums) {
            *moment = sum.total();
        }
        NodeLoad { center: ball.center, moments, size: sixth.total().max(0.0).powf(1.0 / 6.0) }
    }
}
