//! How the drawn displacement of a scalar kernel fades away from the contact; it enters no figure.

use std::f64::consts::PI;

use crate::contact::candidate::fingers::Fingers;
use crate::surface::checked::Surface;

/// The drawn displacement fades to zero over this many equivalent radii of the candidate region, so that the
/// skin has no step where the response is cut off.
const FADE_RADII: f64 = 3.0;

/// How much of its displacement every vertex is drawn with.
pub(crate) struct Fade {
    /// Empty where nothing fades.
    share: Vec<f64>,
    /// Largest distance along the skin at which that is nothing (m); infinite where nothing fades.
    pub distance: f64,
}

impl Fade {
    /// Share of its displacement that a vertex under a scalar kernel is drawn with, 1 on a candidate.
    pub fn share(&self, vertex: usize) -> f64 {
        self.share.get(vertex).copied().unwrap_or(1.0)
    }

    /// * `candidates`: all of them
    /// * `scalar`: those that a scalar kernel answers for; a body's displacement does not fade
    pub fn new(surface: &Surface, fingers: &Fingers, candidates: &[usize], scalar: &[usize]) -> Self {
        if scalar.is_empty() {
            return Self { share: Vec::new(), distance: f64::INFINITY };
        }
        if scalar.len() < candidates.len() {
            return Self::on_one(surface, scalar);
        }
        match &fingers.candidates[..] {
            [finger] => Self::on_one(surface, finger),
            _ => Self::on_fingers(surface, fingers),
        }
    }

    fn on_one(surface: &Surface, candidates: &[usize]) -> Self {
        let distance = fade_distance(surface, candidates);
        let mut share = vec![0.0; surface.vertices().len()];
        for (vertex, way) in surface.skin_distances(candidates, distance) {
            share[vertex] = fade(way / distance);
        }
        Self { share, distance }
    }

    fn on_fingers(surface: &Surface, fingers: &Fingers) -> Self {
        // Half-way to the next finger another one's displacement begins, so this one's ends there.
        let distances: Vec<f64> = (fingers.candidates.iter().zip(fingers.distances_to_next(surface)))
            .map(|(finger, to_next)| fade_distance(surface, finger).min(0.5 * to_next))
            .collect();
        let share = |vertex| match (fingers.finger_of(vertex), fingers.distance(vertex)) {
            (Some(finger), Some(way)) => fade(way / distances[finger]),
            _ => 0.0,
        };
        let share = (0..surface.vertices().len()).map(share).collect();
        Self { share, distance: distances.into_iter().fold(0.0, f64::max) }
    }
}

/// Way from the candidates at which the drawn displacement has faded (m).
pub(crate) fn fade_distance(surface: &Surface, candidates: &[usize]) -> f64 {
    let area: f64 = candidates.iter().map(|&vertex| surface.vertex_areas()[vertex]).sum();
    FADE_RADII * (area / PI).sqrt()
}

/// 1 at 0, 0 from 1 on, level at both ends.
pub(crate) fn fade(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    1.0 - x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::fade;

    #[test]
    fn fade_is_whole_at_the_contact_gone_at_its_end_and_level_at_both() {
        assert_eq!((fade(0.0), fade(1.0), fade(7.0)), (1.0, 0.0, 0.0));
        let slope = |x: f64| (fade(x + 1e-6) - fade(x - 1e-6)) / 2e-6;
        assert!(slope(1e-6).abs() < 1e-5 && slope(1.0 - 1e-6).abs() < 1e-5);
    }
}
