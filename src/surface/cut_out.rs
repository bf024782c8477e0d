//! One finger out of a whole hand, closed and held at the cut.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::geometry::face_tree::find_crossings;
use crate::mesh::topology::loops_of;
use crate::surface::checked::{Surface, SurfaceError};
use crate::surface::rim::add_cap;

/// Times that faces at the rim of a cap that folds are left out.
const MOST_RIM_TRIES: usize = 20;

/// A part of a skin, closed by caps.
#[derive(Debug, Clone)]
pub struct CutOut {
    /// The part: first the vertices of the whole skin that it keeps, in their order, then those of the caps. The skin
    /// mask keeps caps and what was masked before out of contact.
    pub surface: Surface,
    /// Vertices of the caps, rims included: those that a body made of the part holds fixed.
    pub fixed: Vec<bool>,
    /// For each vertex of the part the vertex of the whole skin; `None` inside a cap.
    pub source_vertices: Vec<Option<usize>>,
    /// For each vertex of the whole skin its vertex in the part, if it is kept.
    pub part_vertices: Vec<Option<usize>>,
}

/// Why a part could not be cut out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CutOutError {
    /// The tip is no vertex of the skin.
    #[error("tip vertex {tip}: the skin has {vertex_count} vertices")]
    TipOutOfRange {
        /// The vertex named.
        tip: usize,
        /// Number of skin vertices.
        vertex_count: usize,
    },
    /// The normal of the plane is zero or not finite.
    #[error("the plane's normal has length {length}")]
    Normal {
        /// Its length.
        length: f64,
    },
    /// No face around the tip lies in front of the plane.
    #[error("tip vertex {tip} lies {distance:.3e} m in front of the plane: no face around it is left")]
    TipCutOff {
        /// The vertex named.
        tip: usize,
        /// Its distance from the plane (m), negative behind.
        distance: f64,
    },
    /// The plane does not meet the part that the tip belongs to.
    #[error("the plane cuts nothing off the part around vertex {tip}: use the skin as it is")]
    NothingCut {
        /// The vertex named.
        tip: usize,
    },
    /// There is not one entry a vertex in the mask of what to keep.
    #[error("`keep` has {found} entries, but the skin has {vertex_count} vertices")]
    KeepLength {
        /// Its length.
        found: usize,
        /// Number of skin vertices.
        vertex_count: usize,
    },
    /// The mask marks no face, or a whole closed surface.
    #[error(
        "`keep` marks {marked} of {vertex_count} vertices, expected those of a part: some whole faces, and not all that \
         hang together"
    )]
    KeepNothing {
        /// Vertices marked.
        marked: usize,
        /// Number of skin vertices.
        vertex_count: usize,
    },
    /// A cap folds however many faces at its rim are left out.
    #[error("the cap over the border folds: cut along a smoother border, or by a plane")]
    Folds,
    /// The same where a plane cuts.
    #[error(
        "the cap over the plane's cut folds: the plane has no end and may run through several fingers; move or tilt it, \
         or give `keep`"
    )]
    PlaneFolds,
    /// The closed part is no sound surface.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

/// The part of a skin around a vertex in front of a plane, as a closed surface.
///
/// Keeps the faces in front of the plane that are connected to `tip`, cut along existing edges, and closes every
/// border by rings of triangles of the border's edge length around its centroid; faces at the border that such a cap
/// would cross are left out too. A body response takes what the cut leaves out as immobile, so cut a finger's width or more
/// away from the contact.
///
/// * `skin`: the whole hand
/// * `tip`: a vertex of the part to keep, such as a fingertip
/// * `point`: a point of the plane (m)
/// * `normal`: the plane's normal, towards the part to keep; of any length
///
/// # Errors
/// [`CutOutError`] by variant; [`CutOutError::PlaneFolds`] if the border is so crooked that its cap folds.
pub fn cut_out(
    skin: &Surface,
    tip: usize,
    point: &Vector3<f64>,
    normal: &Vector3<f64>,
) -> Result<CutOut, CutOutError> {
    let vertex_count = skin.vertices().len();
    if tip >= vertex_count {
        return Err(CutOutError::TipOutOfRange { tip, vertex_count });
    }
    let length = normal.norm();
    if !(length > 0.0 && length.is_finite()) {
        return Err(CutOutError::Normal { length });
    }
    let normal = normal / length;
    let in_front = |v: u32| (skin.vertices()[v as usize] - point).dot(&normal) > 0.0;
    let allowed = skin.faces().iter().map(|face| face.iter().all(|&v| in_front(v))).collect();
    let around_tip = |allowed: &[bool]| {
        let first = skin.faces_around(tip).iter().map(|&face| face as usize).find(|&face| allowed[face]);
        first.map_or_else(|| vec![false; allowed.len()], |first| connected(skin, allowed, first))
    };
    let tip_cut_off =
        || CutOutError::TipCutOff { tip, distance: (skin.vertices()[tip] - point).dot(&normal) };
    match closed_without_folds(skin, allowed, around_tip, tip_cut_off) {
        Err(CutOutError::Folds) => Err(CutOutError::PlaneFolds),
        cut => cut?.ok_or(CutOutError::NothingCut { tip }),
    }
}

/// The part of a skin that a mask marks, as a closed surface: [`cut_out`] with the faces whose corners are all marked.
///
/// Of several pieces that do not hang together, the one with the most faces.
///
/// * `keep`: one entry a vertex of the skin
///
/// # Errors
/// [`CutOutError`] by variant; [`CutOutError::Folds`] if the border is so crooked that its cap folds.
pub fn cut_out_marked(skin: &Surface, keep: &[bool]) -> Result<CutOut, CutOutError> {
    let (found, vertex_count) = (keep.len(), skin.vertices().len());
    if found != vertex_count {
        return Err(CutOutError::KeepLength { found, vertex_count });
    }
    let marked = keep.iter().filter(|&&marked| marked).count();
    let is_marked = |face: &[u32; 3]| face.iter().all(|&vertex| keep[vertex as usize]);
    let allowed = skin.faces().iter().map(is_marked).collect();
    let nothing = || CutOutError::KeepNothing { marked, vertex_count };
    closed_without_folds(skin, allowed, |allowed| largest_piece(skin, allowed), nothing)?.ok_or_else(nothing)
}

/// What `pick` keeps of the allowed faces, closed by caps, less the faces that a cap crosses or folds at; `None` where it
/// has no border.
///
/// * `nothing`: why nothing is left
fn closed_without_folds(
    skin: &Surface,
    mut allowed: Vec<bool>,
    pick: impl Fn(&[bool]) -> Vec<bool>,
    nothing: impl Fn() -> CutOutError,
) -> Result<Option<CutOut>, CutOutError> {
    for _ in 0..MOST_RIM_TRIES {
        let kept = without_pinches(skin, &mut allowed, &pick);
        if !kept.contains(&true) {
            return Err(nothing());
        }
        let Some(cut) = closed(skin, &kept)? else { return Ok(None) };
        let kept: Vec<usize> = (0..kept.len()).filter(|&face| kept[face]).collect();
        let mut crossings = find_crossings(cut.surface.vertices(), cut.surface.faces());
        crossings.retain(|pair| pair.iter().any(|&face| face >= kept.len()));
        if crossings.is_empty() {
            return Ok(Some(cut));
        }
        let left_out = at_rim(skin, &kept, &cut, crossings.as_flattened());
        if left_out.is_empty() {
            break;
        }
        left_out.iter().for_each(|&face| allowed[face] = false);
    }
    Err(CutOutError::Folds)
}

/// Those of some faces of a part that are faces of the skin, and the skin's around those of its caps.
///
/// * `kept`: the face of the skin for each of the part that is one
fn at_rim(skin: &Surface, kept: &[usize], cut: &CutOut, faces: &[usize]) -> Vec<usize> {
    let of_skin = |&face: &usize| match kept.get(face) {
        Some(&own) => vec![own],
        None => {
            let corners = cut.surface.faces()[face].iter();
            let rim = corners.filter_map(|&vertex| cut.source_vertices[vertex as usize]);
            rim.flat_map(|vertex| skin.faces_around(vertex)).map(|&face| face as usize).collect()
        }
    };
    faces.iter().flat_map(of_skin).collect()
}

/// The kept faces closed by caps; `None` where they have no border.
fn closed(skin: &Surface, kept: &[bool]) -> Result<Option<CutOut>, CutOutError> {
    let vertex_count = skin.vertices().len();
    // In the direction of the caps' faces, against that of the kept faces.
    let loops = loops_of(border_edges(skin, kept).map(|[a, b]| [b, a]), vertex_count);
    if loops.is_empty() {
        return Ok(None);
    }

    let mut part_vertices = vec![None; vertex_count];
    let kept_faces = || skin.faces().iter().zip(kept).filter(|(_, kept)| **kept).map(|(face, _)| face);
    kept_faces().flatten().for_each(|&v| part_vertices[v as usize] = Some(0));
    let mut source_vertices = Vec::new();
    for (vertex, part) in part_vertices.iter_mut().enumerate().filter(|(_, part)| part.is_some()) {
        *part = Some(source_vertices.len());
        source_vertices.push(Some(vertex));
    }
    let renamed = |v: u32| part_vertices[v as usize].expect("a kept vertex") as u32;
    let mut vertices: Vec<_> =
        source_vertices.iter().flatten().map(|&v: &usize| skin.vertices()[v]).collect();
    let mut faces: Vec<[u32; 3]> = kept_faces().map(|face| face.map(renamed)).collect();
    let mut fixed = vec![false; vertices.len()];
    for border in &loops {
        let rim: Vec<u32> = border.iter().map(|&v| renamed(v)).collect();
        rim.iter().for_each(|&v| fixed[v as usize] = true);
        add_cap(&rim, &mut vertices, &mut faces);
    }
    fixed.resize(vertices.len(), true);
    source_vertices.resize(vertices.len(), None);
    let may_touch = |(source, fixed): (&Option<usize>, &bool)| {
        !fixed && source.is_some_and(|vertex| skin.skin_mask()[vertex])
    };
    let skin_mask = source_vertices.iter().zip(&fixed).map(may_touch).collect();
    let surface = Surface::new(vertices, faces)?.with_skin_mask(skin_mask)?;
    Ok(Some(CutOut { surface, fixed, source_vertices, part_vertices }))
}

/// The largest connected piece of some faces.
fn largest_piece(skin: &Surface, allowed: &[bool]) -> Vec<bool> {
    let mut left = allowed.to_vec();
    let (mut largest, mut most) = (vec![false; allowed.len()], 0);
    while let Some(first) = left.iter().position(|&is_left| is_left) {
        let piece = connected(skin, allowed, first);
        let taken = piece.iter().zip(&mut left).filter(|(is_in, _)| **is_in);
        let count = taken.map(|(_, left)| *left = false).count();
        if count > most {
            (largest, most) = (piece, count);
        }
    }
    largest
}

/// What `pick` keeps of the allowed faces, once no two of its borders meet in a vertex.
fn without_pinches(skin: &Surface, allowed: &mut [bool], pick: impl Fn(&[bool]) -> Vec<bool>) -> Vec<bool> {
    loop {
        let kept = pick(allowed);
        let mut starts: HashMap<u32, usize> = HashMap::new();
        border_edges(skin, &kept).for_each(|[a, _]| *starts.entry(a).or_default() += 1);
        let pinched: Vec<u32> =
            starts.into_iter().filter(|&(_, count)| count > 1).map(|(vertex, _)| vertex).collect();
        if pinched.is_empty() {
            return kept;
        }
        for &vertex in &pinched {
            skin.faces_around(vertex as usize).iter().for_each(|&face| allowed[face as usize] = false);
        }
    }
}

/// The allowed faces that hang together with one of them.
fn connected(skin: &Surface, allowed: &[bool], first: usize) -> Vec<bool> {
    let mut kept = vec![false; allowed.len()];
    let mut waiting = vec![first];
    while let Some(face) = waiting.pop() {
        if std::mem::replace(&mut kept[face], true) {
            continue;
        }
        let across = (0..3).filter_map(|edge| skin.topology().across(face, edge));
        waiting.extend(across.filter(|&next| allowed[next] && !kept[next]));
    }
    kept
}

/// Directed edges of kept faces without a kept face across.
fn border_edges<'a>(skin: &'a Surface, kept: &'a [bool]) -> impl Iterator<Item = [u32; 2]> + 'a {
    let edges =
        (0..kept.len()).filter(|&face| kept[face]).flat_map(|face| (0..3).map(move |edge| (face, edge)));
    edges
        .filter(|&(face, edge)| !skin.topology().across(face, edge).is_some_and(|next| kept[next]))
        .map(|(face, edge)| [skin.faces()[face][edge], skin.faces()[face][(edge + 1) % 3]])
}
