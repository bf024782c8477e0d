//! The layer's smooth part with its derivatives by the squared distance, tabulated.

use crate::response::integral::gauss::gauss_interval;
use crate::response::series::taylor::{DEGREES, MAX_DEGREE};

/// Derivatives kept: two beyond the highest degree of a series, for its error.
pub(crate) const SLOPE_COUNT: usize = MAX_DEGREE + 3;
/// Largest ρ = r/h of the table.
pub(crate) const LARGEST_RHO: usize = 32;
/// Pieces per unit of ρ.
const PIECES_PER_UNIT: usize = 4;
/// Coefficients of a piece.
const PIECE_TERMS: usize = 10;
/// Points in which the integrals are taken on every two units of ρ.
const SAMPLE_POINTS: usize = 24;
/// Steps of ρ per unit at which the error of a series is known.
const ERROR_STEPS: usize = 4;

/// One number for each derivative, then the mean.
type Sample = [f64; SLOPE_COUNT + 1];

/// `φ_k(ρ) = (d/dσ)^k φ / k!` with σ = ρ², for k = 0 .. [`SLOPE_COUNT`], in pieces:
///
/// ```text
/// φ_k(ρ) = (-1)^k / (4^k k!) ∫_0^∞ (1 - W(t)) t^2k j_k(ρt) dt,   j_k(x) = J_k(x) / (x/2)^k
/// ```
///
/// and the mean of φ over a disc, `2/ρ² ∫_0^ρ φ(s) s ds = ∫_0^∞ (1 - W(t)) j_1(ρt) dt`.
#[derive(Debug)]
pub(crate) struct LayerTable {
    /// Coefficients of powers of the piece's coordinate -1 .. 1, lowest first.
    pieces: Vec<[[f64; SLOPE_COUNT]; PIECE_TERMS]>,
    /// The same of the mean.
    means: Vec<[f64; PIECE_TERMS]>,
    /// For each of [`DEGREES`] and step of ρ: `max ρ^(m+1) |c_m|` over the two degrees m that follow and all larger
    /// ρ, where c_m is the term of degree m of the whole kernel's Taylor series, in its worst direction.
    roughness: Vec<[f64; DEGREES.len()]>,
}

impl LayerTable {
    /// * `transform`: 1 - W
    pub(crate) fn new(transform: impl Fn(f64) -> f64) -> Self {
        let mut table = Self { pieces: Vec::new(), means: Vec::new(), roughness: Vec::new() };
        for start in (0..LARGEST_RHO).step_by(2) {
            let points = transform_points(&transform, start as f64 + 2.0);
            let series = chebyshev::<SAMPLE_POINTS>(|x| integrals(&points, start as f64 + 1.0 + x));
            for part in 0..2 * PIECES_PER_UNIT {
                let at = |x: f64| (part as f64 + 0.5 * (1.0 + x)) / PIECES_PER_UNIT as f64 - 1.0;
                let short = chebyshev::<PIECE_TERMS>(|x| clenshaw(&series, at(x)));
                let powers = monomials(&short);
                table.pieces.push(powers.map(|sample| std::array::from_fn(|k| sample[k])));
                table.means.push(powers.map(|sample| sample[SLOPE_COUNT]));
            }
        }
        table.find_roughness();
        table
    }

    /// φ_k(ρ) for k = 0 .. N <= [`SLOPE_COUNT`]; ρ is cut to the table.
    #[inline(always)]
    pub(crate) fn smooth_slopes<const N: usize>(&self, rho: f64) -> [f64; N] {
        let scaled = rho * PIECES_PER_UNIT as f64;
        let index = (scaled as usize).min(LARGEST_RHO * PIECES_PER_UNIT - 1);
        let x = 2.0 * (scaled - index as f64).min(1.0) - 1.0;
        let piece = &self.pieces[index];
        let mut value = [0.0; N];
        for n in (0..PIECE_TERMS).rev() {
            for k in 0..N {
                value[k] = value[k] * x + piece[n][k];
            }
        }
        value
    }

    /// `2/ρ² ∫_0^ρ φ(s) s ds`; ρ is cut to the table.
    #[inline(always)]
    pub(crate) fn mean(&self, rho: f64) -> f64 {
        let scaled = rho * PIECES_PER_UNIT as f64;
        let index = (scaled as usize).min(LARGEST_RHO * PIECES_PER_UNIT - 1);
        let x = 2.0 * (scaled - index as f64).min(1.0) - 1.0;
        let piece = &self.means[index];
        // two short chains in place of a long one
        let (mut even, mut odd, square) = (piece[PIECE_TERMS - 2], piece[PIECE_TERMS - 1], x * x);
        for k in (0..PIECE_TERMS / 2 - 1).rev() {
            even = even * square + piece[2 * k];
            odd = odd * square + piece[2 * k + 1];
        }
        let mean = even + x * odd;
        // beyond the table φ = 1/ρ
        let far = rho - LARGEST_RHO as f64;
        if far <= 0.0 { mean } else { (mean * (LARGEST_RHO * LARGEST_RHO) as f64 + 2.0 * far) / (rho * rho) }
    }

    /// The error of a series that ends at `DEGREES[level]`, as a multiple of the half-space's, at any distance
    /// from ρ on.
    pub(crate) fn roughness(&self, level: usize, rho: f64) -> f64 {
        let step = ((rho * ERROR_STEPS as f64) as usize).clamp(1, self.roughness.len()) - 1;
        self.roughness[step][level]
    }

    fn find_roughness(&mut self) {
        let mut envelope = [0.0f64; DEGREES.len()];
        for step in (1..=LARGEST_RHO * ERROR_STEPS).rev() {
            let rho = step as f64 / ERROR_STEPS as f64;
            let smooth = self.smooth_slopes::<SLOPE_COUNT>(rho);
            let slopes: [f64; SLOPE_COUNT] =
                std::array::from_fn(|k| INVERSE_SLOPES[k] * rho.powi(-1 - 2 * k as i32) - smooth[k]);
            for (worst, degree) in envelope.iter_mut().zip(DEGREES) {
                for m in [degree + 1, degree + 2] {
                    let largest = (0..=6)
                        .map(|i| taylor_term(&slopes, rho, m, i as f64 / 6.0).abs())
                        .fold(0.0, f64::max);
                    *worst = worst.max(largest * rho.powi(m as i32 + 1));
                }
            }
            self.roughness.push(envelope);
        }
        self.roughness.reverse();
    }
}

/// `(d/dσ)^k σ^(-1/2) / k!` at σ = 1.
pub(crate) const INVERSE_SLOPES: [f64; SLOPE_COUNT] = {
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
fn taylor_term(slopes: &[f64; SLOPE_COUNT], rho: f64, m: usize, cosine: f64) -> f64 {
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
fn transform_points(transform: &impl Fn(f64) -> f64, largest: f64) -> Vec<(f64, Sample)> {
    // Up to here (1 - W) t^22 has fallen to 1e-12 of its peak; J_k(ρt) turns at most 7.6 times in a panel.
    let end: f64 = 40.0;
    let panels = (end * largest / 48.0).max(0.25 * end).ceil();
    let width = end / panels;
    let rule = gauss_interval(40);
    let mut points = Vec::with_capacity(panels as usize * rule.len());
    for panel in 0..panels as usize {
        for (u, w) in rule {
            let t = width * (panel as f64 + u);
            let mut weights = [width * w * transform(t); SLOPE_COUNT + 1];
            for k in 1..SLOPE_COUNT {
                weights[k] = weights[k - 1] * -0.25 * t * t / k as f64;
            }
            points.push((t, weights));
        }
    }
    points
}

fn integrals(points: &[(f64, Sample)], rho: f64) -> Sample {
    let mut sums = [0.0; SLOPE_COUNT + 1];
    for (t, weights) in points {
        let bessel = bessel_ratios(rho * t);
        for k in 0..SLOPE_COUNT {
            sums[k] += weights[k] * bessel[k];
        }
        sums[SLOPE_COUNT] += weights[SLOPE_COUNT] * bessel[1];
    }
    sums
}

/// `J_k(x) / (x/2)^k` for k = 0 .. [`SLOPE_COUNT`], x >= 0.
fn bessel_ratios(x: f64) -> [f64; SLOPE_COUNT] {
    let quarter = 0.25 * x * x;
    let mut ratios = [0.0; SLOPE_COUNT];
    if x <= 12.0 {
        // power series of the two highest, then J_(k-1) = 2k/x J_k - J_(k+1)
        for k in [SLOPE_COUNT - 2, SLOPE_COUNT - 1] {
            let mut term = 1.0 / (1..=k).map(|v| v as f64).product::<f64>();
            let mut i = 0.0;
            while term != 0.0 && i < 40.0 {
                ratios[k] += term;
                i += 1.0;
                term *= -quarter / (i * (i + k as f64));
            }
        }
        for k in (1..SLOPE_COUNT - 1).rev() {
            ratios[k - 1] = k as f64 * ratios[k] - quarter * ratios[k + 1];
        }
    } else {
        // upwards, stable as k stays below x
        ratios[0] = libm::j0(x);
        ratios[1] = libm::j1(x) * 2.0 / x;
        for k in 1..SLOPE_COUNT - 1 {
            ratios[k + 1] = (k as f64 * ratios[k] - ratios[k - 1]) / quarter;
        }
    }
    ratios
}

/// Chebyshev coefficients of the interpolant in N points on -1 .. 1.
fn chebyshev<const N: usize>(f: impl Fn(f64) -> Sample) -> [Sample; N] {
    let angle = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / N as f64;
    let values: [Sample; N] = std::array::from_fn(|k| f(angle(k).cos()));
    std::array::from_fn(|j| {
        let factor = if j == 0 { 1.0 } else { 2.0 } / N as f64;
        let cosines: [f64; N] = std::array::from_fn(|k| factor * (j as f64 * angle(k)).cos());
        std::array::from_fn(|s| (0..N).map(|k| values[k][s] * cosines[k]).sum())
    })
}

fn clenshaw(c: &[Sample], x: f64) -> Sample {
    std::array::from_fn(|s| {
        let (mut b1, mut b2) = (0.0, 0.0);
        for ck in c[1..].iter().rev() {
            (b1, b2) = (ck[s] + 2.0 * x * b1 - b2, b1);
        }
        c[0][s] + x * b1 - b2
    })
}

/// Powers of x from a short Chebyshev series.
fn monomials(c: &[Sample; PIECE_TERMS]) -> [Sample; PIECE_TERMS] {
    let mut sum = [[0.0; SLOPE_COUNT + 1]; PIECE_TERMS];
    let (mut before, mut now) = ([0.0; PIECE_TERMS], [0.0; PIECE_TERMS]);
    now[0] = 1.0;
    for (k, ck) in c.iter().enumerate() {
        for i in 0..PIECE_TERMS {
            for s in 0..=SLOPE_COUNT {
                sum[i][s] += ck[s] * now[i];
            }
        }
        // T_(k+1) = 2 x T_k - T_(k-1), T_1 = x
        let mut next = [0.0; PIECE_TERMS];
        for i in 1..PIECE_TERMS {
            next[i] = if k == 0 { 1.0 } else { 2.0 } * now[i - 1];
        }
        for i in 0..PIECE_TERMS {
            next[i] -= if k == 0 { 0.0 } else { before[i] };
        }
        (before, now) = (now, next);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::response::kernel::layer::LayerKernel;

    #[test]
    fn bessel_ratios_are_those_of_the_library() {
        for i in 0..400 {
            let x = 0.037 * 1.022f64.powi(i);
            let ratios = bessel_ratios(x);
            for (k, ratio) in ratios.into_iter().enumerate() {
                let expected = libm::jn(k as i32, x);
                let found = ratio * (0.5 * x).powi(k as i32);
                assert!((found - expected).abs() < 1e-13, "J_{k}({x}): {found} {expected}");
            }
        }
    }

    #[test]
    fn each_slope_is_the_derivative_of_the_one_before() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        for i in 1..60 {
            let rho = 0.31 * i as f64;
            let step = 1e-3;
            let at = |rho: f64| kernel.table.smooth_slopes::<SLOPE_COUNT>(rho);
            let (low, high, here) = (at(rho - step), at(rho + step), at(rho));
            for k in 0..SLOPE_COUNT - 1 {
                // dσ = 2 ρ dρ; the third derivative of the difference quotient leaves step²/6 of some k² / ρ²
                let quotient = (high[k] - low[k]) / (4.0 * rho * step) / (k as f64 + 1.0);
                let scale = (1.0 + 1.0 / (rho * rho)) * ((k + 2) * (k + 3)) as f64 * step * step;
                let size = here[k + 1].abs().max(here[k].abs() / (rho * rho + 4.0));
                assert!((quotient - here[k + 1]).abs() < (4.0 * scale + 1e-7) * size, "k {k}, rho {rho}");
            }
        }
    }

    #[test]
    fn mean_is_the_integral_of_the_smooth_part_also_beyond_the_table() {
        let kernel = LayerKernel::new(0.5).expect("in range");
        for rho in [0.01, 0.3, 1.0, 4.7, 13.0, 31.9, 40.0] {
            let pieces = 200;
            let mut integral = 0.0;
            for piece in 0..pieces {
                for (u, w) in gauss_interval(8) {
                    let s = rho * (piece as f64 + u) / pieces as f64;
                    integral += w * rho / pieces as f64 * kernel.smooth_part(s) * s;
                }
            }
            let expected = 2.0 * integral / (rho * rho);
            assert!((kernel.table.mean(rho) / expected - 1.0).abs() < 1e-10, "{rho}");
        }
    }
}
