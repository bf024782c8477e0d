//! Axis-aligned boxes.

use nalgebra::{Matrix3, Vector3};

/// Largest magnitude of a coordinate or a length (m), far below where products of five of them overflow.
pub const LARGEST_COORDINATE: f64 = 1e60;

/// Whether all coordinates are numbers and none is beyond [`LARGEST_COORDINATE`].
pub(crate) fn is_within_range(point: &Vector3<f64>) -> bool {
    point.iter().all(|x| x.abs() <= LARGEST_COORDINATE)
}

/// Axis-aligned box, its border included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest coordinates (m).
    pub low: Vector3<f64>,
    /// Highest coordinates (m).
    pub high: Vector3<f64>,
}

impl Bounds {
    /// The smallest box around some points (m); `low` = inf and `high` = -inf without any.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Vector3<f64>>) -> Bounds {
        Self::around_each(points.into_iter().copied())
    }

    /// The same of points that are stored nowhere.
    pub fn around_each(points: impl IntoIterator<Item = Vector3<f64>>) -> Bounds {
        let none = Bounds { low: Vector3::repeat(f64::INFINITY), high: Vector3::repeat(f64::NEG_INFINITY) };
        points
            .into_iter()
            .fold(none, |bounds, point| Bounds { low: bounds.low.inf(&point), high: bounds.high.sup(&point) })
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Bounds) -> Bounds {
        Bounds { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The common part of both; `low` exceeds `high` along some axis if there is none.
    pub fn intersection(&self, other: &Bounds) -> Bounds {
        Bounds { low: self.low.sup(&other.low), high: self.high.inf(&other.high) }
    }

    /// The box with every side moved outward by `margin` (m).
    #[inline]
    pub fn grown(&self, margin: f64) -> Bounds {
        Bounds { low: self.low.add_scalar(-margin), high: self.high.add_scalar(margin) }
    }

    /// The box moved by `translation` (m).
    pub fn translated(&self, translation: &Vector3<f64>) -> Bounds {
        Bounds { low: self.low + translation, high: self.high + translation }
    }

    /// The box around this one after a turn.
    pub fn turned(&self, turn: &Matrix3<f64>) -> Bounds {
        let along = |axis: usize| turn.row(axis).transpose();
        Bounds {
            low: Vector3::from_fn(|axis, _| -self.farthest_along(&-along(axis))),
            high: Vector3::from_fn(|axis, _| self.farthest_along(&along(axis))),
        }
    }

    /// Whether the box holds a point.
    pub fn contains(&self, point: &Vector3<f64>) -> bool {
        *point >= self.low && *point <= self.high
    }

    /// Whether the boxes have a point in common.
    pub fn meets(&self, other: &Bounds) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// Length of the diagonal (m).
    pub fn diagonal(&self) -> f64 {
        (self.high - self.low).norm()
    }

    /// The middle of the box (m).
    pub fn center(&self) -> Vector3<f64> {
        (self.low + self.high) * 0.5
    }

    /// How far along a direction some of the box lies (m).
    pub fn farthest_along(&self, direction: &Vector3<f64>) -> f64 {
        self.low.component_mul(direction).sup(&self.high.component_mul(direction)).sum()
    }

    /// Distance between two boxes (m), 0 where they meet.
    pub fn distance(&self, other: &Bounds) -> f64 {
        self.distance_squared(other).sqrt()
    }

    /// Square of the distance between two boxes (m²), 0 where they meet.
    #[inline]
    pub fn distance_squared(&self, other: &Bounds) -> f64 {
        let gap = (self.low - other.high).sup(&(other.low - self.high));
        gap.sup(&Vector3::zeros()).norm_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds(low: [f64; 3], high: [f64; 3]) -> Bounds {
        Bounds { low: low.into(), high: high.into() }
    }

    #[test]
    fn boxes_apart_in_one_two_and_three_axes_have_the_distance_of_their_nearest_features() {
        let unit = bounds([0.0; 3], [1.0; 3]);
        for (low, distance) in
            [([3.0, 0.2, 0.2], 2.0), ([4.0, 5.0, 0.0], 5.0), ([2.0, 3.0, 3.0], 3.0), ([1.0, 0.5, 0.0], 0.0)]
        {
            let other = bounds(low, low.map(|x| x + 1.0));
            assert_eq!(unit.distance(&other), distance);
            assert_eq!(other.distance(&unit), distance);
        }
    }

    #[test]
    fn a_box_holds_its_border_and_nothing_beyond() {
        let points = [Vector3::new(0.0, 3.0, -1.0), Vector3::new(2.0, 1.0, 1.0)];
        let around = Bounds::around(&points);
        assert_eq!(around, bounds([0.0, 1.0, -1.0], [2.0, 3.0, 1.0]));
        assert!(points.iter().all(|point| around.contains(point)) && around.contains(&around.center()));
        assert!(!around.contains(&Vector3::new(1.0, 1.0, 1.1)));
        assert!(around.grown(0.2).contains(&Vector3::new(1.0, 1.0, 1.1)));
        assert_eq!(around.diagonal(), 12f64.sqrt());
        assert!(!Bounds::around(&[]).contains(&Vector3::zeros()));
    }
}
