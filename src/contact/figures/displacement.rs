//! The skin as it looks under the solved forces, and the volume it moves.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::contact::candidate::fingers::Fingers;
use crate::contact::equilibrium::compliance::Compliance;
use crate::contact::equilibrium::solve::Equilibrium;
use crate::contact::error::ContactError;
use crate::contact::figures::volume::{VolumeOffset, take_up_second_order};
use crate::contact::gap::initial::InitialGaps;
use crate::surface::checked::Surface;

/// The drawn displacement fades to zero over this many equivalent radii of the candidate region, so that the
/// skin has no step where the response is cut off.
const FADE_RADII: f64 = 3.0;

/// Displacement of every vertex.
#[derive(Debug)]
pub(crate) struct Deformation {
    /// u (n, m), faded.
    pub displacement: Vec<Vector3<f64>>,
    /// Distance along the skin at which it has faded to zero (m); infinite where nothing fades.
    pub fade_distance: f64,
    /// Σ S_i N_i · u_i over the skin, without the fade and without the offsets (m³).
    pub volume_change: f64,
    /// What each body's skin was moved by so that its mesh changes its volume as the first order says.
    pub offsets: Vec<VolumeOffset>,
}

impl Deformation {
    /// Nothing moves.
    pub fn none(vertex_count: usize) -> Self {
        let displacement = vec![Vector3::zeros(); vertex_count];
        Self { displacement, fade_distance: 0.0, volume_change: 0.0, offsets: Vec::new() }
    }
}

/// Displaces the skin under the forces of `solved`.
///
/// On a candidate `u_i = (R f)_i n_i`, with the obstacle's normal there. Elsewhere the magnitude is `(R f)_i` too
/// and the direction that of `Σ_j R_ij f_j n_j`, which goes over into the former without a need for the obstacle's
/// normal far away. A vertex moves with the finger that is nearest along the skin. A body tells the whole
/// displacement of each of its vertices, and nothing fades there; the second order of its volume, which linear
/// elasticity leaves open, is taken up by its free skin.
pub(crate) fn deform(
    surface: &Surface,
    compliance: &Compliance,
    gaps: &InitialGaps,
    solved: &Equilibrium,
) -> Result<Deformation, ContactError> {
    let vertex_count = surface.vertices().len();
    let active = solved.active();
    let everywhere: Vec<usize> = (0..vertex_count).collect();
    let field =
        compliance.displacement(&solved.fingers, &everywhere, &active, &solved.node_force, &gaps.normal)?;
    let of_kernel = |vertex: usize| field.along_normal[vertex].is_some();
    let along =
        |(vector, rise): (&Vector3<f64>, &Option<f64>)| rise.map_or(*vector, |rise| resized(vector, rise));
    let mut displacement: Vec<Vector3<f64>> =
        field.vectors.iter().zip(&field.along_normal).map(along).collect();
    for &vertex in solved.candidates.iter().filter(|&&vertex| of_kernel(vertex)) {
        displacement[vertex] = (solved.gap[vertex] - gaps.distance[vertex]) * gaps.normal[vertex];
    }
    let volume_change = surface
        .skin_mask()
        .iter()
        .enumerate()
        .filter(|&(_, &may_touch)| may_touch)
        .map(|(vertex, _)| {
            surface.vertex_areas()[vertex] * surface.vertex_normals()[vertex].dot(&displacement[vertex])
        })
        .sum();

    let offsets = compliance
        .skin
        .bodies()
        .iter()
        .filter_map(|body| {
            let own: Vec<usize> = active.iter().copied().filter(|v| body.binary_search(v).is_ok()).collect();
            take_up_second_order(surface, body, &own, &solved.gap, &mut displacement)
        })
        .collect();

    let fading: Vec<usize> = solved.candidates.iter().copied().filter(|&vertex| of_kernel(vertex)).collect();
    if fading.is_empty() {
        return Ok(Deformation { displacement, fade_distance: f64::INFINITY, volume_change, offsets });
    }
    let fingers =
        if fading.len() == solved.candidates.len() { &solved.fingers } else { &Fingers::one(&fading) };
    let (share, fade_distance) = shares(surface, fingers);
    for (vertex, u) in displacement.iter_mut().enumerate().filter(|(vertex, _)| of_kernel(*vertex)) {
        *u *= share[vertex];
    }
    Ok(Deformation { displacement, fade_distance, volume_change, offsets })
}

/// How much of its displacement every vertex is drawn with (n), and the largest distance at which that is nothing (m).
fn shares(surface: &Surface, fingers: &Fingers) -> (Vec<f64>, f64) {
    let fade_distance = |finger: &Vec<usize>| {
        let area: f64 = finger.iter().map(|&vertex| surface.vertex_areas()[vertex]).sum();
        FADE_RADII * (area / PI).sqrt()
    };
    let mut share = vec![0.0; surface.vertices().len()];
    if let [finger] = &fingers.candidates[..] {
        let fade_distance = fade_distance(finger);
        for (vertex, distance) in surface.skin_distances(finger, fade_distance) {
            share[vertex] = fade(distance / fade_distance);
        }
        return (share, fade_distance);
    }
    // Half-way to the next finger another one's displacement begins, so this one's ends there.
    let fade_distances: Vec<f64> = (fingers.candidates.iter().enumerate())
        .map(|(index, finger)| fade_distance(finger).min(0.5 * fingers.to_next(index)))
        .collect();
    for (vertex, share) in share.iter_mut().enumerate() {
        if let (Some(finger), Some(distance)) = (fingers.of(vertex), fingers.distance(vertex)) {
            *share = fade(distance / fade_distances[finger]);
        }
    }
    (share, fade_distances.into_iter().fold(0.0, f64::max))
}

/// The vector at the length of `rise`, its direction kept: it points against the normals already where they sink.
fn resized(vector: &Vector3<f64>, rise: f64) -> Vector3<f64> {
    let norm = vector.norm();
    if norm > 0.0 { vector * (rise.abs() / norm) } else { Vector3::zeros() }
}

/// 1 at 0, 0 from 1 on, level at both ends.
fn fade(x: f64) -> f64 {
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
