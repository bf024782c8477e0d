//! Mean pressure over discs of a given area.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::Vector3;

use crate::contact::figures::loaded::LoadedVertex;
use crate::geometry::bounds::Bounds;

/// The area (m²) over which every set of vertices has its mean pressure.
pub(crate) const SQUARE_CENTIMETRE: f64 = 1e-4;

/// Relative difference below which two sums of the same forces are one.
const SAME_FORCE: f64 = 1e-12;

/// Largest mean pressure over the disc of `area` around one of the vertices (Pa); 0 without vertices.
///
/// The disc takes the forces within `√(area / π)` of the vertex, in a straight line on the undeformed skin. Each is
/// spread over a disc of its cell, so that of one whose cell the rim cuts it takes the share of that within: whole
/// forces would come and go with the places of the nodes. Cells that overlap count once, so no mean is above the peak.
pub(crate) fn largest_mean(loaded: &[&LoadedVertex], area: f64) -> f64 {
    let radius = (area / PI).sqrt();
    let around = Bounds::around(loaded.iter().map(|one| &one.position));
    let axis = if loaded.is_empty() { 0 } else { (around.high - around.low).imax() };
    let sorted = spread(loaded, axis);
    let reach = radius + sorted.iter().map(|one| one.radius).fold(0.0, f64::max);
    // The strip across the axis that each may reach, and the force on it: no more lies within the reach.
    let (mut first, mut end, mut force) = (0, 0, 0.0);
    let mut strips: Vec<(f64, usize, Range<usize>)> = Vec::with_capacity(sorted.len());
    for (middle, one) in sorted.iter().enumerate() {
        while end < sorted.len() && sorted[end].position[axis] <= one.position[axis] + reach {
            force += sorted[end].force;
            end += 1;
        }
        while sorted[first].position[axis] < one.position[axis] - reach {
            force -= sorted[first].force;
            first += 1;
        }
        strips.push((force, middle, first..end));
    }
    let mean = |middle: usize, strip: &Range<usize>| {
        let center = sorted[middle].position;
        let (mut force, mut covered) = (0.0, 0.0);
        for one in &sorted[strip.clone()] {
            let share = one.share_within(&center, radius);
            force += share * one.force;
            covered += share * one.area;
        }
        force / area.max(covered)
    };
    // A disc around the middle one may take all there is.
    let central = central(&sorted);
    let around = strips.iter().find(|(_, middle, _)| Some(*middle) == central);
    let mut largest = around.map_or(0.0, |(_, middle, strip)| mean(*middle, strip));
    strips.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
    for (most, middle, strip) in strips {
        if most <= largest * area * (1.0 + SAME_FORCE) {
            break;
        }
        largest = f64::max(largest, mean(middle, &strip));
    }
    largest
}

/// The one nearest to the center of the forces.
fn central(forces: &[SpreadForce]) -> Option<usize> {
    let total: f64 = forces.iter().map(|one| one.force).sum();
    let center = forces.iter().map(|one| one.force * one.position).sum::<Vector3<f64>>() / total;
    let distance = |place: &usize| (forces[*place].position - center).norm_squared();
    (0..forces.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// A node force, evenly spread over a disc.
struct SpreadForce {
    position: Vector3<f64>,
    /// (N)
    force: f64,
    /// Of the disc (m²).
    area: f64,
    /// Of the disc (m).
    radius: f64,
}

/// The node forces, each over a disc as large as its vertex's contact area, or larger where that would put it above the
/// peak; ascending along an axis.
fn spread(loaded: &[&LoadedVertex], axis: usize) -> Vec<SpreadForce> {
    let peak = loaded.iter().map(|one| one.peak_pressure).fold(0.0, f64::max);
    let disc = |one: &&LoadedVertex| {
        let area = one.contact_area.max(one.node_force / peak);
        SpreadForce { position: one.position, force: one.node_force, area, radius: (area / PI).sqrt() }
    };
    let mut sorted: Vec<SpreadForce> = loaded.iter().map(disc).collect();
    sorted.sort_by(|a, b| a.position[axis].total_cmp(&b.position[axis]));
    sorted
}

impl SpreadForce {
    /// Share of its disc within `radius` of a center: that of the lens in which two circles overlap.
    fn share_within(&self, center: &Vector3<f64>, radius: f64) -> f64 {
        let distance = (self.position - center).norm();
        let (small, large) = if self.radius < radius { (self.radius, radius) } else { (radius, self.radius) };
        let lens = if distance >= small + large {
            0.0
        } else if distance <= large - small {
            PI * small * small
        } else {
            // The segments that the common chord cuts off: r² (α - sin α cos α), with cos α = x / r.
            let to_chord = (distance * distance + large * large - small * small) / (2.0 * distance);
            let segment = |radius: f64, to_chord: f64| {
                let cos = (to_chord / radius).clamp(-1.0, 1.0);
                radius * radius * (cos.acos() - cos * (1.0 - cos * cos).sqrt())
            };
            segment(large, to_chord) + segment(small, distance - to_chord)
        };
        lens / self.area
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use approx::assert_relative_eq;
    use nalgebra::Vector3;

    use super::{SpreadForce, largest_mean};
    use crate::contact::figures::loaded::LoadedVertex;
    use crate::sample::Random;

    /// The force of a pressure on a cell.
    fn on_cell(position: [f64; 3], pressure: f64, cell: f64) -> LoadedVertex {
        LoadedVertex {
            vertex: 0,
            given_vertex: 0,
            patch: 0,
            position: position.into(),
            deformed: Vector3::zeros(),
            force: Vector3::zeros(),
            node_force: pressure * cell,
            contact_area: cell,
            peak_pressure: pressure,
        }
    }

    /// A force as good as at a point.
    fn loaded(position: [f64; 3], node_force: f64) -> LoadedVertex {
        on_cell(position, node_force * 1e14, 1e-14)
    }

    #[test]
    fn a_cell_that_the_rim_of_the_disc_cuts_counts_by_its_share_within() {
        // Two circles of radius 1 at distance 1 share 2π/3 - √3/2; of radius 1/2 and 1 at distance √3/2 the small one's
        // half by the common chord, and of the large one the segment of ±30°.
        let share = |radius: f64, distance: f64, disc: f64| {
            let cell = PI * radius * radius;
            let one = SpreadForce { position: Vector3::zeros(), force: 1.0, area: cell, radius };
            one.share_within(&Vector3::new(0.0, distance, 0.0), disc) * cell
        };
        let root = 3f64.sqrt();
        assert_relative_eq!(share(1.0, 1.0, 1.0), 2.0 * PI / 3.0 - root / 2.0, max_relative = 1e-14);
        let small_and_large = PI / 8.0 + PI / 6.0 - root / 4.0;
        assert_relative_eq!(share(0.5, root / 2.0, 1.0), small_and_large, max_relative = 1e-14);
        assert_relative_eq!(share(1.0, root / 2.0, 0.5), small_and_large, max_relative = 1e-14);
        assert_relative_eq!(share(1.0, 0.3, 0.5), PI / 4.0, max_relative = 1e-14);
        assert_relative_eq!(share(0.5, 0.3, 1.0), PI / 4.0, max_relative = 1e-14);
        assert_eq!(share(0.5, 1.5, 1.0), 0.0);
    }

    #[test]
    fn the_mean_of_hertz_pressure_is_found_at_all_areas_wherever_the_nodes_lie() {
        // 10 cells a radius. Half a cell beside the axis the best disc lacks (h/2a)² of p at most; cells along the rim of
        // the disc, as wide as h, are off by a part of h/c each.
        let (radius, spacing) = (1.0, 0.1);
        for [x, y] in [[0.0, 0.0], [0.5, 0.0], [0.3, 0.4], [0.5, 0.5]] {
            let mut all = Vec::new();
            for k in 0..31 * 31 {
                let place = [(k % 31 - 15) as f64 + x, (k / 31 - 15) as f64 + y].map(|cells| cells * spacing);
                let within = 1.0 - (place[0] * place[0] + place[1] * place[1]) / (radius * radius);
                if within > 0.0 {
                    all.push(on_cell([place[0], place[1], 0.0], within.sqrt(), spacing * spacing));
                }
            }
            let all: Vec<&LoadedVertex> = all.iter().collect();
            for share in [0.05, 0.1, 0.2, 0.35, 0.5, 0.8, 1.0, 1.5, 2.0] {
                // ∫ p over c ≤ a: 2/3 π a² p0 (1 - (1 - c²/a²)^{3/2}) (Johnson 1985, §4.2).
                let force = 2.0 / 3.0 * (1.0 - (1.0 - f64::min(share, 1.0)).powf(1.5));
                let found = largest_mean(&all, share * PI * radius * radius);
                assert_relative_eq!(found, force / share, max_relative = 0.03);
            }
            for area in [1e-4, 0.003, 0.006, 0.01, 0.015, 0.02, 0.03, 0.05, 0.08] {
                let found = largest_mean(&all, area);
                assert!(0.85 < found && found <= 1.0 + 1e-12, "{found} of the peak over {area}");
            }
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
        assert_relative_eq!(largest_mean(&all, PI), 7.0 / PI, max_relative = 1e-12);
        // Radius 0.9: the third leaves the second, and the last has the most.
        assert_relative_eq!(largest_mean(&all, 0.81 * PI), 6.5 / (0.81 * PI), max_relative = 1e-12);
        // Radius 10: all.
        assert_relative_eq!(largest_mean(&all, 100.0 * PI), 13.5 / (100.0 * PI), max_relative = 1e-12);
        assert_eq!(largest_mean(&[], PI), 0.0);
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
                let area = PI * radius * radius;
                let expected = all.iter().map(within).fold(0.0, f64::max) / area;
                let found = largest_mean(&all.iter().collect::<Vec<_>>(), area);
                assert_relative_eq!(found, expected, max_relative = 1e-12);
            }
        }
    }
}
