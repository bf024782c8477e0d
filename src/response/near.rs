//! The exact triangle integral for many points at once.

use super::elementary::{angle, ln_ratio};
use super::source::LoadedFace;
use nalgebra::Vector3;

/// A loaded triangle with everything that does not depend on the point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearFace {
    corners: [[f64; 3]; 3],
    normal: [f64; 3],
    tangents: [[f64; 3]; 3],
    outward: [[f64; 3]; 3],
    lengths: [f64; 3],
    double_area: f64,
    /// The load's density is `at_corner - gradient · (y - corner 0)`.
    at_corner: f64,
    gradient: [f64; 3],
    /// Half of `gradient · outward` for each edge.
    edge: [f64; 3],
}

fn array(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

impl NearFace {
    pub(crate) fn new(face: &LoadedFace) -> Self {
        let frame = &face.frame;
        let mut gradient = Vector3::zeros();
        let even = face.density[0] == face.density[1] && face.density[0] == face.density[2];
        if !even {
            for k in 0..3 {
                gradient += frame.outward[k] * (face.density[k] / frame.heights[k]);
            }
        }
        Self {
            corners: std::array::from_fn(|k| array(&frame.vertices[k])),
            normal: array(&frame.normal),
            tangents: std::array::from_fn(|k| array(&frame.tangents[k])),
            outward: std::array::from_fn(|k| array(&frame.outward[k])),
            lengths: frame.heights.map(|h| 2.0 * frame.area / h),
            double_area: 2.0 * frame.area,
            at_corner: face.density[0],
            gradient: array(&gradient),
            edge: std::array::from_fn(|k| 0.5 * gradient.dot(&frame.outward[k])),
        }
    }

    /// Adds `amplitude ∫ p(y) / |x - y| dA` at each point. Written without branches, so that the compiler
    /// makes vector code of it; called within a `pulp` dispatch.
    #[inline(always)]
    pub(crate) fn add(&self, amplitude: f64, x: &[f64], y: &[f64], z: &[f64], out: &mut [f64]) {
        let n = out.len();
        let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
        for i in 0..n {
            out[i] += amplitude * self.at(x[i], y[i], z[i]);
        }
    }

    #[inline(always)]
    fn at(&self, x: f64, y: f64, z: f64) -> f64 {
        let to = |c: &[f64; 3]| [c[0] - x, c[1] - y, c[2] - z];
        let [a, b, c] = [to(&self.corners[0]), to(&self.corners[1]), to(&self.corners[2])];
        let (ra, rb, rc) = (dot(&a, &a).sqrt(), dot(&b, &b).sqrt(), dot(&c, &c).sqrt());
        let height = dot(&a, &self.normal);
        let height_squared = height * height;
        let mut potential = 0.0;
        let mut boundary = 0.0;
        for (k, start, end, r0, r1) in [(0, &b, &c, rb, rc), (1, &c, &a, rc, ra), (2, &a, &b, ra, rb)] {
            let length = self.lengths[k];
            // of the two ends the nearer one gives the distance with the least rounding
            let (d0, d1) = (dot(start, &self.outward[k]), dot(end, &self.outward[k]));
            let d = if r0 <= r1 { d0 } else { d1 };
            let (s0, s1) = (dot(start, &self.tangents[k]), dot(end, &self.tangents[k]));
            let rho_squared = d * d + height_squared;
            // asinh(s1/ρ) - asinh(s0/ρ) as the logarithm of a ratio of sums of positive parts
            let (t0, t1) = (r0 + s0.abs(), r1 + s1.abs());
            let inside = s0 <= 0.0 && s1 >= 0.0;
            let numerator = if inside || s0 > 0.0 { t1 } else { t0 };
            let denominator = if s0 > 0.0 { t0 } else { t1 };
            let numerator = if inside { t0 * t1 } else { numerator };
            let denominator = if inside { rho_squared } else { denominator };
            let log = ln_ratio(numerator, denominator, length, r0 + r1);
            potential += d * log;
            boundary += self.edge[k] * (rho_squared * log + s1 * r1 - s0 * r0);
        }
        let lifted = height.abs();
        let solid = ra * rb * rc + dot(&a, &b) * rc + dot(&a, &c) * rb + dot(&b, &c) * ra;
        potential -= 2.0 * lifted * angle(self.double_area * lifted, solid);
        (self.at_corner + dot(&self.gradient, &a)) * potential - boundary
    }
}

#[inline(always)]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::super::reference_values::INVERSE;
    use super::super::triangle::Frame;
    use super::*;

    #[test]
    fn vector_form_matches_34_digit_quadrature() {
        for (row, (corners, point, expected)) in INVERSE.iter().enumerate() {
            let frame =
                Frame::new([0, 3, 6].map(|k| Vector3::new(corners[k], corners[k + 1], corners[k + 2])));
            let least = frame.heights.into_iter().fold(f64::INFINITY, f64::min);
            let length = 2.0 * frame.area / least;
            let reach = ((Vector3::from(*point) - frame.vertices[0]).norm() / length).max(1.0);
            let bound = 40.0 * f64::EPSILON * (length / least).powi(2) * reach.powi(3);
            for k in 0..3 {
                let mut density = [0.0; 3];
                density[k] = 1.0;
                let face = LoadedFace { frame, density, center: Vector3::zeros(), radius: length };
                let mut out = [0.0; 1];
                NearFace::new(&face).add(1.0, &[point[0]], &[point[1]], &[point[2]], &mut out);
                let error = (out[0] / expected[k] - 1.0).abs();
                assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
            }
        }
    }
}
