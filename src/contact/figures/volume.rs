//! The volume that a body's linear displacement misses at second order, taken up by its free skin.
//!
//! A body's displacement `u` changes the volume under the skin by `Σ a_i · u_i` (`a_i`: a third of the area vectors of
//! the faces around vertex `i`), which is zero for incompressible tissue. The mesh moved by `u` encloses another volume,
//! by terms of second and third order in `u`: some percent of what the press displaces at a millimetre. Linear
//! elasticity says nothing of these, so the deformed skin is moved along its normals by `α w_i`, with `w` rising
//! smoothly from zero at the contact to one, and `α` from Newton's method on the exact volume of the mesh.

use std::f64::consts::PI;

use nalgebra::Vector3;

use crate::surface::checked::Surface;

/// The offset rises over this many equivalent radii of the contact, and at least over this many edges.
const RISE: f64 = 2.0;
/// Part of a candidate's gap that the offset may close.
const GAP_SHARE: f64 = 0.5;
/// Rounds of Newton's method, and of holding the offset back where a gap is small; both settle in two or three.
const ROUNDS: usize = 8;
/// Newton's method ends at this share of the volume that is missing.
const SETTLED: f64 = 1e-10;

/// What [`take_up_second_order`] did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct VolumeOffset {
    /// Volume by which the mesh moved linearly missed its first-order change (m³).
    pub missed: f64,
    /// Largest offset of a vertex (m, >= 0).
    pub largest: f64,
}

/// The part of a surface that one body moves.
struct Shell<'a> {
    surface: &'a Surface,
    /// Faces with a vertex of the body.
    faces: Vec<[u32; 3]>,
    /// Near the shell, so that little is lost to rounding (m).
    origin: Vector3<f64>,
}

impl<'a> Shell<'a> {
    fn new(surface: &'a Surface, body: &[usize]) -> Self {
        let mut belongs = vec![false; surface.vertices().len()];
        body.iter().for_each(|&vertex| belongs[vertex] = true);
        let moves = |face: &&[u32; 3]| face.iter().any(|&vertex| belongs[vertex as usize]);
        let origin = body.iter().map(|&v| surface.vertices()[v]).sum::<Vector3<f64>>() / body.len() as f64;
        Self { surface, faces: surface.faces().iter().filter(moves).copied().collect(), origin }
    }

    /// Change of volume (m³) when the vertices are displaced; those off the body must stay.
    fn change(&self, displacement: &[Vector3<f64>]) -> f64 {
        let volume = |moved: f64| -> f64 {
            let place =
                |v: u32| self.surface.vertices()[v as usize] + displacement[v as usize] * moved - self.origin;
            self.faces.iter().map(|&[a, b, c]| place(a).dot(&place(b).cross(&place(c))) / 6.0).sum()
        };
        volume(1.0) - volume(0.0)
    }

    /// Change of volume (m³) per unit motion along `direction`, at the displaced shell.
    fn rate(&self, displacement: &[Vector3<f64>], direction: &[Vector3<f64>]) -> f64 {
        let place = |v: u32| self.surface.vertices()[v as usize] + displacement[v as usize] - self.origin;
        let face_rate = |&[a, b, c]: &[u32; 3]| {
            let (x, y, z) = (place(a), place(b), place(c));
            let along = |v: u32| direction[v as usize];
            along(a).dot(&y.cross(&z)) + along(b).dot(&z.cross(&x)) + along(c).dot(&x.cross(&y))
        };
        self.faces.iter().map(face_rate).sum::<f64>() / 6.0
    }
}

/// Moves the free skin of `body` so that the mesh changes its volume as the displacement does to first order.
///
/// Contact vertices and those that do not move at all stay where they are; next to the contact no gap shrinks by
/// more than half.
///
/// * `body`: the vertices that one body moves
/// * `active`: vertices in contact
/// * `gap`: per vertex, the gap after the press (m) of candidates, infinite or that before elsewhere
/// * `displacement`: per vertex (m); changed
///
/// Returns what was moved, or `None` if nothing is missing or nothing can move.
pub(crate) fn take_up_second_order(
    surface: &Surface,
    body: &[usize],
    active: &[usize],
    gap: &[f64],
    displacement: &mut [Vector3<f64>],
) -> Option<VolumeOffset> {
    let shell = Shell::new(surface, body);
    let at_rest = vec![Vector3::zeros(); displacement.len()];
    let mut linear = at_rest.clone();
    body.iter().for_each(|&vertex| linear[vertex] = displacement[vertex]);
    let wanted = shell.rate(&at_rest, &linear);
    let missed = wanted - shell.change(&linear);

    let contact_area: f64 = active.iter().map(|&vertex| surface.vertex_areas()[vertex]).sum();
    let reach = RISE * (contact_area / PI).sqrt().max(surface.mean_edge_length());
    let mut weights = vec![0.0; displacement.len()];
    for &vertex in body.iter().filter(|&&vertex| displacement[vertex] != Vector3::zeros()) {
        weights[vertex] = 1.0;
    }
    for (vertex, distance) in surface.skin_distances(active, reach) {
        weights[vertex] *= rise(distance / reach);
    }

    let mut offset = 0.0;
    for _ in 0..ROUNDS {
        offset = newton(&shell, &linear, &weights, wanted, missed)?;
        let too_far = |vertex: usize| weights[vertex] * f64::abs(offset) > GAP_SHARE * gap[vertex].max(0.0);
        let held: Vec<usize> = body.iter().copied().filter(|&vertex| too_far(vertex)).collect();
        if held.is_empty() {
            break;
        }
        // Held back a little further than needed, as the others now move more.
        held.iter().for_each(|&v| weights[v] = 0.9 * GAP_SHARE * gap[v].max(0.0) / f64::abs(offset));
    }
    let mut largest: f64 = 0.0;
    for &vertex in body {
        displacement[vertex] += surface.vertex_normals()[vertex] * (offset * weights[vertex]);
        largest = largest.max((offset * weights[vertex]).abs());
    }
    Some(VolumeOffset { missed, largest })
}

/// The offset (m) along weighted normals with which the shell's change of volume is `wanted` (m³).
fn newton(shell: &Shell, linear: &[Vector3<f64>], weights: &[f64], wanted: f64, missed: f64) -> Option<f64> {
    let normals = shell.surface.vertex_normals();
    let direction: Vec<Vector3<f64>> = normals.iter().zip(weights).map(|(n, w)| n * *w).collect();
    let mut offset = 0.0;
    for _ in 0..ROUNDS {
        let moved: Vec<Vector3<f64>> = linear.iter().zip(&direction).map(|(u, n)| u + n * offset).collect();
        let error = wanted - shell.change(&moved);
        if error.abs() <= SETTLED * missed.abs() {
            break;
        }
        offset += error / shell.rate(&moved, &direction);
    }
    (offset.is_finite() && offset != 0.0).then_some(offset)
}

/// 0 at 0, 1 from 1 on, level at both ends.
fn rise(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Octahedron with each face cut in 4^k, on the unit sphere.
    fn ball(subdivisions: usize) -> Surface {
        let mut vertices: Vec<Vector3<f64>> =
            [[1.0, 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]]
                .map(Vector3::from)
                .to_vec();
        let mut faces: Vec<[u32; 3]> =
            vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        for _ in 0..subdivisions {
            let mut middles = std::collections::HashMap::new();
            let mut finer = Vec::new();
            for &[a, b, c] in &faces {
                let mut middle = |a: u32, b: u32| {
                    *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                        vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
                        vertices.len() as u32 - 1
                    })
                };
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
            }
            faces = finer;
        }
        Surface::new(vertices, faces).expect("a sound mesh")
    }

    /// A dent of depth `depth` at the lowest point, spread back over the rest, zero above z = 0.8.
    fn dented(surface: &Surface, depth: f64) -> (Vec<Vector3<f64>>, Vec<usize>) {
        let low = |p: &Vector3<f64>| p.z < -0.8;
        let dent = |p: &Vector3<f64>| match p.z {
            z if z < -0.8 => Vector3::z() * (depth * (-0.8 - z) / 0.2),
            z if z < 0.8 => p * (0.1 * depth),
            _ => Vector3::zeros(),
        };
        let active = (0..surface.vertices().len()).filter(|&v| low(&surface.vertices()[v])).collect();
        (surface.vertices().iter().map(dent).collect(), active)
    }

    #[test]
    fn the_mesh_changes_its_volume_as_the_displacement_does_to_first_order() {
        let surface = ball(3);
        let everything: Vec<usize> = (0..surface.vertices().len()).collect();
        let (linear, active) = dented(&surface, 0.1);
        let gap = vec![f64::INFINITY; linear.len()];
        let mut displacement = linear.clone();
        let done = take_up_second_order(&surface, &everything, &active, &gap, &mut displacement)
            .expect("a finite dent misses some volume");
        let area_vector = |vertex: usize| -> Vector3<f64> {
            let faces = surface.faces_around(vertex).iter().map(|&face| face as usize);
            faces.map(|face| surface.face_normals()[face] * (surface.face_areas()[face] / 3.0)).sum()
        };
        let first_order: f64 = everything.iter().map(|&v| area_vector(v).dot(&linear[v])).sum();
        let moved = surface.vertices().iter().zip(&displacement).map(|(x, u)| x + u).collect();
        let change = surface.with_vertices(moved).volume() - surface.volume();
        assert!(done.missed.abs() > 1e-4 && done.largest > 0.0);
        assert!((change - first_order).abs() < 1e-12, "{change} {first_order}");
        // Neither the contact nor what does not move has been moved.
        let still = |v: &usize| active.contains(v) || linear[*v] == Vector3::zeros();
        assert!(everything.iter().filter(|v| still(v)).all(|&v| displacement[v] == linear[v]));
        // Halving the dent takes a quarter of the offset.
        let (mut half, _) = dented(&surface, 0.05);
        let quarter = take_up_second_order(&surface, &everything, &active, &gap, &mut half).expect("missed");
        let ratio = done.largest / quarter.largest;
        assert!((3.5..4.5).contains(&ratio), "{ratio}");
    }

    #[test]
    fn no_gap_shrinks_by_more_than_half() {
        let surface = ball(3);
        let everything: Vec<usize> = (0..surface.vertices().len()).collect();
        let (linear, active) = dented(&surface, 0.1);
        let mut free = linear.clone();
        let open = vec![f64::INFINITY; linear.len()];
        let largest =
            take_up_second_order(&surface, &everything, &active, &open, &mut free).expect("missed").largest;
        let near = everything.iter().filter(|&&v| (-0.8..-0.2).contains(&surface.vertices()[v].z));
        let mut gap = open.clone();
        near.clone().for_each(|&v| gap[v] = 0.1 * largest);
        let mut held = linear.clone();
        take_up_second_order(&surface, &everything, &active, &gap, &mut held).expect("missed");
        assert!(near.clone().all(|&v| (held[v] - linear[v]).norm() <= GAP_SHARE * gap[v]));
        let shell = Shell::new(&surface, &everything);
        assert!((shell.change(&held) - shell.change(&free)).abs() < 1e-12);
    }

    #[test]
    fn a_body_that_does_not_move_is_left_alone() {
        let surface = ball(1);
        let everything: Vec<usize> = (0..surface.vertices().len()).collect();
        let mut still = vec![Vector3::zeros(); everything.len()];
        let gap = vec![f64::INFINITY; still.len()];
        assert_eq!(take_up_second_order(&surface, &everything, &[], &gap, &mut still), None);
    }
}
