//! Bessel functions of the first kind over the leading power of their argument.

/// `J_k(x) / (x/2)^k` for k = 0 .. N, 2 to 12, and x >= 0.
pub(super) fn bessel_ratios<const N: usize>(x: f64) -> [f64; N] {
    let quarter = 0.25 * x * x;
    let mut ratios = [0.0; N];
    if x <= 12.0 {
        // power series of the two highest, then J_(k-1) = 2k/x J_k - J_(k+1)
        for k in [N - 2, N - 1] {
            let mut term = 1.0 / (1..=k).map(|v| v as f64).product::<f64>();
            let mut i = 0.0;
            while term != 0.0 && i < 40.0 {
                ratios[k] += term;
                i += 1.0;
                term *= -quarter / (i * (i + k as f64));
            }
        }
        for k in (1..N - 1).rev() {
            ratios[k - 1] = k as f64 * ratios[k] - quarter * ratios[k + 1];
        }
    } else {
        // upwards, stable as k stays below x
        ratios[0] = libm::j0(x);
        ratios[1] = libm::j1(x) * 2.0 / x;
        for k in 1..N - 1 {
            ratios[k + 1] = (k as f64 * ratios[k] - ratios[k - 1]) / quarter;
        }
    }
    ratios
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_ratios_are_those_of_the_library() {
        for i in 0..400 {
            let x = 0.037 * 1.022f64.powi(i);
            let ratios: [f64; 12] = bessel_ratios(x);
            for (k, ratio) in ratios.into_iter().enumerate() {
                let expected = libm::jn(k as i32, x);
                let found = ratio * (0.5 * x).powi(k as i32);
                assert!((found - expected).abs() < 1e-13, "J_{k}({x}): {found} {expected}");
            }
        }
    }
}
