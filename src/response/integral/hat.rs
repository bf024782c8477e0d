//! Exact integrals of a linear density over a flat triangle, against `1/r`.

use nalgebra::Vector3;

use crate::response::integral::cutoff::{Inverse, hats_within};
use crate::response::integral::frame::TriangleFrame;
use crate::response::integral::gauss::triangle_rule;

/// Least (length / height)² (distance / length)³ of a piece, times its share of the whole triangle's
/// length, up to which it is integrated by the closed form: 40 ε times that is its loss of digits. The share counts
/// because at a sharp corner no cut makes the pieces rounder, only smaller.
const PLAIN_LOSS: f64 = 20.0;
/// Distance / longest edge beyond which a piece is integrated by quadrature: the ball around a triangle has
/// at most 0.58 of that edge as radius, so that n points in each direction err by some (0.58/2)²ⁿ.
const FAR_DISTANCE: f64 = 2.0;
/// Most points of that rule in each direction, for an error below 1e-14.
const FAR_POINTS: usize = 14;
/// Share of a tolerance that each of the two ways may use up.
const TOLERANCE_SHARE: f64 = 0.1;

/// A part of the triangle, relative to the point, and the weights of the whole triangle's corners in each
/// of its own.
struct Piece {
    corners: [Vector3<f64>; 3],
    weights: [[f64; 3]; 3],
    /// As the whole triangle's corners give it: far from the point the piece's own may be rounded to a line (m²).
    area: f64,
}

/// Integrals over a triangle of its three hat functions against `1/r`.
///
/// `I_k = ∫ hat_k(y) / |x - y| dA`, exact, from the potential and the first moment of a uniform density
/// (Wilton et al. 1984, doi 10.1109/TAP.1984.1143304; the in-plane case is Johnson 1985, pp. 53-55).
///
/// * `point`: x (m), anywhere: on a vertex, an edge, the face, off the plane
/// * `triangle`: corners (m), not degenerate, in either order of rotation
///
/// Returns the integral for each corner's hat (m), all positive, with a relative error of some 1e-13: slivers
/// and far triangles, on which the closed form cancels, are cut into pieces or integrated numerically.
///
/// The longest edge is halved until a piece is either well shaped or far from the point.
pub fn hat_integrals(point: &Vector3<f64>, triangle: &[Vector3<f64>; 3]) -> [f64; 3] {
    hat_integrals_within(point, triangle, 0.0)
}

/// [`hat_integrals`] with a relative error of at most `tolerance`, or of 1e-13.
pub(crate) fn hat_integrals_within(
    point: &Vector3<f64>,
    triangle: &[Vector3<f64>; 3],
    tolerance: f64,
) -> [f64; 3] {
    let allowed = TOLERANCE_SHARE * tolerance;
    let plain_loss = (allowed / (40.0 * f64::EPSILON)).max(PLAIN_LOSS);
    let far_points = (0.5 * allowed.max(1e-300).ln() / (0.29_f64).ln()).ceil() as usize;
    let far_rule = triangle_rule(far_points.clamp(4, FAR_POINTS));
    let whole = Piece {
        corners: triangle.map(|v| v - point),
        weights: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        area: TriangleFrame::new(*triangle).area,
    };
    let mut stack = vec![whole];
    let mut integrals = [0.0; 3];
    let mut size = None;
    while let Some(Piece { corners, weights, area }) = stack.pop() {
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let (apex, longest) = (0..3)
            .map(|k| (k, (corners[(k + 1) % 3] - corners[(k + 2) % 3]).norm()))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .expect("a triangle has three edges");
        let height = 2.0 * area / longest;
        let distance = center.norm() / longest;
        let share = longest / *size.get_or_insert(longest);
        let loss = (longest / height).powi(2) * distance.max(1.0).powi(3) * share;
        if distance > FAR_DISTANCE {
            for (l, w) in far_rule {
                let y = corners[0] * l[0] + corners[1] * l[1] + corners[2] * l[2];
                let inverse = w * area / y.norm();
                for k in 0..3 {
                    let hat = l[0] * weights[0][k] + l[1] * weights[1][k] + l[2] * weights[2][k];
                    integrals[k] += inverse * hat;
                }
            }
        } else if loss > plain_loss {
            // Halve the longest edge, opposite to `apex`
            let (b, c) = ((apex + 1) % 3, (apex + 2) % 3);
            let middle = (corners[b] + corners[c]) * 0.5;
            let hats: [f64; 3] = std::array::from_fn(|k| 0.5 * (weights[b][k] + weights[c][k]));
            for to in [c, b] {
                let mut half = Piece { corners, weights, area: 0.5 * area };
                half.corners[to] = middle;
                half.weights[to] = hats;
                stack.push(half);
            }
        } else {
            let frame = TriangleFrame::new(corners);
            let own = hats_within(&frame, &Vector3::zeros(), &Inverse, f64::INFINITY);
            for k in 0..3 {
                integrals[k] += own[0] * weights[0][k] + own[1] * weights[1][k] + own[2] * weights[2][k];
            }
        }
    }
    integrals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_needle_so_far_away_that_its_corners_round_to_a_line_keeps_its_area() {
        let needle = [Vector3::new(0.0, 0.0, 1e9), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];
        let distance = 2_f64.powi(53);
        for integral in hat_integrals(&Vector3::new(0.0, -distance, 0.0), &needle) {
            let expected = 0.5 * (1e9 - 1.0) / 3.0 / distance;
            assert!((integral / expected - 1.0).abs() < 1e-9, "{integral:e} is not {expected:e}");
        }
    }
}
