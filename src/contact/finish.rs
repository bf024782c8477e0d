//! From solved node forces to a [`Contact`].

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::clues::{Clues, LoadedEdge};
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::accuracy::Accuracy;
use crate::contact::figures::area::beside::Beside;
use crate::contact::figures::area::cells::cells_per_radius;
use crate::contact::figures::area::rim::RimOnEdges;
use crate::contact::figures::area::within_rim::areas_within_rim;
use crate::contact::figures::loaded::LoadedVertices;
use crate::contact::figures::motion::candidates::{CandidateMotion, Drawing};
use crate::contact::figures::penetration::after::penetration_after;
use crate::contact::figures::penetration::at_rest::penetration_between;
use crate::contact::figures::pressure::vertices::VertexPressure;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, ContactMesh, ContactPart, ContactStatus};
use crate::contact::report::record::Report;
use crate::lcp::solution::LcpStatus;
use crate::response::kernel::basis::{Discretization, PressureBasis};
use crate::response::skin::elastic::Traits;

/// What is read off the forces.
struct Figures {
    loaded: LoadedVertices,
    pressure: VertexPressure,
    motion: CandidateMotion,
    max_penetration_after: f64,
    discretization: Discretization,
}

impl Contact {
    /// Skin and obstacle are apart: no forces.
    pub(crate) fn apart(
        gaps: &Gaps,
        traits: &Traits,
        options: &ContactOptions,
        mut report: Report,
    ) -> Result<Self, ContactError> {
        let forces = NodeForces::apart(gaps);
        let mut figures = Figures::at_rest(gaps, traits, &forces);
        figures.max_penetration_after = penetration_between(gaps.surface, &gaps.scene.obstacle)?;
        report.warn_of_unmet(gaps.surface, figures.max_penetration_after);
        report.warn_of_swallowed(gaps)?;
        Ok(Self::new(ContactStatus::NoContact, gaps, forces, figures, options, report))
    }

    /// A complementarity problem did not end solved: no figures but those of the problems that did.
    pub(crate) fn failed(
        ending: LcpStatus,
        gaps: &Gaps,
        forces: NodeForces,
        traits: &Traits,
        options: &ContactOptions,
        report: Report,
    ) -> Self {
        let figures = Figures::at_rest(gaps, traits, &forces);
        Self::new(ContactStatus::Failed(ending), gaps, forces, figures, options, report)
    }

    /// Every complementarity problem solved.
    pub(crate) fn solved(
        gaps: &Gaps,
        forces: NodeForces,
        response: &Compliance,
        options: &ContactOptions,
        mut report: Report,
    ) -> Result<Self, ContactError> {
        let started = Instant::now();
        let traits = &response.traits;
        let (surface, discretization) = (gaps.surface, traits.discretization);
        let motion = CandidateMotion::new(gaps, response, &forces)?;
        report.warn_of_pull(gaps, &forces);
        report.warn_of_steep_sides(gaps, &forces);
        let beside = Beside::new(gaps, response, &forces, &motion)?;
        let left = penetration_after(gaps, &forces, response, &motion, &beside)?;
        report.warn_of_penetration(discretization, gaps.deepest(), &left);
        let at_cuts = report.warn_of_cuts(gaps, response.skin, &forces);
        report.warn_of_unknown(gaps, response.skin, &forces);
        let mut pressure = VertexPressure::new(surface, traits.basis, discretization, &forces);
        let on_edges = RimOnEdges::new(gaps, &forces)?;
        let (motion, obstacle_share) = motion.with_product(response, &forces)?;
        let within_rim = areas_within_rim(gaps, response, obstacle_share, &forces, &beside, &on_edges)?;
        let [body, product] = response.doubts(&forces.active, &forces.active_vectors(), gaps.deepest())?;
        let edge = LoadedEdge::of_obstacle(gaps, &forces);
        let skin_edge = LoadedEdge::of_skin(gaps, &forces);
        report.note_edges(edge.as_ref().map(|edge| edge.ends).or(on_edges.ends), skin_edge.as_ref());
        let is_blunt = |&vertex: &usize| gaps.line_at(vertex).is_some_and(|line| line.faces.is_none());
        let clues = Clues {
            deepest: gaps.deepest_vertex,
            area_within_rim: within_rim.iter().sum(),
            body,
            product,
            at_cuts,
            edge,
            skin_edge,
            ends_at_edges: on_edges.share,
            is_between: forces.active.iter().all(is_blunt),
            is_unsettled: report.is_unsettled || gaps.steep_share.is_some(),
            mean_penetration: left.mean / gaps.deepest(),
            apart: left.apart / gaps.deepest(),
            receding: left.receding,
            unfelt: left.unfelt,
            unmet: left.unmet,
            touched_between: 0,
        };
        // In collocation on a mesh that was given the area is that of its vertices.
        let is_given = discretization == Discretization::Collocation && gaps.scene.inherited.is_none();
        let areas = if is_given { surface.vertex_areas() } else { &within_rim };
        if discretization == Discretization::Galerkin || traits.basis == PressureBasis::OneRing {
            pressure.raise_to_means(surface, &forces, areas);
        }
        let figures = Figures::new(gaps, &forces, pressure, areas, motion, left.depth, discretization);
        report.clock("outcome", started);
        Ok(Self {
            clues,
            obstacle_share,
            ..Self::new(ContactStatus::Solved, gaps, forces, figures, options, report)
        })
    }

    fn new(
        status: ContactStatus,
        gaps: &Gaps,
        forces: NodeForces,
        figures: Figures,
        options: &ContactOptions,
        report: Report,
    ) -> Self {
        let surface = gaps.surface;
        let ContactPart { resultant, patches } = figures.loaded.whole();
        let cells = cells_per_radius(surface, &forces.active, resultant.contact_area);
        let (solutions, spectra) = (&forces.solutions, &forces.spectra);
        let accuracy = Accuracy::new(solutions, spectra, options.tolerance, figures.discretization, cells);
        Self {
            status,
            resultant,
            max_penetration_before: gaps.deepest(),
            max_penetration_after: figures.max_penetration_after,
            obstacle_share: None,
            pressure: figures.pressure.at_vertices,
            node_force: forces.force,
            force_vectors: forces.vectors,
            gap: forces.gap,
            candidates: forces.candidates,
            active: forces.active,
            patches,
            loaded: figures.loaded,
            mesh: ContactMesh::given(surface),
            refinements: report.linearizations,
            obstacle: gaps.scene.obstacle.clone(),
            travel: gaps.scene.travel,
            depth: gaps.scene.press.as_ref().map(|travel| travel.depth),
            lcp_solutions: forces.solutions,
            accuracy,
            timings: report.timings,
            left_out: report.left_out,
            warnings: report.warnings,
            drawing: Drawing {
                fingers: forces.fingers,
                on_product: forces.on_product,
                motion: figures.motion,
            },
            clues: Clues { deepest: gaps.deepest_vertex, ..Clues::default() },
        }
    }
}

impl Figures {
    fn new(
        gaps: &Gaps,
        forces: &NodeForces,
        pressure: VertexPressure,
        areas: &[f64],
        motion: CandidateMotion,
        max_penetration_after: f64,
        discretization: Discretization,
    ) -> Self {
        let surface = gaps.surface;
        let loaded = LoadedVertices::new(surface, forces, &pressure, areas, &motion.of_skin());
        Self { loaded, pressure, motion, max_penetration_after, discretization }
    }

    /// Of a skin that stays where it is.
    fn at_rest(gaps: &Gaps, traits: &Traits, forces: &NodeForces) -> Self {
        let pressure = VertexPressure::new(gaps.surface, traits.basis, traits.discretization, forces);
        let displacement = vec![Vector3::zeros(); forces.candidates.len()];
        let motion = CandidateMotion { displacement, ..CandidateMotion::default() };
        let areas = gaps.surface.vertex_areas();
        Self::new(gaps, forces, pressure, areas, motion, gaps.deepest(), traits.discretization)
    }
}
