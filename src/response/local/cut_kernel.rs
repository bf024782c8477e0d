//! The Gaussian's kernel around its cutoff, as a polynomial.

use super::super::corrected::Corrected;
use nalgebra::{DMatrix, DVector};
use std::array::from_fn;
use std::f64::consts::PI;

/// Steps in which the size of the kernel is looked at.
const SIZES: usize = 16;

/// The kernel over `s = (r² - L²) / 2L` in units of `range`, -1 < s < 0, by as few terms as keep a tolerance.
#[derive(Debug)]
pub(super) struct CutKernel {
    /// L (m).
    pub(super) cutoff: f64,
    /// Largest -s of a point of a cut load (m).
    pub(super) range: f64,
    /// Largest magnitude there relative to K/L, at least 1.
    pub(super) size: f64,
    pub(super) polynomial: Polynomial,
}

/// By the number of terms.
#[derive(Debug)]
pub(super) enum Polynomial {
    Four(Terms<4>),
    Six(Terms<6>),
    Eight(Terms<8>),
}

/// A polynomial of s and what its integrals over triangles need.
#[derive(Debug)]
pub(super) struct Terms<const N: usize> {
    /// Value at s = 0.
    pub(super) value: f64,
    /// Derivative, highest power first, the first of which is none.
    pub(super) slope: [f64; N],
    /// Coefficient i times `2 i! / (i + 3)!`, which powers and a hat integrate to.
    pub(super) full: [f64; N],
    /// The same times i + 1, highest power first.
    pub(super) at_corner: [f64; N],
    /// `full`, highest power first.
    pub(super) beside: [f64; N],
}

impl CutKernel {
    /// * `load_radius`: how far a load extends around its node (m), at most
    /// * `tolerance`: largest error relative to K/L
    ///
    /// `None` where the kernel changes too fast over a load.
    pub(super) fn new(kernel: &Corrected, load_radius: f64, tolerance: f64) -> Option<Self> {
        let &Corrected { constant, height, width, cutoff } = kernel;
        // of the point by a load's diameter nearer than the cutoff
        let range = 2.0 * load_radius * (1.0 - load_radius / cutoff);
        let at = |s: f64| {
            let r = (cutoff * (cutoff + 2.0 * s * range)).sqrt();
            constant / r - height * (-0.5 * (r / width).powi(2)).exp()
        };
        let allowed = tolerance * constant / cutoff;
        let polynomial = (Terms::fitted(at, allowed).map(Polynomial::Four))
            .or_else(|| Terms::fitted(at, allowed).map(Polynomial::Six))
            .or_else(|| Terms::fitted(at, allowed).map(Polynomial::Eight))?;
        let sizes = (0..=SIZES).map(|k| at(-(k as f64) / SIZES as f64).abs() * cutoff / constant);
        let size = sizes.fold(1.0, f64::max);
        (load_radius < 0.5 * cutoff).then_some(Self { cutoff, range, size, polynomial })
    }
}

impl<const N: usize> Terms<N> {
    /// Through Chebyshev points of -1 .. 0; `None` where it errs by more than `allowed` between them.
    fn fitted(at: impl Fn(f64) -> f64, allowed: f64) -> Option<Self> {
        let points: [f64; N] = from_fn(|k| -(PI * (2 * k + 1) as f64 / (4 * N) as f64).cos().powi(2));
        let powers = DMatrix::from_fn(N, N, |k, power| points[k].powi(power as i32));
        let power = powers.lu().solve(&DVector::from_fn(N, |k, _| at(points[k])))?;
        let polynomial = |s: f64| power.iter().rev().fold(0.0, |sum, c| sum * s + c);
        let checks = 5 * N;
        let is_within = (0..=checks)
            .map(|k| -(k as f64) / checks as f64)
            .all(|s| (polynomial(s) - at(s)).abs() <= allowed);
        let full: [f64; N] = from_fn(|i| 2.0 * power[i] / ((i + 1) * (i + 2) * (i + 3)) as f64);
        is_within.then(|| Self {
            value: power[0],
            slope: from_fn(|k| if k == 0 { 0.0 } else { power[N - k] * (N - k) as f64 }),
            full,
            at_corner: from_fn(|i| full[N - 1 - i] * (N - i) as f64),
            beside: from_fn(|i| full[N - 1 - i]),
        })
    }
}
