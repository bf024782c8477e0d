//! Mean pressure over discs of a given area.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::Vector3;

use crate::contact::figures::resultant::LoadedVertex;
use crate::geometry::bounds::Bounds;

/// The area (m²) over which every set of vertices has its mean pressure.
pub(crate) const SQUARE_CENTIMETRE: f64 = 1e-4;

/// Largest sum of node forces within `√(area / π)` of one of the vertices, in a straight line on the undeformed skin,
/// over `area` (Pa); 0 without vertices.
pub(crate) fn largest_mean(loaded: &[&LoadedVertex], area: f64) -> f64 {
    let radius = (area / PI).sqrt();
    let around = Bounds::around(loaded.iter().map(|one| &one.position));
    let axis = if loaded.is_empty() { 0 } else { (around.high - around.low).imax() };
    let mut sorted: Vec<(Vector3<f64>, f64)> =
        loaded.iter().map(|one| (one.position, one.node_force)).collect();
    sorted.sort_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
    // The strip across the axis that each may reach, and the force on it: no more lies within the radius.
    let (mut first, mut end, mut force) = (0, 0, 0.0);
    let mut strips: Vec<(f64, usize, Range<usize>)> = Vec::with_capacity(sorted.len());
    for (middle, (position, _)) in sorted.iter().enumerate() {
        while end < sorted.len() && sorted[end].0[axis] <= position[axis] + radius {
            force += sorted[end].1;
            end += 1;
        }
        while sorted[first].0[axis] < position[axis] - radius {
            force -= sorted[first].1;
            first += 1;
        }
        strips.push((force, middle, first..end));
    }
    strips.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
    let mut largest = 0.0;
    for (most, middle, strip) in strips {
        if most <= largest {
            break;
        }
        let (place, reach) = (sorted[middle].0, radius * radius);
        let within = sorted[strip].iter().filter(|(other, _)| (other - place).norm_squared() <= reach);
        largest = f64::max(largest, within.map(|(_, force)| force).sum());
    }
    largest / area
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::Vector3;

    use super::largest_mean;
    use crate::contact::figures::resultant::LoadedVertex;
    use crate::sample::Random;

    fn loaded(position: [f64; 3], node_force: f64) -> LoadedVertex {
        LoadedVertex {
            vertex: 0,
            given_vertex: 0,
            patch: 0,
            position: position.into(),
            deformed: Vector3::zeros(),
            force: Vector3::zeros(),
            node_force,
            contact_area: 0.0,
            peak_pressure: 0.0,
        }
    }

    #[test]
    fn the_mean_is_the_most_force_within_the_radius_of_a_vertex_over_the_area() {
        // Area π: radius 1. Around the second lie the first two and the third (at distance 1 - ε in z); the last, at 3,
        // is alone with the most force of all single ones.
        let all = [
            loaded([0.0, 0.0, 0.0], 1.0),
            loaded([0.5, 0.0, 0.0], 2.0),
            loaded([0.5, 0.0, 0.999], 4.0),
            loaded([3.0, 0.0, 0.0], 6.5),
        ];
        let all: Vec<&LoadedVertex> = all.iter().collect();
        let pi = std::f64::consts::PI;
        assert_relative_eq!(largest_mean(&all, pi), 7.0 / pi, max_relative = 1e-15);
        // Radius 0.9: the third leaves the second, and the last has the most.
        assert_relative_eq!(largest_mean(&all, 0.81 * pi), 6.5 / (0.81 * pi), max_relative = 1e-15);
        // Radius 10: all.
        assert_relative_eq!(largest_mean(&all, 100.0 * pi), 13.5 / (100.0 * pi), max_relative = 1e-15);
        assert_eq!(largest_mean(&[], pi), 0.0);
    }

    #[test]
    fn the_mean_is_that_of_all_pairs_whichever_way_the_vertices_lie() {
        let mut random = Random(7);
        for stretch in [[1.0, 1.0, 1.0], [9.0, 1.0, 1.0], [0.1, 1.0, 6.0]] {
            let place = |random: &mut Random| stretch.map(|length| length * random.signed());
            let all: Vec<LoadedVertex> =
                (0..150).map(|_| loaded(place(&mut random), random.next())).collect();
            for radius in [0.05, 0.7, 3.0, 20.0] {
                let within = |middle: &LoadedVertex| -> f64 {
                    let is_near = |other: &&LoadedVertex| (other.position - middle.position).norm() <= radius;
                    all.iter().filter(is_near).map(|other| other.node_force).sum()
                };
                let area = std::f64::consts::PI * radius * radius;
                let expected = all.iter().map(within).fold(0.0, f64::max) / area;
                let found = largest_mean(&all.iter().collect::<Vec<_>>(), area);
                assert_relative_eq!(found, expected, max_relative = 1e-13);
            }
        }
    }
}
