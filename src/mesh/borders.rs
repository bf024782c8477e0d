//! Borders that run along each other without being joined.

use nalgebra::Vector3;

use crate::mesh::adjacency::NO_FACE;
use crate::mesh::csr::Csr;
use crate::mesh::distinct::distinct;
use crate::mesh::error::MeshError;
use crate::mesh::grid::PointGrid;
use crate::mesh::topology::are_joined;

/// Border vertices closer than this part of the mean edge length are one vertex left unwelded (dimensionless).
const UNWELDED_DISTANCE: f64 = 1e-3;
/// Two border vertices farther apart than this part of the edges at one of them are no twins, however fine the mesh is
/// there: neighbours of one vertex are that close only where the border turns back at less than 15° (dimensionless).
const LOCAL_DISTANCE: f64 = 0.25;
/// How far to look for the twins of border vertices once some are known to be unwelded, in mean edge lengths.
const TWIN_DISTANCE: f64 = 0.05;

/// Looks for border vertices that lie on another border vertex, or on a border edge, without being joined to it.
pub(super) fn check_borders(
    vertices: &[Vector3<f64>],
    faces: &[[u32; 3]],
    across: &[[u32; 3]],
    incident: &Csr,
    mean_edge_length: f64,
) -> Result<(), MeshError> {
    let mut edges = Vec::new();
    for (corners, others) in faces.iter().zip(across) {
        for k in (0..3).filter(|k| others[*k] == NO_FACE) {
            edges.push(BorderEdge {
                ends: [corners[k], corners[(k + 1) % 3]],
                opposite: corners[(k + 2) % 3],
            });
        }
    }
    let ids = distinct(edges.iter().flat_map(|edge| edge.ends));
    let points: Vec<Vector3<f64>> = ids.iter().map(|id| vertices[*id as usize]).collect();
    let shortest_edge = |id: &u32| {
        let corners = incident.row(*id as usize).iter().flat_map(|face| faces[*face as usize]);
        let others = corners.filter(|corner| corner != id);
        let lengths = others.map(|other| (vertices[other as usize] - vertices[*id as usize]).norm());
        lengths.fold(f64::INFINITY, f64::min)
    };
    let reaches = ids.iter().map(|id| LOCAL_DISTANCE * shortest_edge(id)).collect();
    let border = Border { ids, points, reaches, faces, incident };
    border.check_twins(mean_edge_length)?;
    border.check_edges(vertices, &edges, mean_edge_length)
}

struct BorderEdge {
    ends: [u32; 2],
    /// Third corner of the face on the edge.
    opposite: u32,
}

struct Border<'a> {
    ids: Vec<u32>,
    points: Vec<Vector3<f64>>,
    /// Farthest that a twin of each may be (m).
    reaches: Vec<f64>,
    faces: &'a [[u32; 3]],
    incident: &'a Csr,
}

impl Border<'_> {
    fn are_joined(&self, a: u32, b: u32) -> bool {
        a == b || are_joined(a, b, self.faces, self.incident)
    }

    /// For every border vertex the nearest one within `radius` that no edge joins to it.
    fn twins(&self, radius: f64) -> Vec<Option<(u32, f64)>> {
        let grid = PointGrid::new(&self.points, radius);
        let nearest = |(i, point): (usize, &Vector3<f64>)| {
            let mut best: Option<(u32, f64)> = None;
            grid.for_each_near(point, |j, distance| {
                let nearer = best.is_none_or(|(other, least)| (distance, self.ids[j]) < (least, other));
                let is_twin = distance <= self.reaches[i].min(self.reaches[j]);
                if nearer && is_twin && !self.are_joined(self.ids[i], self.ids[j]) {
                    best = Some((self.ids[j], distance));
                }
            });
            best
        };
        self.points.iter().enumerate().map(nearest).collect()
    }

    fn check_twins(&self, mean_edge_length: f64) -> Result<(), MeshError> {
        let twins = self.twins(UNWELDED_DISTANCE * mean_edge_length);
        let Some(first) = twins.iter().position(Option::is_some) else { return Ok(()) };
        let (other, distance) = twins[first].expect("the position of a twin");
        let widest = self.twins(TWIN_DISTANCE * mean_edge_length).into_iter().flatten().map(|twin| twin.1);
        // Twice the widest gap, as corners of several faces scatter around their common place.
        let weld_tolerance = (2.0 * widest.fold(0.0, f64::max)).max(1e-6 * mean_edge_length);
        Err(MeshError::Unwelded {
            vertex: self.ids[first] as usize,
            other: other as usize,
            distance,
            count: twins.iter().flatten().count(),
            weld_tolerance: round_up(weld_tolerance),
        })
    }

    /// Vertices on the inner part of a border edge that they do not belong to.
    fn check_edges(
        &self,
        vertices: &[Vector3<f64>],
        edges: &[BorderEdge],
        mean_edge_length: f64,
    ) -> Result<(), MeshError> {
        let tolerance = UNWELDED_DISTANCE * mean_edge_length;
        let start_and_way = |edge: &BorderEdge| {
            let [a, b] = edge.ends.map(|vertex| vertices[vertex as usize]);
            (a, b - a)
        };
        let total: f64 = edges.iter().map(|edge| start_and_way(edge).1.norm()).sum();
        // Balls of radius `step` at distances of at most `step` along an edge cover all that is near it.
        let step = (total / edges.len() as f64).max(2.0 * tolerance);
        let grid = PointGrid::new(&self.points, step);
        let mut found: Vec<(u32, [u32; 2], f64)> = Vec::new();
        for edge in edges {
            let (a, way) = start_and_way(edge);
            let pieces = (way.norm() / step).ceil().max(1.0) as usize;
            for piece in 0..pieces {
                let center = a + way * ((piece as f64 + 0.5) / pieces as f64);
                grid.for_each_near(&center, |j, _| {
                    let id = self.ids[j];
                    let s = (self.points[j] - a).dot(&way) / way.norm_squared();
                    let distance = (self.points[j] - (a + way * s)).norm();
                    let is_on = s > 0.0 && s < 1.0 && distance <= tolerance.min(self.reaches[j]);
                    // The tip of a thin face on the border may come this close to its own border edge.
                    if is_on && !edge.ends.contains(&id) && id != edge.opposite {
                        found.push((id, edge.ends, distance));
                    }
                });
            }
        }
        found.sort_by_key(|hit| (hit.0, hit.1));
        found.dedup_by_key(|hit| hit.0);
        match found.first() {
            Some((vertex, ends, distance)) => Err(MeshError::UnjoinedBorder {
                vertex: *vertex as usize,
                edge: ends.map(|end| end as usize),
                distance: *distance,
                count: found.len(),
            }),
            None => Ok(()),
        }
    }
}

/// Rounds a positive number up to two digits, to be typed in again.
fn round_up(value: f64) -> f64 {
    let unit = 10f64.powi(value.log10().floor() as i32 - 1);
    let rounded = (value / unit).ceil() * unit;
    // The decimal text is what a person copies; it must not fall below the value.
    format!("{rounded:.1e}").parse().unwrap_or(rounded)
}

#[cfg(test)]
mod tests {
    use super::round_up;

    #[test]
    fn tolerances_round_up_to_two_digits() {
        for (value, expected) in
            [(8.21e-6, 8.3e-6), (8.3e-6, 8.3e-6), (1.0, 1.0), (9.91, 10.0), (1.4e-9, 1.4e-9), (123.0, 130.0)]
        {
            assert_eq!(round_up(value), expected);
            assert!(round_up(value) >= value);
        }
    }
}
