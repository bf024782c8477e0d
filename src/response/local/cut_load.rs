//! Entries of loads that the Gaussian's cutoff cuts, many at a time.

use super::super::column::Scratch;
use super::super::corrected::Corrected;
use super::super::targets::Targets;
use super::cut_face::{Add, CutFace};
use super::cut_kernel::CutKernel;
use nalgebra::Vector3;

/// Error of an entry over what [`Add`] finds as squares: of single triangles, slivers among them, one in a thousand errs by
/// more than 1.4 times that, one in ten thousand by more than 2.5 times.
const QUADRATIC: f64 = 2.0;
/// Share of the tolerance that each triangle may leave out of a load.
const LEFT_OUT: f64 = 0.25;
/// Divisions of a triangle in four, at most: after more, quadrature along its edges is faster.
const DIVISIONS: usize = 1;
/// Points are padded to multiples of this, which every vector length divides.
const BLOCK: usize = 8;

/// A kernel around its cutoff.
#[derive(Debug)]
pub(super) struct CutLoads {
    kernel: Corrected,
    near_cutoff: CutKernel,
    /// How far a load extends around its node (m), at most.
    largest_load: f64,
    /// Largest error of an entry relative to K/L.
    tolerance: f64,
}

impl CutLoads {
    /// * `load_radius`: how far a load extends around its node (m), at most
    /// * `tolerance`: of an entry, relative to K/L
    ///
    /// `None` where the kernel changes too fast over a load.
    pub(super) fn new(kernel: Corrected, load_radius: f64, tolerance: f64) -> Option<Self> {
        let near_cutoff = CutKernel::new(&kernel, load_radius, 0.25 * tolerance)?;
        Some(Self { kernel, near_cutoff, largest_load: load_radius, tolerance })
    }

    /// L (m).
    pub(super) fn cutoff(&self) -> f64 {
        self.kernel.cutoff
    }

    /// How far a load may extend around its node (m).
    pub(super) fn largest_load(&self) -> f64 {
        self.largest_load
    }

    /// `∫ p(y) f(|x - y|) dA` of a load at each point that it may be cut for.
    ///
    /// * `scratch`: the load is on its faces
    /// * `points`: (m), at least one
    pub(super) fn values(&self, scratch: &mut Scratch, points: &[Vector3<f64>]) -> Vec<f64> {
        let load = &scratch.faces;
        let mut values = vec![0.0; points.len()];
        // errors are those of areas, on which the kernel may be larger than K/L
        let tolerance = self.tolerance / self.near_cutoff.size;
        let largest_square = tolerance / QUADRATIC;
        let longest = load.iter().map(|face| 2.0 * face.radius).fold(0.0, f64::max);
        // as if s changed by the whole of an edge along it
        let share = longest / (8.0 * self.kernel.cutoff * largest_square.sqrt());
        let enough = (0..=DIVISIONS).find(|&n| share <= (1 << n) as f64).unwrap_or(DIVISIONS + 1);
        let mut faces: Vec<CutFace> = load.iter().map(|face| CutFace::new(&self.near_cutoff, face)).collect();
        let mut open: Vec<usize> = (0..points.len()).collect();
        for divisions in 0..=DIVISIONS {
            if divisions > 0 {
                faces = faces.iter().flat_map(CutFace::divided).collect();
            }
            if divisions < enough {
                continue;
            }
            let coordinate = |axis: usize| {
                let mut list: Vec<f64> = open.iter().map(|&i| points[i][axis]).collect();
                list.resize(open.len().next_multiple_of(BLOCK), points[open[0]][axis]);
                list
            };
            let at = [coordinate(0), coordinate(1), coordinate(2)];
            let (mut sums, mut squares) = (vec![0.0; at[0].len()], vec![0.0; at[0].len()]);
            let (kernel, tolerance) = (&self.near_cutoff, LEFT_OUT * tolerance);
            pulp::Arch::new().dispatch(Add {
                kernel,
                tolerance,
                faces: &faces,
                at: &at,
                sums: &mut sums,
                squares: &mut squares,
            });
            let mut found = sums.into_iter().zip(squares);
            open.retain(|&i| {
                let (sum, square) = found.next().expect("one for each open point");
                values[i] = sum;
                square.is_nan() || square > largest_square
            });
            if open.is_empty() {
                return values;
            }
        }
        let mut targets = Targets::default();
        open.iter().for_each(|&i| targets.push(&points[i]));
        targets.pad();
        self.kernel.values(&targets, scratch, self.tolerance);
        open.into_iter().zip(&scratch.values).for_each(|(i, &value)| values[i] = value);
        values
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::skin::Pressure;
    use super::super::super::source::{LoadedFace, loaded_faces};
    use super::*;
    use crate::surface::Surface;
    use std::f64::consts::PI;

    const CUTOFF: f64 = 15e-3;

    fn kernel(height: f64, width: f64) -> Corrected {
        Corrected { constant: 1.3e-6, height, width, cutoff: CUTOFF }
    }

    /// Numbers from -1 to 1.
    fn random() -> impl FnMut() -> f64 {
        let mut state = 7u64;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            2.0 * (state >> 11) as f64 / (1u64 << 53) as f64 - 1.0
        }
    }

    /// The load in the middle of a bent, jittered hexagon with edges of some `edge` (m) and thin triangles among them.
    fn load(edge: f64, pressure: Pressure, random: &mut impl FnMut() -> f64) -> Vec<LoadedFace> {
        let mut ring = |k: usize| {
            let angle = (k as f64 + 0.3 * random()) * PI / 3.0;
            let point = Vector3::new(angle.cos(), angle.sin(), 0.3 * random());
            point * (edge * (1.0 + 0.25 * random()))
        };
        let mut vertices: Vec<_> = std::iter::once(Vector3::zeros()).chain((0..6).map(&mut ring)).collect();
        vertices[2] = vertices[1] + 0.05 * (vertices[2] - vertices[1]);
        let faces = (0..6u32).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect();
        let surface = Surface::new(vertices, faces).expect("a hexagon");
        let mut faces = Vec::new();
        loaded_faces(&surface, 0, pressure, &mut faces);
        faces
    }

    #[test]
    fn cut_entries_keep_their_tolerance() {
        let mut random = random();
        // the printed height, and one that makes the kernel large before the cutoff
        let cases = [(Pressure::Linear, 0.8e-3), (Pressure::OneRing, 0.8e-3), (Pressure::OneRing, 4e-3)];
        for (pressure, height) in cases {
            let kernel = kernel(height, 5e-3);
            let at_cutoff =
                (kernel.constant / CUTOFF - height * (-0.5 * (CUTOFF / 5e-3).powi(2)).exp()).abs();
            for edge in [0.1e-3, 0.5e-3, 1e-3, 2e-3] {
                let load = load(edge, pressure, &mut random);
                let mut points: Vec<Vector3<f64>> = Vec::new();
                for _ in 0..300 {
                    let direction = Vector3::new(random(), random(), random()).normalize();
                    points.push(direction * (CUTOFF + 1.3 * edge * random()));
                }
                // in the normal direction too, where the cutoff runs along the triangles
                points.push(Vector3::new(0.0, 0.0, CUTOFF - 0.01 * edge));
                for face in &load {
                    for _ in 0..20 {
                        let weights = [random().abs(), random().abs(), random().abs()];
                        let inside = Vector3::from(weights) / weights.iter().sum::<f64>();
                        let height = CUTOFF - random() * face.radius.powi(2) / CUTOFF;
                        let corners = &face.frame.vertices;
                        let foot = corners[0] * inside.x + corners[1] * inside.y + corners[2] * inside.z;
                        points.push(foot + face.frame.normal * height);
                    }
                }
                for tolerance in [1e-2, 1e-3, 1e-4, 1e-5] {
                    let cut_loads =
                        CutLoads::new(kernel, 1.3 * edge, tolerance).expect("a kernel without steep slopes");
                    let (mut cut, scale) = (0, cut_loads.kernel.constant / CUTOFF);
                    let mut scratch = Scratch::new(&Targets::default());
                    scratch.faces.clone_from(&load);
                    for (point, value) in points.iter().zip(cut_loads.values(&mut scratch, &points)) {
                        let exact: f64 = load.iter().map(|face| cut_loads.kernel.exact(face, point)).sum();
                        assert!(
                            (value - exact).abs() <= tolerance * scale,
                            "edge {edge} tolerance {tolerance} {point:?}: {value:e} {exact:e}"
                        );
                        cut += usize::from(exact.abs() > 0.01 * at_cutoff && exact.abs() < 0.3 * at_cutoff);
                    }
                    assert!(cut > 30, "{cut}");
                }
            }
        }
    }

    #[test]
    fn kernels_that_are_steep_over_a_load_are_left_to_the_closed_form() {
        assert!(CutLoads::new(kernel(0.8e-3, 5e-3), 3e-3, 1e-3).is_some());
        assert!(CutLoads::new(kernel(0.8e-3, 3e-3), 3e-3, 1e-6).is_none());
        assert!(CutLoads::new(kernel(0.8e-3, 5e-3), CUTOFF, 1e-3).is_none());
    }
}
