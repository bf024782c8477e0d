//! Triangles that must be finer: those that carry force, and those whose curved middle is pressed where no vertex is.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::measured::Measured;
use crate::contact::scene::first_touch;
use crate::obstacle::posed::Obstacle;
use crate::response::skin::elastic::Traits;
use crate::surface::checked::Surface;
use crate::surface::refined::MeshRefinement;

/// Most times that a triangle is cut to find a first touch: each quarters how far its middle stands out.
const MOST_CUTS: usize = 8;
/// Farthest that a point of a curved face lies from its nearest corner, as a share of the longest edge: in its plane
/// 1/√3, and a quarter over it, as edges meet at no more than sharp angles.
const FARTHEST_POINT: f64 = 0.85;

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
        let farthest = FARTHEST_POINT * longest_edge(surface, vertex);
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

fn longest_edge(surface: &Surface, vertex: usize) -> f64 {
    let own = surface.vertices()[vertex];
    let length = |&other: &u32| (surface.vertices()[other as usize] - own).norm();
    surface.neighbours(vertex).iter().map(length).fold(0.0, f64::max)
}

/// Triangles with a corner under force.
///
/// * `active`: numbers in the whole refined surface, ascending
pub(crate) fn loaded(mesh: &MeshRefinement, active: &[usize]) -> Vec<bool> {
    let is_active = |vertex: &usize| active.binary_search(vertex).is_ok();
    (0..mesh.leaf_count()).map(|leaf| mesh.corners(leaf).iter().any(is_active)).collect()
}

/// Triangles with one of some corners and edges longer than so many m in the mean.
///
/// * `corners`: numbers in the whole refined surface, ascending
pub(crate) fn too_large(mesh: &MeshRefinement, corners: &[usize], longest: f64) -> Vec<bool> {
    let mut marked = loaded(mesh, corners);
    for (leaf, is_marked) in marked.iter_mut().enumerate() {
        *is_marked = *is_marked && mesh.mean_edge(leaf) > longest;
    }
    marked
}

/// Marks triangles of the given surface too that no vertex of feels the obstacle but a curved middle does.
///
/// * `gap`: of the given surface's vertices (m)
pub(crate) fn add_pressed_middles(
    mesh: &MeshRefinement,
    gap: &[f64],
    obstacle: &Obstacle,
    marked: &mut [bool],
) -> Result<(), ContactError> {
    let mask = mesh.given().skin_mask();
    let may_press = |leaf: &usize| {
        let corners = mesh.corners(*leaf);
        // Of the given vertices, none was added.
        corners.iter().all(|&vertex| vertex < mask.len() && mask[vertex])
            && corners.iter().any(|&vertex| gap[vertex] < FARTHEST_POINT * longest_edge(mesh.given(), vertex))
    };
    let leaves: Vec<usize> = (0..marked.len()).filter(|&leaf| !marked[leaf]).filter(may_press).collect();
    pressed_middles(mesh, &leaves, obstacle)?.into_iter().for_each(|leaf| marked[leaf] = true);
    Ok(())
}

/// Those of some triangles that a curved middle of is in the obstacle.
fn pressed_middles(
    mesh: &MeshRefinement,
    leaves: &[usize],
    obstacle: &Obstacle,
) -> Result<Vec<usize>, ContactError> {
    let middles: Vec<_> = leaves.iter().flat_map(|&leaf| mesh.curved_middles(leaf)).collect();
    let measured = Measured::near(&middles, obstacle, 0.0, None)?;
    let gaps = leaves.iter().zip(measured.distance.as_chunks::<3>().0);
    let pressed = gaps.filter(|(_, gaps)| gaps.iter().any(|&gap| gap < 0.0));
    Ok(pressed.map(|(&leaf, _)| leaf).collect())
}

/// Travel (m) at which the obstacle, coming from infinity along a unit direction, first touches the smooth skin: triangles
/// are cut until no curved middle is touched before the vertices.
pub(crate) fn touch_of_smooth_skin(
    surface: &Surface,
    obstacle: &Obstacle,
    direction: &Vector3<f64>,
) -> Result<f64, ContactError> {
    let mut travel = first_touch(surface, obstacle, direction)?;
    let pressed_at = |mesh: &MeshRefinement, travel: f64| {
        let leaves: Vec<usize> = (0..mesh.leaf_count()).collect();
        pressed_middles(mesh, &leaves, &obstacle.translated(&(travel * direction)))
    };
    let mask = surface.skin_mask();
    let may_touch = |face: &u32| surface.faces()[*face as usize].iter().all(|&corner| mask[corner as usize]);
    let all = MeshRefinement::new(surface, (0..surface.faces().len() as u32).filter(may_touch));
    let faces: Vec<u32> = pressed_at(&all, travel)?.into_iter().map(|leaf| all.face(leaf)).collect();
    let mut mesh = MeshRefinement::new(surface, faces);
    for _ in 0..MOST_CUTS {
        let pressed = pressed_at(&mesh, travel)?;
        if pressed.is_empty() {
            break;
        }
        let mut marked = vec![false; mesh.leaf_count()];
        pressed.into_iter().for_each(|leaf| marked[leaf] = true);
        mesh.refine(&marked);
        travel = travel.min(first_touch(&mesh.part().surface, obstacle, direction)?);
    }
    Ok(travel)
}
