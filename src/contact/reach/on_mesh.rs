//! The search for a depth on one mesh.

use std::sync::Arc;
use std::time::Instant;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::in_place::{InPlace, Known, solve_in_place};
use crate::contact::outcome::{Contact, ContactStatus, Timing};
use crate::contact::reach::search::{Found, Search, Trial};
use crate::contact::reach::target::{Quantity, Target};
use crate::contact::refine::meshes::Meshes;
use crate::contact::report::advice::advice;
use crate::contact::report::digits::{Digits, Given};
use crate::contact::report::record::{Report, add_timings};
use crate::contact::report::warning::WarningKind;
use crate::contact::scene::{Approach, Inherited, Scene, Touch};
use crate::contact::setup::Setup;
use crate::contact::tilt::axes::Turn;
use crate::lcp::solution::{LcpSolution, LcpStatus};
use crate::response::skin::elastic::ElasticSkin;
use crate::response::skin::kept::KeptSkin;
use crate::surface::refined::RefinedSurface;

/// Share of the promised tolerance to which a value is found where more is to follow from it.
const CLOSE: f64 = 0.1;
/// Why no depth has a value, where none of those tried stays near it.
pub(crate) const JUMPS: &str = "it jumps there from depth to depth";

/// One mesh of the skin, and the press that is carried out on it.
pub(crate) struct OnMesh<'a> {
    /// With the surface and the skin of this mesh.
    pub setup: Setup<'a>,
    /// What a refined mesh takes over from the given one.
    pub inherited: Option<Arc<Inherited>>,
    pub touch: Touch,
    /// How long it took to find that (s).
    pub touched_in: f64,
}

/// How the search on one mesh ended: in both cases with a contact.
pub(crate) enum Reached {
    /// With the quantity, and the power of the depth that it rises with there.
    Goal { contact: Contact, power: f64 },
    /// Without: the largest contact below, the least way past the touch (m) with one above, and why there is none between.
    Short { contact: Contact, above: Option<f64>, why: String },
}

/// What the trials of a search take over from each other.
pub(crate) struct Trials<'a> {
    skin: &'a dyn ElasticSkin,
    /// Of the last one in contact.
    pub known: Option<Known>,
    /// What all of them took.
    pub timings: Vec<Timing>,
    /// Overlap of skin and obstacle beyond which none is of use (m).
    pub deepest: f64,
    refusal: Option<ContactError>,
}

impl<'a> Trials<'a> {
    /// * `known`: what the first trial begins from
    pub fn new(skin: &'a dyn ElasticSkin, known: Option<Known>) -> Self {
        Self { skin, known, timings: Vec::new(), deepest: f64::INFINITY, refusal: None }
    }
}

impl<'a> OnMesh<'a> {
    /// The press on the given mesh.
    pub fn given(setup: Setup<'a>) -> Result<Self, ContactError> {
        let started = Instant::now();
        setup.approach.check_start(setup.surface, setup.obstacle)?;
        let touch = setup.approach.touch(setup.surface, setup.obstacle)?;
        Ok(Self { setup, inherited: None, touch, touched_in: started.elapsed().as_secs_f64() })
    }

    /// The press on a mesh that the given one was refined to.
    ///
    /// * `setup`: on the given mesh
    /// * `skin`: of the refined one, as [`Setup::refined_skin`] gives it
    pub fn refined(
        setup: Setup<'a>,
        meshes: &Meshes,
        part: &'a RefinedSurface,
        skin: &'a dyn ElasticSkin,
    ) -> Result<Self, ContactError> {
        let started = Instant::now();
        let touch = setup.approach.touch(&part.surface, setup.obstacle)?;
        let touched_in = started.elapsed().as_secs_f64();
        let inherited = Some(meshes.inherited_by(part, setup.skin));
        Ok(Self { setup: Setup { surface: &part.surface, skin, ..setup }, inherited, touch, touched_in })
    }
}

impl OnMesh<'_> {
    /// Searches the way past the touch.
    ///
    /// The contact found is solved as any other at its depth would be on the given mesh, so that a press to that depth
    /// gives it to the bit; on a refined mesh it takes over what the search knows.
    ///
    /// * `search`: lengths past the touch (m), values in N or m
    /// * `known`: what the first trial takes over
    /// * `last`: a contact on this mesh; the answer where it is below the goal and none nearer is found
    pub fn reach(
        &self,
        quantity: Quantity,
        search: &Search,
        known: Option<Known>,
        last: Option<&Contact>,
    ) -> Result<Reached, ContactError> {
        let is_kept = self.setup.skin.kept_factors().is_some();
        let kept = (!is_kept).then(|| KeptSkin::new(self.setup.skin));
        let skin = kept.as_ref().map_or(self.setup.skin, |kept| kept);
        let mut trials = Trials::new(skin, known);
        self.add_first_touch(&mut trials.timings);
        let found = search.run(|past| self.trial(quantity, past, &mut trials))?;
        let (at, end) = match found {
            Found::Close { at, power } => (at, Ok(power)),
            Found::NotReached { largest: Some(at), above, why } => (at, Err((above, why))),
            Found::NotReached { largest: None, above, why } => match (last, trials.refusal.take()) {
                (Some(contact), _) if quantity.of(contact, &self.setup.approach.direction) < search.value => {
                    let contact = Contact { timings: trials.timings, ..contact.clone() };
                    return Ok(Reached::Short { contact, above, why });
                }
                (_, Some(error)) => return Err(error),
                (_, None) => (0.0, Err((above, why))),
            },
        };
        let is_refined = self.inherited.is_some();
        let mut contact = if is_refined { self.solve_with(at, &mut trials)? } else { self.solve(at)? };
        add_timings(&mut contact.timings, &trials.timings);
        match end {
            Ok(power) => {
                let value = quantity.of(&contact, &self.setup.approach.direction);
                let most = if is_refined { Search::UNEVENNESS } else { Search::TOLERANCE };
                let is_close = (value / search.value - 1.0).abs() <= most;
                if is_close || matches!(contact.status, ContactStatus::Failed(_)) {
                    self.warn_of_jump(quantity, search.value, &mut contact);
                    return Ok(Reached::Goal { contact, power });
                }
                if is_refined {
                    return Ok(Reached::Short { contact, above: None, why: JUMPS.into() });
                }
                self.reach_exactly(quantity, &Search { known: Some((at, value)), power, ..*search }, contact)
            }
            Err((above, why)) => Ok(Reached::Short { contact, above, why }),
        }
    }

    /// Searches on with contacts that take over nothing, where these differ too much from those that do.
    ///
    /// * `near`: a contact near the goal
    fn reach_exactly(
        &self,
        quantity: Quantity,
        search: &Search,
        near: Contact,
    ) -> Result<Reached, ContactError> {
        let mut timings = near.timings.clone();
        let mut best = near;
        let off = |contact: &Contact| {
            (quantity.of(contact, &self.setup.approach.direction) / search.value - 1.0).abs()
        };
        search.run(|past| -> Result<_, ContactError> {
            self.setup.options.check_interrupt("search for the depth")?;
            let contact = match self.solve(past) {
                Err(error) if error.is_of_deeper() => return Ok(Trial::Blocked(error.to_string())),
                other => other?,
            };
            add_timings(&mut timings, &contact.timings);
            if let ContactStatus::Failed(status) = contact.status {
                return Ok(blocked(status, &contact.lcp_solutions));
            }
            let value = quantity.of(&contact, &self.setup.approach.direction).max(0.0);
            if off(&contact) < off(&best) {
                best = contact;
            }
            Ok(Trial::Value(value))
        })?;
        best.timings = timings;
        self.warn_of_jump(quantity, search.value, &mut best);
        Ok(Reached::Goal { contact: best, power: search.power })
    }

    /// Warns where the contact changes by jumps around the goal.
    pub fn warn_of_jump(&self, quantity: Quantity, value: f64, contact: &mut Contact) {
        let found = quantity.of(contact, &self.setup.approach.direction);
        if (found / value - 1.0).abs() > Search::TOLERANCE {
            let (name, unit) = quantity.name_and_unit();
            let message = format!(
                "the {name} jumps there as the depth rises, and {} {unit} is the nearest to {} {unit} that was found: a smaller `gap_tolerance` makes the jumps smaller",
                Digits(found, 7),
                Given(value)
            );
            contact.warn(WarningKind::Refinement, message);
        }
    }

    /// The quantity so far past the touch.
    fn trial(&self, quantity: Quantity, past: f64, trials: &mut Trials) -> Result<Trial, ContactError> {
        self.setup.options.check_interrupt("search for the depth")?;
        let tried = match quantity {
            Quantity::Force => self.force(past, trials),
            Quantity::Overlap => self.overlap(past, trials).map(Trial::Value),
        };
        match tried {
            Err(error) if error.is_of_deeper() => {
                let why = error.to_string();
                trials.refusal = Some(error);
                Ok(Trial::Blocked(why))
            }
            other => other,
        }
    }

    /// The force so far past the touch.
    fn force(&self, past: f64, trials: &mut Trials) -> Result<Trial, ContactError> {
        let scene = self.scene(past);
        let Some(solved) = self.in_place(&scene, trials)? else {
            return Ok(Trial::Blocked("deeper skin and product overlap by more than is of use".into()));
        };
        add_timings(&mut trials.timings, solved.timings());
        let Some(forces) = solved.forces() else { return Ok(Trial::Value(0.0)) };
        match forces.failure {
            None => {
                trials.known = solved.known();
                let total: Vector3<f64> = forces.active_vectors().iter().sum();
                Ok(Trial::Value(total.dot(&self.setup.approach.direction).max(0.0)))
            }
            Some(status) => Ok(blocked(status, &forces.solutions)),
        }
    }

    /// `None` where skin and obstacle overlap by more than is of use.
    fn in_place<'b>(
        &'b self,
        scene: &'b Scene,
        trials: &Trials<'b>,
    ) -> Result<Option<InPlace<'b>>, ContactError> {
        let Setup { surface, options, .. } = self.setup;
        let mut report = Report::default();
        let gaps = InPlace::gaps(surface, scene, options, &mut report)?;
        if gaps.deepest() > trials.deepest {
            return Ok(None);
        }
        InPlace::solve(gaps, trials.skin, trials.known.as_ref(), options, report).map(Some)
    }

    /// The contact so far past the touch, with what trials before it know.
    pub fn solve_with(&self, past: f64, trials: &mut Trials) -> Result<Contact, ContactError> {
        Ok(self.solve_within(past, trials)?.expect("any overlap is of use"))
    }

    /// The same; `None` where skin and obstacle overlap by more than is of use.
    pub fn solve_within(&self, past: f64, trials: &mut Trials) -> Result<Option<Contact>, ContactError> {
        let scene = self.scene(past);
        let Some(solved) = self.in_place(&scene, trials)? else { return Ok(None) };
        if let Some(known) = solved.known() {
            trials.known = Some(known);
        }
        solved.contact(self.setup.options).map(Some)
    }

    /// The deepest penetration so far past the touch (m).
    fn overlap(&self, past: f64, trials: &mut Trials) -> Result<f64, ContactError> {
        let Setup { surface, options, .. } = self.setup;
        let mut report = Report::default();
        let deepest = InPlace::gaps(surface, &self.scene(past), options, &mut report)?.deepest();
        add_timings(&mut trials.timings, &report.timings);
        Ok(deepest)
    }

    /// The way past the touch to a value (m); `None` where it is not reached.
    ///
    /// * `begins`: the way at which the quantity may be taken to begin to rise (m)
    /// * `first`: way past that which is tried first (m)
    pub fn past_at(
        &self,
        target: Target,
        begins: f64,
        first: f64,
        trials: &mut Trials,
    ) -> Result<Option<f64>, ContactError> {
        let search = Search { tolerance: CLOSE * Search::TOLERANCE, ..self.setup.search(target, first) };
        match search.run(|past| self.trial(target.quantity, begins + past, trials))? {
            Found::Close { at, .. } => Ok(Some(begins + at)),
            Found::NotReached { .. } => Ok(None),
        }
    }

    /// The same with the obstacle turned; `None` where it never touches so.
    pub fn turned(&self, turn: Turn) -> Result<Option<OnMesh<'_>>, ContactError> {
        let Setup { surface, obstacle, .. } = self.setup;
        let approach = Approach { turn: Some(turn), ..self.setup.approach };
        let touch = approach.turned_touch(self.touch, surface, obstacle)?;
        let (setup, inherited) = (Setup { approach, ..self.setup }, self.inherited.clone());
        Ok(touch.map(|touch| OnMesh { setup, inherited, touch, touched_in: 0.0 }))
    }

    /// The contact so far past the touch.
    pub fn solve(&self, past: f64) -> Result<Contact, ContactError> {
        let Setup { surface, skin, options, .. } = self.setup;
        solve_in_place(surface, &self.scene(past), skin, options, Report::default())
    }

    /// Adds the time that the first touch took, which serves all presses on this mesh.
    pub fn add_first_touch(&self, timings: &mut Vec<Timing>) {
        add_timings(timings, &[Timing { stage: "first_touch", seconds: self.touched_in }]);
    }

    fn scene(&self, past: f64) -> Scene {
        let Setup { surface, obstacle, approach, .. } = self.setup;
        let scene = approach.scene(self.touch.depth + past, surface, obstacle, self.touch);
        Scene { inherited: self.inherited.clone(), ..scene }
    }
}

/// A trial whose complementarity problems did not end solved.
fn blocked(status: LcpStatus, solutions: &[LcpSolution]) -> Trial {
    Trial::Blocked(format!("deeper it does not end solved: {}", advice(status, solutions)))
}
