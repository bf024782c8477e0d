//! Presses one after the other.

use std::sync::Arc;
use std::time::Instant;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::error::ContactError;
use crate::contact::gap::initial::Gaps;
use crate::contact::in_place::Known;
use crate::contact::options::{ContactOptions, with_threads};
use crate::contact::outcome::{Contact, ContactStatus, RefinementEnd};
use crate::contact::press::{press, unit_direction};
use crate::contact::reach::goal::{reach, reach_on};
use crate::contact::reach::on_mesh::{OnMesh, Reached, Trials};
use crate::contact::reach::on_refined::FARTHEST_MOVE;
use crate::contact::reach::target::{Aim, Target};
use crate::contact::refine::mark::{faces_near, loaded, pressed_between, touched_between};
use crate::contact::refine::meshes::Meshes;
use crate::contact::refine::rounds::{Begun, begin};
use crate::contact::report::guards::Guarded;
use crate::contact::report::record::add_timings;
use crate::contact::scene::{Approach, Press, Touch};
use crate::contact::setup::Setup;
use crate::contact::solve::on_given_mesh;
use crate::contact::tilt::axes::Balance;
use crate::contact::warm::mesh::{RefinedFor, WarmMesh};
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::ElasticSkin;
use crate::response::skin::kept::KeptSkin;
use crate::surface::checked::Surface;

/// Mean edges of the given mesh that an obstacle may come farther until faces may be reached that are not taken in.
const FARTHEST_KNOWN: f64 = 0.75;
/// Most times that a mesh is changed for one press.
const MOST_CHANGES: usize = 6;
/// What a press leaves to the next one of the same obstacle against the same skin, along the same direction and with the
/// same options.
#[derive(Default)]
pub struct WarmStart(Option<WarmMesh>);

/// As [`press`], from what a press before leaves, if `before` holds anything.
///
/// On the mesh of that press, which is cut where skin comes under force; the figures are those of [`press`] within the
/// estimates of their errors. A tilt and a mesh taken as it is begin anew.
///
/// # Errors
/// As [`press`]; nothing is left for the next one then.
pub fn press_after(
    surface: &Surface,
    obstacle: &Obstacle,
    skin: &dyn ElasticSkin,
    asked: &Press,
    options: &ContactOptions,
    before: &mut WarmStart,
) -> Result<Contact, ContactError> {
    let warm = before.0.take();
    let is_plain = asked.balance == Balance::None && options.target_error.is_some();
    let aim = match asked.goal.aim() {
        Ok(aim) if is_plain => aim,
        _ => return press(surface, obstacle, skin, asked, options),
    };
    options.validate()?;
    let approach = Approach::new(unit_direction(&asked.direction)?, asked.start);
    let setup = Setup { surface, obstacle, skin, options, approach };
    let guarded = Guarded { surface, obstacle, skin, press: Some(asked) };
    with_threads(options, || {
        guarded.check(setup.answer(aim, warm).map(|(contact, warm)| {
            before.0 = warm;
            contact
        }))
    })
}

impl Setup<'_> {
    /// The contact, from what a press before leaves where that serves, with what it leaves itself.
    fn answer(&self, aim: Aim, warm: Option<WarmMesh>) -> Result<(Contact, Option<WarmMesh>), ContactError> {
        if let Some(warm) = warm
            && let Some((contact, warm)) = self.go_on(aim, warm)?
        {
            return Ok((contact, Some(warm)));
        }
        let started = Instant::now();
        match aim {
            Aim::Value(target) => {
                let near = reach_on(&OnMesh::given(*self)?, target)?;
                if let Begun::Rounds(mut rounds) = self.begun(near, started)?
                    && rounds.run()? == RefinementEnd::Target
                    && let Some(warm) = self.warm(&rounds.meshes)?
                    && let Some((contact, warm)) = self.go_on(aim, warm)?
                {
                    return Ok((contact, Some(warm)));
                }
                Ok((reach(*self, target)?, None))
            }
            Aim::Depth(depth) => {
                let given = on_given_mesh(self.surface, &self.at(depth), self.skin, self.options)?;
                let mut rounds = match self.begun(given, started)? {
                    Begun::Ended(contact) => return Ok((*contact, None)),
                    Begun::Rounds(rounds) => *rounds,
                };
                let end = rounds.run()?;
                let warm = if end == RefinementEnd::Target { self.warm(&rounds.meshes)? } else { None };
                Ok((rounds.conclude(end)?, warm))
            }
        }
    }

    /// What is to be done about the mesh of a contact on the given one.
    fn begun(&self, given: Contact, started: Instant) -> Result<Begun<'_>, ContactError> {
        let placement = self.at(given.pressed_depth());
        begin(given, started, placement, self.skin, self.options)
    }

    /// What a contact leaves.
    fn warm(&self, meshes: &Meshes) -> Result<Option<WarmMesh>, ContactError> {
        let Some((part, last)) = &meshes.last else { return Ok(None) };
        let (Some(target), most) = (self.options.target_error, self.options.max_nodes) else {
            return Ok(None);
        };
        let Some(refined_for) = RefinedFor::new(&part.surface, last, target, most) else { return Ok(None) };
        let warm = WarmMesh {
            refined_for,
            touch: self.approach.touch(&part.surface, self.obstacle)?,
            inherited: meshes.inherited_by(part, self.skin),
            kept: Arc::default(),
            known: Some(Known::of_active(last.active.clone())),
            meshes: meshes.clone(),
        };
        Ok(Some(warm))
    }

    /// The contact on the mesh of the one before; `None` where that does not serve.
    fn go_on(&self, aim: Aim, mut warm: WarmMesh) -> Result<Option<(Contact, WarmMesh)>, ContactError> {
        let started = Instant::now();
        let Some(target) = self.options.target_error else { return Ok(None) };
        if let Aim::Depth(depth) = aim
            && warm.is_outgrown_at(depth)
        {
            return Ok(None);
        }
        let mut timings = Vec::new();
        for _ in 0..MOST_CHANGES {
            self.options.check_interrupt("refinement")?;
            let contact = match self.solve_on(&mut warm, aim) {
                Err(error) if error.is_of_deeper() => return Ok(None),
                other => other?,
            };
            let Some(mut contact) = contact else { return Ok(None) };
            if !warm.serves(&contact) {
                return Ok(None);
            }
            add_timings(&mut timings, &contact.timings);
            let Some(view) = self.look_around(&mut warm, &contact)? else { return Ok(None) };
            if view != View::Another {
                match warm.error(&contact) {
                    Ok(error) => {
                        contact.timings = timings;
                        let contact = warm.conclude(contact, error, started, target, self.skin)?;
                        if view == View::Wider {
                            self.onto_mesh(&mut warm)?;
                        }
                        return Ok(Some((contact, warm)));
                    }
                    Err(longest) if !warm.cut(&contact, longest) => return Ok(None),
                    Err(_) => {}
                }
            }
            warm.put_contact(contact);
            self.onto_mesh(&mut warm)?;
        }
        Ok(None)
    }

    /// The contact on the last mesh; `None` where the goal is out of its reach.
    fn solve_on(&self, warm: &mut WarmMesh, aim: Aim) -> Result<Option<Contact>, ContactError> {
        let before = warm.known.take();
        let (part, last) = warm.last();
        let skin = self.refined_skin(part)?;
        let kept = KeptSkin::with(&*skin, Arc::clone(&warm.kept));
        let setup = Setup { surface: &part.surface, skin: &kept, ..*self };
        let on = OnMesh {
            setup,
            inherited: Some(Arc::clone(&warm.inherited)),
            touch: warm.touch,
            touched_in: 0.0,
        };
        let (contact, known) = match aim {
            Aim::Depth(depth) => {
                let mut trials = Trials::new(&kept, before);
                (on.solve_with(depth - warm.touch.depth, &mut trials)?, trials.known)
            }
            Aim::Value(target) => {
                let Target { quantity, value } = target;
                let past = warm.touch.past(last);
                let reached = quantity.of(last, &self.approach.direction);
                if past <= 0.0 || reached <= 0.0 {
                    return Ok(None);
                }
                // Of the mesh before, where that has changed: no more than a guess.
                let first = past * (value / reached).powf(1.0 / quantity.power());
                match on.reach(quantity, &setup.search(target, first), before, None)? {
                    Reached::Short { .. } => return Ok(None),
                    Reached::Goal { contact, .. } => {
                        let known = Known::of_active(contact.active.clone());
                        (contact, Some(known))
                    }
                }
            }
        };
        warm.known = known;
        Ok(Some(contact))
    }

    /// Takes in the faces that the obstacle may reach from here, and the fingers anew where there are more patches; `None`
    /// where the given mesh does not answer.
    fn look_around(&self, warm: &mut WarmMesh, contact: &Contact) -> Result<Option<View>, ContactError> {
        let edges = (contact.travel - warm.meshes.given.travel).abs() / self.surface.mean_edge_length();
        let has_more_patches = contact.patches.len() > warm.last().1.patches.len();
        if edges <= FARTHEST_MOVE && !has_more_patches {
            let is_touched = self.cut_between(warm, contact, false)?;
            return Ok(Some(if is_touched { View::Another } else { View::Same }));
        }
        let depth = contact.pressed_depth();
        let traits = self.skin.traits(self.surface)?.with_product(self.obstacle.material());
        let mut is_felt_anew = has_more_patches;
        let near = if has_more_patches {
            let given = on_given_mesh(self.surface, &self.at(depth), self.skin, self.options)?;
            if given.status != ContactStatus::Solved {
                return Ok(None);
            }
            let deepest = given.max_penetration_before;
            let near = faces_near(&given.gap, &given.candidates, deepest, self.surface, &traits);
            warm.meshes.given = given;
            near
        } else {
            let touch = Touch { begin: contact.travel - depth, ..warm.touch };
            let scene = self.approach.scene(depth, self.surface, self.obstacle, touch);
            let gaps = Gaps::measure(self.surface, &scene, self.options.search_distance)?;
            let given = &mut warm.meshes.given;
            given.gap = gaps.undeformed().to_vec();
            if !self.options.couple_fingers {
                let is_under_kernel = |vertex| self.skin.kernel_at(vertex).is_some();
                let pressed = &gaps.penetrating;
                let fingers = Fingers::split_by_tissue(self.surface, pressed, &given.gap, is_under_kernel);
                is_felt_anew = fingers.coupling != given.drawing.fingers.coupling;
                given.drawing.fingers = fingers;
            }
            faces_near(&given.gap, &gaps.penetrating, gaps.deepest(), self.surface, &traits)
        };
        warm.meshes.given.travel = contact.travel;
        let is_wider = warm.meshes.mesh.take(near);
        let is_touched = self.cut_between(warm, contact, true)?;
        Ok(Some(match (is_felt_anew || is_touched || edges > FARTHEST_KNOWN, is_wider) {
            (true, _) => View::Another,
            (false, true) => View::Wider,
            (false, false) => View::Same,
        }))
    }

    /// Cuts triangles without force that the obstacle touches between their vertices; whether there are some.
    ///
    /// * `looks_around`: also those of the given mesh that a curved edge of is in the obstacle before the skin moves
    fn cut_between(
        &self,
        warm: &mut WarmMesh,
        contact: &Contact,
        looks_around: bool,
    ) -> Result<bool, ContactError> {
        let Meshes { given, mesh, .. } = &warm.meshes;
        let (part, _) = warm.last();
        let skin = self.refined_skin(part)?;
        let mut between = touched_between(mesh, Some(part), contact, &*skin, self.options)?;
        if looks_around {
            let under_force = loaded(mesh, &part.numbers(&contact.active));
            between.extend(pressed_between(mesh, &given.gap, &contact.obstacle, &under_force)?);
        }
        let mut marked = vec![false; mesh.leaf_count()];
        between.iter().for_each(|&leaf| marked[leaf] = true);
        warm.meshes.mesh.refine(&marked);
        Ok(!between.is_empty())
    }

    /// Puts what is known of the last contact onto the mesh, which has changed.
    fn onto_mesh(&self, warm: &mut WarmMesh) -> Result<(), ContactError> {
        let part = warm.meshes.mesh.part();
        warm.known = Some(Known::of_active(warm.meshes.expected(&part)));
        warm.inherited = warm.meshes.inherited_by(&part, self.skin);
        warm.touch = self.approach.touch(&part.surface, self.obstacle)?;
        warm.kept = Arc::default();
        warm.put_part(part);
        Ok(())
    }
}

/// What a look around shows.
#[derive(Clone, Copy, PartialEq)]
enum View {
    /// Faces and fingers that were known.
    Same,
    /// More faces, which the next contact may need.
    Wider,
    /// Faces or fingers that this one may need.
    Another,
}
