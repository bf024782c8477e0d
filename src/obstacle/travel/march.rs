//! The farthest surface on a line, by marching back along it in steps of the signed distance.

use nalgebra::Vector3;

use crate::obstacle::error::ObstacleError;
use crate::obstacle::posed::Obstacle;

/// A step shorter than this, as a share of the line, ends the march.
const LAST_STEP: f64 = 1e-10;
/// Steps at the most: they shrink by half a step and more but where the line grazes the surface.
const MOST_STEPS: usize = 60;

impl Obstacle {
    /// How far (m) along its direction each point has the surface farthest on, up to its reach (m); `None` where there is none,
    /// or the line ends inside the obstacle.
    ///
    /// * `points`, `directions`, `reach`: (n) starts (m), unit vectors, lengths of the lines (m)
    pub(crate) fn farthest_surfaces(
        &self,
        points: &[Vector3<f64>],
        directions: &[Vector3<f64>],
        reach: &[f64],
    ) -> Result<Vec<Option<f64>>, ObstacleError> {
        let mut found = vec![None; points.len()];
        let mut on_way: Vec<(usize, f64)> = reach.iter().copied().enumerate().collect();
        for _ in 0..MOST_STEPS {
            if on_way.is_empty() {
                break;
            }
            let at: Vec<Vector3<f64>> =
                on_way.iter().map(|&(point, way)| points[point] + way * directions[point]).collect();
            let distance = self.signed_distance(&at, None)?.distance;
            let mut left = Vec::with_capacity(on_way.len());
            for ((point, way), distance) in on_way.into_iter().zip(distance) {
                if distance.abs() <= LAST_STEP * reach[point] {
                    found[point] = Some(way);
                } else if distance > 0.0 && way > distance {
                    left.push((point, way - distance));
                }
            }
            on_way = left;
        }
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_finds_the_far_side_of_a_sheet_and_nothing_beyond_its_end() {
        let sheet = Obstacle::cuboid(Vector3::new(1.0, 1.0, 0.1)).expect("a box");
        let points = [Vector3::new(0.2, 0.0, 0.3), Vector3::new(0.2, 0.0, -0.3), Vector3::new(3.0, 0.0, 0.3)];
        let down = [-Vector3::z(); 3];
        let ways = sheet.farthest_surfaces(&points, &down, &[1.0; 3]).expect("finite points");
        assert!((ways[0].expect("through it") - 0.4).abs() < 1e-9, "{ways:?}");
        assert_eq!(ways[1..], [None, None]);
        // The line ends inside.
        assert_eq!(sheet.farthest_surfaces(&points[..1], &down[..1], &[0.3]).expect("finite points"), [None]);
        let slant = Vector3::new(1.0, 0.0, -1.0).normalize();
        let ways = sheet.farthest_surfaces(&points[..1], &[slant], &[2.0]).expect("finite points");
        assert!((ways[0].expect("through it") - 0.4 * 2f64.sqrt()).abs() < 1e-8, "{ways:?}");
    }
}
