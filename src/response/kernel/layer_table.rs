//! The layer's smooth part with its derivatives by the squared distance, tabulated.

use pulp::Simd;

use crate::response::integral::gauss::gauss_interval;
use crate::response::kernel::bessel::bessel_ratios;
use crate::response::series::point_loads::RadialMeans;
use crate::response::series::taylor::{DEGREES, MAX_DEGREE};
use crate::response::simd::lanes::Lanes;

/// The smooth part is singular at ρ = ±2i and so smooth on the scale of v = ρ² + 4.
pub(crate) const SINGULARITY: f64 = 4.0;
/// Octaves of v from 4 on in which the smooth part is integrated, up to ρ = 31.9; beyond them it is 1/ρ.
const OCTAVES: usize = 8;
/// Octaves of the table.
const ALL_OCTAVES: usize = 40;
/// Pieces per octave in which it is integrated, and pieces of the table for each of them.
const PARTS_PER_OCTAVE: usize = 32;
const PIECES_PER_PART: usize = 4;
/// Derivatives kept: two beyond the highest degree of a series, for its error.
const SLOPE_COUNT: usize = MAX_DEGREE + 3;
/// Terms of Ψ.
const PRIMITIVE_TERMS: usize = 7;
/// Largest ρ at which the kernel is felt at all: it has fallen below 1e-9.
pub(super) const LARGEST_RHO: usize = 32;
/// Steps per unit of ρ at which the error of a series is known.
const ERROR_STEPS: usize = 4;

/// One number for each derivative.
type Slopes = [f64; SLOPE_COUNT];

/// `φ_k(ρ) = (d/dσ)^k φ / k!` with σ = ρ², and the integral Ψ of φ, as Taylor series in many pieces:
///
/// ```text
/// φ_k(ρ) = (-1)^k / (4^k k!) ∫_0^∞ (1 - W(t)) t^2k j_k(ρt) dt,   j_k(x) = J_k(x) / (x/2)^k
/// ```
///
/// Terms are for x = (v - c) / p, c the middle of the piece and p the power of 2 below it, so |x| <= 1/256.
#[derive(Debug)]
pub(crate) struct LayerTable {
    /// `φ_k p^k` at c.
    slopes: Vec<Slopes>,
    /// Coefficients of `Ψ = ∫_0^ρ φ(s) s ds`.
    primitives: Vec<[f64; PRIMITIVE_TERMS]>,
    /// For each step of ρ and each of [`DEGREES`]: `max ρ |c_m|` over all larger ρ for the two degrees m that follow,
    /// c_m the term of degree m of the Taylor series in its worst direction.
    roughness: Vec<[[f64; 2]; DEGREES.len()]>,
}

impl LayerTable {
    /// * `transform`: 1 - W
    pub(crate) fn new(transform: impl Fn(f64) -> f64) -> Self {
        let mut table = Self { slopes: Vec::new(), primitives: Vec::new(), roughness: Vec::new() };
        let (mut points, mut known) = (Vec::new(), 0.0);
        for part in 0..ALL_OCTAVES * PARTS_PER_OCTAVE {
            let octave = part / PARTS_PER_OCTAVE;
            let power = SINGULARITY * 2f64.powi(octave as i32);
            if part % PARTS_PER_OCTAVE == 0 && octave < OCTAVES {
                points = transform_points(&transform, (2.0 * power - SINGULARITY).sqrt());
            }
            // middle of the part, in powers
            let middle = 1.0 + ((part % PARTS_PER_OCTAVE) as f64 + 0.5) / PARTS_PER_OCTAVE as f64;
            let rho = (middle * power - SINGULARITY).sqrt();
            let found = if octave < OCTAVES {
                integrals(&points, rho)
            } else {
                std::array::from_fn(|k| INVERSE_SLOPES[k] * rho.powi(-1 - 2 * k as i32))
            };
            let scaled: Slopes = std::array::from_fn(|k| found[k] * power.powi(k as i32));
            for piece in 0..PIECES_PER_PART {
                let step = 1.0 / (PARTS_PER_OCTAVE * PIECES_PER_PART) as f64;
                let mut terms = scaled;
                move_center(&mut terms, (piece as f64 + 0.5) * step - 0.5 / PARTS_PER_OCTAVE as f64);
                // Ψ goes on from piece to piece
                let mut primitive = [0.0; PRIMITIVE_TERMS];
                for k in 1..PRIMITIVE_TERMS {
                    primitive[k] = 0.5 * power * terms[k - 1] / k as f64;
                }
                let rise = |x: f64| primitive.iter().rev().fold(0.0, |sum, term| sum * x + term);
                let (low, high) = (rise(-0.5 * step), rise(0.5 * step));
                primitive[0] = known - low;
                known += high - low;
                table.slopes.push(terms);
                table.primitives.push(primitive);
            }
        }
        table.find_roughness();
        table
    }

    /// φ(ρ).
    pub(crate) fn smooth_part(&self, rho: f64) -> f64 {
        self.slopes_at::<1, 6>(rho)[0]
    }

    /// φ_k(ρ), k = 0 .. N.
    fn slopes_at<const N: usize, const T: usize>(&self, rho: f64) -> [f64; N] {
        let [v, one] = [rho * rho + SINGULARITY, 1.0].map(|x| Lanes::splat(pulp::Scalar, x));
        self.smooth_slopes::<_, N, T>(v, one).map(|slope| slope.v)
    }

    /// `φ_k scale^k`, k = 0 .. N, at v = ρ² + 4, out of T > N terms, at least 6 for 12 digits.
    #[inline(always)]
    pub(crate) fn smooth_slopes<S: Simd, const N: usize, const T: usize>(
        &self,
        v: Lanes<S>,
        scale: Lanes<S>,
    ) -> [Lanes<S>; N] {
        const { assert!(N <= T && T <= SLOPE_COUNT) };
        let mut terms = v.pick_rows::<T, SLOPE_COUNT>(&self.slopes, piece);
        let inverse = v.map_bits(inverse_power);
        let x = (v - v.map_bits(middle)) * inverse;
        // the series about v in place of the one about the middle of the piece
        for n in 0..N {
            for m in (n..T - 1).rev() {
                terms[m] = terms[m + 1].mul_add(x, terms[m]);
            }
        }
        let (step, mut power) = (scale * inverse, v.all(1.0));
        let mut slopes = [power; N];
        for n in 0..N {
            slopes[n] = terms[n] * power;
            power = power * step;
        }
        slopes
    }

    /// `Ψ = ∫_0^ρ φ(s) s ds` at v = ρ² + 4.
    #[inline(always)]
    pub(crate) fn primitive<S: Simd>(&self, v: Lanes<S>) -> Lanes<S> {
        let terms = v.pick_rows::<PRIMITIVE_TERMS, PRIMITIVE_TERMS>(&self.primitives, piece);
        let x = (v - v.map_bits(middle)) * v.map_bits(inverse_power);
        let mut sum = terms[PRIMITIVE_TERMS - 1];
        for k in (0..PRIMITIVE_TERMS - 1).rev() {
            sum = sum.mul_add(x, terms[k]);
        }
        sum
    }

    /// The v from which on the series of a load keeps the tolerance, relative to 1/ρ, for each of [`DEGREES`]; falling.
    ///
    /// * `thinness`: radius of the load's ball over the thickness
    pub(crate) fn ladder(&self, means: &RadialMeans, thinness: f64, tolerance: f64) -> [f64; DEGREES.len()] {
        let mut ladder: [f64; DEGREES.len()] = std::array::from_fn(|level| {
            let term = |m: usize| means.at(m) * thinness.powi(m as i32);
            let (first, second) = (term(DEGREES[level] + 1), term(DEGREES[level] + 2));
            let fails = |rough: &[[f64; 2]; DEGREES.len()]| {
                // the rest falls at least as fast as the first two
                rough[level][0] * first + 2.0 * rough[level][1] * second > tolerance
            };
            match self.roughness.partition_point(fails) {
                step if step == self.roughness.len() => f64::INFINITY,
                step => SINGULARITY + (step as f64 / ERROR_STEPS as f64).powi(2),
            }
        });
        for level in (1..DEGREES.len()).rev() {
            ladder[level - 1] = ladder[level - 1].max(ladder[level]);
        }
        ladder
    }

    fn find_roughness(&mut self) {
        let mut envelope = [[0.0f64; 2]; DEGREES.len()];
        for step in (0..=LARGEST_RHO * ERROR_STEPS).rev() {
            // at the end of the step, as the terms vanish at ρ = 0
            let rho = (step + 1) as f64 / ERROR_STEPS as f64;
            let slopes = self.slopes_at::<SLOPE_COUNT, SLOPE_COUNT>(rho);
            for (worst, degree) in envelope.iter_mut().zip(DEGREES) {
                for (worst, m) in worst.iter_mut().zip([degree + 1, degree + 2]) {
                    for i in 0..=6 {
                        *worst = worst.max(rho * taylor_term(&slopes, rho, m, i as f64 / 6.0).abs());
                    }
                }
            }
            self.roughness.push(envelope);
        }
        self.roughness.reverse();
    }
}

/// Bits below those that name a piece.
const REST_BITS: u32 = 52 - (PARTS_PER_OCTAVE * PIECES_PER_PART).ilog2();

/// Number of the piece of v, by its bits.
#[inline(always)]
fn piece(bits: u64) -> usize {
    const FIRST: u64 = SINGULARITY.to_bits() >> REST_BITS;
    ((bits >> REST_BITS) - FIRST) as usize
}

/// Middle of the piece of v.
#[inline(always)]
fn middle(bits: u64) -> u64 {
    (bits >> REST_BITS << REST_BITS) | 1 << (REST_BITS - 1)
}

/// One over the power of 2 below v.
#[inline(always)]
fn inverse_power(bits: u64) -> u64 {
    (2046 << 52) - (bits >> 52 << 52)
}

/// A Taylor series about a place `shift` further.
fn move_center(terms: &mut Slopes, shift: f64) {
    for n in 0..SLOPE_COUNT {
        for m in (n..SLOPE_COUNT - 1).rev() {
            terms[m] += terms[m + 1] * shift;
        }
    }
}

/// `(d/dσ)^k σ^(-1/2) / k!` at σ = 1.
const INVERSE_SLOPES: [f64; SLOPE_COUNT] = {
    let mut list = [1.0; SLOPE_COUNT];
    let mut k = 1;
    while k < SLOPE_COUNT {
        list[k] = list[k - 1] * (0.5 - k as f64) / k as f64;
        k += 1;
    }
    list
};

/// Coefficient of ε^m in G(|D + ε e|²) for |D| = ρ, e a unit vector under the given cosine: of
/// `Σ_k G_k (2ρ cos ε + ε²)^k`.
fn taylor_term(slopes: &Slopes, rho: f64, m: usize, cosine: f64) -> f64 {
    let mut sum = 0.0;
    let mut k = m.div_ceil(2);
    while k <= m {
        let squares = m - k;
        let choose: f64 = (0..squares).map(|i| (k - i) as f64 / (i + 1) as f64).product();
        sum += slopes[k] * choose * (2.0 * rho * cosine).powi((k - squares) as i32);
        k += 1;
    }
    sum
}

/// Gauss panels over t with the weights (1 - W) t^2k, times what stands before the integral, for ρ up to
/// `largest`.
fn transform_points(transform: &impl Fn(f64) -> f64, largest: f64) -> Vec<(f64, Slopes)> {
    // Up to here (1 - W) t^22 has fallen to 1e-12 of its peak; J_k(ρt) turns at most 7.6 times in a panel.
    let end: f64 = 40.0;
    let panels = (end * largest / 48.0).max(0.25 * end).ceil();
    let width = end / panels;
    let rule = gauss_interval(40);
    let mut points = Vec::with_capacity(panels as usize * rule.len());
    for panel in 0..panels as usize {
        for (u, w) in rule {
            let t = width * (panel as f64 + u);
            let mut weights = [width * w * transform(t); SLOPE_COUNT];
            for k in 1..SLOPE_COUNT {
                weights[k] = weights[k - 1] * -0.25 * t * t / k as f64;
            }
            points.push((t, weights));
        }
    }
    points
}

fn integrals(points: &[(f64, Slopes)], rho: f64) -> Slopes {
    let mut sums = [0.0; SLOPE_COUNT];
    for (t, weights) in points {
        let bessel: Slopes = bessel_ratios(rho * t);
        for k in 0..SLOPE_COUNT {
            sums[k] += weights[k] * bessel[k];
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::kernel::layer::LayerKernel;

    #[test]
    fn each_slope_is_the_derivative_of_the_one_before() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        for i in 1..60 {
            let rho = 0.31 * i as f64;
            let step = 1e-3;
            let at = |rho: f64| kernel.table.slopes_at::<SLOPE_COUNT, SLOPE_COUNT>(rho);
            let (low, high, here) = (at(rho - step), at(rho + step), at(rho));
            // the last ones lack the terms that a piece leaves out
            for k in 0..MAX_DEGREE {
                // dσ = 2 ρ dρ; the third derivative of the difference quotient leaves step²/6 of some k² / ρ²
                let quotient = (high[k] - low[k]) / (4.0 * rho * step) / (k as f64 + 1.0);
                let scale = (1.0 + 1.0 / (rho * rho)) * ((k + 2) * (k + 3)) as f64 * step * step;
                let size = here[k + 1].abs().max(here[k].abs() / (rho * rho + 4.0));
                let error = (quotient - here[k + 1]).abs();
                assert!(error < (4.0 * scale + 1e-7) * size, "k {k}, rho {rho}: {:e}", error / size);
            }
        }
    }

    #[test]
    fn primitive_is_the_integral_of_the_smooth_part_also_beyond_the_integrals() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        for rho in [0.01, 0.3, 1.0, 4.7, 13.0, 31.9, 40.0, 700.0] {
            let pieces = 2000;
            let mut sum = 0.0;
            for piece in 0..pieces {
                for (u, w) in gauss_interval(8) {
                    let s = rho * (piece as f64 + u) / pieces as f64;
                    sum += w * rho / pieces as f64 * kernel.smooth_part(s) * s;
                }
            }
            let v = Lanes::splat(pulp::Scalar, rho * rho + SINGULARITY);
            assert!((kernel.table.primitive(v).v / sum - 1.0).abs() < 1e-10, "{rho}");
        }
    }
}
