//! A search for the place of the obstacle: on the given mesh, then on the one refined around what it found there.

use std::time::Instant;

use crate::contact::error::ContactError;
use crate::contact::outcome::{Contact, RefinementEnd};
use crate::contact::reach::on_mesh::OnMesh;
use crate::contact::refine::given::end_unrefined;
use crate::contact::refine::rounds::{Begun, Rounds, begin};
use crate::contact::report::record::add_timings;
use crate::contact::scene::Approach;
use crate::contact::setup::Setup;
use crate::contact::tilt::axes::Turn;

/// Refinements at the most: one at the place that the given mesh asks for, one at that of the refined mesh.
const MOST_REFINEMENTS: usize = 2;
/// How much farther than the part of the skin that was refined was made for, in mean edges of the given mesh, an
/// obstacle may come.
pub(crate) const FARTHEST_MOVE: f64 = 0.5;

/// What is searched on each mesh: a depth, or angles as well.
pub(crate) trait MeshSearch {
    /// What the search on one mesh leaves to that on the next.
    type Hint;

    /// How the obstacle has turned at a place.
    fn turn(&self, _: &Self::Hint) -> Option<Turn> {
        None
    }

    /// Searches on the mesh that was refined last, and puts the contact found in the place of the one there.
    ///
    /// `None` where nothing was refined or the last contact did not end solved.
    fn search_again(
        &self,
        rounds: &mut Rounds,
        hint: &Self::Hint,
    ) -> Result<Option<Searched<Self::Hint>>, ContactError>;

    /// How far the obstacle has moved from one contact to another (m).
    fn way_between(&self, from: &Contact, to: &Contact) -> f64;

    /// A contact on a mesh that is not refined, or why it is not what was searched.
    fn unless_missed(&self, contact: Contact, hint: &Self::Hint) -> Result<Contact, ContactError>;

    /// The error that says where a search ended in vain.
    fn missed(&self, contact: Contact, hint: &Self::Hint, why: String) -> ContactError;
}

/// How a search ended on one mesh.
pub(crate) struct Searched<G> {
    pub hint: G,
    /// Why it is not what was searched.
    pub why: Option<String>,
}

/// Refines the mesh around the contact that a search found on the given one, and searches again there.
///
/// * `started`: when the search on the given mesh did
pub(crate) fn search_on_refined<S: MeshSearch>(
    search: &S,
    on_given: &OnMesh,
    mut started: Instant,
    mut given: Contact,
    found: Searched<S::Hint>,
) -> Result<Contact, ContactError> {
    let Setup { surface, skin, options, .. } = on_given.setup;
    let turned = |hint: &S::Hint| {
        let approach = Approach { turn: search.turn(hint), ..on_given.setup.approach };
        Setup { approach, ..on_given.setup }
    };
    let Searched { mut hint, why } = found;
    if let Some(why) = why {
        let placement = turned(&hint).at(given.pressed_depth());
        let contact = end_unrefined(given, started, placement, skin)?;
        return Err(search.missed(contact, &hint, why));
    }
    let (mut before, mut left) = (None, MOST_REFINEMENTS);
    loop {
        left -= 1;
        let placement = turned(&hint).at(given.pressed_depth());
        let mut rounds = match begin(given, started, placement, skin, options)? {
            Begun::Ended(contact) => return search.unless_missed(*contact, &hint),
            Begun::Rounds(rounds) => *rounds,
        };
        let end = rounds.run()?;
        let refined_for = rounds.meshes.finest().resultant.contact_area;
        let met = (end == RefinementEnd::Target).then_some(rounds.target);
        let Some(again) = search.search_again(&mut rounds, &hint)? else {
            let (rounds, end) = before.unwrap_or((rounds, end));
            return search.unless_missed(rounds.conclude(end)?, &hint);
        };
        hint = again.hint;
        if let Some(why) = again.why {
            return Err(search.missed(rounds.conclude(end)?, &hint, why));
        }
        let has_gone_farther = |found: &Contact| {
            let way = search.way_between(&rounds.meshes.given, found);
            way > FARTHEST_MOVE * surface.mean_edge_length()
        };
        let found = rounds.meshes.outgrown(met, refined_for, has_gone_farther);
        let Some(found) = found.filter(|_| left > 0) else {
            return rounds.conclude(end);
        };
        started = Instant::now();
        let turned = search.turn(&hint).map(|turn| on_given.turned(turn)).transpose()?.flatten();
        let on = turned.as_ref().unwrap_or(on_given);
        given = on.solve(on.touch.past(found))?;
        add_timings(&mut given.timings, &found.timings);
        before = Some((rounds, end));
    }
}
