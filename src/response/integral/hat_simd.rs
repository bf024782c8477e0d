//! The exact triangle integral for many points at once.

use nalgebra::Vector3;
use pulp::Simd;

use crate::response::integral::frame::TriangleFrame;
use crate::response::simd::functions::{angle, ln_ratio};
use crate::response::simd::lanes::{Lanes, dot};
use crate::response::simd::points::Selection;

/// A triangle under a linear density, with everything that does not depend on the point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearFace {
    pub(crate) corners: [[f64; 3]; 3],
    pub(crate) normal: [f64; 3],
    pub(crate) tangents: [[f64; 3]; 3],
    pub(crate) outward: [[f64; 3]; 3],
    lengths: [f64; 3],
    double_area: f64,
    /// The load's density is `at_corner - gradient · (y - corner 0)`.
    pub(crate) at_corner: f64,
    pub(crate) gradient: [f64; 3],
    /// Half of `gradient · outward` for each edge.
    pub(crate) edge: [f64; 3],
}

fn array(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z]
}

impl NearFace {
    /// * `density`: at the corners
    pub(crate) fn new(frame: &TriangleFrame, density: [f64; 3]) -> Self {
        let mut gradient = Vector3::zeros();
        let even = density[0] == density[1] && density[0] == density[2];
        if !even {
            for ((outward, value), height) in frame.outward.iter().zip(density).zip(frame.heights) {
                gradient += outward * (value / height);
            }
        }
        Self {
            corners: std::array::from_fn(|k| array(&frame.vertices[k])),
            normal: array(&frame.normal),
            tangents: std::array::from_fn(|k| array(&frame.tangents[k])),
            outward: std::array::from_fn(|k| array(&frame.outward[k])),
            lengths: frame.heights.map(|h| 2.0 * frame.area / h),
            double_area: 2.0 * frame.area,
            at_corner: density[0],
            gradient: array(&gradient),
            edge: std::array::from_fn(|k| 0.5 * gradient.dot(&frame.outward[k])),
        }
    }

    /// Adds `amplitude ∫ p(y) / |x - y| dA` to the value of each point.
    #[inline(always)]
    pub(crate) fn add<S: Simd>(&self, simd: S, amplitude: f64, points: &mut Selection) {
        let amplitude = Lanes::splat(simd, amplitude);
        for first in (0..points.index.len()).step_by(S::F64_LANES) {
            let value = self.at(points.points.load(simd, first));
            let sum = amplitude.mul_add(value, Lanes::load(simd, &points.values, first));
            sum.store(&mut points.values, first);
        }
    }

    #[inline(always)]
    fn at<S: Simd>(&self, x: [Lanes<S>; 3]) -> Lanes<S> {
        let Uniform { to_corner, potential, terms } = self.uniform(x);
        let any = x[0];
        let mut boundary = any.all(0.0);
        for (&edge, &term) in self.edge.iter().zip(&terms) {
            boundary = any.all(edge).mul_add(term, boundary);
        }
        (any.all(self.at_corner) + along(&to_corner, &self.gradient)) * potential - boundary
    }

    /// What the potentials of all linear densities are made of.
    #[inline(always)]
    fn uniform<S: Simd>(&self, x: [Lanes<S>; 3]) -> Uniform<S> {
        let any = x[0];
        let a = from_point(&self.corners[0], &x);
        let b = from_point(&self.corners[1], &x);
        let c = from_point(&self.corners[2], &x);
        let (ra, rb, rc) = (dot(&a, &a).sqrt(), dot(&b, &b).sqrt(), dot(&c, &c).sqrt());
        let height = along(&a, &self.normal);
        let height_squared = height * height;
        let of_edges = [
            self.edge_terms(0, [&b, &c], [rb, rc], height_squared),
            self.edge_terms(1, [&c, &a], [rc, ra], height_squared),
            self.edge_terms(2, [&a, &b], [ra, rb], height_squared),
        ];
        let potential = of_edges[0].0 + of_edges[1].0 + of_edges[2].0;
        let terms = [of_edges[0].1, of_edges[1].1, of_edges[2].1];
        let lifted = height.abs();
        let solid = ra * rb * rc + dot(&a, &b) * rc + dot(&a, &c) * rb + dot(&b, &c) * ra;
        let potential = potential - any.all(2.0) * lifted * angle(any.all(self.double_area) * lifted, solid);
        Uniform { to_corner: a, potential, terms }
    }

    /// What an edge gives to the potential, and its term; its ends as seen from the points, and their distances.
    #[inline(always)]
    fn edge_terms<S: Simd>(
        &self,
        k: usize,
        [start, end]: [&[Lanes<S>; 3]; 2],
        [r0, r1]: [Lanes<S>; 2],
        height_squared: Lanes<S>,
    ) -> (Lanes<S>, Lanes<S>) {
        let zero = r0.all(0.0);
        // of the two ends the nearer one gives the distance with the least rounding
        let (d0, d1) = (along(start, &self.outward[k]), along(end, &self.outward[k]));
        let d = r0.at_most(r1).pick(d0, d1);
        let (s0, s1) = (along(start, &self.tangents[k]), along(end, &self.tangents[k]));
        let rho_squared = d.mul_add(d, height_squared);
        // asinh(s1/ρ) - asinh(s0/ρ) as the logarithm of a ratio of sums of positive parts: t0 t1 / ρ² where
        // the foot of the point lies on the edge, t1 / t0 before it, t0 / t1 behind it
        let (t0, t1) = (r0 + s0.abs(), r1 + s1.abs());
        let (before, behind) = (zero.less(s0), s1.less(zero));
        let numerator = before.pick(t1, behind.pick(t0, t0 * t1));
        let denominator = before.pick(t0, behind.pick(t1, rho_squared));
        let log = ln_ratio(numerator, denominator, r0.all(self.lengths[k]), r0 + r1);
        (d * log, rho_squared.mul_add(log, s1 * r1 - s0 * r0))
    }
}

/// Integrals of a uniform density seen from some points.
struct Uniform<S: Simd> {
    /// From the point to corner 0 (m).
    to_corner: [Lanes<S>; 3],
    /// `∫ dA / |x - y|` (m).
    potential: Lanes<S>,
    /// `2 ∫ |x - y| ds` along each edge (m²).
    terms: [Lanes<S>; 3],
}

/// The three hats of a triangle, as [`NearFace`] is one linear density.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NearHats {
    face: NearFace,
    /// One over the heights (1/m).
    slopes: [f64; 3],
    /// [`NearFace::edge`] of each hat.
    edges: [[f64; 3]; 3],
}

impl NearHats {
    pub(crate) fn new(frame: &TriangleFrame) -> Self {
        let slopes = frame.heights.map(|height| 1.0 / height);
        let edge = |k: usize, e: usize| 0.5 * slopes[k] * frame.outward[k].dot(&frame.outward[e]);
        let edges = std::array::from_fn(|k| std::array::from_fn(|e| edge(k, e)));
        Self { face: NearFace::new(frame, [1.0; 3]), slopes, edges }
    }

    /// `∫ hat(y) / |x - y| dA` (m) of each hat.
    #[inline(always)]
    pub(crate) fn at<S: Simd>(&self, x: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let any = x[0];
        let Uniform { to_corner, potential, terms } = self.face.uniform(x);
        let mut hats = [potential; 3];
        for (k, hat) in hats.iter_mut().enumerate() {
            let here = along(&to_corner, &self.face.outward[k]);
            let own = here.mul_add(any.all(self.slopes[k]), any.all(if k == 0 { 1.0 } else { 0.0 }));
            *hat = own * potential;
            for (&edge, &term) in self.edges[k].iter().zip(&terms) {
                *hat = *hat - any.all(edge) * term;
            }
        }
        hats
    }
}

#[inline(always)]
pub(crate) fn from_point<S: Simd>(c: &[f64; 3], x: &[Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [x[0].all(c[0]) - x[0], x[0].all(c[1]) - x[1], x[0].all(c[2]) - x[2]]
}

#[inline(always)]
pub(crate) fn along<S: Simd>(a: &[Lanes<S>; 3], v: &[f64; 3]) -> Lanes<S> {
    dot(a, &[a[0].all(v[0]), a[0].all(v[1]), a[0].all(v[2])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::reference_integrals;

    #[test]
    fn vector_form_matches_60_digit_quadrature() {
        for (row, case) in reference_integrals().iter().enumerate() {
            let (frame, point) = (TriangleFrame::new(case.triangle), case.point);
            let least = frame.heights.into_iter().fold(f64::INFINITY, f64::min);
            let length = 2.0 * frame.area / least;
            let reach = ((point - frame.vertices[0]).norm() / length).max(1.0);
            let bound = 40.0 * f64::EPSILON * (length / least).powi(2) * reach.powi(3);
            for k in 0..3 {
                let mut density = [0.0; 3];
                density[k] = 1.0;
                let mut here = Selection { index: vec![0], values: vec![0.0], ..Selection::default() };
                here.points.push(&point);
                NearFace::new(&frame, density).add(pulp::Scalar, 1.0, &mut here);
                let error = (here.values[0] / case.inverse[k] - 1.0).abs();
                assert!(error < bound, "row {row}, corner {k}: {error:e}, bound {bound:e}");
            }
        }
    }
}
