//! The contact of a skin with an obstacle at a given place, on one mesh.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::candidate::watched::watched;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::equilibrium::group::{Guess, Nearness};
use crate::contact::equilibrium::linearization::solve_to_the_end;
use crate::contact::equilibrium::solve as equilibrium;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, Timing};
use crate::contact::report::record::Report;
use crate::contact::scene::Scene;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// What a contact nearby takes over.
#[derive(Debug)]
pub(crate) struct Known {
    /// Vertices under force, ascending.
    active: Vec<usize>,
    /// Vertices whose gap was linearized, and the displacements (m) that it was measured at.
    vertices: Vec<usize>,
    displacement: Vec<Vector3<f64>>,
    /// Whether linearized gaps led to no better answer.
    in_vain: bool,
    /// [`Gaps::steep_share`].
    steep_share: Option<f64>,
}

/// Node forces where the obstacle of a scene stands.
pub(crate) struct InPlace<'a> {
    gaps: Gaps<'a>,
    response: Compliance<'a>,
    /// `None`: apart.
    forces: Option<NodeForces>,
    report: Report,
}

/// Solves the contact where the obstacle of `scene` stands.
pub(crate) fn solve_in_place(
    surface: &Surface,
    scene: &Scene,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
    mut report: Report,
) -> Result<Contact, ContactError> {
    let gaps = InPlace::gaps(surface, scene, options, &mut report)?;
    InPlace::solve(gaps, skin, None, options, report)?.contact(options)
}

impl Known {
    /// Vertices that are expected to carry force, ascending, and nothing else.
    pub fn of_active(active: Vec<usize>) -> Self {
        Self { active, vertices: Vec::new(), displacement: Vec::new(), in_vain: false, steep_share: None }
    }

    /// The same, with the displacement (m) that the gap of each vertex was linearized at, where it was.
    ///
    /// * `steep_share`: [`Gaps::steep_share`]
    pub fn linearized(active: Vec<usize>, at: Vec<Option<Vector3<f64>>>, steep_share: Option<f64>) -> Self {
        let (vertices, displacement) =
            at.into_iter().enumerate().filter_map(|(vertex, at)| Some((vertex, at?))).unzip();
        Self { active, vertices, displacement, in_vain: false, steep_share }
    }

    /// Vertices whose gap was linearized, each with the displacement (m) that it was measured at.
    pub fn into_linearized(self) -> impl Iterator<Item = (usize, Vector3<f64>)> {
        self.vertices.into_iter().zip(self.displacement)
    }
}

impl<'a> InPlace<'a> {
    /// 1. Gaps; back along the press where the skin came in through another side.
    pub fn gaps(
        surface: &'a Surface,
        scene: &'a Scene,
        options: &ContactOptions<'a>,
        report: &mut Report,
    ) -> Result<Gaps<'a>, ContactError> {
        if !surface.skin_mask().contains(&true) {
            return Err(ContactError::NoSkin { vertex_count: surface.vertices().len() });
        }
        let started = Instant::now();
        let gaps = Gaps::measure(surface, scene, options.search_distance)?;
        report.clock("signed_distance", started);
        report.note_gaps(&gaps);
        report.warn_of_walls(&gaps);
        Ok(gaps)
    }

    /// Finds the node forces that close the [gaps](Self::gaps).
    ///
    /// * `known`: of a contact with the obstacle close by, on the same mesh
    pub fn solve(
        mut gaps: Gaps<'a>,
        skin: &'a dyn ElasticSkin,
        known: Option<&Known>,
        options: &ContactOptions<'a>,
        mut report: Report,
    ) -> Result<Self, ContactError> {
        let traits = skin.traits(gaps.surface)?;

        // 2-4. Candidates, response, complementarity.
        let response = Compliance::new(gaps.surface, skin, traits, options);
        if gaps.penetrating.is_empty() {
            return Ok(Self { gaps, response, forces: None, report });
        }
        let response = response.with_product(&gaps)?;
        skin.expect(watched(&gaps));
        if let Some(known) = known {
            gaps.steep_share = known.steep_share;
            // The plane to an edge or a line of the obstacle stays.
            let pairs = known.vertices.iter().zip(&known.displacement);
            let (vertices, displacement): (Vec<usize>, Vec<Vector3<f64>>) =
                pairs.filter(|(vertex, _)| gaps.line_at(**vertex).is_none()).unzip();
            let there = gaps.measured_at(&vertices, &displacement)?;
            gaps.linearize(&vertices, &displacement, &there);
        }
        let guess = known.map(|known| {
            let is_refined = gaps.scene.inherited.is_some();
            let nearness = if is_refined { Nearness::OfCoarser } else { Nearness::Any };
            Guess { active: &known.active, nearness, fingers: None }
        });
        let forces = equilibrium::solve(&gaps, &response, guess, options, &mut report)?;
        let was_vain = known.is_some_and(|known| known.in_vain);
        let forces = solve_to_the_end(&mut gaps, forces, &response, was_vain, options, &mut report)?;
        Ok(Self { gaps, response, forces: Some(forces), report })
    }

    /// Forces on the skin at its vertices; `None` where it is apart from the obstacle.
    pub fn forces(&self) -> Option<&NodeForces> {
        self.forces.as_ref()
    }

    /// [`Gaps::steep_share`].
    pub fn steep_share(&self) -> Option<f64> {
        self.gaps.steep_share
    }

    /// What a contact nearby can take over; nothing where this one is apart or failed.
    pub fn known(&self) -> Option<Known> {
        let forces = self.forces.as_ref().filter(|forces| forces.failure.is_none())?;
        let mut vertices = self.gaps.surface.k_ring(&forces.candidates, 1);
        vertices.retain(|&vertex| self.gaps.linearized_at(vertex) != Vector3::zeros());
        let displacement = vertices.iter().map(|&vertex| self.gaps.linearized_at(vertex)).collect();
        let in_vain = self.report.is_unsettled;
        Some(Known {
            active: forces.active.clone(),
            vertices,
            displacement,
            in_vain,
            steep_share: self.gaps.steep_share,
        })
    }

    /// Seconds of each stage so far.
    pub fn timings(&self) -> &[Timing] {
        &self.report.timings
    }

    /// 5-6. Figures; the drawn skin when somebody asks.
    pub fn contact(self, options: &ContactOptions) -> Result<Contact, ContactError> {
        let Self { gaps, response, forces, mut report } = self;
        let Some(forces) = forces else {
            return Contact::apart(&gaps, &response.traits, options, report);
        };
        report.note_forces(&gaps, &response, &forces, options);
        match forces.failure {
            Some(ending) => Ok(Contact::failed(ending, &gaps, forces, &response.traits, options, report)),
            None => Contact::solved(&gaps, forces, &response, options, report),
        }
    }
}
