//! The response matrix over the candidate nodes.

use super::cut::{Inverse, hats_within};
use super::error::ResponseError;
use super::gaussian::Gaussian;
use super::options::{AssemblyOptions, check_request};
use super::parallel::fill_columns;
use super::rule::triangle_rule;
use super::skin::{Response, Skin};
use super::source::{LoadedFace, loaded_faces, weighted};
use super::triangle::frame_hat_integrals;
use crate::surface::Surface;
use faer::Mat;
use nalgebra::Vector3;

/// Response matrix over the candidate nodes.
///
/// `R_ij = Σ_T ∫_T p_j(y) u(|x_i - y|) dA` with p_j the pressure of a unit force at node j, spread as
/// [`Pressure`](super::Pressure) says (eq. 7 and 8 of Xie, Kanai, Date 2011), and u the kernel of the skin.
///
/// * `surface`: the skin's mesh
/// * `skin`: material and kernel
/// * `nodes`: (k,) vertices of the mesh, no two equal
/// * `directions`: (k,) outward normals of the obstacle, or `None`; the scalar kernels do not depend on them
/// * `options`: tolerance, threads, memory
///
/// Returns R (k × k, m/N): column j is the displacement of all nodes per newton at node j.
///
/// # Errors
/// A constant out of range, a node that is out of range or repeated, directions that do not fit, too large
/// a matrix, or an interruption: see [`ResponseError`].
pub fn assemble(
    surface: &Surface,
    skin: &Skin,
    nodes: &[usize],
    directions: Option<&[Vector3<f64>]>,
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    check_request(surface, nodes, nodes.len(), directions, options)?;
    fill_block(surface, skin, nodes, nodes, options)
}

/// Displacement of `rows` per newton at each of `columns`: [`assemble`] for two sets of vertices.
///
/// Returns a block of R (rows × columns, m/N).
///
/// # Errors
/// As [`assemble`].
pub fn assemble_block(
    surface: &Surface,
    skin: &Skin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    check_request(surface, rows, columns.len(), None, options)?;
    check_request(surface, columns, rows.len(), None, options)?;
    fill_block(surface, skin, rows, columns, options)
}

fn fill_block(
    surface: &Surface,
    skin: &Skin,
    rows: &[usize],
    columns: &[usize],
    options: &AssemblyOptions,
) -> Result<Mat<f64>, ResponseError> {
    skin.validate()?;
    let mut matrix = Mat::zeros(rows.len(), columns.len());
    let points: Vec<_> = rows.iter().map(|&v| surface.vertices()[v]).collect();
    let constant = skin.kernel_constant();
    let pressure = skin.pressure();
    fill_columns(&mut matrix, options, Vec::new, |faces: &mut Vec<LoadedFace>, j, column| {
        faces.clear();
        loaded_faces(surface, columns[j], pressure, faces);
        column.fill(0.0);
        for face in faces.iter() {
            match skin.response {
                Response::HalfSpace { .. } => half_space_column(constant, face, &points, column),
                Response::GaussianCorrected { height, width, cutoff, .. } => {
                    let kernel = Corrected { constant, height, cutoff, gaussian: Gaussian { width } };
                    kernel.add_column(face, &points, options.tolerance, column);
                }
            }
        }
    })?;
    Ok(matrix)
}

fn half_space_column(constant: f64, face: &LoadedFace, points: &[Vector3<f64>], column: &mut [f64]) {
    for (entry, x) in column.iter_mut().zip(points) {
        *entry += constant * weighted(&face.density, &frame_hat_integrals(&face.frame, x));
    }
}

/// `K/r - a exp(-r²/2c²)` within the cutoff.
struct Corrected {
    constant: f64,
    height: f64,
    cutoff: f64,
    gaussian: Gaussian,
}

impl Corrected {
    /// Points in each direction of the rule that integrates the Gaussian over a triangle with an error under
    /// `tolerance` times the 1/r part; `None` where Owen's T is the better way.
    ///
    /// The derivatives of order n of exp(-t²/2c²) are at most 1.09 √n! / cⁿ (Cramér's bound of the Hermite
    /// functions), so the rule of degree 2n - 1 errs by at most 2.2 (ρ/c)²ⁿ / √(2n)! of the area.
    fn rule_points(&self, radius: f64, tolerance: f64) -> Option<usize> {
        let reach = self.cutoff.min(10.0 * self.gaussian.width);
        let allowed = tolerance.max(1e-15) * self.constant / (self.height * reach);
        let ratio = radius / self.gaussian.width;
        let mut bound = 2.2;
        for n in 1..=8 {
            let k = 2.0 * n as f64;
            bound *= ratio * ratio / (k * (k - 1.0)).sqrt();
            if bound <= allowed {
                return Some(n);
            }
        }
        None
    }

    fn add_column(&self, face: &LoadedFace, points: &[Vector3<f64>], tolerance: f64, column: &mut [f64]) {
        let rule = self.rule_points(face.radius, tolerance).map(|n| spread(face, n));
        let falloff = -0.5 / (self.gaussian.width * self.gaussian.width);
        for (entry, x) in column.iter_mut().zip(points) {
            let distance = (x - face.center).norm();
            if distance - face.radius >= self.cutoff {
                continue;
            }
            let density = &face.density;
            let cut = distance + face.radius > self.cutoff;
            let inverse = if cut {
                hats_within(&face.frame, x, &Inverse, self.cutoff)
            } else {
                frame_hat_integrals(&face.frame, x)
            };
            let smooth = match &rule {
                Some(rule) if !cut => {
                    rule.iter().map(|(y, w)| w * ((x - y).norm_squared() * falloff).exp()).sum()
                }
                _ => weighted(density, &hats_within(&face.frame, x, &self.gaussian, self.cutoff)),
            };
            *entry += self.constant * weighted(density, &inverse) - self.height * smooth;
        }
    }
}

/// The load of a face as point forces: places (m) and shares of the unit force.
fn spread(face: &LoadedFace, n: usize) -> Vec<(Vector3<f64>, f64)> {
    let [a, b, c] = face.frame.vertices;
    let at = |l: &[f64; 3]| a * l[0] + b * l[1] + c * l[2];
    triangle_rule(n).iter().map(|(l, w)| (at(l), w * face.frame.area * weighted(&face.density, l))).collect()
}
