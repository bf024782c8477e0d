//! What penetration a contact leaves, measured anew at the deformed skin: at its vertices, in its triangles, and of the
//! obstacle's edges in them.

use nalgebra::Vector3;

use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::forces::NodeForces;
use crate::contact::error::ContactError;
use crate::contact::figures::displacement::{CandidateMotion, drawn_vector};
use crate::contact::figures::fade::Fade;
use crate::contact::gap::edge::SkinPart;
use crate::contact::gap::initial::{Gaps, triangles_among};
use crate::contact::gap::measured::Measured;

/// Parts that the edges of all triangles, and of those that penetrate, are cut into to look between their vertices.
const COARSE: usize = 3;
const FINE: usize = 8;
/// Share of the deepest penetration from which a triangle is looked at more finely.
const DEEP: f64 = 0.25;

/// What penetration is left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Penetration {
    /// The deepest (m, ≥ 0).
    pub depth: f64,
    /// Whether a vertex of the skin is that deep, not only a point between vertices.
    pub is_at_vertex: bool,
}

/// Deepest penetration of skin and obstacle into one another, where the forces put the skin.
///
/// Beside the candidates a vertex can penetrate where its gap was less than the largest displacement of any. Without
/// candidates an obstacle that is finer than the mesh can stand between vertices.
pub(crate) fn penetration_after(
    gaps: &Gaps,
    response: &Compliance,
    forces: &NodeForces,
    motion: &CandidateMotion,
) -> Result<Penetration, ContactError> {
    let surface = gaps.surface;
    let reach = match &motion.displacement[..] {
        [] => surface.mean_edge_length(),
        displacement => displacement.iter().map(Vector3::norm).fold(0.0, f64::max),
    };
    let mut others = surface.k_ring(&forces.candidates, 1);
    {
        let distance = gaps.distances();
        others.extend((0..distance.len()).filter(|&vertex| distance[vertex] < reach));
    }
    others.retain(|vertex| surface.skin_mask()[*vertex] && forces.candidates.binary_search(vertex).is_err());
    others.sort_unstable();
    others.dedup();

    let mut vertices = forces.candidates.clone();
    let mut points: Vec<Vector3<f64>> = forces
        .candidates
        .iter()
        .zip(&motion.displacement)
        .map(|(&vertex, u)| surface.vertices()[vertex] + u)
        .collect();
    if !others.is_empty() {
        let found = response.displace_coarsely(forces.applied(), &others)?;
        let fade = Fade::new(surface, &forces.fingers, &forces.candidates, &motion.scalar);
        for (row, &vertex) in others.iter().enumerate() {
            let share = found.along_normal[row].map_or(1.0, |_| fade.share(vertex));
            vertices.push(vertex);
            points.push(surface.vertices()[vertex] + share * drawn_vector(&found, row));
        }
    }
    let triangles = triangles_among(surface, &vertices);
    let skin = SkinPart { points: &points, triangles: &triangles };
    let of_edges = skin.deepest_edge(&gaps.scene.obstacle, gaps.deepest());
    let at = |points: &[Vector3<f64>]| -> Result<Vec<f64>, ContactError> {
        let measured = Measured::near(points, &gaps.scene.obstacle, gaps.deepest(), None)?;
        Ok(measured.distance.iter().map(|distance| -distance).collect())
    };
    let at_vertices = at(&points)?.into_iter().fold(0.0, f64::max);
    let coarse = lattice(COARSE);
    let depths = at(&spread(&points, &triangles, &coarse))?;
    let between = depths.iter().copied().fold(0.0, f64::max);
    // Finer where it is deep.
    let is_deep = |depths: &[f64]| depths.iter().any(|&depth| depth > DEEP * between);
    let pairs = triangles.iter().zip(depths.chunks(coarse.len()));
    let deep: Vec<[u32; 3]> =
        pairs.filter(|(_, depths)| is_deep(depths)).map(|(triangle, _)| *triangle).collect();
    let between = at(&spread(&points, &deep, &lattice(FINE)))?.into_iter().fold(between, f64::max);
    let depth = at_vertices.max(between).max(of_edges);
    Ok(Penetration { depth, is_at_vertex: at_vertices >= depth })
}

/// Barycentric coordinates of the points that cut the edges of a triangle into so many parts, but for its corners.
fn lattice(parts: usize) -> Vec<[f64; 3]> {
    let rows = (0..=parts).flat_map(|i| (0..=parts - i).map(move |j| [i, j, parts - i - j]));
    let between = rows.filter(|corners| !corners.contains(&parts));
    between.map(|corners| corners.map(|share| share as f64 / parts as f64)).collect()
}

/// Points of triangles at barycentric coordinates.
fn spread(points: &[Vector3<f64>], triangles: &[[u32; 3]], shares: &[[f64; 3]]) -> Vec<Vector3<f64>> {
    let of = |triangle: &[u32; 3], [a, b, c]: &[f64; 3]| {
        let [p, q, r] = triangle.map(|corner| points[corner as usize]);
        *a * p + *b * q + *c * r
    };
    triangles.iter().flat_map(|triangle| shares.iter().map(move |shares| of(triangle, shares))).collect()
}
