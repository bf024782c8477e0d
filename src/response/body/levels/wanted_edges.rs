//! How long the edges of a coarse mesh may be over the tissue.

use crate::response::body::levels::thickness::mean_thickness;
use crate::response::body::solve::Body;
use crate::surface::checked::Surface;

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

/// Vertices of equilateral triangles with edges of so many m (n).
fn vertex_count(skin: &Surface, edges: &[f64]) -> f64 {
    let areas = skin.vertex_areas().iter().zip(edges);
    areas.map(|(area, edge)| area / (0.75_f64.sqrt() * edge * edge)).sum()
}

/// The share of the thickness (n, m) that leaves not too many vertices beside those that are kept.
fn edge_per_thickness(skin: &Surface, thickness: &[f64], kept: &[usize]) -> f64 {
    let [least, most] = EDGE_PER_THICKNESS;
    let mut elsewhere = thickness.to_vec();
    kept.iter().for_each(|&vertex| elsewhere[vertex] = f64::INFINITY);
    let vertices = vertex_count(skin, &elsewhere) / (least * least);
    let many = (MANY_VERTICES - kept.len() as f64).max(1.0);
    (least * (vertices / many).sqrt()).clamp(least, most)
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

impl Body {
    /// Lengths of the coarse edges that the tissue and the bend of the skin ask for (n, m), and whether the skin would get
    /// too many vertices.
    ///
    /// * `fixed`: vertices of the skin that do not move (n)
    /// * `kept`: vertices that stay whatever the length
    /// * `nodes`: vertices where contact is expected
    pub(super) fn wanted_edges(
        &self,
        skin: &Surface,
        fixed: &[bool],
        kept: &[usize],
        nodes: &[usize],
    ) -> (Vec<f64>, bool) {
        let deepest = mean_thickness(skin);
        let known = self.tissue_thickness(skin, fixed);
        let mut thickness = known.unwrap_or_else(|| vec![deepest; skin.vertices().len()]);
        thickness.iter_mut().for_each(|t| *t = t.min(deepest));
        let share = edge_per_thickness(skin, &thickness, kept);
        let bends = bend_radii(skin, fixed);
        let wanted = |(thickness, bend): (f64, &f64)| (share * thickness).min(EDGE_PER_BEND[0] * bend);
        let mut edges: Vec<f64> = thickness.iter().copied().zip(&bends).map(wanted).collect();
        let has_many = lengthen_edges(&mut edges, skin, &thickness, &bends, nodes);
        (edges, has_many)
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
