//! A triangle that a sphere cuts, against a kernel that ends there.
//!
//! For y on a triangle small against the cutoff L, `s(y) = (|x - y|² - L²) / 2L`, negative within the cutoff, is almost
//! linear: on a chord of length c it lies below its linear interpolant by at most `c² / 8L`. The cut triangle is what
//! the chord between the exact crossings of two edges leaves, and a segment between chord and arc. There the kernel as
//! a polynomial of s, whose linear interpolant is lowered by its mean error, has closed integrals against a linear
//! density. The rest falls with the square of `c² / 8L` over the range of s on the triangle, and over the slope of s along
//! an edge that the arc hardly leaves.

use super::super::lanes::{Lanes, Mask};
use super::super::near::{dot, from_point};
use super::super::source::LoadedFace;
use super::cut_kernel::{CutKernel, Polynomial, Terms};
use pulp::{Simd, WithSimd};
use std::array::from_fn;

/// A triangle of a load, and how much a sphere cuts it otherwise than a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutFace {
    corners: [[f64; 3]; 3],
    /// Pressure at the corners (1/m²).
    density: [f64; 3],
    /// Area (m²).
    area: f64,
    /// `c² / 2L` of the edge opposite each corner, in ranges.
    bow: [f64; 3],
    /// Mean of what s lies below its interpolant, weighted with the density, in ranges.
    below: f64,
    /// `c² / 8L` of the longest edge, in ranges.
    sagitta: f64,
    /// Its part of the unit load.
    weight: f64,
}

impl CutFace {
    pub(super) fn new(kernel: &CutKernel, face: &LoadedFace) -> Self {
        let corners = face.frame.vertices;
        let scale = 0.5 / (kernel.cutoff * kernel.range);
        let bow = from_fn(|k| scale * (corners[(k + 1) % 3] - corners[(k + 2) % 3]).norm_squared());
        Self::of(corners.map(Into::into), face.density, face.frame.area, bow)
    }

    fn of(corners: [[f64; 3]; 3], density: [f64; 3], area: f64, bow: [f64; 3]) -> Self {
        let total: f64 = density.iter().sum();
        // three different hats integrate to area / 60, two to area / 30 where one is there twice
        let below = |k: usize| bow[k] * (2.0 * (total - density[k]) + density[k]) / 60.0;
        let below = below(0) + below(1) + below(2);
        let below = if total == 0.0 { 0.0 } else { 3.0 * below / total };
        let sagitta = 0.25 * bow.into_iter().fold(0.0, f64::max);
        Self { corners, density, area, bow, below, sagitta, weight: area * total / 3.0 }
    }

    /// In four, by the middles of the edges.
    pub(super) fn divided(&self) -> [Self; 4] {
        let Self { corners, density, bow, .. } = *self;
        let (next, before) = (|k: usize| (k + 1) % 3, |k: usize| (k + 2) % 3);
        let middle: [[f64; 3]; 3] =
            from_fn(|k| from_fn(|axis| 0.5 * (corners[k][axis] + corners[next(k)][axis])));
        let between: [f64; 3] = from_fn(|k| 0.5 * (density[k] + density[next(k)]));
        let of = |corners, density, bow: [f64; 3]| {
            Self::of(corners, density, 0.25 * self.area, bow.map(|bow| 0.25 * bow))
        };
        let at_corner = |k: usize| {
            let (a, b) = (middle[k], middle[before(k)]);
            let density = [density[k], between[k], between[before(k)]];
            of([corners[k], a, b], density, [bow[k], bow[next(k)], bow[before(k)]])
        };
        // the middle of edge k is opposite to corner k + 2
        [at_corner(0), at_corner(1), at_corner(2), of(middle, between, [bow[2], bow[0], bow[1]])]
    }
}

/// Sums the triangles' parts of an entry at each point, and their parts of the load times the squares by which they err.
pub(super) struct Add<'a> {
    pub(super) kernel: &'a CutKernel,
    /// Part of a unit load that a triangle may leave out.
    pub(super) tolerance: f64,
    pub(super) faces: &'a [CutFace],
    /// Coordinates of whole vectors of points (m).
    pub(super) at: &'a [Vec<f64>; 3],
    pub(super) sums: &'a mut [f64],
    pub(super) squares: &'a mut [f64],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match &self.kernel.polynomial {
            Polynomial::Four(terms) => self.with_terms(simd, terms),
            Polynomial::Six(terms) => self.with_terms(simd, terms),
            Polynomial::Eight(terms) => self.with_terms(simd, terms),
        }
    }
}

// What the functions below handed to closures would no longer be compiled for the vectors at hand.

impl Add<'_> {
    #[inline(always)]
    fn with_terms<S: Simd, const N: usize>(self, simd: S, terms: &Terms<N>) {
        let Self { kernel, tolerance, faces, at, sums, squares } = self;
        for first in (0..sums.len()).step_by(S::F64_LANES) {
            let x = [
                Lanes::load(simd, &at[0], first),
                Lanes::load(simd, &at[1], first),
                Lanes::load(simd, &at[2], first),
            ];
            let (mut sum, mut error) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 0.0));
            for face in faces {
                let s = face.beyond(kernel, &x);
                let [value, square, share] = face.value(terms, &s);
                sum = sum + value;
                let square = face.cut_twice(&s, square, share, face.segment(kernel), tolerance);
                error = square.mul_add(error.all(face.weight), error);
            }
            sum.store(sums, first);
            error.store(squares, first);
        }
    }
}

impl CutFace {
    /// Its part of an entry at points from which its corners have these s; the square of `c² / 8L` of the longest edge in
    /// the range of s, or what counts as that where the arc crosses an edge at a flat angle, 0 where the face is whole or
    /// beyond the cutoff; and `c² / 8L` in the range of s anywhere.
    #[inline(always)]
    fn value<S: Simd, const N: usize>(&self, terms: &Terms<N>, s: &[Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let any = s[0];
        let (zero, half, one) = (any.all(0.0), any.all(0.5), any.all(1.0));
        let whole = self.whole(terms, s);
        let mut inside = *s;
        for s in &mut inside {
            *s = s.less(zero).pick(one, zero);
        }
        let count = inside[0] + inside[1] + inside[2];
        // the corner that is alone on its side comes first
        let one_inside = count.less(any.all(1.5));
        let mut is_alone = inside;
        for side in &mut is_alone {
            *side = one_inside.pick(*side, one - *side);
        }
        let (first, second) = (half.less(is_alone[1]), half.less(is_alone[2]));
        let [alone, next, last] = turned(first, second, *s);
        let [p0, p1, p2] = self.density;
        let [p_alone, p_next, p_last] = turned(first, second, [any.all(p0), any.all(p1), any.all(p2)]);
        let [b0, b1, b2] = self.bow;
        let [across, on_last, on_next] = turned(first, second, [any.all(b0), any.all(b1), any.all(b2)]);
        // where the arc crosses the two edges from it, 1/s' along them there, and the densities
        let sign = one_inside.pick(one, zero - one);
        let (a, run_a) = crossing(alone, next, on_next, sign);
        let (b, run_b) = crossing(alone, last, on_last, sign);
        let p_a = a.mul_add(p_next - p_alone, p_alone);
        let p_b = b.mul_add(p_last - p_alone, p_alone);
        let (a_bow, b_bow) = (a * a * on_next, b * b * on_last);
        let chord = a_bow + b_bow - a * b * (on_next + on_last - across);
        let third = any.all(1.0 / 3.0);
        let at_corner = p_alone * alone.polynomial(terms.at_corner);
        let lowered = (alone * third).polynomial(terms.slope) * (a_bow + b_bow + chord) * any.all(1.0 / 12.0);
        let corner = a
            * b
            * ((p_a + p_b).mul_add(alone.polynomial(terms.beside), at_corner)
                - lowered * (p_alone + p_a + p_b) * third);
        let segment = chord * (p_a + p_b) * (b * run_a + a * run_b) * any.all(terms.value / 12.0);
        let cut = one_inside.pick(corner, whole - corner) + segment;
        let (none, every) = (count.less(half), any.all(2.5).less(count));
        let value = none.pick(zero, every.pick(whole, cut)) * any.all(self.area);
        let (flat_a, flat_b) = (half * on_next * run_a, half * on_last * run_b);
        let flat = flat_a.less(flat_b).pick(flat_b, flat_a);
        let flat = a * b * flat * flat;
        let (to_next, to_last) = ((alone - next).abs(), (alone - last).abs());
        let share = any.all(self.sagitta) / to_next.less(to_last).pick(to_last, to_next);
        let square = share * share;
        let square = flat.less(square).pick(square, flat);
        [value, none.pick(zero, every.pick(zero, square)), share]
    }

    /// What lies of a unit load between an edge and an arc that comes through it alone, over `c² / 8L` in the range of s:
    /// at most `2/3 c · c` times the density, as s changes by its range within c.
    #[inline(always)]
    fn segment(&self, kernel: &CutKernel) -> f64 {
        let longest_squared = 8.0 * kernel.cutoff * kernel.range * self.sagitta;
        let [a, b, c] = self.density;
        2.0 / 3.0 * longest_squared * a.max(b).max(c)
    }

    /// `square`, but infinite where the arc may cut an edge twice, or nothing but the inside of the face, and leave more
    /// than `tolerance` of a unit load within.
    #[inline(always)]
    fn cut_twice<S: Simd>(
        &self,
        s: &[Lanes<S>; 3],
        mut square: Lanes<S>,
        share: Lanes<S>,
        segment: f64,
        tolerance: f64,
    ) -> Lanes<S> {
        let (zero, never) = (share.all(0.0), share.all(f64::NEG_INFINITY));
        let counts = share.all(tolerance).less(share * share.all(segment));
        let doubt = counts.pick(share.all(f64::INFINITY), square);
        // With weights λ of its corners s is at every point `Σ λᵢ² sᵢ + Σ λᵢ λⱼ (sᵢ + sⱼ - bow)`.
        for k in 0..3 {
            let (one, other) = (s[(k + 1) % 3], s[(k + 2) % 3]);
            let bow = zero.at_most(one).pick(zero.at_most(other).pick(share.all(self.bow[k]), never), never);
            square = (one + other).less(bow).pick(doubt, square);
        }
        square
    }

    /// s at the corners, in ranges.
    #[inline(always)]
    fn beyond<S: Simd>(&self, kernel: &CutKernel, x: &[Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let squared = x[0].all(kernel.cutoff * kernel.cutoff);
        let scale = x[0].all(0.5 / (kernel.cutoff * kernel.range));
        let mut s = *x;
        for (s, corner) in s.iter_mut().zip(&self.corners) {
            let arm = from_point(corner, x);
            *s = (dot(&arm, &arm) - squared) * scale;
        }
        s
    }

    /// Its part without a cut, over its area.
    #[inline(always)]
    fn whole<S: Simd, const N: usize>(&self, terms: &Terms<N>, s: &[Lanes<S>; 3]) -> Lanes<S> {
        let any = s[0];
        let below = any.all(self.below);
        let s = [s[0] - below, s[1] - below, s[2] - below];
        // complete homogeneous polynomials of the three s
        let mut powers = [any.all(0.0); N];
        powers[0] = any.all(1.0);
        for s in &s {
            for i in 1..N {
                powers[i] = s.mul_add(powers[i - 1], powers[i]);
            }
        }
        let mut sum = any.all(0.0);
        for (s, &density) in s.iter().zip(&self.density) {
            if density == 0.0 {
                continue;
            }
            // and of these with the one of a hat twice
            let (mut power, mut integral) = (any.all(1.0), any.all(terms.full[0]));
            for (&of_three, &share) in powers[1..].iter().zip(&terms.full[1..]) {
                power = s.mul_add(power, of_three);
                integral = power.mul_add(any.all(share), integral);
            }
            sum = integral.mul_add(any.all(density), sum);
        }
        sum
    }
}

/// Where between 0 and 1 `start + t (end - start) - t (1 - t) bow` is 0, which has the sign of `-sign` at the start and the
/// other at the end; and one over how steep it is there.
#[inline(always)]
fn crossing<S: Simd>(start: Lanes<S>, end: Lanes<S>, bow: Lanes<S>, sign: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    let linear = end - start - bow;
    let root = (linear * linear - start.all(4.0) * bow * start).sqrt();
    let two = start.all(2.0);
    (two * start.abs() / (sign * linear + root), start.all(1.0) / root)
}

/// Three values in their cyclic order, the first or the second of the last two first where a mask says so.
#[inline(always)]
fn turned<S: Simd>(first: Mask<S>, second: Mask<S>, v: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [
        first.pick(v[1], second.pick(v[2], v[0])),
        first.pick(v[2], second.pick(v[0], v[1])),
        first.pick(v[0], second.pick(v[1], v[2])),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::super::corrected::Corrected;
    use super::*;

    #[test]
    fn vectors_of_all_lengths_agree() {
        let corrected = Corrected { constant: 1.3e-6, height: 0.8e-3, width: 5e-3, cutoff: 15e-3 };
        let kernel = CutKernel::new(&corrected, 1e-3, 1e-4).expect("a kernel without steep slopes");
        let corners: [[f64; 3]; 3] = [[0.0; 3], [1e-3, 0.1e-3, 0.0], [0.4e-3, 0.8e-3, 0.2e-3]];
        let bow = [1, 2, 0].map(|k: usize| {
            let edge = |axis: usize| corners[k][axis] - corners[(k + 1) % 3][axis];
            (0..3).map(|axis| edge(axis).powi(2)).sum::<f64>() / (2.0 * kernel.cutoff * kernel.range)
        });
        let face = CutFace::of(corners, [2e6, 1e6, 0.0], 4e-7, bow);
        // in all directions, from before to behind the cutoff
        let point = |k: usize| {
            let (polar, azimuth) = (0.05 * k as f64, 2.4 * k as f64);
            let distance = kernel.cutoff + 0.5e-3 * (0.7 * k as f64).sin();
            let (sin, cos) = polar.sin_cos();
            [sin * azimuth.cos() * distance, sin * azimuth.sin() * distance, cos * distance]
        };
        let at = [0, 1, 2].map(|axis| (0..64).map(|k| point(k)[axis]).collect::<Vec<_>>());
        let found = |add: &dyn Fn(Add)| {
            let (mut sums, mut squares) = (vec![0.0; 64], vec![0.0; 64]);
            let (sums_of, squares_of) = (&mut sums[..], &mut squares[..]);
            let faces = &[face];
            add(Add { kernel: &kernel, tolerance: 1e-4, faces, at: &at, sums: sums_of, squares: squares_of });
            (sums, squares)
        };
        let one = found(&|add| add.with_simd(pulp::Scalar::new()));
        let many = found(&|add| pulp::Arch::new().dispatch(add));
        let scale = corrected.constant / corrected.cutoff;
        let close = |a: f64, b: f64, scale: f64| a == b || (a - b).abs() <= 1e-10 * scale;
        assert!((0..64).all(|k| close(one.0[k], many.0[k], scale)));
        assert!((0..64).all(|k| close(one.1[k], many.1[k], one.1[k])));
        assert!(one.0.iter().filter(|&&value| value > 0.0).count() > 20);
        assert!(one.1.iter().filter(|&&square| square > 0.0 && square < 0.1).count() > 10);
    }
}
