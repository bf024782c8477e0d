//! What penetration a contact leaves, measured anew at the deformed skin: at its vertices, in its triangles, and of the
//! obstacle's edges in them.

use nalgebra::Vector3;

use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::beside::Beside;
use crate::contact::figures::between::{Between, PointsBetween};
use crate::contact::figures::fade::Fade;
use crate::contact::figures::motion::CandidateMotion;
use crate::contact::figures::receding::{Corners, Receding};
use crate::contact::gap::edge::{SkinPart, triangles_among};
use crate::contact::gap::initial::Gaps;
use crate::contact::gap::measured::Measured;
use crate::response::skin::elastic::ElasticSkin;

/// Penetration left that is next to none, as a share of that before.
pub(crate) const SMALL_PENETRATION: f64 = 0.02;

/// Share of that from which a closer look may find more.
const NEARLY_SMALL: f64 = 0.75;

/// How deep in a triangle, over its shortest edge, something blunt stands: what is deeper has sides that vertices slid past.
const BLUNT: f64 = 0.25;

/// What penetration is left.
#[derive(Debug, Clone)]
pub(crate) struct Penetration {
    /// The deepest (m, ≥ 0).
    pub depth: f64,
    /// How far off the obstacle the force acts in the mean (m), where gaps that are zero at vertices did not settle.
    pub apart: f64,
    /// Whether a vertex of the skin is that deep, not only a point between vertices.
    pub is_at_vertex: bool,
    /// Where the obstacle recedes between vertices under force.
    pub receding: Receding,
    /// Vertices that penetrate by more than a little away from all force, as averages over their triangles feel nothing of it.
    pub unfelt: Vec<usize>,
    /// Corners, ascending, of triangles away from all force that something blunt stands in between their vertices.
    pub unmet: Vec<[usize; 3]>,
}

/// Deepest penetration of skin and obstacle into one another, where the forces put the skin.
pub(crate) fn penetration_after(
    gaps: &Gaps,
    forces: &NodeForces,
    skin: &dyn ElasticSkin,
    motion: &CandidateMotion,
    beside: &Beside,
) -> Result<Penetration, ContactError> {
    if forces.candidates.is_empty() {
        // Nothing has moved.
        let (depth, of_vertices) = (gaps.deepest(), gaps.undeformed());
        let is_at_vertex = of_vertices.into_iter().any(|gap| -gap >= depth);
        return Ok(Penetration {
            depth,
            apart: 0.0,
            is_at_vertex,
            receding: Receding::default(),
            unfelt: gaps.penetrating.clone(),
            unmet: Vec::new(),
        });
    }
    let surface = gaps.surface;
    let mut vertices = forces.candidates.clone();
    let mut points: Vec<Vector3<f64>> = forces
        .candidates
        .iter()
        .zip(&motion.displacement)
        .map(|(&vertex, u)| surface.vertices()[vertex] + u)
        .collect();
    let (others, found) = beside.near();
    if !others.is_empty() {
        let fade = Fade::new(surface, &forces.fingers, &forces.candidates, &motion.scalar);
        for (&vertex, moved) in others.iter().zip(found) {
            let share = if skin.is_scalar(vertex) { fade.share(vertex) } else { 1.0 };
            vertices.push(vertex);
            points.push(surface.vertices()[vertex] + share * moved);
        }
    }
    let triangles = triangles_among(surface, &vertices);
    let moved_skin = SkinPart { points: &points, triangles: &triangles };
    let reach = gaps.deepest();
    let measured = Measured::near(&points, &gaps.scene.obstacle, reach, None)?;
    let depths: Vec<f64> = measured.distance.iter().map(|distance| -distance.min(reach)).collect();
    let at_vertices = depths.iter().copied().fold(0.0, f64::max);
    let of_edges = moved_skin.deepest_between(&gaps.scene.obstacle, reach, at_vertices, &measured.distance);
    let between = PointsBetween::new(&points, &depths, &triangles);
    let Between { deepest, middles, of_faces } = between.look(&gaps.scene.obstacle, of_edges)?;
    // The figure that a warning tells is worth a closer look.
    let depth = if deepest > NEARLY_SMALL * SMALL_PENETRATION * reach {
        let at_rest: Vec<Vector3<f64>> = vertices.iter().map(|&vertex| surface.vertices()[vertex]).collect();
        moved_skin.deepest_inside(&at_rest, &gaps.scene.obstacle, reach, deepest)
    } else {
        deepest
    };
    let is_at_vertex = at_vertices >= depth;
    let pressure_at = |&vertex: &usize| match gaps.line_at(vertex) {
        None => forces.force[vertex] / surface.vertex_areas()[vertex],
        Some(_) => 0.0,
    };
    let pressure: Vec<f64> = vertices.iter().map(pressure_at).collect();
    let Measured { distance, normal } = &measured;
    let corners = Corners { points: &points, distance, normal, pressure: &pressure };
    // E* of tissue that keeps its volume.
    let modulus = 4.0 * skin.shear_modulus_at(vertices[0]).unwrap_or(0.0);
    let receding = Receding::new(&triangles, &middles, &corners, modulus);
    let is_free = |vertex: usize| forces.force[vertex] == 0.0;
    let is_unfelt = |(&vertex, &depth): (&usize, &f64)| {
        let mut beside = surface.neighbours(vertex).iter().map(|&other| other as usize);
        (depth > SMALL_PENETRATION * reach && is_free(vertex) && beside.all(is_free)).then_some(vertex)
    };
    // The skin that drapes over an edge stands off it.
    let apart = |(&vertex, &distance): (&usize, &f64)| match gaps.line_at(vertex) {
        None => forces.force[vertex] * distance.clamp(0.0, reach),
        Some(_) => 0.0,
    };
    let work: f64 = vertices.iter().zip(&measured.distance).map(apart).sum();
    let apart = work / forces.force.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let unfelt = vertices.iter().zip(&depths).filter_map(is_unfelt).collect();
    let is_blunt = |triangle: &[u32; 3], depth: f64| {
        let [a, b, c] = triangle.map(|corner| points[corner as usize]);
        depth < BLUNT * (b - a).norm().min((c - b).norm()).min((a - c).norm())
    };
    let is_unmet = |(triangle, &depth): (&[u32; 3], &f64)| {
        let mut corners = triangle.map(|corner| vertices[corner as usize]);
        corners.sort_unstable();
        let may_touch = corners.iter().all(|&vertex| is_free(vertex) && surface.skin_mask()[vertex]);
        (depth > SMALL_PENETRATION * reach && may_touch && is_blunt(triangle, depth)).then_some(corners)
    };
    let unmet = triangles.iter().zip(&of_faces).filter_map(is_unmet).collect();
    Ok(Penetration { depth, apart, is_at_vertex, receding, unfelt, unmet })
}
