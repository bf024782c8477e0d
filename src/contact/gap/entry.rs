//! Vertices that came in through another side than their closest one: their gap is measured back the way they came, along
//! the press, or along the inward normal of the skin where a scene stands in overlap.
//!
//! Beside an edge of the obstacle, and inside a wall thinner than the depth, the closest surface is a side of it or its
//! far end: a gap to it pushes the skin out sideways, at a fraction of the force. Along the travel of a press the vertex
//! met the obstacle at the entry point `e = x + s t`, with t the direction of travel and s the way back (m); in
//! overlap t is the inward normal of the skin, and e the farthest surface along it within the search distance. From the
//! plane of the surface there, with its normal m,
//!
//! ```text
//! g0 = -s (m . t)    along m
//! ```
//!
//! Skin that does not face the travel was slid past and not passed through: it is not met from behind.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::gap::measured::Measured;
use crate::contact::scene::{Scene, Travel};
use crate::obstacle::posed::Obstacle;

/// Closest and entry normal are of two sides of the obstacle where their cosine is below this: 60 degrees and a little, as
/// regular meshes have normals that meet at 60 degrees but for rounding.
pub(crate) const OTHER_SIDE: f64 = 0.499;

/// How skin came into the obstacle.
pub(crate) enum WayIn<'a> {
    /// Against the travel of a press, of points on skin that faces it or is passed by.
    Press { travel: &'a Travel, faces: Vec<bool> },
    /// Along its inward unit normals, one for each point, from no farther than the reach of that (m).
    Inward { normals: Vec<Vector3<f64>>, reach: Vec<f64> },
}

impl<'a> WayIn<'a> {
    /// Of skin with outward unit normals under a scene.
    ///
    /// * `reach`: how far a point looks for it in overlap (m)
    pub fn new(
        scene: &'a Scene,
        outward: impl Iterator<Item = Vector3<f64>>,
        reach: impl Fn(usize) -> f64,
    ) -> Self {
        match &scene.press {
            Some(travel) => {
                let faces = outward.map(|normal| normal.dot(&travel.direction) < -OTHER_SIDE).collect();
                Self::Press { travel, faces }
            }
            None => {
                let normals: Vec<Vector3<f64>> = outward.map(|normal| -normal).collect();
                let reach = (0..normals.len()).map(reach).collect();
                Self::Inward { normals, reach }
            }
        }
    }

    fn direction(&self, point: usize) -> Vector3<f64> {
        match self {
            Self::Press { travel, .. } => travel.direction,
            Self::Inward { normals, .. } => normals[point],
        }
    }

    /// Whether the obstacle may have come through the skin at a point, and did not slide past it.
    fn may_pass(&self, point: usize) -> bool {
        match self {
            Self::Press { faces, .. } => faces[point],
            Self::Inward { .. } => true,
        }
    }

    /// How far back the way of a point (m) goes at the most; inside the obstacle none is deeper.
    fn reach(&self, row: usize, point: &Vector3<f64>, is_inside: bool) -> f64 {
        match self {
            Self::Press { travel, .. } if is_inside => travel.deepest,
            Self::Press { travel, .. } => travel.way_to(point),
            Self::Inward { reach, .. } => reach[row],
        }
    }

    /// The way of each of some points (m) back to where it met the obstacle; `None` where it did not.
    fn back(
        &self,
        obstacle: &Obstacle,
        rows: &[usize],
        points: &[Vector3<f64>],
        directions: &[Vector3<f64>],
    ) -> Result<Vec<Option<f64>>, ContactError> {
        Ok(match self {
            Self::Press { travel, .. } => {
                obstacle.entry_distances(points, &travel.direction, travel.deepest)?
            }
            Self::Inward { reach, .. } => {
                let reach: Vec<f64> = rows.iter().map(|&row| reach[row]).collect();
                obstacle.farthest_surfaces(points, directions, &reach)?
            }
        })
    }
}

/// A point is in the obstacle from this share of its reach on: skin in contact lies on it, but for rounding.
const ON_SURFACE: f64 = 1e-7;
/// A normal faces against the way in from this cosine on: that of a side is no more than rounded.
pub(crate) const FACING_BACK: f64 = -1e-3;

/// Vertices whose gap is measured back the way they came.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct EntryGap {
    /// All of them.
    pub vertices: usize,
    /// Those that went through a wall thinner than twice their depth: they left the obstacle again, or their closest
    /// surface faces against the travel, or lies on a wall thinner than twice the way back.
    pub through_walls: usize,
}

/// A point whose gap is measured back the way it came.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entered {
    pub point: usize,
    /// Back to where it met the obstacle (m).
    pub way: f64,
    /// Whether it left the obstacle again.
    pub has_left: bool,
}

/// Measures the gap back along the way in where the entry normal points elsewhere than the one at the closest point.
///
/// Others keep their gap to the bit. Returns these points too.
///
/// * `points`: (k, m)
/// * `may_touch`: which of them
pub(crate) fn measure_entries(
    points: &[Vector3<f64>],
    may_touch: impl Fn(usize) -> bool,
    obstacle: &Obstacle,
    way_in: &WayIn,
    gaps: &mut Measured,
) -> Result<(EntryGap, Vec<Entered>), ContactError> {
    let cosine = |row: usize| gaps.normal[row].dot(&way_in.direction(row));
    let is_inside = |row: usize| gaps.distance[row] < -ON_SURFACE * way_in.reach(row, &points[row], true);
    let reach = |row: usize| way_in.reach(row, &points[row], is_inside(row));
    let suspects: Vec<usize> = (0..gaps.distance.len())
        .filter(|&row| may_touch(row) && gaps.distance[row] < reach(row))
        .filter(|&row| is_inside(row) || way_in.may_pass(row))
        .filter(|&row| cosine(row) < if is_inside(row) { OTHER_SIDE } else { FACING_BACK })
        .collect();
    if suspects.is_empty() {
        return Ok((EntryGap::default(), Vec::new()));
    }
    let suspected: Vec<Vector3<f64>> = suspects.iter().map(|&row| points[row]).collect();
    let directions: Vec<Vector3<f64>> = suspects.iter().map(|&row| way_in.direction(row)).collect();
    let ways = way_in.back(obstacle, &suspects, &suspected, &directions)?;
    let in_reach =
        |(row, way): (usize, Option<f64>)| way.filter(|way| *way <= reach(row)).map(|way| (row, way));
    let met: Vec<(usize, f64)> = suspects.into_iter().zip(ways).filter_map(in_reach).collect();
    let entries: Vec<Vector3<f64>> =
        met.iter().map(|&(vertex, way)| points[vertex] + way * way_in.direction(vertex)).collect();
    let entry_normal = obstacle.signed_distance(&entries, None)?.normal;
    // Through the closest point and on by twice the way back: outside again behind a thin wall.
    let beyond: Vec<Vector3<f64>> = met
        .iter()
        .map(|&(vertex, way)| points[vertex] - (gaps.distance[vertex] + 2.0 * way) * gaps.normal[vertex])
        .collect();
    let behind = obstacle.signed_distance(&beyond, None)?.distance;
    let (mut entered, mut through_walls) = (Vec::new(), 0);
    for (row, (vertex, way)) in met.into_iter().enumerate() {
        let (normal, entry) = (gaps.normal[vertex], entry_normal[row]);
        let advance = entry.dot(&way_in.direction(vertex));
        let faces_back = normal.dot(&way_in.direction(vertex)) < FACING_BACK && way_in.may_pass(vertex);
        if normal.dot(&entry) >= OTHER_SIDE && !faces_back || advance <= 0.0 {
            continue;
        }
        let has_left = gaps.distance[vertex] >= 0.0;
        let through_wall = has_left || faces_back || behind[row] > 0.0;
        gaps.distance[vertex] = -way * advance;
        gaps.normal[vertex] = entry;
        entered.push(Entered { point: vertex, way, has_left });
        through_walls += usize::from(through_wall);
    }
    Ok((EntryGap { vertices: entered.len(), through_walls }, entered))
}

#[cfg(test)]
mod tests {
    use nalgebra::UnitQuaternion;

    use super::*;
    use crate::contact::tilt::axes::Turn;

    #[test]
    fn a_turn_meets_the_skin_behind_on_the_side_that_it_brings_forward_alone() {
        let (up, arm) = (Vector3::z(), 20e-3);
        let rotation = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -0.2);
        let turn = Turn { rotation, point: Vector3::zeros() };
        let plate = turn.of(&Obstacle::cuboid(Vector3::new(0.05, 0.05, 2e-4)).expect("a plate"));
        // 1 mm behind the plate, on the side that came forward by 4 mm, and on the other.
        let points = [arm, -arm].map(|x| rotation * Vector3::new(x, 0.0, -1.2e-3));
        let travel = Travel { direction: up, depth: 1e-3, past: 1e-3, turned: Some(turn), deepest: 0.02 };
        let mut gaps = Measured::near(&points, &plate, 0.01, None).expect("points");
        let way_in = WayIn::Press { travel: &travel, faces: vec![true; 2] };
        measure_entries(&points, |_| true, &plate, &way_in, &mut gaps).expect("points");
        // Back to the upper face, along its normal.
        let expected = [-1.4e-3, 1e-3];
        (gaps.distance.iter().zip(expected)).for_each(|(gap, at)| assert!((gap - at).abs() < 1e-12, "{gap}"));
    }
}
