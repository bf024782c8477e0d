//! Triangles that must be finer: those that carry force, and those with a curved edge that is pressed where no vertex is.

use std::collections::HashSet;

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::figures::penetration::after::SMALL_PENETRATION;
use crate::contact::gap::measured::Measured;
use crate::contact::options::ContactOptions;
use crate::contact::outcome::Contact;
use crate::mesh::distinct::distinct;
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::{ElasticSkin, Traits};
use crate::surface::checked::Surface;
use crate::surface::refined::{MeshRefinement, PLACES_ON_EDGE, RefinedSurface, height_on_edge};

/// How much farther than a curved edge its face may stand out from the straight one: where it is cut, a quarter is left.
const BEYOND_EDGE: f64 = 0.25;
/// Farthest that a point of a curved face lies from its nearest corner, as a share of the longest edge: in its plane
/// 1/√3, and a quarter over it, as edges meet at no more than sharp angles.
const FARTHEST_ON_CURVE: f64 = 0.85;

/// Faces that a contact may need finer: all around a vertex that may come to touch.
///
/// * `gap`: of the given surface's vertices (m)
/// * `candidates`: those that may touch, ascending
/// * `deepest`: penetration (m)
pub(crate) fn faces_near(
    gap: &[f64],
    candidates: &[usize],
    deepest: f64,
    surface: &Surface,
    traits: &Traits,
) -> Vec<u32> {
    // Where forces can press skin outside, it must be there.
    let margin = if traits.negative_entries { deepest } else { 0.0 };
    let mut is_near = vec![false; surface.faces().len()];
    let mut near = Vec::new();
    for (vertex, &gap) in gap.iter().enumerate() {
        if gap.is_infinite() {
            continue;
        }
        let around = surface.faces_around(vertex);
        let farthest = FARTHEST_ON_CURVE * surface.longest_edge(vertex);
        if gap > margin.max(farthest) && candidates.binary_search(&vertex).is_err() {
            continue;
        }
        for &face in around {
            if !std::mem::replace(&mut is_near[face as usize], true) {
                near.push(face);
            }
        }
    }
    near.sort_unstable();
    near
}

/// Triangles with a corner under force.
///
/// * `active`: numbers in the whole refined surface, ascending
pub(crate) fn loaded(mesh: &MeshRefinement, active: &[usize]) -> Vec<bool> {
    let is_active = |vertex: &usize| active.binary_search(vertex).is_ok();
    (0..mesh.leaf_count()).map(|leaf| mesh.corners(leaf).iter().any(is_active)).collect()
}

/// Triangles longer, in the mean of their edges, than one of their corners has use for.
///
/// * `longest`: of some vertices by their numbers in the whole refined surface (m)
pub(crate) fn too_large(mesh: &MeshRefinement, longest: impl Fn(usize) -> Option<f64>) -> Vec<bool> {
    let is_large = |leaf: usize| {
        let corners = mesh.corners(leaf);
        let least = corners.into_iter().filter_map(&longest).reduce(f64::min);
        least.is_some_and(|least| mesh.mean_edge(leaf) > least)
    };
    (0..mesh.leaf_count()).map(is_large).collect()
}

/// Triangles of the given surface that a curved edge of is in the obstacle and no vertex need be.
///
/// * `gap`: of the given surface's vertices (m)
/// * `is_marked`: triangles that are not looked at
pub(crate) fn pressed_between(
    mesh: &MeshRefinement,
    gap: &[f64],
    obstacle: &Obstacle,
    is_marked: &[bool],
) -> Result<Vec<usize>, ContactError> {
    let mask = mesh.given().skin_mask();
    let may_press = |leaf: &usize| {
        let corners = mesh.corners(*leaf);
        // Of the given vertices, none was added.
        corners.iter().all(|&vertex| vertex < mask.len() && mask[vertex])
            && corners
                .iter()
                .any(|&vertex| gap[vertex] < FARTHEST_ON_CURVE * mesh.given().longest_edge(vertex))
    };
    let leaves = (0..is_marked.len()).filter(|&leaf| !is_marked[leaf]).filter(may_press).collect();
    with_pressed_edge(mesh, leaves, obstacle, |_| 0.0, |_| Vector3::zeros())
}

/// Triangles without force that the obstacle touches between their vertices: they stand out so far that they touch where the
/// skin has moved to, by more than a little, as another patch begins to; or something blunt stands in them.
///
/// * `part`: of the mesh that the contact is on; `None` for the given surface
/// * `skin`: of that part
pub(crate) fn touched_between(
    mesh: &MeshRefinement,
    part: Option<&RefinedSurface>,
    contact: &Contact,
    skin: &dyn ElasticSkin,
    options: &ContactOptions,
) -> Result<Vec<usize>, ContactError> {
    let surface = contact.surface();
    let number = |row| part.map_or(row, |part| part.number(row));
    let row = |corner| part.map_or(Some(corner), |part| part.row(corner));
    let felt = contact.accuracy.discretization.felt(surface, &contact.active);
    let mut felt: Vec<usize> = felt.into_iter().map(number).collect();
    felt.sort_unstable();
    let is_felt = loaded(mesh, &felt);
    let mask = surface.skin_mask();
    // Against an obstacle that is flat beside the triangle, with gaps that are no larger than they are where it moved.
    let may_touch = |leaf: &usize| {
        let rows = mesh.corners(*leaf).map(row);
        let [Some(a), Some(b), Some(c)] = rows else { return false };
        let nearest = [a, b, c].map(|corner| contact.gap[corner]).into_iter().fold(f64::INFINITY, f64::min);
        let longest = [a, b, c].map(|corner| surface.longest_edge(corner)).into_iter().fold(0.0, f64::max);
        let most = (1.0 + BEYOND_EDGE) * FARTHEST_ON_CURVE * longest;
        if !(mask[a] && mask[b] && mask[c]) || nearest >= most {
            return false;
        }
        let is_near = |([from, to], bulge): ([usize; 2], f64)| {
            PLACES_ON_EDGE.into_iter().any(|place| {
                let straight = (1.0 - place) * contact.gap[from] + place * contact.gap[to];
                straight < (1.0 + BEYOND_EDGE) * height_on_edge(place) * bulge
            })
        };
        [[a, b], [b, c], [c, a]].into_iter().zip(mesh.bulges(*leaf)).any(is_near)
    };
    let unfelt = (0..is_felt.len()).filter(|&leaf| !is_felt[leaf]);
    let unmet: HashSet<[usize; 3]> =
        contact.clues.unmet.iter().map(|corners| ascending(corners.map(number))).collect();
    let (mut stood_in, leaves): (Vec<usize>, Vec<usize>) =
        unfelt.partition(|&leaf| unmet.contains(&ascending(mesh.corners(leaf))));
    let leaves: Vec<usize> = leaves.into_iter().filter(may_touch).collect();
    if leaves.is_empty() || contact.active.is_empty() {
        return Ok(stood_in);
    }
    let corners = distinct(leaves.iter().flat_map(|&leaf| mesh.corners(leaf)));
    let rows: Vec<usize> = corners.iter().filter_map(|&corner| row(corner)).collect();
    let moved = contact.moved(skin, &rows, options)?;
    let moved =
        |corner: usize| corners.binary_search(&corner).map_or_else(|_| Vector3::zeros(), |at| moved[at]);
    let little = SMALL_PENETRATION * contact.max_penetration_before;
    let beyond = |bulge| BEYOND_EDGE * bulge - little;
    stood_in.extend(with_pressed_edge(mesh, leaves, &contact.obstacle, beyond, moved)?);
    Ok(stood_in)
}

fn ascending(mut corners: [usize; 3]) -> [usize; 3] {
    corners.sort_unstable();
    corners
}

/// Those of some triangles that have a point of a curved edge as near to the obstacle, or as deep in it, as is asked for.
///
/// * `most`: gap (m) of a point below which it is, by how far it stands out from the straight edge (m)
/// * `moved`: how far corners have moved (m)
pub(crate) fn with_pressed_edge(
    mesh: &MeshRefinement,
    mut leaves: Vec<usize>,
    obstacle: &Obstacle,
    most: impl Fn(f64) -> f64,
    moved: impl Fn(usize) -> Vector3<f64>,
) -> Result<Vec<usize>, ContactError> {
    let (mut places, mut gaps) = (Vec::new(), Vec::new());
    for &leaf in &leaves {
        let (moved, bulges) = (mesh.corners(leaf).map(&moved), mesh.bulges(leaf));
        for (at, point) in mesh.on_curved_edges(leaf).into_iter().enumerate() {
            let (side, place) = (at / 3, PLACES_ON_EDGE[at % 3]);
            places.push(point + moved[side].lerp(&moved[(side + 1) % 3], place));
            gaps.push(most(height_on_edge(place) * bulges[side]));
        }
    }
    let reach = gaps.iter().copied().fold(0.0, f64::max);
    let measured = Measured::near(&places, obstacle, reach, None)?;
    let is_pressed =
        |(found, most): (&[f64; 9], &[f64; 9])| found.iter().zip(most).any(|(gap, most)| gap < most);
    let mut pressed = measured.distance.as_chunks().0.iter().zip(gaps.as_chunks().0).map(is_pressed);
    leaves.retain(|_| pressed.next().is_some_and(|is_pressed| is_pressed));
    Ok(leaves)
}
