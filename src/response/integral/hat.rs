//! Exact integrals of a linear density over a flat triangle, against `1/r`.

use nalgebra::Vector3;

use crate::response::integral::cutoff::{Inverse, hats_within};
use crate::response::integral::frame::TriangleFrame;
use crate::response::integral::gauss::triangle_rule;
use crate::response::integral::piece::TrianglePiece;

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
    let whole = TrianglePiece::whole(point, triangle);
    let (_, size) = whole.longest_edge();
    let mut stack = if whole.is_needle() { whole.slices() } else { vec![whole] };
    let mut integrals = [0.0; 3];
    while let Some(piece) = stack.pop() {
        let (apex, longest) = piece.longest_edge();
        let TrianglePiece { corners, weights, area } = piece;
        let center = (corners[0] + corners[1] + corners[2]) / 3.0;
        let height = 2.0 * area / longest;
        let distance = center.norm() / longest;
        let share = longest / size;
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
            stack.extend(piece.halves(apex));
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

    /// Seen from afar a needle is a line of that weight, and its parts add up to it from anywhere.
    #[test]
    fn a_needle_is_the_sum_of_its_parts_at_any_height() {
        for height in [1e-4, 1e-7, 1e-10, 1e-12] {
            let needle = [Vector3::zeros(), Vector3::x(), Vector3::new(0.3, height, 0.0)];
            let middle = Vector3::new(0.55, 0.0, 0.0);
            let parts = [[needle[0], middle, needle[2]], [middle, needle[1], needle[2]]];
            let inside = (needle[0] + needle[1] + needle[2] * 2.0) / 4.0;
            for point in [inside, needle[0], needle[2], Vector3::new(0.4, 1e-3, 0.1)] {
                let whole: f64 = hat_integrals(&point, &needle).iter().sum();
                let sum: f64 = parts.iter().flat_map(|part| hat_integrals(&point, part)).sum();
                // Corners are rounded to a share of a height that the integral feels by a thousandth.
                let rounding = 1e-9_f64.max(1e-3 * f64::EPSILON / height);
                assert!(
                    (whole / sum - 1.0).abs() < rounding,
                    "{height:e}, {point:?}: {whole:e} is not {sum:e}"
                );
            }
            // On the axis of the strip h wide: int dA / r of a needle of full height from its tip is about h.
            let from_tip: f64 = hat_integrals(&needle[0], &needle).iter().sum();
            // Over s from 0 to 0.3 the width is h s / 0.3, then h (1 - s) / 0.7: h + h (ln(1/0.3) / 0.7 - 1).
            let expected = height * ((1.0 / 0.3_f64).ln() / 0.7);
            assert!((from_tip / expected - 1.0).abs() < 10.0 * height, "{from_tip:e} is not {expected:e}");
        }
    }

    #[test]
    fn a_needle_so_far_away_that_its_corners_round_to_a_line_keeps_its_area() {
        let needle = [Vector3::new(0.0, 0.0, 1e9), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];
        let distance = 2_f64.powi(53);
        for integral in hat_integrals(&Vector3::new(0.0, -distance, 0.0), &needle) {
            let expected = 0.5 * (1e9 - 1.0) / 3.0 / distance;
            assert!((integral / expected - 1.0).abs() < 1e-9, "{integral:e} is not {expected:e}");
        }
    }

    #[test]
    fn an_isosceles_needle_is_finite_at_its_base() {
        // Over s from 0 to L a strip of width w (1 - s / L), seen from a corner of its base:
        // int asinh(w (1 - s / L) / s) ds = w ln(2 L / w), but for terms in w / L.
        let width = 2_f64.sqrt();
        for length in [1e7, 1e8, 1e9, 1e12] {
            let needle = [Vector3::z() * length, Vector3::x(), Vector3::y()];
            for corner in [Vector3::x(), Vector3::y()] {
                let whole: f64 = hat_integrals(&corner, &needle).iter().sum();
                let expected = width * (2.0 * length / width).ln();
                assert!((whole / expected - 1.0).abs() < 1e-6, "{length:e}: {whole:e} is not {expected:e}");
            }
        }
    }
}
