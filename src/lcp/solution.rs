//! How a solve ended and what it found.

use crate::lcp::certificate::Certificate;
use crate::lcp::ray::{LcpRay, RayConclusion};

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LcpStatus {
    /// z and w solve the problem; the certificate passed.
    Solved,
    /// Lemke's path left for infinity along [`LcpSolution::ray`].
    Ray,
    /// The pivot budget was used up.
    PivotLimit,
    /// Rounding errors took over; no answer passed the certificate.
    Breakdown,
    /// The caller's interrupt said stop.
    Interrupted,
}

impl LcpStatus {
    /// The name used in reports and in Python.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Ray => "ray",
            Self::PivotLimit => "pivot_limit",
            Self::Breakdown => "breakdown",
            Self::Interrupted => "interrupted",
        }
    }
}

impl std::fmt::Display for LcpStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// What ran; [`LcpMethod`](crate::lcp::LcpMethod) is what was asked for, with its options.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LcpMethodName {
    /// Lemke's complementary pivoting.
    Lemke,
    /// Block principal pivoting.
    BlockPivoting,
    /// Projected conjugate gradients.
    ProjectedCg,
    /// Whatever suits the problem.
    Auto,
}

impl LcpMethodName {
    /// Every method.
    pub const ALL: [Self; 4] = [Self::Lemke, Self::BlockPivoting, Self::ProjectedCg, Self::Auto];

    /// The name used in reports and in Python.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Lemke => "lemke",
            Self::BlockPivoting => "block_pivoting",
            Self::ProjectedCg => "projected_cg",
            Self::Auto => "auto",
        }
    }
}

impl std::fmt::Display for LcpMethodName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.as_str())
    }
}

/// One method's run within a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LcpAttempt {
    /// What ran.
    pub method: LcpMethodName,
    /// How it ended.
    pub status: LcpStatus,
    /// Basis exchanges of this run (iterations for projected_cg).
    pub pivots: usize,
    /// Where it began.
    pub start: StartingBasis,
}

/// Where a run began.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum StartingBasis {
    /// Nothing, or a guess of the method's own.
    Cold,
    /// The caller's guess of the active set.
    Guess,
    /// A crash basis that block exchanges look for; only a run that they do not solve is followed by others.
    Crash,
}

/// What a solve found; z and w are an answer only where the status is [`LcpStatus::Solved`].
#[derive(Debug, Clone, PartialEq)]
pub struct LcpSolution {
    /// How the solve ended.
    pub status: LcpStatus,
    /// Unknowns (n), never negative; what is zero to rounding is zero. All zero where z or w would not be finite.
    pub z: Vec<f64>,
    /// `M z + q` (n) as recomputed from the M and q given.
    pub w: Vec<f64>,
    /// Basis exchanges of every run together.
    pub pivots: usize,
    /// The method that gave this ending.
    pub method: LcpMethodName,
    /// Measures against the M and q given.
    pub certificate: Certificate,
    /// Where the path left for, when it did.
    pub ray: Option<LcpRay>,
    /// Every run, in order.
    pub attempts: Vec<LcpAttempt>,
    /// Number of unknowns that the method looked at; the others can stay at zero.
    pub candidates: usize,
}

impl LcpSolution {
    /// Unknowns with `z > 0`, ascending.
    pub fn active(&self) -> Vec<usize> {
        (0..self.z.len()).filter(|&i| self.z[i] > 0.0).collect()
    }

    /// What happened, why that usually is, and what to try.
    pub fn advice(&self) -> String {
        let remedy = match (self.status, self.method) {
            (LcpStatus::Solved | LcpStatus::Interrupted, _) => return self.ending(),
            (LcpStatus::Ray, _) if self.is_infeasible() => "no method solves it: look at M and q again",
            (LcpStatus::Ray, _) => "try `method=\"auto\"`, another covering vector or an initial active set",
            (LcpStatus::PivotLimit, _) => {
                "raise `max_pivots`, start from an initial active set, or try `method=\"auto\"`"
            }
            (LcpStatus::Breakdown, LcpMethodName::ProjectedCg) => {
                "use `method=\"lemke\"` or `method=\"auto\"`"
            }
            (LcpStatus::Breakdown, LcpMethodName::BlockPivoting) => {
                "use `method=\"lemke\"` or `method=\"auto\"`, or merge unknowns that are one"
            }
            (LcpStatus::Breakdown, _) => "merge unknowns that are one, or accept less by raising `tolerance`",
        };
        format!("{}: {remedy}", self.ending())
    }

    fn is_infeasible(&self) -> bool {
        self.ray.as_ref().is_some_and(|ray| ray.conclusion == RayConclusion::Infeasible)
    }

    /// What happened, and why that usually is.
    pub fn ending(&self) -> String {
        let residual = self.certificate.natural_residual;
        match self.status {
            LcpStatus::Solved => {
                let unique = if self.certificate.is_unique() { "; it is the only solution" } else { "" };
                format!("solved: the natural residual is {residual:.1e} of max(-q){unique}")
            }
            LcpStatus::Ray => {
                let meaning = match self.ray.as_ref().map(|ray| ray.conclusion) {
                    Some(RayConclusion::Infeasible) => {
                        "along it no z >= 0 can make M z + q >= 0, so the problem has no solution. Usually M has \
                         rows without enough positive entries for the negative q, by the signs of M and q"
                    }
                    Some(RayConclusion::InfeasibleToRounding) => {
                        "up to rounding, along it no z >= 0 can make M z + q >= 0: a solution, if there is one, is \
                         huge. Usually M is singular, or has rows without enough positive entries for the negative q"
                    }
                    Some(RayConclusion::NotCopositive) => {
                        "it shows a z >= 0 with z·Mz < 0, so M is not copositive: there may be no solution, one or \
                         several, and Lemke's method cannot tell"
                    }
                    _ => {
                        "it proves nothing about M beyond that Lemke's method cannot process it with this covering \
                         vector"
                    }
                };
                format!("ray: after {} pivots the path left for infinity; {meaning}", self.pivots)
            }
            LcpStatus::PivotLimit => format!(
                "pivot_limit: {} pivots were not enough; usual are about as many as unknowns above zero",
                self.pivots
            ),
            LcpStatus::Breakdown => {
                let what = match self.method {
                    LcpMethodName::ProjectedCg => {
                        "conjugate gradients stalled or met a direction without curvature; usually M is not positive \
                         definite, or so unlike a contact's that unknowns are let in and cut off in turns"
                    }
                    LcpMethodName::BlockPivoting => {
                        "an active block had no usable factor; usually M is singular or no P-matrix"
                    }
                    _ => "rounding errors took over; usually M is nearly singular on the active set",
                };
                format!("breakdown: {what}. The natural residual is {residual:.1e} of max(-q)")
            }
            LcpStatus::Interrupted => {
                format!("interrupted: the caller stopped the solve after {} pivots", self.pivots)
            }
        }
    }
}
