//! Interrupts, limits and extreme numbers: how a solve ends.

use faer::{Mat, mat};
use quasirigid::lcp::{LcpMethodName, LcpOptions, LcpStatus};

use crate::problems::{Noise, grid_contact};
use crate::{assert_solves, run, run_with};

#[test]
fn an_interrupt_ends_every_method_soon() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let contact = grid_contact(25, 0.8e-3, 10e-3, 1e-3);
    let q = vec![-1e-3; contact.q.len()];
    for method in
        [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg, LcpMethodName::Auto]
    {
        let asked = AtomicUsize::new(0);
        let stop = || asked.fetch_add(1, Ordering::Relaxed) >= 2;
        let options = LcpOptions { interrupt: Some(&stop), ..LcpOptions::default() };
        let solution = run_with(&contact.m, &q, method, &options);
        assert_eq!(solution.status, LcpStatus::Interrupted, "{method}");
        assert!(solution.advice().starts_with("interrupted"));
        assert!(asked.into_inner() < 10, "{method} went on asking");
    }
}

#[test]
fn an_interrupt_at_any_ask_never_looks_like_another_ending() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let contact = grid_contact(25, 0.8e-3, 10e-3, 1e-3);
    let infeasible = Mat::from_fn(90, 90, |i, j| if i == j { 1.0 } else { -0.5 });
    let pressed = vec![-1.0; 90];
    for (m, q) in [(&contact.m, &contact.q), (&infeasible, &pressed)] {
        for method in [
            LcpMethodName::Lemke,
            LcpMethodName::BlockPivoting,
            LcpMethodName::ProjectedCg,
            LcpMethodName::Auto,
        ] {
            let whole = run_with(m, q, method, &LcpOptions::default());
            for after in 0..60 {
                let asked = AtomicUsize::new(0);
                let stop = || asked.fetch_add(1, Ordering::Relaxed) >= after;
                let options = LcpOptions { interrupt: Some(&stop), ..LcpOptions::default() };
                let solution = run_with(m, q, method, &options);
                let context = format!("{method}, {after}: {}", solution.advice());
                if solution.status != LcpStatus::Interrupted {
                    assert_eq!(
                        (solution.status, &solution.z, &solution.w),
                        (whole.status, &whole.z, &whole.w)
                    );
                    assert_eq!(solution.ray, whole.ray, "{context}");
                }
            }
        }
    }
}

#[test]
fn nothing_is_called_solved_that_tolerance_does_not_pass() {
    let contact = grid_contact(15, 0.8e-3, 10e-3, 0.5e-3);
    let options = LcpOptions { tolerance: 1e-30, ..LcpOptions::default() };
    let solution = run_with(&contact.m, &contact.q, LcpMethodName::Lemke, &options);
    assert_eq!(solution.status, LcpStatus::Breakdown);
    assert!(solution.certificate.natural_residual > 1e-30 && solution.advice().contains("tolerance"));
}

#[test]
fn gradients_and_blocks_say_when_m_is_not_for_them() {
    let m = mat![[1.0, 2.0], [2.0, 1.0]];
    let solution = run_with(&m, &[-1.0, -1.1], LcpMethodName::ProjectedCg, &LcpOptions::default());
    if solution.status != LcpStatus::Solved {
        assert_eq!(solution.status, LcpStatus::Breakdown);
        assert!(solution.advice().contains("positive definite"), "{}", solution.advice());
    }
    let m = mat![[0.0, 1.0], [1.0, 0.0]];
    let solution = run_with(&m, &[-1.0, -1.1], LcpMethodName::ProjectedCg, &LcpOptions::default());
    assert_eq!(solution.status, LcpStatus::Breakdown);
    let singular = mat![[1.0, 1.0], [1.0, 1.0]];
    let solution = run_with(&singular, &[-1.0, -1.0], LcpMethodName::BlockPivoting, &LcpOptions::default());
    assert_eq!(solution.status, LcpStatus::Breakdown);
    assert!(solution.advice().contains("lemke"), "{}", solution.advice());
    assert_solves(&singular, &[-1.0, -1.0], &run(&singular, &[-1.0, -1.0]), 1e-15);
}

#[test]
fn extreme_numbers_end_without_panic() {
    let mut noise = Noise(77);
    for _ in 0..2000 {
        let n = 1 + noise.below(6);
        let mut entry = || {
            let exponent = noise.integer(300);
            noise.value() * if noise.below(3) == 0 { 10_f64.powf(exponent) } else { 1.0 }
        };
        let m = Mat::from_fn(n, n, |_, _| entry());
        let q: Vec<f64> = (0..n).map(|_| entry()).collect();
        for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
            let solution = run_with(&m, &q, method, &LcpOptions::default());
            assert!(solution.z.iter().all(|&z| z >= 0.0 && z.is_finite()), "{}", solution.advice());
            assert!(solution.w.iter().all(|w| w.is_finite()), "{}", solution.advice());
            if solution.status == LcpStatus::Solved {
                assert!(solution.z.iter().all(|&z| z >= 0.0 && z.is_finite()));
                assert!(solution.certificate.natural_residual <= 1e-10);
            }
        }
    }
}
