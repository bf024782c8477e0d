//! How long the edges of a coarse mesh may be over the tissue.

use std::time::Instant;

use crate::geometry::face_tree::find_crossings;
use crate::response::body::check::distance::crossings;
use crate::response::body::check::tissue::{check_nodes, check_uncrossed};
use crate::response::body::error::BodyError;
use crate::response::body::levels::thickness::{mean_thickness, tissue_thickness};
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;
use crate::surface::coarse::CoarseSkin;

/// Coarse meshes tried where the tissue decides, each with edges of [`SHORTER_EDGES`] times the length where the one before
/// crosses itself or the bone, or everywhere.
const MOST_COARSE_MESHES: usize = 16;
const SHORTER_EDGES: f64 = 0.7;

/// Wanted length of the coarse edges, as a share of the tissue's thickness: the least and the most. Collapses make some
/// up to 1.5 times as long.
const EDGE_PER_THICKNESS: [f64; 2] = [0.4, 0.7];

/// Longest edge as a share of the radius that the skin bends with: twelve around a finger, and eight where there are too
/// many vertices.
const EDGE_PER_BEND: [f64; 2] = [0.5, 0.8];

/// Vertices of a coarse skin above which its edges are longer than the least share.
const MANY_VERTICES: f64 = 800.0;

/// Vertices of a coarse skin above which its edges are longer than the most share: what a whole hand with its bones may cost.
const MOST_VERTICES: f64 = 2050.0;

/// How many times longer edges may get for that: away from what may be loaded, and then everywhere.
const LONGER_EDGES: [f64; 2] = [2.0, 1.7];

/// How much longer edges get per distance from what may be loaded: the least and the most.
const EDGE_GROWTH: [f64; 2] = [0.4, 1.0];

/// Steps from the least share and growth to the most.
const GROWTH_STEPS: u32 = 20;

/// The same for the edges of a coarse bone.
const BONE_EDGE_PER_THICKNESS: f64 = 0.35;

/// Vertices of equilateral triangles with edges of so many m (n).
fn vertex_count(skin: &Surface, edges: &[f64]) -> f64 {
    let areas = skin.vertex_areas().iter().zip(edges);
    areas.map(|(area, edge)| area / (0.75_f64.sqrt() * edge * edge)).sum()
}

/// The share of the thickness (n, m) that leaves not too many vertices.
fn edge_per_thickness(skin: &Surface, thickness: &[f64]) -> f64 {
    let [least, most] = EDGE_PER_THICKNESS;
    let vertices = vertex_count(skin, thickness) / (least * least);
    (least * (vertices / MANY_VERTICES).sqrt()).clamp(least, most)
}

/// Makes the edges (n, m) of a skin that would have too many vertices longer: first away from the nodes, the more so
/// the farther away, then everywhere by one factor. At the nodes edges are the least share of the thickness that there are
/// vertices for, and grow with its cube root where the tissue is deeper than is typical: balls on palm and fingertips of a
/// hand erred less so than with the root or the fourth root. Returns whether it has too many.
///
/// * `thickness`: of the tissue (n, m)
/// * `bends`: radius that the skin bends with (n, m)
/// * `nodes`: vertices where contact is expected
fn lengthen_edges(
    edges: &mut [f64],
    skin: &Surface,
    thickness: &[f64],
    bends: &[f64],
    nodes: &[usize],
) -> bool {
    if vertex_count(skin, edges) <= MOST_VERTICES {
        return false;
    }
    let typical = typical_thickness(skin, thickness, nodes);
    let [far, everywhere] = LONGER_EDGES;
    let distances = skin.skin_distances(nodes, f64::INFINITY);
    let bounded = |edge: f64, longer: f64, bend: f64| longer.min((EDGE_PER_BEND[1] * bend).max(edge));
    let graded = |step: u32| {
        let [share, growth] = [EDGE_PER_THICKNESS, EDGE_GROWTH]
            .map(|[least, most]| least + (most - least) * f64::from(step) / f64::from(GROWTH_STEPS));
        let mut graded = edges.to_vec();
        for &(vertex, away) in &distances {
            let thickness = thickness[vertex].min((typical * typical * thickness[vertex]).cbrt());
            let edge = edges[vertex].min(share * thickness + growth * away);
            graded[vertex] = bounded(edge, (edge + growth * away).min(far * edge), bends[vertex]);
        }
        graded
    };
    let fits = |edges: &Vec<f64>| vertex_count(skin, edges) <= MOST_VERTICES;
    let graded = (0..GROWTH_STEPS).map(graded).find(fits).unwrap_or_else(|| graded(GROWTH_STEPS));
    edges.copy_from_slice(&graded);
    let longer = (vertex_count(skin, edges) / MOST_VERTICES).sqrt().clamp(1.0, everywhere);
    edges.iter_mut().zip(bends).for_each(|(edge, &bend)| *edge = bounded(*edge, longer * *edge, bend));
    true
}

/// The median thickness (m) over the coarse vertices at the nodes, their edges being a share of it.
fn typical_thickness(skin: &Surface, thickness: &[f64], nodes: &[usize]) -> f64 {
    let mut counts: Vec<(f64, f64)> = nodes
        .iter()
        .map(|&node| (thickness[node], skin.vertex_areas()[node] / thickness[node].powi(2)))
        .collect();
    counts.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * counts.iter().map(|(_, count)| count).sum::<f64>();
    let mut below = 0.0;
    for (thickness, count) in counts {
        below += count;
        if below >= half {
            return thickness;
        }
    }
    f64::INFINITY
}

/// Radius that the skin bends with at each vertex (n, m): from the turn of the normals along the edges around it, and
/// around its neighbours.
///
/// * `is_held`: vertices that count for none (n), such as those of a cut
fn bend_radii(skin: &Surface, is_held: &[bool]) -> Vec<f64> {
    let (points, normals) = (skin.vertices(), skin.vertex_normals());
    let mean = |vertex: usize, value: &dyn Fn(usize) -> f64| {
        let others = skin.neighbours(vertex).iter().map(|&other| other as usize);
        let (sum, count) = others
            .filter(|&other| !is_held[other])
            .fold((0.0, 0.0), |(sum, count), other| (sum + value(other), count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let all = 0..points.len();
    let turn_squared = |vertex: usize, other: usize| {
        (normals[vertex] - normals[other]).norm_squared() / (points[vertex] - points[other]).norm_squared()
    };
    let around =
        |vertex| if is_held[vertex] { 0.0 } else { mean(vertex, &|other| turn_squared(vertex, other)) };
    let own: Vec<f64> = all.clone().map(around).collect();
    all.map(|vertex| 1.0 / mean(vertex, &|other| own[other]).sqrt()).collect()
}

/// A bone with fewer vertices, where it may have: edges by its distance from the skin and by its own size.
pub(crate) fn coarse_bone(bone: &Surface, skin: &Surface) -> Surface {
    let widest = mean_thickness(bone);
    let wanted = |depth: f64| BONE_EDGE_PER_THICKNESS * depth.min(widest);
    let edge_length: Vec<f64> = tissue_thickness(bone, skin).into_iter().map(wanted).collect();
    let coarse = CoarseSkin::new(bone, &edge_length, &vec![false; edge_length.len()]);
    match coarse {
        Ok(coarse) if find_crossings(coarse.surface.vertices(), coarse.surface.faces()).is_empty() => {
            coarse.surface
        }
        _ => bone.clone(),
    }
}

/// A body on a coarse skin.
pub(crate) struct OnCoarse {
    pub skin: CoarseSkin,
    /// Vertices of the skin that do not move (n).
    pub fixed: Vec<bool>,
    /// Vertices to prepare: those asked for, or all that move where edges are long away from them.
    pub nodes: Vec<usize>,
}

/// What a coarse skin was refused for, and the vertices of the skin there; none where that is all of it.
struct Refused {
    reason: String,
    at: Vec<usize>,
}

impl Body {
    /// This body on its coarse skin; `None` where the skin itself is as coarse as that.
    ///
    /// * `nodes`: vertices where contact is expected
    ///
    /// # Errors
    /// [`BodyError::CoarseEdgeLength`], [`BodyError::CoarseMesh`], [`BodyError::Interrupted`]; what [`Body::prepare`] finds
    /// wrong with the body.
    pub(crate) fn coarse_skin(
        &self,
        skin: &Surface,
        nodes: &[usize],
        interrupt: Option<&(dyn Fn() -> bool + Sync)>,
    ) -> Result<Option<OnCoarse>, BodyError> {
        let start = Instant::now();
        let vertex_count = skin.vertices().len();
        if self.coarse_edge_length == Some(0.0) {
            return Ok(None);
        }
        let fixed = self.held_vertices(skin)?;
        check_nodes(vertex_count, &fixed, nodes)?;
        let (mut edge_length, has_many, tries) = match self.coarse_edge_length {
            Some(length) => {
                let size = skin.bounding_box().diagonal();
                if !(length > 0.0 && length <= size) {
                    return Err(BodyError::CoarseEdgeLength { value: length, size });
                }
                (vec![length; vertex_count], false, 1)
            }
            None => {
                let (wanted, has_many) = self.wanted_edges(skin, &fixed, nodes);
                (wanted, has_many, MOST_COARSE_MESHES)
            }
        };
        let own_edges = skin.mean_edges();
        // Where they would be shorter than the skin's own, that stays as it is.
        let shorter =
            |length: f64, own: f64| if SHORTER_EDGES * length < own { 0.0 } else { SHORTER_EDGES * length };
        let mut coarse = self.coarse_body(skin, &edge_length, &fixed);
        for _ in 1..tries {
            let Err(refused) = &coarse else { break };
            if interrupt.is_some_and(|interrupt| interrupt()) {
                let seconds = start.elapsed().as_secs_f64();
                return Err(BodyError::Interrupted { stage: "coarse mesh", seconds });
            }
            let everywhere: Vec<usize> = (0..vertex_count).collect();
            let at = if refused.at.is_empty() { &everywhere } else { &refused.at };
            at.iter().for_each(|&at| edge_length[at] = shorter(edge_length[at], own_edges[at]));
            coarse = self.coarse_body(skin, &edge_length, &fixed);
        }
        let coarse = match coarse {
            Ok(coarse) => coarse,
            Err(Refused { reason, .. }) => {
                check_uncrossed(skin)?;
                return Err(BodyError::CoarseMesh { reason });
            }
        };
        Ok(coarse.map(|coarse| {
            let moving = || (0..vertex_count).filter(|&vertex| !fixed[vertex]).collect();
            OnCoarse { skin: coarse, nodes: if has_many { moving() } else { nodes.to_vec() }, fixed }
        }))
    }

    /// Lengths of the coarse edges that the tissue and the bend of the skin ask for (n, m), and whether the skin would get
    /// too many vertices.
    fn wanted_edges(&self, skin: &Surface, fixed: &[bool], nodes: &[usize]) -> (Vec<f64>, bool) {
        let deepest = mean_thickness(skin);
        let known = self.tissue_thickness(skin, fixed);
        let mut thickness = known.unwrap_or_else(|| vec![deepest; skin.vertices().len()]);
        thickness.iter_mut().for_each(|t| *t = t.min(deepest));
        let share = edge_per_thickness(skin, &thickness);
        let bends = bend_radii(skin, fixed);
        let wanted = |(thickness, bend): (f64, &f64)| (share * thickness).min(EDGE_PER_BEND[0] * bend);
        let mut edges: Vec<f64> = thickness.iter().copied().zip(&bends).map(wanted).collect();
        let has_many = lengthen_edges(&mut edges, skin, &thickness, &bends, nodes);
        (edges, has_many)
    }

    /// The skin with edges of so many m, if that is a body around the same bone; `None` where it is the skin itself.
    fn coarse_body(
        &self,
        skin: &Surface,
        edge_length: &[f64],
        fixed: &[bool],
    ) -> Result<Option<CoarseSkin>, Refused> {
        let everywhere = |reason: String| Refused { reason, at: Vec::new() };
        let coarse =
            CoarseSkin::new(skin, edge_length, fixed).map_err(|error| everywhere(error.to_string()))?;
        if coarse.fine_vertices.len() == skin.vertices().len() {
            return Ok(None);
        }
        let own_crossings = find_crossings(coarse.surface.vertices(), coarse.surface.faces());
        if let Some([one, other]) = own_crossings.first() {
            let reason = format!("its faces {one} and {other} cross");
            return Err(Refused { reason, at: coarse.around(own_crossings.as_flattened()) });
        }
        let held = coarse.fine_vertices.iter().map(|&vertex| fixed[vertex]).collect();
        let body = Self { fixed: self.fixed.as_ref().map(|_| held), ..self.clone() };
        match body.held_vertices(&coarse.surface) {
            Ok(_) => Ok(Some(coarse)),
            Err(error) => {
                let pairs = self.bone.as_ref().map_or_else(Vec::new, |bone| crossings(&coarse.surface, bone));
                let faces: Vec<usize> = pairs.into_iter().map(|[face, _]| face).collect();
                Err(Refused { reason: error.to_string(), at: coarse.around(&faces) })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball() -> (Surface, Vec<usize>) {
        let (vertices, faces) = crate::sample::icosphere(1.0, 4);
        let skin = Surface::new(vertices, faces).expect("a sphere is sound");
        let cap = (0..skin.vertices().len()).filter(|&vertex| skin.vertices()[vertex].z > 0.8).collect();
        (skin, cap)
    }

    #[test]
    fn edges_of_a_small_skin_stay_as_they_are() {
        let (skin, cap) = ball();
        let bends = vec![1.0; skin.vertices().len()];
        // 4 pi / (sqrt(3)/2 0.2^2) = 363 vertices
        let mut edges = vec![0.2; skin.vertices().len()];
        assert!(!lengthen_edges(&mut edges, &skin, &bends, &bends, &cap));
        assert!(edges.iter().all(|&edge| edge == 0.2));
    }

    #[test]
    fn a_large_skin_gets_longer_edges_first_away_from_the_nodes() {
        let (skin, cap) = ball();
        let bends = vec![1.0; skin.vertices().len()];
        let south = (0..skin.vertices().len())
            .min_by(|&a, &b| skin.vertices()[a].z.total_cmp(&skin.vertices()[b].z))
            .expect("vertices");
        // The cap is a tenth of the sphere, so that twice the length elsewhere is enough for the first alone.
        let thickness = vec![1.0; skin.vertices().len()];
        for (times_too_many, is_enough) in [(1.14, true), (3.2, false)] {
            let area = 4.0 * std::f64::consts::PI;
            let edge = (area / (0.75_f64.sqrt() * times_too_many * MOST_VERTICES)).sqrt();
            let mut edges = vec![edge; skin.vertices().len()];
            assert!(lengthen_edges(&mut edges, &skin, &thickness, &bends, &cap));
            assert!(vertex_count(&skin, &edges) < MOST_VERTICES * (1.0 + 1e-9));
            assert_eq!(edges[cap[0]] == edge, is_enough);
            assert!((edges[south] / edges[cap[0]] - LONGER_EDGES[0]).abs() < 1e-12);
        }
    }

    #[test]
    fn edges_at_few_nodes_are_the_least_share_of_the_thickness() {
        let (skin, _) = ball();
        let cap: Vec<usize> =
            (0..skin.vertices().len()).filter(|&vertex| skin.vertices()[vertex].z > 0.95).collect();
        let (thickness, bends) = (vec![0.1; skin.vertices().len()], vec![1.0; skin.vertices().len()]);
        // 4 pi / (sqrt(3)/2 0.07^2) = 2960 vertices
        let mut edges = vec![0.07; skin.vertices().len()];
        assert!(lengthen_edges(&mut edges, &skin, &thickness, &bends, &cap));
        assert!(vertex_count(&skin, &edges) < MOST_VERTICES);
        assert!(cap.iter().all(|&node| (edges[node] - 0.04).abs() < 1e-15));
    }

    #[test]
    fn edges_at_the_nodes_grow_with_the_cube_root_of_the_thickness() {
        let (skin, _) = ball();
        let all: Vec<usize> = (0..skin.vertices().len()).collect();
        let thickness: Vec<f64> =
            skin.vertices().iter().map(|vertex| if vertex.z > 0.0 { 0.08 } else { 0.32 }).collect();
        let mut edges: Vec<f64> = thickness.iter().map(|thickness| 0.7 * thickness).collect();
        assert!(lengthen_edges(&mut edges, &skin, &thickness, &vec![1.0; all.len()], &all));
        for (edge, thickness) in edges.iter().zip(&thickness) {
            let of_thin = edges.iter().copied().fold(f64::INFINITY, f64::min);
            assert!((edge / of_thin - (thickness / 0.08).cbrt()).abs() < 1e-12);
        }
    }
}
