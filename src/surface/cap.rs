//! Flat cut faces, which are no skin.

use nalgebra::Vector3;

use crate::geometry::bounds::Bounds;
use crate::surface::checked::Surface;

// "The hands" are the capped hands and fingers of the test collection: 1,500 to 53,000 vertices, from three sources.

/// Vertices this close to a plane lie in it, in mean edge lengths; float32 rounding comes on top.
///
/// Caps of the hands are flat to 1e-4; skin that bends is not: a one-ring of radius h on a sphere of radius R rises by
/// h²/2R, so R would have to be 500 h.
const PLANE_DISTANCE: f64 = 1e-3;
/// Rounding of float32 coordinates after a rotation, relative to the largest coordinate: half an ε when stored, before
/// and after a rotation that mixes three, so (√3 + 1)/2 ε each for a vertex and for the plane.
const FLOAT32_ROUNDING: f64 = 4.0 * f32::EPSILON as f64;
/// Faces turned away from the plane by more than this (cosine of 60°) do not belong to it.
const SAME_SIDE: f64 = 0.5;
/// Least number of faces of a cut face: one regular one-ring.
const CAP_FACES: usize = 6;
/// Least part of the area of its component that a cut face has: caps of the hands have 4 to 11 %, none of their other flat
/// regions 0.2 %.
const CAP_AREA: f64 = 0.01;
/// The surface turns by more than this at the rim of a cut face (cosine of 40°): half of what it does at the rims of the hands'
/// caps, 80° and more.
const RIM_COSINE: f64 = 0.766_044_443_118_978;
/// Least part of the length of the rim of a cut face that is sharp and convex; on the hands all of it is.
const SHARP_PART: f64 = 0.9;
/// Where more than this part of the area of a component is flat, it is a polyhedron and not a cut skin: the ends of a tube
/// as long as wide have a third.
const POLYHEDRON_SHARE: f64 = 0.5;
/// Most rounds of growing a region and fitting its plane anew; they end once no face is added.
const MOST_FITS: usize = 8;

impl Surface {
    /// Per vertex, true where it is skin and false on flat cut faces, their rims included.
    ///
    /// A cut face, such as the wrist of a hand cut off and capped, is a connected set of at least 6 faces with
    /// at least 1 % of the area of its component, whose vertices lie within 1e-3 of a mean edge length (and
    /// float32 rounding) of one plane, and at whose rim the surface turns back by more than 40° along at least
    /// 90 % of the length. So a fingertip, a nail, a rounded box or an open flat patch has none: they are curved,
    /// meet the rest smoothly, or end in a border. If more than half of a component were cut faces it is taken
    /// for a polyhedron, such as a box, and stays skin.
    pub fn skin_without_caps(&self) -> Vec<bool> {
        let labels = self.topology().face_components();
        let mut component_areas = vec![0.0; self.topology().component_count()];
        for (label, area) in labels.iter().zip(self.face_areas()) {
            component_areas[*label as usize] += area;
        }
        let mut cap_areas = vec![0.0; component_areas.len()];
        let mut caps = Vec::new();
        // The largest faces give the best first planes.
        let mut seeds: Vec<usize> = (0..self.faces().len()).collect();
        seeds.sort_by(|a, b| self.face_areas()[*b].total_cmp(&self.face_areas()[*a]));
        let mut search = CapSearch::new(self);
        let mut seen = vec![false; seeds.len()];
        for seed in seeds {
            if seen[seed] {
                continue;
            }
            let (region, normal) = search.grow(seed);
            region.iter().for_each(|face| seen[*face] = true);
            let area: f64 = region.iter().map(|face| self.face_areas()[*face]).sum();
            let label = labels[seed] as usize;
            let is_large = region.len() >= CAP_FACES && area >= CAP_AREA * component_areas[label];
            if is_large && search.sharp_part(&region, &normal) >= SHARP_PART {
                cap_areas[label] += area;
                caps.push((label, region));
            }
        }
        let mut mask = vec![true; self.vertices().len()];
        for (_, region) in
            caps.iter().filter(|cap| cap_areas[cap.0] <= POLYHEDRON_SHARE * component_areas[cap.0])
        {
            for vertex in region.iter().flat_map(|face| self.faces()[*face]) {
                mask[vertex as usize] = false;
            }
        }
        mask
    }
}

/// Grows flat regions on a surface.
struct CapSearch<'a> {
    surface: &'a Surface,
    /// Distance from a plane that still counts as lying in it (m).
    tolerance: f64,
    /// Per face, the round in which it was last reached.
    reached: Vec<u32>,
    round: u32,
}

impl CapSearch<'_> {
    fn new(surface: &Surface) -> CapSearch<'_> {
        let Bounds { low, high } = surface.bounding_box();
        let rounding = FLOAT32_ROUNDING * low.amax().max(high.amax());
        let tolerance = PLANE_DISTANCE * surface.mean_edge_length() + rounding;
        CapSearch { surface, tolerance, reached: vec![0; surface.faces().len()], round: 0 }
    }

    /// The flat region around a face and its unit normal: grown in the plane of the face first, then in the
    /// plane fitted to what was found, as long as that adds faces.
    fn grow(&mut self, seed: usize) -> (Vec<usize>, Vector3<f64>) {
        let mut normal = self.surface.face_normals()[seed];
        let mut region = self.flood(seed, &normal, &self.centroid(seed));
        for _ in 0..MOST_FITS {
            if region.len() < 2 {
                break;
            }
            let mut vector_area = Vector3::zeros();
            let mut moment = Vector3::zeros();
            let mut area = 0.0;
            for &face in &region {
                let face_area = self.surface.face_areas()[face];
                vector_area += self.surface.face_normals()[face] * face_area;
                moment += self.centroid(face) * face_area;
                area += face_area;
            }
            let fitted = vector_area.normalize();
            let grown = self.flood(seed, &fitted, &(moment / area));
            if grown.len() <= region.len() {
                break;
            }
            (region, normal) = (grown, fitted);
        }
        (region, normal)
    }

    /// Faces joined to the seed whose vertices lie in the plane; just the seed if it does not itself.
    fn flood(&mut self, seed: usize, normal: &Vector3<f64>, through: &Vector3<f64>) -> Vec<usize> {
        self.round += 1;
        let surface = self.surface;
        let near =
            |vertex: u32| (surface.vertices()[vertex as usize] - through).dot(normal).abs() <= self.tolerance;
        let belongs = |face: usize| {
            surface.face_normals()[face].dot(normal) > SAME_SIDE
                && surface.faces()[face].iter().all(|vertex| near(*vertex))
        };
        let mut region = vec![seed];
        self.reached[seed] = self.round;
        let mut head = 0;
        while head < region.len() && belongs(seed) {
            let face = region[head];
            for other in (0..3).filter_map(|edge| surface.topology().across(face, edge)) {
                if self.reached[other] != self.round && belongs(other) {
                    self.reached[other] = self.round;
                    region.push(other);
                }
            }
            head += 1;
        }
        region
    }

    /// Part of the rim's length at which the surface turns back from the region by more than the sharp angle.
    fn sharp_part(&mut self, region: &[usize], normal: &Vector3<f64>) -> f64 {
        self.round += 1;
        region.iter().for_each(|face| self.reached[*face] = self.round);
        let surface = self.surface;
        let (mut sharp, mut rim) = (0.0, 0.0);
        for &face in region {
            for edge in 0..3 {
                let other = surface.topology().across(face, edge);
                if other.is_some_and(|other| self.reached[other] == self.round) {
                    continue;
                }
                let ends = [edge, (edge + 1) % 3].map(|k| surface.faces()[face][k] as usize);
                let [a, b] = ends.map(|vertex| surface.vertices()[vertex]);
                let length = (b - a).norm();
                rim += length;
                let turns_back = |other: usize| {
                    (self.centroid(other) - a).dot(normal) < 0.0
                        && surface.face_normals()[other].dot(normal) < RIM_COSINE
                };
                if other.is_some_and(turns_back) {
                    sharp += length;
                }
            }
        }
        if rim > 0.0 { sharp / rim } else { 0.0 }
    }

    fn centroid(&self, face: usize) -> Vector3<f64> {
        let corners = self.surface.faces()[face].map(|vertex| self.surface.vertices()[vertex as usize]);
        (corners[0] + corners[1] + corners[2]) / 3.0
    }
}
