//! What a contact returns.

use std::sync::OnceLock;

use nalgebra::Vector3;

use crate::contact::clues::Clues;
use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::loaded::LoadedVertices;
use crate::contact::figures::motion::candidates::Drawing;
use crate::contact::report::advice::advice;
use crate::contact::report::warning::Warning;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;
use crate::surface::refined::{MeshRefinement, RefinedSurface};

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
    /// In collocation on the mesh as given the sum of the vertex areas with f > 0; on a refined mesh, and in Galerkin form
    /// on any, the area within the rim, which the gaps beside it and sharp edges of the product place between the
    /// vertices (m²).
    pub contact_area: f64,
    /// Largest pressure at a vertex; in Galerkin form between vertices too. There and with one-rings, never below the
    /// mean over the contact area of a patch (Pa).
    pub max_pressure: f64,
    /// Largest mean pressure over a disc of 1 cm² around a vertex, of these vertices alone
    /// ([`Contact::mean_pressure`], Pa).
    pub mean_pressure: f64,
}

/// A connected part of the active set.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Its vertices, ascending.
    pub vertices: Vec<usize>,
    /// Its force, moment, center, area and peak pressure.
    pub resultant: Resultant,
}

/// What some vertices carry of a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPart {
    /// Their force, moment, center, area and pressures.
    pub resultant: Resultant,
    /// The contact's patches as far as they lie on these vertices.
    pub patches: Vec<Patch>,
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
    /// `first_touch`, `signed_distance`, `response`, `lcp` or `outcome`; `refinement` is what its rounds take beside these.
    pub stage: &'static str,
    /// Wall time (s).
    pub seconds: f64,
}

/// What an entry of [`Contact::refinements`] is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefinementKind {
    /// A mesh, solved to the end.
    Mesh,
    /// One linear problem on the way there: gaps and normals taken anew at the deformed skin.
    Linearization,
}

impl RefinementKind {
    /// The word for it: `mesh` or `linearization`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Linearization => "linearization",
        }
    }
}

/// Why no finer mesh followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefinementEnd {
    /// The target is met.
    Target,
    /// A finer mesh would have too many contact nodes.
    MaxNodes,
    /// A finer mesh would take too much memory.
    MemoryLimit,
    /// The contact is on a sharp edge, and as fine as it gets there.
    SharpEdge,
    /// A finer mesh would have triangles smaller than those that the product's matrix is given on.
    ProductMesh,
    /// Force or area goes on changing.
    Unsettled,
    /// Gaps go on changing from one linear problem to the next.
    UnsettledGaps,
    /// There is no force to refine the mesh under.
    NoForce,
    /// On a finer mesh nothing carries force any more.
    ForceLost,
    /// There were as many rounds as there may be.
    MostRounds,
    /// A complementarity problem did not end solved.
    NotSolved,
    /// One did not on a finer mesh, of more nodes than can be pivoted one by one.
    NotSolvedOnFiner,
    /// No target was given.
    NoTarget,
    /// The response has no other mesh.
    Response,
}

impl RefinementEnd {
    /// The words for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Target => "target_error",
            Self::MaxNodes => "max_nodes",
            Self::MemoryLimit => "memory_limit",
            Self::SharpEdge => "a sharp edge",
            Self::ProductMesh => "the mesh of the product's matrix",
            Self::Unsettled => "force or area does not settle",
            Self::UnsettledGaps => "gaps that do not settle",
            Self::NoForce => "nothing carries force",
            Self::ForceLost => "no force on a finer mesh",
            Self::MostRounds => "the most rounds",
            Self::NotSolved => "a complementarity problem did not end solved",
            Self::NotSolvedOnFiner => "a problem of many nodes that block exchanges do not end",
            Self::NoTarget => "the mesh was taken as it is",
            Self::Response => "the response takes the mesh as it is",
        }
    }
}

/// What one mesh gave, or one linear problem on the way there.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Which of the two.
    pub kind: RefinementKind,
    /// Contact nodes: unknowns of the complementarity problems.
    pub nodes: usize,
    /// Force on the skin (N).
    pub force: Vector3<f64>,
    /// Contact area (m²); `None` of a linearization.
    pub contact_area: Option<f64>,
    /// Largest pressure (Pa); `None` of a linearization.
    pub max_pressure: Option<f64>,
    /// Estimated relative error of the force; `None` of a linearization and without contact.
    pub force_error: Option<f64>,
    /// Estimated relative error of the contact area; `None` of a linearization and without contact.
    pub area_error: Option<f64>,
    /// Deepest penetration left (m); of a linearization the largest gap of a vertex under force or penetration of
    /// another, in Galerkin form the largest change of a node's averaged gap.
    pub max_penetration: f64,
    /// Wall time (s).
    pub seconds: f64,
    /// Why no further round followed; `None` of all but the last.
    pub end: Option<RefinementEnd>,
}

/// The mesh that a contact was solved on.
#[derive(Debug, Clone)]
pub(crate) struct ContactMesh {
    given: Surface,
    refinement: Option<MeshRefinement>,
    /// Built when somebody asks.
    whole: OnceLock<RefinedSurface>,
}

impl ContactMesh {
    pub fn given(surface: &Surface) -> Self {
        Self { given: surface.clone(), refinement: None, whole: OnceLock::new() }
    }

    pub fn refined(mesh: MeshRefinement) -> Self {
        Self { given: mesh.given().clone(), refinement: Some(mesh), whole: OnceLock::new() }
    }
}

/// The skin pressed against the obstacle. Arrays are per vertex of the surface (n of them).
#[derive(Debug, Clone)]
pub struct Contact {
    /// How it ended.
    pub status: ContactStatus,
    /// Force, moment, center of pressure, area, peak pressure of the whole contact.
    pub resultant: Resultant,
    /// Deepest penetration of a skin vertex before (m, ≥ 0), to the plane through an edge or a bump of the obstacle where that
    /// stands in a triangle of it.
    pub max_penetration_before: f64,
    /// Deepest penetration after, measured anew at the deformed skin against the deformed product, in the skin's triangles
    /// and of the product's sharp edges too (m, ≥ 0).
    pub max_penetration_after: f64,
    /// The product's share of what skin and product give way together, `-f·u_P / f·(u_H - u_P)` with forces and
    /// displacements along the obstacle's normals: 0 of a rigid product; `None` without contact.
    pub obstacle_share: Option<f64>,
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
    pub(crate) mesh: ContactMesh,
    /// The obstacle where it stands now.
    pub obstacle: Obstacle,
    /// Way of the obstacle along the direction of a press (m); 0 for a contact solved in place.
    pub travel: f64,
    /// Depth of a press (m): travel past the first touch, or past the position that it began at; `None` for a contact
    /// solved in place.
    pub depth: Option<f64>,
    /// One solution for each complementarity problem, with its nodes.
    pub lcp_solutions: Vec<LcpSolution>,
    /// One entry a mesh that was solved, or a linear problem on the way there, in order.
    pub refinements: Vec<Refinement>,
    /// How far the figures can be trusted.
    pub accuracy: Accuracy,
    /// Seconds per stage, in order.
    pub timings: Vec<Timing>,
    /// What the scene did not need, and why.
    pub left_out: Vec<LeftOut>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// What the figures of any of its vertices are summed from.
    pub(crate) loaded: LoadedVertices,
    pub(crate) drawing: Drawing,
    pub(crate) clues: Clues,
}

impl Contact {
    /// The skin's mesh that was solved, undeformed: the given one, or one refined around the contact.
    pub fn surface(&self) -> &Surface {
        self.refined_surface().map_or(&self.mesh.given, |whole| &whole.surface)
    }

    /// The refined mesh, with where its vertices come from; `None` where nothing was refined.
    pub fn refined_surface(&self) -> Option<&RefinedSurface> {
        let refinement = self.mesh.refinement.as_ref()?;
        Some(self.mesh.whole.get_or_init(|| refinement.whole()))
    }

    /// The depth of a press (m).
    pub(crate) fn pressed_depth(&self) -> f64 {
        self.depth.expect("a press has a depth")
    }

    /// The two vertices that each added one lies between, in the order of the added ones.
    pub fn parents(&self) -> Vec<[usize; 2]> {
        self.mesh.refinement.as_ref().map_or_else(Vec::new, MeshRefinement::parents)
    }

    /// Number of vertices that belong to the given mesh; they come first.
    pub fn given_vertex_count(&self) -> usize {
        self.mesh.given.vertices().len()
    }

    /// What happened and what to try, for an ending other than `solved` and `no_contact`; empty for these.
    pub fn advice(&self) -> String {
        match self.status {
            ContactStatus::Failed(status) => advice(status, &self.lcp_solutions),
            _ => String::new(),
        }
    }
}
