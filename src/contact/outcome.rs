//! What a contact returns.

use nalgebra::Vector3;

use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::displacement::Drawing;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// How a contact ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ContactStatus {
    /// Every penetration is resolved.
    Solved,
    /// Skin and obstacle are apart: all results are zero, no problem was posed.
    NoContact,
    /// A complementarity problem did not end solved; never read the numbers as an answer.
    Failed(LcpStatus),
}

impl ContactStatus {
    /// The word for it: `solved`, `no_contact`, or the ending of the complementarity problem.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::NoContact => "no_contact",
            Self::Failed(status) => status.as_str(),
        }
    }
}

/// Resultants of a set of contact nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Resultant {
    /// Force on the skin (N).
    pub force: Vector3<f64>,
    /// Moment on the skin about the origin, at deformed positions (N m).
    pub moment: Vector3<f64>,
    /// Mean of the deformed positions weighted by node force (m); NaN without force.
    pub center_of_pressure: Vector3<f64>,
    /// Sum of the vertex areas with f > 0; in Galerkin form the area within the rim, which the gaps
    /// place between the vertices (m²). Under a sharp edge, where the gap opens with a step, that rim is up to a cell
    /// too far in.
    pub contact_area: f64,
    /// Largest pressure at a vertex; in Galerkin form between vertices too, and never below the mean over the
    /// contact area of a patch (Pa).
    pub max_pressure: f64,
}

/// A connected part of the active set.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Its vertices, ascending.
    pub vertices: Vec<usize>,
    /// Its force, moment, center, area and peak pressure.
    pub resultant: Resultant,
}

/// One thing that the scene did not need.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOut {
    /// What was left out.
    pub what: &'static str,
    /// Why.
    pub why: String,
}

/// Seconds spent in one stage.
#[derive(Debug, Clone, PartialEq)]
pub struct Timing {
    /// `first_touch`, `signed_distance`, `response`, `lcp` or `outcome`.
    pub stage: &'static str,
    /// Wall time (s).
    pub seconds: f64,
}

/// The skin pressed against the obstacle. Arrays are per vertex of the surface (n of them).
#[derive(Debug, Clone)]
pub struct Contact {
    /// How it ended.
    pub status: ContactStatus,
    /// Force, moment, center of pressure, area, peak pressure of the whole contact.
    pub resultant: Resultant,
    /// Deepest penetration of a skin vertex before (m, ≥ 0).
    pub max_penetration_before: f64,
    /// Deepest penetration of a skin vertex after, measured anew at the deformed skin (m, ≥ 0).
    pub max_penetration_after: f64,
    /// Pressure (n, Pa): `f_i / S_i`, with S_i a third of the area of the triangles around the vertex. In Galerkin
    /// form that is right in the mean only, and this is the smooth pressure recovered from it: its sum over
    /// S_i is the force up to the mesh error, below it as the rim's cells count in part.
    pub pressure: Vec<f64>,
    /// Node force along the obstacle's outward normal (n, N).
    pub node_force: Vec<f64>,
    /// The same as vectors: the force on the skin at each vertex (n, N).
    pub force_vectors: Vec<Vector3<f64>>,
    /// Gap: `g0 + R f` on the candidates, `g0` within the search distance, infinite beyond (n, m).
    pub gap: Vec<f64>,
    /// Vertices in the complementarity problem, ascending.
    pub candidates: Vec<usize>,
    /// Vertices with f > 0, ascending.
    pub active: Vec<usize>,
    /// Connected parts of the active set.
    pub patches: Vec<Patch>,
    /// The skin as it was given; [`Contact::drawn_skin`] deforms it.
    pub surface: Surface,
    /// The obstacle where it stands now.
    pub obstacle: Obstacle,
    /// Way of the obstacle along the direction of a press (m); 0 for a contact solved in place.
    pub travel: f64,
    /// One solution for each complementarity problem, with its nodes.
    pub lcp_solutions: Vec<LcpSolution>,
    /// How far the figures can be trusted.
    pub accuracy: Accuracy,
    /// Seconds per stage, in order.
    pub timings: Vec<Timing>,
    /// What the scene did not need, and why.
    pub left_out: Vec<LeftOut>,
    /// What the user should know, in sentences.
    pub warnings: Vec<String>,
    pub(crate) drawing: Drawing,
}

impl Contact {
    /// What happened and what to try, for an ending other than `solved` and `no_contact`; empty for these.
    pub fn advice(&self) -> String {
        match self.status {
            ContactStatus::Failed(status) => self
                .lcp_solutions
                .iter()
                .find(|solution| solution.status == status)
                .map(|solution| solution.advice())
                .unwrap_or_default(),
            _ => String::new(),
        }
    }
}
