//! Answers against every complementary basis, one after the other.

use faer::Mat;
use quasirigid::lcp::{LcpMethodName, LcpOptions, LcpStatus, RayConclusion};

use crate::problems::{Noise, P_MATRICES, RAY_MEANS_INFEASIBLE, small_problem};
use crate::{assert_solves, run, run_with};

/// Solves the principal block `set` by elimination with full pivoting; `None` where singular.
fn block_solution(m: &Mat<f64>, q: &[f64], set: &[usize]) -> Option<Vec<f64>> {
    let k = set.len();
    let mut a = Mat::from_fn(k, k + 1, |i, j| if j < k { m[(set[i], set[j])] } else { -q[set[i]] });
    let mut order: Vec<usize> = (0..k).collect();
    for step in 0..k {
        let (mut row, mut column) = (step, step);
        for i in step..k {
            for j in step..k {
                if a[(i, j)].abs() > a[(row, column)].abs() {
                    (row, column) = (i, j);
                }
            }
        }
        if a[(row, column)].abs() < 1e-9 {
            return None;
        }
        for j in 0..=k {
            (a[(row, j)], a[(step, j)]) = (a[(step, j)], a[(row, j)]);
        }
        for i in 0..k {
            (a[(i, column)], a[(i, step)]) = (a[(i, step)], a[(i, column)]);
        }
        order.swap(step, column);
        for i in (0..k).filter(|&i| i != step) {
            let factor = a[(i, step)] / a[(step, step)];
            for j in step..=k {
                a[(i, j)] -= factor * a[(step, j)];
            }
        }
    }
    let mut z = vec![0.0; k];
    (0..k).for_each(|i| z[order[i]] = a[(i, k)] / a[(i, i)]);
    Some(z)
}

/// Every complementary basic solution.
fn enumerate(m: &Mat<f64>, q: &[f64]) -> Vec<Vec<f64>> {
    let n = q.len();
    let mut found = Vec::new();
    for mask in 0..1_usize << n {
        let set: Vec<usize> = (0..n).filter(|i| mask >> i & 1 == 1).collect();
        let Some(block) = block_solution(m, q, &set) else { continue };
        let mut z = vec![0.0; n];
        set.iter().zip(block).for_each(|(&i, value)| z[i] = value);
        // Larger than this comes from a block that is singular up to rounding.
        let size = z.iter().map(|z| z.abs()).sum::<f64>();
        if size > 1e5 {
            continue;
        }
        let rounding = 1e-10 * (1.0 + size);
        let w = |i: usize| q[i] + (0..n).map(|j| m[(i, j)] * z[j]).sum::<f64>();
        if (0..n).all(|i| z[i] >= -rounding && w(i) >= -rounding) {
            found.push(z);
        }
    }
    found
}

fn agree_with_enumeration(method: LcpMethodName, cases: usize, seed: u64, largest: usize) {
    let mut noise = Noise(seed);
    let mut solved = 0;
    for case in 0..cases {
        let (m, q, kind) = small_problem(&mut noise, largest);
        let solution = run_with(&m, &q, method, &LcpOptions::default());
        let context =
            || format!("case {case} ({kind}): {} for {m:?} {q:?} {:?}", solution.advice(), solution.attempts);
        match solution.status {
            LcpStatus::Solved => {
                assert_solves(&m, &q, &solution, 1e-9);
                solved += 1;
            }
            LcpStatus::Ray => {
                let ray = solution.ray.as_ref().expect("a ray comes with its direction");
                let none =
                    ray.conclusion == RayConclusion::Infeasible || RAY_MEANS_INFEASIBLE.contains(&kind);
                let basic = if none { enumerate(&m, &q) } else { Vec::new() };
                assert!(basic.is_empty(), "{} {basic:?}", context());
            }
            _ => panic!("{}", context()),
        }
    }
    assert!(solved > cases / 2 && solved < cases, "{solved} of {cases} solved");
}

#[test]
fn small_problems_of_every_kind_agree_with_enumeration() {
    for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
        agree_with_enumeration(method, 4000, 1, 8);
    }
}

#[test]
#[ignore = "takes minutes; the short version always runs"]
fn a_hundred_thousand_small_problems_agree_with_enumeration() {
    for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
        agree_with_enumeration(method, 100_000, 2, 10);
    }
}

#[test]
fn block_pivoting_and_lemke_find_the_one_solution_of_a_p_matrix() {
    let mut noise = Noise(5);
    for _ in 0..3000 {
        let (m, q, kind) = small_problem(&mut noise, 9);
        if P_MATRICES.contains(&kind) {
            let pivoting = run_with(&m, &q, LcpMethodName::BlockPivoting, &LcpOptions::default());
            assert_solves(&m, &q, &pivoting, 1e-10);
            let lemke = run(&m, &q);
            for (a, b) in lemke.z.iter().zip(&pivoting.z) {
                assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{kind}: {a} and {b} for {m:?} {q:?}");
            }
        }
    }
}

#[test]
fn copositive_plus_problems_built_from_an_answer_are_solved() {
    let mut noise = Noise(23);
    for n in [12, 40, 90] {
        for kind in 0..4 {
            for degenerate in [false, true] {
                let g = noise.matrix(n, n);
                let thin = noise.matrix(n, n / 3);
                let m = match kind {
                    0 => &thin * thin.transpose(),
                    1 => &thin * thin.transpose() + &g - g.transpose(),
                    2 => &g - g.transpose(),
                    _ => {
                        // An obstacle-like matrix: columns repeated, as with coincident nodes.
                        let half = noise.matrix(n / 2, n / 2);
                        let core = &half * half.transpose();
                        Mat::from_fn(n, n, |i, j| core[(i % (n / 2), j % (n / 2))])
                    }
                };
                // z on one third, w on another; the rest has neither when degenerate.
                let third = |i: usize| i % 3;
                let z: Vec<f64> =
                    (0..n).map(|i| if third(i) == 0 { noise.value().abs() } else { 0.0 }).collect();
                let w: Vec<f64> = (0..n)
                    .map(|i| {
                        if third(i) == 1 || (third(i) == 2 && !degenerate) {
                            noise.value().abs()
                        } else {
                            0.0
                        }
                    })
                    .collect();
                let q: Vec<f64> =
                    (0..n).map(|i| w[i] - (0..n).map(|j| m[(i, j)] * z[j]).sum::<f64>()).collect();
                for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
                    let solution = run_with(&m, &q, method, &LcpOptions::default());
                    assert_eq!(
                        solution.status,
                        LcpStatus::Solved,
                        "{method}, n = {n}, kind {kind}, degenerate {degenerate}: {} {:?}",
                        solution.advice(),
                        solution.attempts
                    );
                }
            }
        }
    }
}

#[test]
fn block_pivoting_that_goes_in_circles_hands_over() {
    // Far from symmetric: block exchanges do not get on, and single ones would take thousands of factors.
    let mut noise = Noise(3);
    let n = 120;
    let (a, b) = (noise.matrix(n, n), noise.matrix(n, n));
    let m = &a * a.transpose() * (1.0 / n as f64) + &b - b.transpose() + Mat::<f64>::identity(n, n) * 0.1;
    let q: Vec<f64> = (0..n).map(|_| noise.value()).collect();
    let solution = run_with(&m, &q, LcpMethodName::BlockPivoting, &LcpOptions::default());
    assert_solves(&m, &q, &solution, 1e-11);
    assert_eq!(solution.attempts[0].method, LcpMethodName::BlockPivoting);
    assert_eq!(solution.method, solution.attempts.last().unwrap().method);
    let options = LcpOptions { max_pivots: Some(500), ..LcpOptions::default() };
    let bounded = run_with(&m, &q, LcpMethodName::BlockPivoting, &options);
    assert_eq!((bounded.status, bounded.attempts.len()), (LcpStatus::PivotLimit, 1));
    let options = LcpOptions { exchanges_only: true, ..LcpOptions::default() };
    for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
        let given_up = run_with(&m, &q, method, &options);
        assert_eq!((given_up.status, given_up.attempts.len()), (LcpStatus::Breakdown, 1));
    }
}
