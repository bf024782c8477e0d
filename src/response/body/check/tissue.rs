//! Checks of skin, bone and fixed vertices before anything is solved.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::geometry::face_tree::find_crossings;
use crate::geometry::solid_angle::winding_number;
use crate::mesh::nesting::component_volumes;
use crate::response::body::check::distance::{
    FacePair, closest_between_components, closest_faces, crossings,
};
use crate::response::body::error::BodyError;
use crate::response::rows::rows_of_vertices;
use crate::surface::checked::Surface;

/// Bone and skin touch below this part of the skin's mean edge length (dimensionless).
const TOUCHING_DISTANCE: f64 = 1e-6;

/// Checks skin and bones.
pub(crate) fn check_tissue(skin: &Surface, bone: Option<&Surface>) -> Result<(), BodyError> {
    if !skin.is_closed() {
        return Err(BodyError::SkinOpen { border_count: skin.topology().boundary_loops().len() });
    }
    if skin.topology().component_count() != 1 {
        return Err(BodyError::SkinPieces { count: skin.topology().component_count() });
    }
    if skin.volume().is_nan() || skin.volume() <= 0.0 {
        return Err(BodyError::SkinInverted { volume: skin.volume() });
    }
    let Some(bone) = bone else { return Ok(()) };
    check_each_bone(bone)?;

    let crossings = crossings(bone, skin);
    if let Some(&[bone_face, skin_face]) = crossings.first() {
        return Err(BodyError::BoneCrossesSkin { bone_face, skin_face, count: crossings.len() });
    }
    let topology = bone.topology();
    for component in 0..topology.component_count() {
        let members: Vec<usize> =
            (0..bone.vertices().len()).filter(|&v| topology.vertex_component(v) == component).collect();
        let vertex = members[0];
        let winding = winding_number(&bone.vertices()[vertex], skin.vertices(), skin.faces().iter().copied());
        if winding < 0.5 {
            return Err(BodyError::BoneOutside { component, vertex, count: members.len() });
        }
    }
    check_bones_apart(bone)?;

    let limit = TOUCHING_DISTANCE * skin.mean_edge_length();
    let FacePair { first, second, distance } = closest_faces(bone, skin);
    if distance <= limit {
        return Err(BodyError::BoneTouchesSkin { bone_face: first, skin_face: second, distance, limit });
    }
    Ok(())
}

/// A skin that crosses itself encloses no body.
pub(crate) fn check_uncrossed(skin: &Surface) -> Result<(), BodyError> {
    let crossings = find_crossings(skin.vertices(), skin.faces());
    match crossings.first() {
        Some(&[first, second]) => Err(BodyError::SkinCrosses { first, second, count: crossings.len() }),
        None => Ok(()),
    }
}

fn check_each_bone(bone: &Surface) -> Result<(), BodyError> {
    let topology = bone.topology();
    if let Some(border) = topology.boundary_loops().first() {
        let component = topology.vertex_component(border[0] as usize);
        return Err(BodyError::BoneOpen { component, edge: (border[0], border[1]) });
    }
    let volumes = component_volumes(bone.vertices(), bone.faces(), topology);
    match volumes.iter().position(|&volume| volume.is_nan() || volume <= 0.0) {
        Some(component) => Err(BodyError::BoneInverted { component, volume: volumes[component] }),
        None => Ok(()),
    }
}

/// Bones that touch or cross one another leave no tissue between them.
fn check_bones_apart(bone: &Surface) -> Result<(), BodyError> {
    let topology = bone.topology();
    if topology.component_count() < 2 {
        return Ok(());
    }
    let limit = TOUCHING_DISTANCE * bone.mean_edge_length();
    let component = |face: usize| topology.face_components()[face] as usize;
    match closest_between_components(bone, component, limit) {
        Some(FacePair { first, second, .. }) => Err(BodyError::BonesMeet {
            first: component(first),
            second: component(second),
            first_face: first,
            second_face: second,
        }),
        None => Ok(()),
    }
}

/// Checks the mask of fixed vertices; returns the vertices that are fixed (those of fixed faces).
pub(crate) fn check_fixed(skin: &Surface, mask: &[bool]) -> Result<Vec<bool>, BodyError> {
    let vertex_count = skin.vertices().len();
    if mask.len() != vertex_count {
        return Err(BodyError::FixedLength { found: mask.len(), expected: vertex_count });
    }
    let count = mask.iter().filter(|&&fixed| fixed).count();
    let Some(first) = mask.iter().position(|&fixed| fixed) else {
        return Err(BodyError::FixedNothing { vertex_count });
    };
    if count == vertex_count {
        return Err(BodyError::FixedEverything { vertex_count });
    }
    let mut held = vec![false; vertex_count];
    for face in skin.faces().iter().filter(|face| face.iter().all(|&v| mask[v as usize])) {
        face.iter().for_each(|&v| held[v as usize] = true);
    }
    if !held.contains(&true) {
        return Err(BodyError::FixedWithoutFace { count, first });
    }
    Ok(held)
}

/// Checks the nodes to load.
pub(crate) fn check_nodes(vertex_count: usize, fixed: &[bool], nodes: &[usize]) -> Result<(), BodyError> {
    if nodes.is_empty() {
        return Err(BodyError::NoNodes);
    }
    rows_of_vertices(vertex_count, nodes)?;
    let count = nodes.iter().filter(|&&vertex| fixed[vertex]).count();
    match nodes.iter().find(|&&vertex| fixed[vertex]) {
        Some(&vertex) => Err(BodyError::NodeFixed { vertex, count }),
        None => Ok(()),
    }
}

/// Area vectors of the vertices (m²): a third of the area vectors of the faces around each.
pub(crate) fn area_vectors(surface: &Surface) -> Vec<Vector3<f64>> {
    (0..surface.vertices().len())
        .into_par_iter()
        .map(|vertex| {
            let faces = surface.faces_around(vertex).iter().map(|&face| face as usize);
            faces.map(|face| surface.face_normals()[face] * (surface.face_areas()[face] / 3.0)).sum()
        })
        .collect()
}
