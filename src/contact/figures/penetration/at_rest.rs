//! How deep skin at rest and obstacle stand in one another between the vertices of the skin.

use nalgebra::Vector3;

use crate::contact::error::ContactError;
use crate::contact::figures::penetration::between::PointsBetween;
use crate::contact::gap::edge::{SkinPart, triangles_among};
use crate::contact::gap::measured::Measured;
use crate::obstacle::posed::Obstacle;
use crate::surface::checked::Surface;

/// Skin at rest that is near to the obstacle.
pub(crate) struct SkinNear {
    pub vertices: Vec<usize>,
    points: Vec<Vector3<f64>>,
    /// Of the points from the obstacle (m).
    pub distance: Vec<f64>,
    triangles: Vec<[u32; 3]>,
    /// The longest edge of the skin (m): no point between vertices is nearer to the obstacle than these by more.
    reach: f64,
}

impl SkinNear {
    /// * `depth_bound`: as of [`Measured::near`] (m)
    pub fn new(
        surface: &Surface,
        obstacle: &Obstacle,
        depth_bound: Option<f64>,
    ) -> Result<Self, ContactError> {
        let skin: Vec<usize> =
            (0..surface.vertices().len()).filter(|&vertex| surface.skin_mask()[vertex]).collect();
        let points: Vec<Vector3<f64>> = skin.iter().map(|&vertex| surface.vertices()[vertex]).collect();
        let reach = skin.iter().map(|&vertex| surface.longest_edge(vertex)).fold(0.0, f64::max);
        let distance = Measured::near(&points, obstacle, reach, depth_bound)?.distance;
        let near: Vec<usize> = (0..skin.len()).filter(|&row| distance[row] <= reach).collect();
        let (vertices, points): (Vec<usize>, Vec<Vector3<f64>>) =
            near.iter().map(|&row| (skin[row], points[row])).unzip();
        let distance = near.iter().map(|&row| distance[row]).collect();
        Ok(Self { triangles: triangles_among(surface, &vertices), vertices, points, distance, reach })
    }

    /// Deepest penetration (m) of what first touch looks at between vertices; `least` (m) where none is deeper.
    pub fn deepest_edge(&self, obstacle: &Obstacle, least: f64) -> f64 {
        self.part().deepest_edge(obstacle, self.reach, least, &self.distance)
    }

    fn part(&self) -> SkinPart<'_> {
        SkinPart { points: &self.points, triangles: &self.triangles }
    }
}

/// Deepest penetration (m, ≥ 0) of skin and obstacle into one another at rest, where no vertex of the skin penetrates.
pub(crate) fn penetration_between(surface: &Surface, obstacle: &Obstacle) -> Result<f64, ContactError> {
    let near = SkinNear::new(surface, obstacle, Some(0.0))?;
    let of_edges = near.part().deepest_between(obstacle, near.reach, 0.0, &near.distance);
    let depths: Vec<f64> = near.distance.iter().map(|distance| -distance).collect();
    Ok(PointsBetween::new(&near.points, &depths, &near.triangles).look(obstacle, of_edges)?.deepest)
}
