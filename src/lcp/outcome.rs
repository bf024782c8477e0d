//! What a run of any method gives back.

use crate::lcp::solution::LcpStatus;
use crate::linalg::factor::NoFactor;

/// An ending and a z, in the reduced problem's terms.
pub(super) struct Outcome {
    pub(super) status: LcpStatus,
    pub(super) z: Vec<f64>,
    pub(super) pivots: usize,
    /// Direction of z and of z0 where the status is a ray.
    pub(super) ray: Option<(Vec<f64>, f64)>,
    /// Multiplications, roughly.
    pub(super) work: f64,
}

impl Outcome {
    /// z = 0 of `size` unknowns.
    pub(super) fn zero(status: LcpStatus, size: usize) -> Self {
        Self { status, z: vec![0.0; size], pivots: 0, ray: None, work: 0.0 }
    }
}

impl From<NoFactor> for LcpStatus {
    fn from(reason: NoFactor) -> Self {
        match reason {
            NoFactor::Singular => Self::Breakdown,
            NoFactor::Interrupted => Self::Interrupted,
        }
    }
}
