//! Even triangles: edges flipped to Delaunay and vertices moved along the surface.
//!
//! Flips and tangential steps in turn, as in isotropic remeshing (Botsch, Kobbelt 2004,
//! doi:10.1145/1057432.1057457), each step to the centroid of the faces around a vertex in the metric of the wanted
//! edges (Du, Faber, Gunzburger 1999, doi:10.1137/S0036144599352836).

use std::collections::BTreeSet;

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::mesh::remesh::coarsen::{FineMesh, LEAST_COSINE, SurfacePoint, normal_and_shape};

/// Rounds of flips and steps.
const MOST_ROUNDS: usize = 8;
/// Passes over the edges in a round.
const MOST_PASSES: usize = 8;
/// Sum of the cotangents across an edge below which it flips: 0 but for rounding, so that squares stay.
const FLIP_BELOW: f64 = -1e-6;

impl FineMesh {
    /// Moves vertices along the surface and flips edges; held faces and still vertices stay as they are.
    ///
    /// * `project`: the point of the surface closest to one beside it
    pub fn even_out(&mut self, project: impl Fn(&Vector3<f64>) -> SurfacePoint + Sync) {
        let mut is_still = self.is_still.clone();
        let stays = |face: &[u32; 3]| face.iter().all(|&vertex| is_still[vertex as usize]);
        let still_faces: Vec<bool> =
            self.faces.iter().zip(self.held_faces()).map(|(face, held)| held || stays(face)).collect();
        for (face, _) in self.faces.iter().zip(&still_faces).filter(|(_, still)| **still) {
            face.iter().for_each(|&vertex| is_still[vertex as usize] = true);
        }
        for _ in 0..MOST_ROUNDS {
            self.flip_to_delaunay(&still_faces);
            let centroids = self.centroids();
            let moving = self.vertices.par_iter_mut().zip(&centroids).zip(&is_still);
            moving.filter(|(_, is_still)| !**is_still).for_each(|((vertex, centroid), _)| {
                let there = project(centroid);
                // Beside a slit or a crease the closest skin may be that across.
                if there.normal.dot(&vertex.normal) >= LEAST_COSINE {
                    *vertex = there;
                }
            });
        }
        self.flip_to_delaunay(&still_faces);
    }

    /// Centroid of the faces around each vertex, in the metric of the wanted edges (n, m).
    fn centroids(&self) -> Vec<Vector3<f64>> {
        let mut sums = vec![(Vector3::zeros(), 0.0); self.vertices.len()];
        for face in &self.faces {
            let corners = face.map(|vertex| self.vertices[vertex as usize]);
            let [a, b, c] = corners.map(|corner| corner.point);
            let wanted = corners.map(|corner| corner.edge_length).iter().sum::<f64>() / 3.0;
            let weight = (b - a).cross(&(c - a)).norm() / wanted.powi(4);
            for &vertex in face {
                let (sum, total) = &mut sums[vertex as usize];
                *sum += weight * (a + b + c) / 3.0;
                *total += weight;
            }
        }
        sums.into_iter().map(|(sum, total)| sum / total).collect()
    }

    /// Flips edges until each is Delaunay or may not flip.
    fn flip_to_delaunay(&mut self, still_faces: &[bool]) {
        // Off the plane flips may run in circles.
        for _ in 0..MOST_PASSES {
            if !self.flip_apart(still_faces) {
                break;
            }
        }
    }

    /// Flips edges of faces that have none in common; returns whether there were any.
    fn flip_apart(&mut self, still_faces: &[bool]) -> bool {
        // The face in which an edge runs from its lower vertex comes first.
        let mut sides = Vec::with_capacity(3 * self.faces.len());
        for (face, corners) in self.faces.iter().enumerate() {
            for k in 0..3 {
                let [a, b, apex] = [k, k + 1, k + 2].map(|k| corners[k % 3]);
                sides.push(([a.min(b), a.max(b)], a > b, face, apex));
            }
        }
        sides.sort_unstable();
        let mut is_touched = still_faces.to_vec();
        let mut made = BTreeSet::new();
        for across in sides.chunk_by(|one, other| one.0 == other.0) {
            let &[([a, b], _, one, c), (_, _, other, d)] = across else { continue };
            let flipped = [c.min(d), c.max(d)];
            let is_edge = || sides.binary_search_by_key(&flipped, |side| side.0).is_ok();
            if is_touched[one] || is_touched[other] || is_edge() {
                continue;
            }
            let faces = [[a, d, c], [d, b, c]];
            if self.is_delaunay([a, b], [c, d]) || faces.iter().any(|face| self.turns(face)) {
                continue;
            }
            if made.insert(flipped) {
                [self.faces[one], self.faces[other]] = faces;
                [is_touched[one], is_touched[other]] = [true; 2];
            }
        }
        !made.is_empty()
    }

    fn is_delaunay(&self, edge: [u32; 2], apexes: [u32; 2]) -> bool {
        let cotangent = |apex: u32| {
            let [u, v] = edge.map(|end| self.point(end) - self.point(apex));
            u.dot(&v) / u.cross(&v).norm().max(f64::MIN_POSITIVE)
        };
        apexes.into_iter().map(cotangent).sum::<f64>() >= FLIP_BELOW
    }

    fn point(&self, vertex: u32) -> Vector3<f64> {
        self.vertices[vertex as usize].point
    }

    /// The face would not lie along the surface at one of its corners.
    fn turns(&self, face: &[u32; 3]) -> bool {
        let (normal, _) = normal_and_shape(face.map(|vertex| self.point(vertex)));
        face.iter().any(|&vertex| normal.dot(&self.vertices[vertex as usize].normal) < LEAST_COSINE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stays where it is, far from the face that is held.
    const STILL: u32 = 100;

    /// A unit sphere of uneven triangles, the first of them held.
    fn uneven_sphere() -> FineMesh {
        let (points, faces) = crate::sample::icosphere(1.0, 2);
        // Points slide along the sphere by up to a third of an edge, each its own way.
        let slid = |(k, p): (usize, Vector3<f64>)| {
            let k = k as f64;
            let way = Vector3::new((1.3 * k).sin(), (2.1 * k).cos(), (3.7 * k).sin());
            (p + 0.1 * (way - p * p.dot(&way))).normalize()
        };
        let held = faces[0];
        let on_sphere = |point: Vector3<f64>| SurfacePoint { point, normal: point, edge_length: 0.3 };
        FineMesh {
            is_still: (0..points.len()).map(|vertex| vertex == STILL as usize).collect(),
            is_held: (0..points.len()).map(|vertex| held.contains(&(vertex as u32))).collect(),
            vertices: points.into_iter().enumerate().map(slid).map(on_sphere).collect(),
            faces,
        }
    }

    #[test]
    fn triangles_become_even_stay_on_the_surface_and_held_ones_stay_as_they_are() {
        let worst = |mesh: &FineMesh| {
            let shape = |face: &[u32; 3]| normal_and_shape(face.map(|vertex| mesh.point(vertex))).1;
            let held = mesh.held_faces();
            let free = mesh.faces.iter().zip(held).filter(|(_, held)| !held);
            free.map(|(face, _)| shape(face)).fold(f64::INFINITY, f64::min)
        };
        let before = uneven_sphere();
        let mut after = uneven_sphere();
        after.even_out(|p| SurfacePoint { point: p.normalize(), normal: p.normalize(), edge_length: 0.3 });
        let (uneven, even) = (worst(&before), worst(&after));
        assert!(uneven < 0.5 && even > 0.7, "worst shape {uneven:.2} to {even:.2}");
        assert!(after.vertices.iter().all(|vertex| (vertex.point.norm() - 1.0).abs() < 1e-15));
        for vertex in before.faces[0] {
            assert_eq!(after.point(vertex), before.point(vertex));
        }
        assert!(after.faces.contains(&before.faces[0]));
        assert!(!before.faces[0].contains(&STILL));
        assert_eq!(after.point(STILL), before.point(STILL));
        // Closed and turned outward.
        assert!(
            crate::surface::checked::Surface::new(
                after.vertices.iter().map(|vertex| vertex.point).collect(),
                after.faces.clone()
            )
            .is_ok_and(|surface| surface.is_closed() && surface.volume() > 4.0)
        );
    }
}
