//! The search for a depth on one mesh.

use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::in_place::solve_in_place;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::{Contact, ContactStatus, Timing};
use crate::contact::reach::search::{Found, Search, Trial};
use crate::contact::report::record::{Report, add_timings};
use crate::contact::scene::{Approach, Inherited, Scene};
use crate::obstacle::posed::Obstacle;
use crate::response::body::error::BodyError;
use crate::response::error::ResponseError;
use crate::response::kernel::basis::Discretization;
use crate::response::skin::elastic::ElasticSkin;
use crate::surface::checked::Surface;

/// What the contact is to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Quantity {
    /// Force along the direction (N).
    Force,
    /// Deepest penetration of the undeformed skin (m).
    Overlap,
}

/// One mesh of the skin, and the press that is carried out on it.
pub(crate) struct OnMesh<'a> {
    pub surface: &'a Surface,
    pub skin: &'a dyn ElasticSkin,
    /// What a refined mesh takes over from the given one.
    pub inherited: Option<Inherited>,
    pub obstacle: &'a Obstacle,
    /// Direction and start; its depth is not looked at.
    pub press: Approach,
    pub options: &'a ContactOptions<'a>,
    /// Travel at which the press begins, and the depth at which it touches (m).
    pub touch: (f64, f64),
}

/// How the search on one mesh ended: in both cases with a contact.
pub(crate) enum Reached {
    /// With the quantity, and the power of the depth that it rises with there.
    Goal { contact: Contact, power: f64 },
    /// Without: the largest contact below, and why there is no larger one.
    Short { contact: Contact, why: String },
}

impl OnMesh<'_> {
    /// Searches the way past the touch.
    ///
    /// * `search`: lengths past the touch (m), values in N or m
    /// * `largest`: a contact below the goal that is known, for a search that finds none
    pub fn reach(
        &self,
        quantity: Quantity,
        search: &Search,
        largest: Option<Contact>,
    ) -> Result<Reached, ContactError> {
        let mut timings = Vec::new();
        let mut refusal = None;
        let found = search.run(|past| {
            if self.options.is_interrupted() {
                return Err(ContactError::Interrupted { stage: "search for the depth" });
            }
            let tried = match quantity {
                Quantity::Force => self.force(past, &mut timings),
                Quantity::Overlap => self.overlap(past).map(|overlap| Trial::Value(overlap, None)),
            };
            match tried {
                // Deeper than the response knows or memory holds.
                Err(ContactError::Response(error)) if !is_interruption(&error) => {
                    let why = error.to_string();
                    refusal = Some(error);
                    Ok(Trial::Blocked(why))
                }
                other => other,
            }
        })?;
        let (at, contact, end) = match found {
            Found::Close { at, found, power } => (at, found, Ok(power)),
            Found::NotReached { largest: Some((at, found)), why } => (at, found, Err(why)),
            Found::NotReached { largest: None, why } => match (largest, refusal) {
                (Some(contact), _) => return Ok(Reached::Short { contact, why }),
                (None, Some(error)) => return Err(error.into()),
                (None, None) => (0.0, None, Err(why)),
            },
        };
        let mut contact = match contact {
            Some(contact) => contact,
            None => self.solve(at)?,
        };
        // Earlier trials; its own are among them under a force.
        let own = std::mem::take(&mut contact.timings);
        add_timings(&mut timings, &own);
        contact.timings = timings;
        Ok(match end {
            Ok(power) => Reached::Goal { contact, power },
            Err(why) => Reached::Short { contact, why },
        })
    }

    /// The force so far past the touch.
    fn force(&self, past: f64, timings: &mut Vec<Timing>) -> Result<Trial<Option<Contact>>, ContactError> {
        let mut contact = self.solve(past)?;
        add_timings(timings, &std::mem::take(&mut contact.timings));
        Ok(match contact.status {
            ContactStatus::NoContact => Trial::Value(0.0, Some(contact)),
            ContactStatus::Solved => {
                Trial::Value(force_along(&contact, &self.press.direction).max(0.0), Some(contact))
            }
            ContactStatus::Failed(status) => {
                let advice = contact.advice();
                Trial::Blocked(format!("deeper the contact ends with status '{}': {advice}", status.as_str()))
            }
        })
    }

    /// The deepest penetration so far past the touch (m).
    fn overlap(&self, past: f64) -> Result<f64, ContactError> {
        let with_edges = self.skin.traits(self.surface)?.discretization == Discretization::Collocation;
        Ok(Gaps::measure(self.surface, &self.scene(past), self.options.search_distance, with_edges)?
            .deepest())
    }

    /// The contact so far past the touch.
    pub fn solve(&self, past: f64) -> Result<Contact, ContactError> {
        let started = Instant::now();
        let scene = self.scene(past);
        let mut report = Report::default();
        report.clock("first_touch", started);
        solve_in_place(self.surface, &scene, self.skin, self.options, report)
    }

    fn scene(&self, past: f64) -> Scene {
        let (begin, touch) = self.touch;
        let approach = Approach { depth: touch + past, ..self.press };
        let scene = approach.scene(self.surface, self.obstacle, begin);
        Scene { inherited: self.inherited.clone(), ..scene }
    }

    /// Beyond this way past the touch, obstacle and skin are apart again, or no skin is left (m).
    pub fn limit(&self) -> f64 {
        let obstacle = self.obstacle.bounding_box().map_or(0.0, |bounds| bounds.diagonal());
        self.surface.bounding_box().diagonal() + obstacle
    }
}

/// Force on the skin along a direction (N).
pub(crate) fn force_along(contact: &Contact, direction: &Vector3<f64>) -> f64 {
    contact.resultant.force.dot(direction)
}

fn is_interruption(error: &ResponseError) -> bool {
    matches!(error, ResponseError::Interrupted { .. } | ResponseError::Body(BodyError::Interrupted { .. }))
}
