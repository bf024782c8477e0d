//! Lemke's method from a crash basis.

use faer::Mat;
use quasirigid::lcp::{
    LcpMethod, LcpMethodName, LcpOptions, LcpStatus, LemkeOptions, RayConclusion, StartingBasis,
};

use crate::problems::{Noise, any_q, grid_contact};
use crate::{assert_solves, run, run_path, run_with};

/// Problems of more than a handful of unknowns, with what a ray would mean.
fn larger_problem(noise: &mut Noise, case: usize) -> (Mat<f64>, Vec<f64>, &'static str) {
    let n = 20 + noise.below(40);
    let (g, h) = (noise.matrix(n, n), noise.matrix(n, n));
    let thin = noise.matrix(n, n / 2);
    let skew = &h - h.transpose();
    let identity = Mat::<f64>::identity(n, n);
    let (m, kind) = match case % 9 {
        0 => (&g * g.transpose() + &identity * 0.1, "definite"),
        1 => (&g * g.transpose() * (1.0 / n as f64) + skew + &identity * 0.1, "P, far from symmetric"),
        2 => (&thin * thin.transpose(), "semidefinite"),
        3 => (&thin * thin.transpose() + skew, "semidefinite and skew"),
        4 => (Mat::from_fn(n, n, |i, j| g[(i, j)].abs() + if i == j { 0.1 } else { 0.0 }), "copositive"),
        5 => (Mat::from_fn(n, n, |i, j| 0.5_f64.powi((i / 2).abs_diff(j / 2) as i32)), "coincident nodes"),
        6 => (Mat::from_fn(n, n, |i, j| if i == j { 1.0 } else { -g[(i, j)].abs() / n as f64 }), "M-matrix"),
        7 => (Mat::from_fn(n, n, |_, _| noise.integer(2)), "small integers"),
        _ => (&g + &identity * 2.0, "any"),
    };
    (m, any_q(noise, n), kind)
}

#[test]
fn a_crash_basis_changes_no_ending() {
    let mut noise = Noise(41);
    let mut used = 0;
    for case in 0..900 {
        let (m, q, kind) = larger_problem(&mut noise, case);
        let crashed = run(&m, &q);
        let plain = run_path(&m, &q);
        let context = format!("case {case}, {kind}: {} / {}", crashed.advice(), plain.advice());
        assert!(plain.attempts.iter().all(|attempt| attempt.start != StartingBasis::Crash));
        assert!(crashed.attempts.iter().skip(1).all(|attempt| attempt.start != StartingBasis::Crash));
        assert_eq!(crashed.pivots, crashed.attempts.iter().map(|attempt| attempt.pivots).sum::<usize>());
        if crashed.status == LcpStatus::Solved {
            assert_solves(&m, &q, &crashed, 1e-9);
        }
        let by_crash = crashed.attempts.len() == 1 && crashed.attempts[0].start == StartingBasis::Crash;
        used += usize::from(by_crash);
        if by_crash {
            assert_eq!(crashed.status, LcpStatus::Solved, "{context}");
            if matches!(kind, "definite" | "P, far from symmetric" | "M-matrix") {
                for (a, b) in crashed.z.iter().zip(&plain.z) {
                    assert!((a - b).abs() <= 1e-8 * (1.0 + a.abs()), "{context}: {a} and {b}");
                }
            } else if plain.status != LcpStatus::Solved {
                // An answer where plain Lemke ends on a ray is welcome, unless the ray has proved there is none.
                let ray = plain.ray.as_ref().expect(&context);
                assert_ne!(ray.conclusion, RayConclusion::Infeasible, "{context}");
            }
        } else if crashed.status != LcpStatus::Interrupted {
            // From nothing then: the very path of plain Lemke, with its ending and its proof.
            assert_eq!((crashed.status, &crashed.z), (plain.status, &plain.z), "{context}");
            assert_eq!(crashed.ray, plain.ray, "{context}");
        }
    }
    assert!(used > 200, "the crash basis was taken in {used} of 900 cases");
}

#[test]
fn a_crash_that_finds_nothing_takes_nothing_from_the_path() {
    // Block exchanges end at the first block with a negative determinant; the path needs all it is given.
    let mut noise = Noise(41);
    let mut seen = 0;
    for case in 0..300 {
        let (m, q, kind) = larger_problem(&mut noise, case);
        let plain = run_path(&m, &q);
        if plain.status != LcpStatus::Solved || plain.attempts.len() > 1 || plain.pivots == 0 {
            continue;
        }
        let options = LcpOptions { max_pivots: Some(plain.pivots), ..LcpOptions::default() };
        let crashed = run_with(&m, &q, LcpMethodName::Lemke, &options);
        assert_eq!(crashed.status, LcpStatus::Solved, "case {case}, {kind}: {}", crashed.advice());
        if let [crash, path] = crashed.attempts[..] {
            assert!(crash.start == StartingBasis::Crash && path.pivots == plain.pivots);
            assert_eq!(crashed.pivots, crash.pivots + path.pivots);
            seen += usize::from(crash.pivots > 0);
        }
    }
    assert!(seen > 20, "a crash that found nothing was seen {seen} times");
}

#[test]
fn a_contact_costs_as_many_pivots_as_nodes_and_says_how() {
    let contact = grid_contact(30, 0.8e-3, 10e-3, 2e-3);
    let crashed = run(&contact.m, &contact.q);
    let plain = run_path(&contact.m, &contact.q);
    assert_eq!(crashed.active(), plain.active());
    let contacts = crashed.active().len();
    assert!(crashed.pivots >= contacts && 10 * crashed.pivots <= 12 * contacts, "{}", crashed.pivots);
    assert!(plain.pivots > contacts);
    assert_eq!(crashed.method, LcpMethodName::Lemke);
    assert_eq!(crashed.attempts[0].start, StartingBasis::Crash);
    // A budget below what the guess alone needs leaves all of it to the path.
    let tight = LcpOptions { max_pivots: Some(30), ..LcpOptions::default() };
    let tight = run_with(&contact.m, &contact.q, LcpMethodName::Lemke, &tight);
    assert_eq!((tight.status, tight.pivots), (LcpStatus::PivotLimit, 30));
    // The caller's own covering vector is what the path follows.
    let covering = LemkeOptions { covering: Some(vec![2.0; contact.q.len()]), ..LemkeOptions::default() };
    let covered = run_with(&contact.m, &contact.q, LcpMethod::Lemke(covering), &LcpOptions::default());
    assert!(covered.attempts.iter().all(|attempt| attempt.start != StartingBasis::Crash));
    assert_eq!(covered.active(), crashed.active());
}

#[test]
fn rows_that_bulge_are_taken_in() {
    // A short-ranged pull: what is pressed lifts its neighbours, so rows with q > 0 come to touch.
    let n = 120;
    let m = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 1.0,
        1 => -0.45,
        _ => 0.0,
    });
    let q: Vec<f64> = (0..n).map(|i| if i.abs_diff(60) < 12 { -1.0 } else { 0.05 }).collect();
    let plain = run_path(&m, &q);
    assert!(plain.active().len() > 23, "{:?}", plain.active());
    for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
        let solution = run_with(&m, &q, method, &LcpOptions::default());
        assert_solves(&m, &q, &solution, 1e-12);
        assert_eq!(solution.active(), plain.active(), "{method}");
    }
}
