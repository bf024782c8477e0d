//! A contact solved on the part of the skin around it, in the numbers of the whole refined skin.

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::clues::Clues;
use crate::contact::error::ContactError;
use crate::contact::figures::motion::candidates::{CandidateMotion, Drawing};
use crate::contact::gap::deepest::DeepestVertex;
use crate::contact::outcome::{Contact, ContactMesh, LeftOut, Patch};
use crate::contact::report::left_out::{FAR_VERTICES, MASKED_VERTICES};
use crate::surface::refined::{MeshRefinement, RefinedSurface};

/// `contact` on `part` as a contact on the whole skin.
///
/// * `given`: the same on the given mesh
pub(crate) fn into_whole(
    given: Contact,
    contact: Contact,
    part: &RefinedSurface,
    mesh: MeshRefinement,
) -> Result<Contact, ContactError> {
    let count = mesh.given().vertices().len() + mesh.added_count();
    let numbers = |vertices: &[usize]| part.numbers(vertices);
    let gap = gaps(&given, &contact, part, &mesh, count)?;
    let in_whole = |fingers: &Fingers| {
        let candidates = fingers.candidates.iter().map(|finger| numbers(finger)).collect();
        Fingers::listed(candidates, fingers.coupling.clone())
    };
    let Drawing { fingers, on_product, motion } = &contact.drawing;
    let drawing = Drawing {
        fingers: in_whole(fingers),
        on_product: in_whole(on_product),
        motion: CandidateMotion { scalar: numbers(&motion.scalar), ..motion.clone() },
    };
    let patch =
        |patch: &Patch| Patch { vertices: numbers(&patch.vertices), resultant: patch.resultant.clone() };
    let by_given =
        |deepest: DeepestVertex| DeepestVertex { vertex: part.nearest_given()[deepest.vertex], ..deepest };
    let clues = Clues {
        deepest: contact.clues.deepest.map(by_given),
        unfelt: numbers(&contact.clues.unfelt),
        unmet: contact.clues.unmet.iter().map(|corners| corners.map(|corner| part.number(corner))).collect(),
        ..contact.clues.clone()
    };
    let left_out = left_out(&given.left_out, &contact.left_out);
    Ok(Contact {
        pressure: spread(&contact.pressure, part, count, 0.0),
        node_force: spread(&contact.node_force, part, count, 0.0),
        force_vectors: spread(&contact.force_vectors, part, count, Vector3::zeros()),
        gap,
        candidates: numbers(&contact.candidates),
        active: numbers(&contact.active),
        patches: contact.patches.iter().map(patch).collect(),
        loaded: contact.loaded.in_whole(part, [mesh.given().vertices().len(), count]),
        mesh: ContactMesh::refined(mesh),
        clues,
        left_out,
        drawing,
        ..contact
    })
}

/// What was left out: on the whole of the given skin where that was looked at, else on the part.
fn left_out(given: &[LeftOut], part: &[LeftOut]) -> Vec<LeftOut> {
    let is_of_whole = |one: &&LeftOut| [FAR_VERTICES, MASKED_VERTICES].contains(&one.what);
    let mut all: Vec<LeftOut> = given.iter().filter(is_of_whole).cloned().collect();
    all.extend(part.iter().filter(|one| !is_of_whole(one)).cloned());
    all
}

/// Values of a part at the vertices of the whole, `elsewhere` off it.
fn spread<T: Copy>(values: &[T], part: &RefinedSurface, count: usize, elsewhere: T) -> Vec<T> {
    let mut all = vec![elsewhere; count];
    values.iter().enumerate().for_each(|(vertex, value)| all[part.number(vertex)] = *value);
    all
}

/// Gaps of all vertices: those off the part that had one on the given mesh are measured where the obstacle stands now.
fn gaps(
    given: &Contact,
    contact: &Contact,
    part: &RefinedSurface,
    mesh: &MeshRefinement,
    count: usize,
) -> Result<Vec<f64>, ContactError> {
    let mut gap = spread(&contact.gap, part, count, f64::INFINITY);
    let mut is_off = vec![true; given.gap.len()];
    part.given_vertices().iter().for_each(|&vertex| is_off[vertex] = false);
    let near: Vec<usize> = (0..is_off.len()).filter(|&v| is_off[v] && given.gap[v].is_finite()).collect();
    let points: Vec<Vector3<f64>> = near.iter().map(|&vertex| mesh.given().vertices()[vertex]).collect();
    if !points.is_empty() {
        let measured = contact.obstacle.signed_distance(&points, None)?;
        near.into_iter().zip(measured.distance).for_each(|(vertex, distance)| gap[vertex] = distance);
    }
    Ok(gap)
}
