//! Elementary functions without branches, from which the compiler makes vector code.
//!
//! Called within a `pulp` dispatch; each is accurate to a few units in the last place.

const MANTISSA: u64 = (1 << 52) - 1;
const ONE: u64 = 1023 << 52;
/// 2⁵² as bits: a small integer put into its mantissa reads as 2⁵² plus that integer.
const MAGIC: u64 = 1075 << 52;

/// `ln(numerator / denominator)`, with one division.
///
/// Where the ratio is close to 1 it equals `2 atanh(length / sum)`, which keeps all digits. Any finite
/// argument gives a finite result; 0 and subnormal numbers give a wrong one, which the caller multiplies
/// by 0.
#[inline(always)]
pub(crate) fn ln_ratio(numerator: f64, denominator: f64, length: f64, sum: f64) -> f64 {
    let (n, d) = (numerator.to_bits(), denominator.to_bits());
    let exponent = |bits: u64| f64::from_bits((bits >> 52) | MAGIC) - 4503599627370496.0;
    let mantissa = |bits: u64| f64::from_bits((bits & MANTISSA) | ONE);
    let mut power = exponent(n) - exponent(d);
    let (mut a, mut b) = (mantissa(n), mantissa(d));
    // bring a / b into 1/√2 .. √2
    let high = a > std::f64::consts::SQRT_2 * b;
    let low = b > std::f64::consts::SQRT_2 * a;
    power += if high { 1.0 } else { 0.0 };
    power -= if low { 1.0 } else { 0.0 };
    b *= if high { 2.0 } else { 1.0 };
    a *= if low { 2.0 } else { 1.0 };
    let close = power == 0.0;
    let top = if close { length } else { a - b };
    let bottom = if close { sum } else { a + b };
    let f = top / bottom;
    let w = f * f;
    // 2 atanh(f) / f on |f| <= (√2 - 1) / (√2 + 1), error 2e-20
    let mut p = 0.132_621_445_130_916_62;
    p = p * w + 0.132_487_585_772_216_45;
    p = p * w + 0.153_871_611_272_208_64;
    p = p * w + 0.181_817_737_333_680_17;
    p = p * w + 0.222_222_226_769_887_07;
    p = p * w + 0.285_714_285_688_187_2;
    p = p * w + 0.400_000_000_000_074_96;
    p = p * w + 0.666_666_666_666_666_6;
    let series = f * w * p + 2.0 * f;
    // ln 2 in two parts: the first times any exponent is exact
    power * 0.693_147_180_369_123_8 + (series + power * 1.908_214_929_270_587_7e-10)
}

/// `atan2(y, x)` for y >= 0, finite at the origin.
#[inline(always)]
pub(crate) fn angle(y: f64, x: f64) -> f64 {
    let across = x.abs();
    let steep = y > across;
    let small = if steep { across } else { y };
    let large = if steep { y } else { across };
    let large = if large > f64::MIN_POSITIVE { large } else { f64::MIN_POSITIVE };
    // atan(t) = π/4 + atan((t - 1) / (t + 1)) beyond tan(π/8)
    let turn = small > (std::f64::consts::SQRT_2 - 1.0) * large;
    let top = if turn { small - large } else { small };
    let bottom = if turn { small + large } else { large };
    let t = top / bottom;
    let w = t * t;
    // atan(t) / t on |t| <= tan(π/8), error 5e-20
    let mut p = 0.015_113_188_421_315_578;
    p = p * w - 0.033_387_254_662_610_874;
    p = p * w + 0.044_994_761_370_224_005;
    p = p * w - 0.052_173_064_890_151_256;
    p = p * w + 0.058_768_330_517_689_14;
    p = p * w - 0.066_662_051_616_548_52;
    p = p * w + 0.076_922_810_931_870_7;
    p = p * w - 0.090_909_080_587_269_49;
    p = p * w + 0.111_111_110_853_134_44;
    p = p * w - 0.142_857_142_853_295_62;
    p = p * w + 0.199_999_999_999_970_12;
    p = p * w - 0.333_333_333_333_333_26;
    let mut a = t * w * p + t;
    a += if turn { std::f64::consts::FRAC_PI_4 } else { 0.0 };
    a = if steep { std::f64::consts::FRAC_PI_2 - a } else { a };
    if x < 0.0 { std::f64::consts::PI - a } else { a }
}

/// `exp(x)` for x <= 0; 1e-300 or so below -690.
#[inline(always)]
pub(crate) fn exp_negative(x: f64) -> f64 {
    let x = if x < -690.0 { -690.0 } else { x };
    // the nearest integer to x / ln 2 appears in the low bits of a number near 1.5 * 2^52
    let shifted = x * std::f64::consts::LOG2_E + 6755399441055744.0;
    let power = shifted - 6755399441055744.0;
    let r = (x - power * 0.693_147_180_369_123_8) - power * 1.908_214_929_270_587_7e-10;
    // exp(r) on |r| <= ln 2 / 2, error 3e-18
    let mut p = 2.511_003_794_061_966_5e-8;
    p = p * r + 2.763_264_007_423_722_4e-7;
    p = p * r + 2.755_724_091_767_456e-6;
    p = p * r + 2.480_148_548_115_237e-5;
    p = p * r + 0.000_198_412_698_900_479_6;
    p = p * r + 0.001_388_888_895_231_587_4;
    p = p * r + 0.008_333_333_333_319_601;
    p = p * r + 0.041_666_666_666_488_09;
    p = p * r + 0.166_666_666_666_666_8;
    p = p * r + 0.500_000_000_000_001_9;
    p = p * r + 1.0;
    p = p * r + 1.0;
    p * f64::from_bits((shifted.to_bits().wrapping_add(1023)) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

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
        for i in 0..20_000 {
            let x = -0.033 * i as f64;
            let expected = x.exp();
            assert!((exp_negative(x) - expected).abs() <= 4.0 * f64::EPSILON * expected, "{x}");
        }
        assert_eq!(exp_negative(0.0), 1.0);
        assert!(exp_negative(-1e30) < 1e-290);
    }
}
