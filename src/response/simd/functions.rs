//! Elementary functions without branches, for vectors of numbers.
//!
//! Called within a `pulp` dispatch; each is accurate to a few units in the last place.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI, SQRT_2};

use pulp::Simd;

use crate::response::simd::lanes::Lanes;

const MANTISSA_BITS: u64 = (1 << 52) - 1;
const ONE_BITS: u64 = 1023 << 52;
/// 2⁵² as bits: a small integer put into its mantissa reads as 2⁵² plus that integer.
const SHIFT_BITS: u64 = 1075 << 52;
/// 1.5 · 2⁵²: a number below 2⁵¹ added to it is rounded to an integer, which its last bits hold.
const ROUNDING_SHIFT: f64 = 6_755_399_441_055_744.0;
/// Exponent below which [`exp`] stays what it is there.
const LEAST_EXPONENT: f64 = -700.0;
/// ln 2 in two parts: the first times any exponent is exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];

/// 1/n!, n = 13 .. 0.
const TAYLOR: [f64; 14] = [
    1.0 / 6_227_020_800.0,
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    1.0 / 2.0,
    1.0,
    1.0,
];

/// `ln(numerator / denominator)`, with one division.
///
/// Where the ratio is close to 1 it equals `2 atanh(length / sum)`, which keeps all digits. Any finite
/// argument gives a finite result; 0 and subnormal numbers give a wrong one, which the caller multiplies
/// by 0.
#[inline(always)]
pub(crate) fn ln_ratio<S: Simd>(
    numerator: Lanes<S>,
    denominator: Lanes<S>,
    length: Lanes<S>,
    sum: Lanes<S>,
) -> Lanes<S> {
    let one = sum.all(1.0);
    let zero = sum.all(0.0);
    let two = sum.all(2.0);
    // the two offsets 2⁵² cancel
    let power = exponent(numerator) - exponent(denominator);
    let (a, b) = (mantissa(numerator), mantissa(denominator));
    // bring a / b into 1/√2 .. √2
    let root = sum.all(SQRT_2);
    let (high, low) = ((root * b).less(a), (root * a).less(b));
    let power = power + high.pick(one, zero) - low.pick(one, zero);
    let b = b * high.pick(two, one);
    let a = a * low.pick(two, one);
    let close = power.abs().less(sum.all(0.5));
    let f = close.pick(length, a - b) / close.pick(sum, a + b);
    let w = f * f;
    // 2 atanh(f) / f - 2 over f² on |f| <= (√2 - 1) / (√2 + 1), error 2e-20
    let p = w.polynomial([
        0.132_621_445_130_916_62,
        0.132_487_585_772_216_45,
        0.153_871_611_272_208_64,
        0.181_817_737_333_680_17,
        0.222_222_226_769_887_07,
        0.285_714_285_688_187_2,
        0.400_000_000_000_074_96,
        0.666_666_666_666_666_6,
    ]);
    let series = (f * w).mul_add(p, two * f);
    power.mul_add(sum.all(LN_2[0]), power.mul_add(sum.all(LN_2[1]), series))
}

/// The exponent, biased, plus 2⁵².
#[inline(always)]
fn exponent<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    x.map_bits(|b| (b >> 52) | SHIFT_BITS)
}

/// The mantissa in 1 .. 2.
#[inline(always)]
fn mantissa<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    x.map_bits(|b| (b & MANTISSA_BITS) | ONE_BITS)
}

/// `atan2(y, x)` for y >= 0, finite at the origin.
#[inline(always)]
pub(crate) fn angle<S: Simd>(y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    let zero = x.all(0.0);
    let across = x.abs();
    let steep = across.less(y);
    let small = steep.pick(across, y);
    let large = steep.pick(y, across);
    let least = x.all(f64::MIN_POSITIVE);
    let large = least.less(large).pick(large, least);
    // atan(t) = π/4 + atan((t - 1) / (t + 1)) beyond tan(π/8)
    let turn = (large * x.all(SQRT_2 - 1.0)).less(small);
    let t = turn.pick(small - large, small) / turn.pick(small + large, large);
    let w = t * t;
    // atan(t) / t - 1 over t² on |t| <= tan(π/8), error 5e-20
    let p = w.polynomial([
        0.015_113_188_421_315_578,
        -0.033_387_254_662_610_874,
        0.044_994_761_370_224_005,
        -0.052_173_064_890_151_256,
        0.058_768_330_517_689_14,
        -0.066_662_051_616_548_52,
        0.076_922_810_931_870_7,
        -0.090_909_080_587_269_49,
        0.111_111_110_853_134_44,
        -0.142_857_142_853_295_62,
        0.199_999_999_999_970_12,
        -0.333_333_333_333_333_26,
    ]);
    let a = (t * w).mul_add(p, t) + turn.pick(x.all(FRAC_PI_4), zero);
    let a = steep.pick(x.all(FRAC_PI_2) - a, a);
    x.less(zero).pick(x.all(PI) - a, a)
}

/// `exp(x)` for x <= 0; below e⁻⁷⁰⁰ it is e⁻⁷⁰⁰.
#[inline(always)]
pub(crate) fn exp<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let least = x.all(LEAST_EXPONENT);
    let x = x.less(least).pick(least, x);
    let rounded = x.mul_add(x.all(LOG2_E), x.all(ROUNDING_SHIFT));
    let power = rounded - x.all(ROUNDING_SHIFT);
    let rest = power.mul_add(x.all(-LN_2[1]), power.mul_add(x.all(-LN_2[0]), x));
    // Taylor up to rest¹³ / 13! on |rest| <= ln 2 / 2, error 5e-18
    let p = rest.polynomial(TAYLOR);
    p * rounded.map_bits(|b| b.wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use pulp::WithSimd;

    use super::*;

    #[derive(Clone, Copy)]
    enum Function {
        LnRatio,
        Angle,
        Exp,
    }

    /// A function of the first of four numbers that it takes, on the machine's vectors.
    #[derive(Clone, Copy)]
    struct Apply {
        function: Function,
        x: [f64; 4],
    }

    impl WithSimd for Apply {
        type Output = f64;

        #[inline(always)]
        fn with_simd<S: Simd>(self, simd: S) -> f64 {
            let [a, b, c, d] = self.x.map(|x| Lanes::splat(simd, x));
            let value = match self.function {
                Function::LnRatio => super::ln_ratio(a, b, c, d),
                Function::Angle => super::angle(a, b),
                Function::Exp => super::exp(a),
            };
            simd.reduce_max_f64s(value.v)
        }
    }

    /// On the machine's vectors, which must agree with plain numbers to rounding.
    fn both(apply: Apply) -> f64 {
        let vector = pulp::Arch::new().dispatch(apply);
        let plain = apply.with_simd(pulp::Scalar);
        assert!((vector - plain).abs() <= 16.0 * f64::EPSILON * plain.abs().max(1.0), "{vector} {plain}");
        vector
    }

    fn ln_ratio(a: f64, b: f64, length: f64, sum: f64) -> f64 {
        both(Apply { function: Function::LnRatio, x: [a, b, length, sum] })
    }

    fn angle(y: f64, x: f64) -> f64 {
        both(Apply { function: Function::Angle, x: [y, x, 0.0, 0.0] })
    }

    #[test]
    fn logarithm_is_accurate_to_a_few_ulp() {
        for i in 0..4000 {
            let s0 = 0.001 * 1.007f64.powi(i % 1500) - 5.0;
            let s1 = s0 + 0.01 * 1.01f64.powi(i / 5);
            let rho: f64 = 1.3f64.powi(i % 37 - 25);
            let (r0, r1) = (rho.hypot(s0), rho.hypot(s1));
            let (t0, t1) = (r0 + s0.abs(), r1 + s1.abs());
            let (n, d) = if s0 > 0.0 {
                (t1, t0)
            } else if s1 >= 0.0 {
                (t0 * t1, rho * rho)
            } else {
                (t0, t1)
            };
            let expected = 2.0 * libm::atanh((s1 - s0) / (r0 + r1));
            let by_parts = libm::asinh(s1 / rho) - libm::asinh(s0 / rho);
            let got = ln_ratio(n, d, s1 - s0, r0 + r1);
            let best = if expected < 1.0 { expected } else { by_parts };
            assert!((got - best).abs() <= 8.0 * f64::EPSILON * (1.0 + best), "{s0} {s1} {rho}: {got} {best}");
            if expected < 0.3 {
                assert!((got / expected - 1.0).abs() <= 8.0 * f64::EPSILON, "{got} {expected}");
            }
        }
    }

    #[test]
    fn angle_is_accurate_to_a_few_ulp() {
        for i in 0..=1000 {
            let turn = std::f64::consts::PI * i as f64 / 1000.0;
            for scale in [1e-20, 1e-9, 1.0, 1e7] {
                let (y, x) = (scale * turn.sin().abs(), scale * turn.cos());
                let expected = libm::atan2(y, x);
                assert!((angle(y, x) - expected).abs() <= 4.0 * f64::EPSILON * expected, "{turn}");
            }
        }
        assert_eq!(angle(0.0, 1.0), 0.0);
        assert!(angle(0.0, 0.0).is_finite());
    }
    #[test]
    fn exponential_is_accurate_to_a_few_ulp() {
        for i in 0..=20_000 {
            let x = -0.034_99 * i as f64;
            let (got, expected) = (both(Apply { function: Function::Exp, x: [x; 4] }), libm::exp(x));
            assert!((got - expected).abs() <= 4.0 * f64::EPSILON * expected, "{x}: {got} {expected}");
        }
        assert!(both(Apply { function: Function::Exp, x: [f64::NEG_INFINITY; 4] }) < 1e-300);
    }
}
