//! The linear complementarity solvers through the public API.

#[path = "common/lcp_problems.rs"]
mod problems;

use faer::{Mat, mat};
use problems::{
    Noise, P_MATRICES, RAY_MEANS_INFEASIBLE, circulant, exponential_examples, graded_p_matrix, grid_contact,
    small_problem,
};
use quasirigid::lcp::{
    AutoOptions, BlockPivotingOptions, Definiteness, DefinitenessCheck, LcpError, LcpMethod, LcpMethodName,
    LcpOptions, LcpProblem, LcpSolution, LcpStatus, LemkeOptions, RayConclusion, solve,
};
use quasirigid::response::spectrum;

fn run(m: &Mat<f64>, q: &[f64]) -> LcpSolution {
    run_with(m, q, LcpMethodName::Lemke, &LcpOptions::default())
}

fn run_with(m: &Mat<f64>, q: &[f64], method: impl Into<LcpMethod>, options: &LcpOptions) -> LcpSolution {
    let problem = LcpProblem::new(m.as_ref(), q).unwrap();
    solve(&problem, &method.into(), options).unwrap()
}

/// Lemke's path without a look for a crash basis.
fn run_path(m: &Mat<f64>, q: &[f64]) -> LcpSolution {
    let method = LemkeOptions { crash: false, ..LemkeOptions::default() };
    run_with(m, q, LcpMethod::Lemke(method), &LcpOptions::default())
}

/// Checks an answer by its definition, apart from the certificate.
fn assert_solves(m: &Mat<f64>, q: &[f64], solution: &LcpSolution, tolerance: f64) {
    assert_eq!(solution.status, LcpStatus::Solved, "{} for {m:?} {q:?}", solution.advice());
    let n = q.len();
    let limit = tolerance * q.iter().fold(0.0_f64, |a, q| a.max(-q));
    for i in 0..n {
        let w = q[i] + (0..n).map(|j| m[(i, j)] * solution.z[j]).sum::<f64>();
        let row = (0..n).map(|j| m[(i, j)].abs()).fold(0.0, f64::max);
        assert!(solution.z[i] >= 0.0 && w >= -limit, "w[{i}] = {w:e} for {m:?} {q:?} {solution:?}");
        assert!(w <= limit || solution.z[i] * row <= limit, "w[{i}] = {w:e}, z = {:e}", solution.z[i]);
    }
}

// Known answers

#[test]
fn the_empty_problem_and_those_without_deficit_are_solved_at_zero() {
    let empty = Mat::<f64>::zeros(0, 0);
    assert_eq!(run(&empty, &[]).status, LcpStatus::Solved);
    let m = mat![[-1.0, 5.0], [2.0, 0.0]];
    for q in [[0.0, 0.0], [1.0, 0.0], [3.0, 2.0]] {
        let solution = run(&m, &q);
        assert_eq!((solution.status, solution.pivots), (LcpStatus::Solved, 0));
        assert_eq!(solution.z, [0.0, 0.0]);
        assert_eq!(solution.w, q);
    }
}

#[test]
fn one_unknown_has_the_quotient_or_nothing() {
    let solution = run(&mat![[4.0]], &[-2.0]);
    assert_eq!(solution.status, LcpStatus::Solved);
    assert_eq!(solution.z, [0.5]);
    for m in [0.0, -3.0] {
        let solution = run(&mat![[m]], &[-2.0]);
        assert_eq!(solution.status, LcpStatus::Ray);
        assert_eq!(solution.ray.unwrap().conclusion, RayConclusion::Infeasible);
    }
}

#[test]
fn two_unknowns_by_hand() {
    // Both touch: 2 a + b = 5, a + 2 b = 6.
    let m = mat![[2.0, 1.0], [1.0, 2.0]];
    let solution = run(&m, &[-5.0, -6.0]);
    assert_solves(&m, &[-5.0, -6.0], &solution, 1e-15);
    assert!((solution.z[0] - 4.0 / 3.0).abs() < 1e-15 && (solution.z[1] - 7.0 / 3.0).abs() < 1e-15);
    // The second alone: w = (-1 + 3, 0).
    let solution = run(&m, &[-1.0, -6.0]);
    assert_eq!(solution.z, [0.0, 3.0]);
    assert_eq!(solution.w, [2.0, 0.0]);
}

#[test]
fn a_skew_matrix_with_a_zero_diagonal_is_solved() {
    let m = mat![[0.0, 1.0], [-1.0, 0.0]];
    let solution = run(&m, &[-1.0, 2.0]);
    assert_solves(&m, &[-1.0, 2.0], &solution, 1e-15);
    assert_eq!(solution.z, [2.0, 1.0]);
}

#[test]
fn a_huge_solution_is_not_called_impossible() {
    // (1 + 2/u, 2/u) solves it exactly; along (1, 1) the columns of M add to 0 and u.
    let u = 4.0 * f64::EPSILON;
    let m = mat![[1.0, -1.0], [-1.0, 1.0 + u]];
    for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
        let solution = run_with(&m, &[-1.0, -1.0], method, &LcpOptions::default());
        match solution.status {
            LcpStatus::Solved => assert_eq!(solution.z, [1.0 + 2.0 / u, 2.0 / u]),
            _ => {
                let ray = solution.ray.as_ref().expect("a ray");
                assert_eq!(ray.conclusion, RayConclusion::InfeasibleToRounding);
                assert!(solution.advice().contains("up to rounding"), "{}", solution.advice());
            }
        }
        println!("{method}: {} {:?}", solution.advice(), solution.attempts);
        if method == LcpMethodName::Auto {
            assert!(solution.attempts.len() > 1, "a ray to rounding is no end for auto");
        }
        // Without u the columns add to zero exactly, and there is none.
        let none = run_with(&mat![[1.0, -1.0], [-1.0, 1.0]], &[-1.0, -1.0], method, &LcpOptions::default());
        assert_eq!(none.ray.expect("a ray").conclusion, RayConclusion::Infeasible);
    }
}

#[test]
fn the_unit_of_m_changes_no_ending_where_a_diagonal_is_zero() {
    let m = mat![[2.0, 1.0, 2.0], [1.0, 2.0, -3.0], [-2.0, 3.0, 0.0]];
    let q = [-3.0, -4.0, -3.0];
    for method in [LcpMethodName::BlockPivoting, LcpMethodName::Lemke, LcpMethodName::Auto] {
        let plain = run_with(&m, &q, method, &LcpOptions::default());
        for scale in [1e-12, 1e9, 1e12] {
            let scaled = run_with(&(&m * scale), &q, method, &LcpOptions::default());
            assert_eq!(scaled.status, plain.status, "{method}, {scale:e}: {}", scaled.advice());
            assert_eq!(scaled.active(), plain.active(), "{method}, {scale:e}");
        }
    }
}

// Twins: every complementary basis, one after the other

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
    let mut endings = std::collections::BTreeMap::<String, usize>::new();
    for case in 0..cases {
        let (m, q, kind) = small_problem(&mut noise, largest);
        let solution = run_with(&m, &q, method, &LcpOptions::default());
        *endings.entry(format!("{kind}: {}", solution.status)).or_default() += 1;
        let context =
            || format!("case {case} ({kind}): {} for {m:?} {q:?} {:?}", solution.advice(), solution.attempts);
        match solution.status {
            LcpStatus::Solved => assert_solves(&m, &q, &solution, 1e-9),
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
    println!("{endings:#?}");
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

// Hard cases of the literature

#[test]
fn exponential_examples_end_solved_by_every_method() {
    for n in [1, 2, 5, 10, 15, 20] {
        for (name, m, q) in exponential_examples(n) {
            for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
                let solution = run_with(&m, &q, method, &LcpOptions::default());
                println!("{name} {n} {method}: {} pivots, {} runs", solution.pivots, solution.attempts.len());
                assert_solves(&m, &q, &solution, 1e-12);
            }
        }
    }
}

#[test]
fn a_pivot_limit_that_the_caller_set_is_kept() {
    let (_, m, q) = exponential_examples(12).swap_remove(3);
    let options = LcpOptions { max_pivots: Some(100), ..LcpOptions::default() };
    let solution = run_with(&m, &q, LcpMethodName::Lemke, &options);
    assert_eq!((solution.status, solution.pivots), (LcpStatus::PivotLimit, 100));
    assert!(solution.advice().contains("max_pivots"));
}

#[test]
fn circulants_on_which_exchanges_can_cycle_end_solved() {
    for n in [3, 5, 7, 9, 31] {
        let (m, q) = circulant(n);
        for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
            // From every corner: block exchanges jump between sets here without end.
            for first in [vec![], vec![0], (0..n - 1).collect::<Vec<_>>()] {
                let options = LcpOptions { initial_active: Some(first), ..LcpOptions::default() };
                let solution = run_with(&m, &q, method, &options);
                assert_solves(&m, &q, &solution, 1e-12);
            }
        }
    }
}

#[test]
fn graded_p_matrices_are_solved_up_to_condition_1e14() {
    let mut noise = Noise(11);
    for exponent in [0, 4, 8, 12, 14] {
        for n in [5, 20, 60] {
            let m = graded_p_matrix(&mut noise, n, 10_f64.powi(exponent));
            let q: Vec<f64> = (0..n).map(|_| noise.value()).collect();
            for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
                let solution = run_with(&m, &q, method, &LcpOptions::default());
                println!("1e{exponent}, {n}, {method}: {:e}", solution.natural_residual);
                assert_eq!(solution.status, LcpStatus::Solved, "{}", solution.advice());
            }
        }
    }
}

// Crash basis

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
    let q = match noise.below(3) {
        0 => (0..n).map(|_| noise.value()).collect(),
        1 => (0..n).map(|_| noise.integer(2)).collect(),
        _ => vec![-1.0; n],
    };
    (m, q, kind)
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
        assert!(plain.attempts.iter().all(|attempt| !attempt.crash));
        assert!(crashed.attempts.iter().skip(1).all(|attempt| !attempt.crash));
        assert_eq!(crashed.pivots, crashed.attempts.iter().map(|attempt| attempt.pivots).sum::<usize>());
        if crashed.status == LcpStatus::Solved {
            assert_solves(&m, &q, &crashed, 1e-9);
        }
        let by_crash = crashed.attempts.len() == 1 && crashed.attempts[0].crash;
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
            assert!(crash.crash && path.pivots == plain.pivots);
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
    assert!(crashed.attempts[0].crash && !crashed.attempts[0].warm);
    // A budget below what the guess alone needs leaves all of it to the path.
    let tight = LcpOptions { max_pivots: Some(30), ..LcpOptions::default() };
    let tight = run_with(&contact.m, &contact.q, LcpMethodName::Lemke, &tight);
    assert_eq!((tight.status, tight.pivots), (LcpStatus::PivotLimit, 30));
    // The caller's own covering vector is what the path follows.
    let covering = LemkeOptions { covering: Some(vec![2.0; contact.q.len()]), ..LemkeOptions::default() };
    let covered = run_with(&contact.m, &contact.q, LcpMethod::Lemke(covering), &LcpOptions::default());
    assert!(covered.attempts.iter().all(|attempt| !attempt.crash));
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

// Contact

#[test]
fn a_flat_punch_where_every_row_ties_is_solved() {
    let contact = grid_contact(30, 0.8e-3, 10e-3, 1e-3);
    let q = vec![-1e-3; 900];
    let solution = run(&contact.m, &q);
    assert_solves(&contact.m, &q, &solution, 1e-12);
    assert_eq!(solution.active().len(), 900);
}

#[test]
fn spheres_on_a_grid_are_solved_to_rounding() {
    for (side, depth) in [(15, 0.5e-3), (30, 1.12e-3), (30, 2e-3)] {
        let contact = grid_contact(side, 0.8e-3, 10e-3, depth);
        let solution = run(&contact.m, &contact.q);
        assert_solves(&contact.m, &contact.q, &solution, 1e-12);
    }
}

#[test]
fn every_method_finds_the_same_forces() {
    for (side, radius) in [(15, 10e-3), (30, 200e-3)] {
        let contact = grid_contact(side, 0.8e-3, radius, 0.5e-3);
        let lemke = run(&contact.m, &contact.q);
        let largest = lemke.z.iter().copied().fold(0.0, f64::max);
        for method in [LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg, LcpMethodName::Auto] {
            let other = run_with(&contact.m, &contact.q, method, &LcpOptions::default());
            assert_solves(&contact.m, &contact.q, &other, 1e-10);
            for (a, b) in lemke.z.iter().zip(&other.z) {
                // The residual bound times the condition number, about 50.
                assert!((a - b).abs() < 1e-8 * largest, "{method}: {a} and {b}");
            }
        }
    }
}

#[test]
fn scaling_m_or_q_changes_no_active_set() {
    let contact = grid_contact(20, 0.8e-3, 10e-3, 1.12e-3);
    for method in
        [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg, LcpMethodName::Auto]
    {
        let plain = run_with(&contact.m, &contact.q, method, &LcpOptions::default());
        let scales =
            [(1e-9, 1.0), (1e6, 1.0), (1.0, 1e-6), (1e-9, 1e-6), (1e200, 1e-100), (3.0, 0.7), (0.3, 1.9)];
        for (m_scale, q_scale) in scales {
            let m = &contact.m * m_scale;
            let q: Vec<f64> = contact.q.iter().map(|q| q * q_scale).collect();
            let scaled = run_with(&m, &q, method, &LcpOptions::default());
            assert_eq!(
                scaled.status,
                LcpStatus::Solved,
                "{method}, {m_scale:e}, {q_scale:e}: {}",
                scaled.advice()
            );
            assert_eq!(scaled.active(), plain.active(), "{method}, {m_scale:e}, {q_scale:e}");
            let factor = q_scale / m_scale;
            for (a, b) in plain.z.iter().zip(&scaled.z) {
                assert!((a * factor - b).abs() <= 1e-8 * factor * a.abs().max(1e-6));
            }
        }
    }
}

#[test]
fn coincident_nodes_share_their_force() {
    // Every node twice: M is singular and semidefinite.
    let contact = grid_contact(9, 0.8e-3, 10e-3, 0.5e-3);
    let n = contact.q.len();
    let m = Mat::from_fn(2 * n, 2 * n, |i, j| contact.m[(i % n, j % n)]);
    let q = [contact.q.clone(), contact.q.clone()].concat();
    let single = run(&contact.m, &contact.q);
    for method in [LcpMethodName::Lemke, LcpMethodName::ProjectedCg, LcpMethodName::Auto] {
        let double = run_with(&m, &q, method, &LcpOptions::default());
        assert_solves(&m, &q, &double, 1e-10);
        assert!(!double.certificate.is_unique());
        for i in 0..n {
            assert!((double.z[i] + double.z[n + i] - single.z[i]).abs() < 1e-8);
        }
    }
}

#[test]
fn a_step_deeper_starts_from_the_last_contact() {
    let contact = grid_contact(30, 0.8e-3, 10e-3, 2e-3);
    let mut active = Vec::new();
    let mut pivots = 0;
    for step in 1..=50 {
        let back = 2e-3 * (1.0 - step as f64 / 50.0);
        let q: Vec<f64> = contact.q.iter().map(|q| q + back).collect();
        let options = LcpOptions { initial_active: Some(active), ..LcpOptions::default() };
        let solution = run_with(&contact.m, &q, LcpMethodName::Lemke, &options);
        assert_solves(&contact.m, &q, &solution, 1e-12);
        pivots += solution.pivots;
        active = solution.active();
    }
    let cold = run(&contact.m, &contact.q);
    assert_eq!(active, cold.active());
    assert!(2 * pivots <= 3 * cold.pivots, "{pivots} pivots warm, {} cold", cold.pivots);
}

#[test]
fn a_useless_guess_costs_nothing_but_time() {
    let contact = grid_contact(15, 0.8e-3, 10e-3, 0.5e-3);
    let cold = run(&contact.m, &contact.q);
    let far: Vec<usize> = (0..20).collect();
    let singular = mat![[0.0, 1.0], [-1.0, 0.0]];
    let options = |guess: Vec<usize>| LcpOptions { initial_active: Some(guess), ..LcpOptions::default() };
    for method in
        [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg, LcpMethodName::Auto]
    {
        let solution = run_with(&contact.m, &contact.q, method, &options(far.clone()));
        assert_solves(&contact.m, &contact.q, &solution, 1e-10);
        assert_eq!(solution.active(), cold.active());
    }
    for method in [LcpMethodName::Lemke, LcpMethodName::Auto] {
        let solution = run_with(&singular, &[-1.0, 2.0], method, &options(vec![0]));
        assert_eq!(solution.z, [2.0, 1.0]);
    }
}

#[test]
fn exchanges_from_a_guess_ask_for_no_p_matrix() {
    // The first two: determinant -3, solved by z = 1/3.
    let m = Mat::from_fn(20, 20, |i, j| match (i, j) {
        (0, 1) | (1, 0) => 2.0,
        _ => f64::from(u8::from(i == j)),
    });
    let options = LcpOptions { initial_active: Some((0..19).collect()), ..LcpOptions::default() };
    let solution = run_with(&m, &[-1.0; 20], LcpMethodName::Lemke, &options);
    assert_solves(&m, &[-1.0; 20], &solution, 1e-15);
    assert_eq!((solution.attempts.len(), solution.pivots), (1, 1));
}

#[test]
fn a_kernel_that_pulls_its_neighbours_in_ends_on_a_ray_or_is_flagged() {
    // The paper's Gaussian, K/r - a exp(-r²/2c²) within 15 mm: balanced, but not well posed on a wide patch.
    let (side, spacing) = (31, 1e-3);
    let table = grid_contact(side, spacing, 8e-3, 0.0);
    let at = |i: usize| ((i / side) as f64 * spacing, (i % side) as f64 * spacing);
    let m = Mat::from_fn(side * side, side * side, |i, j| {
        let ((a, b), (c, d)) = (at(i), at(j));
        let r = (a - c).hypot(b - d);
        let bulge = 0.805e-3 * (-r * r / (2.0 * 5e-3 * 5e-3)).exp();
        if r < 15e-3 { table.m[(i, j)] - bulge } else { 0.0 }
    });
    let press = |depth: f64| table.q.iter().map(|q| q - depth).collect::<Vec<_>>();
    let shallow = run(&m, &press(0.1e-3));
    assert_solves(&m, &press(0.1e-3), &shallow, 1e-10);
    let deep = run(&m, &press(1.5e-3));
    assert_eq!(deep.status, LcpStatus::Ray);
    let ray = deep.ray.as_ref().unwrap();
    assert_eq!(ray.conclusion, RayConclusion::NotCopositive);
    assert!(ray.curvature < 0.0 && ray.residual < 1e-10);
    assert!(deep.advice().contains("well-posed response"));
}

#[test]
fn an_indefinite_response_is_named_so() {
    let contact = grid_contact(8, 0.8e-3, 10e-3, 0.5e-3);
    let always = LcpOptions { definiteness: DefinitenessCheck::Always, ..LcpOptions::default() };
    let sound = run_with(&contact.m, &contact.q, LcpMethodName::Lemke, &always);
    assert_eq!(sound.certificate.definiteness, Definiteness::PositiveDefinite);
    assert!(sound.certificate.is_unique() && sound.advice().contains("only solution"));
    let never = LcpOptions { definiteness: DefinitenessCheck::Never, ..LcpOptions::default() };
    let silent = run_with(&contact.m, &contact.q, LcpMethodName::Lemke, &never);
    assert_eq!(silent.certificate.definiteness, Definiteness::Unknown);
    // A checkerboard that yields: -0.1 times its own energy.
    let n = contact.q.len();
    let diagonal = contact.m[(0, 0)];
    let sign = |i: usize| if (i / 8 + i % 8).is_multiple_of(2) { 1.0 } else { -1.0 };
    let m = Mat::from_fn(n, n, |i, j| contact.m[(i, j)] - 0.01 * diagonal * sign(i) * sign(j));
    let solution = run_with(&m, &contact.q, LcpMethodName::Lemke, &always);
    assert_eq!(solution.certificate.definiteness, Definiteness::NotPositiveDefinite);
    let known = LcpProblem::new(contact.m.as_ref(), &contact.q).unwrap().with_known_p_matrix();
    let solution = solve(&known, &LcpMethodName::Auto.into(), &LcpOptions::default()).unwrap();
    assert!(solution.certificate.known_p_matrix && solution.certificate.is_unique());
    assert_eq!(solution.method, LcpMethodName::BlockPivoting);
}

#[test]
fn an_exactly_singular_matrix_has_no_only_solution() {
    // B B' with determinant 0; what Cholesky leaves last is rounding above zero. With `z`, `z + t null` solves too.
    let m = mat![[106.0, 90.0, -76.0], [90.0, 106.0, -92.0], [-76.0, -92.0, 80.0]];
    let q = [-210.0, -98.0, 76.0];
    for scale in [1.0, 1e-9, 0.3, 1e12] {
        let m = &m * scale;
        for check in [DefinitenessCheck::Always, DefinitenessCheck::Cheap] {
            let options = LcpOptions { definiteness: check, ..LcpOptions::default() };
            let solution = run_with(&m, &q, LcpMethodName::Lemke, &options);
            assert_eq!(solution.certificate.definiteness, Definiteness::Unknown, "{scale:e}");
            assert!(!solution.advice().contains("only solution"));
        }
    }
}

#[test]
fn definiteness_is_looked_at_where_asked_though_zero_solves() {
    let always = LcpOptions { definiteness: DefinitenessCheck::Always, ..LcpOptions::default() };
    let verdict = |m: &Mat<f64>, options: &LcpOptions| {
        run_with(m, &[1.0, 0.0], LcpMethodName::Lemke, options).certificate.definiteness
    };
    // -1 beside 2 pulls w below zero, so both rows count.
    let definite = mat![[2.0, -1.0], [-1.0, 2.0]];
    assert_eq!(verdict(&definite, &always), Definiteness::PositiveDefinite);
    assert_eq!(verdict(&definite, &LcpOptions::default()), Definiteness::Unknown);
    // z = (0, 1/2) solves as well as zero does: q = (1, 0).
    let singular = mat![[1.0, -2.0], [-2.0, 0.0]];
    assert_eq!(verdict(&singular, &always), Definiteness::NotPositiveDefinite);
}

#[test]
fn storage_order_changes_nothing() {
    let contact = grid_contact(25, 0.8e-3, 60e-3, 0.5e-3);
    let n = contact.q.len();
    // Not symmetric, so that a mixed-up order would show.
    let m = Mat::from_fn(n, n, |i, j| contact.m[(i, j)] * (1.0 + 0.01 * (i as f64 / n as f64)));
    let rows = m.transpose().to_owned();
    for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
        let by_columns = run_with(&m, &contact.q, method, &LcpOptions::default());
        assert_solves(&m, &contact.q, &by_columns, 1e-12);
        let problem = LcpProblem::new(rows.transpose(), &contact.q).unwrap();
        let by_rows = solve(&problem, &method.into(), &LcpOptions::default()).unwrap();
        assert_eq!(by_rows.active(), by_columns.active());
        for (a, b) in by_rows.z.iter().zip(&by_columns.z) {
            assert!((a - b).abs() < 1e-11);
        }
        let again = run_with(&m, &contact.q, method, &LcpOptions::default());
        assert_eq!(again, by_columns, "a second run is equal to the bit");
    }
}

#[test]
fn results_are_equal_to_the_bit_for_any_number_of_threads() {
    let contact = grid_contact(30, 0.8e-3, 200e-3, 0.5e-3);
    for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg] {
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| run_with(&contact.m, &contact.q, method, &LcpOptions::default()))
        });
        assert_eq!(one, three, "{method}");
    }
}

// Definiteness

fn definiteness(m: &Mat<f64>) -> Definiteness {
    spectrum(m.as_ref()).definiteness
}

/// `B B'` of small integers: exact, and singular as B has fewer columns than rows.
fn singular(n: usize, rank: usize, seed: u64) -> Mat<f64> {
    let mut noise = Noise(seed);
    let b = Mat::from_fn(n, rank, |_, _| noise.integer(9));
    &b * b.transpose()
}

#[test]
fn exactly_singular_matrices_are_never_called_definite_nor_indefinite() {
    for seed in 0..400 {
        let n = 2 + seed as usize % 40;
        let m = singular(n, n - 1, seed);
        if (0..n).all(|i| m[(i, i)] > 0.0) {
            assert_eq!(definiteness(&m), Definiteness::Unknown, "seed {seed}");
        }
    }
}

#[test]
fn a_shift_beyond_rounding_either_way_is_told_at_every_scale() {
    for scale in [1.0, 3e-9, 7e12] {
        for (shift, expected) in
            [(1e-9, Definiteness::PositiveDefinite), (-1e-9, Definiteness::NotPositiveDefinite)]
        {
            for n in [3, 30, 300] {
                let m = singular(n, n - 1, 5);
                let mean = (0..n).map(|i| m[(i, i)]).sum::<f64>() / n as f64;
                let m = (m + Mat::<f64>::identity(n, n) * (shift * mean)) * scale;
                assert_eq!(definiteness(&m), expected, "{n}, {scale:e}");
            }
        }
    }
}

#[test]
fn a_diagonal_that_is_not_positive_tells_at_once() {
    assert_eq!(definiteness(&Mat::zeros(2, 2)), Definiteness::NotPositiveDefinite);
    assert!(spectrum(Mat::<f64>::zeros(0, 0).as_ref()).is_positive_definite());
}

#[test]
fn a_two_by_two_has_its_hand_made_eigenvalues() {
    // symmetric part [2 1; 1 2]: 1 and 3
    let m = Mat::from_fn(2, 2, |i, j| [[2.0, 0.5], [1.5, 2.0]][i][j]);
    let d = spectrum(m.as_ref());
    assert!(d.is_positive_definite() && !d.estimated);
    assert!((d.smallest - 1.0).abs() < 1e-14 && (d.largest - 3.0).abs() < 1e-14);
    assert!((d.condition - 3.0).abs() < 1e-13);
    let indefinite = spectrum(mat![[1.0, 2.0], [2.0, 1.0]].as_ref());
    assert_eq!(indefinite.definiteness, Definiteness::NotPositiveDefinite);
    assert!(indefinite.condition == f64::INFINITY && (indefinite.smallest + 1.0).abs() < 1e-14);
}

#[test]
fn estimates_of_large_matrices_match_their_known_spectrum() {
    // second differences: 2 - 2 cos(k π / (n + 1)); plus a shift
    let n = 400;
    for shift in [0.01, -0.5] {
        let m = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0 + shift,
            1 => -1.0,
            _ => 0.0,
        });
        let d = spectrum(m.as_ref());
        let exact = |k: f64| 2.0 - 2.0 * (k * std::f64::consts::PI / (n as f64 + 1.0)).cos() + shift;
        assert!(d.estimated);
        assert_eq!(d.is_positive_definite(), shift > 0.0);
        assert!((d.largest / exact(n as f64) - 1.0).abs() < 1e-2);
        let error = (d.smallest - exact(1.0)).abs();
        // the inverse makes the smallest one sharp; without it Lanczos comes from above
        assert!(error < if shift > 0.0 { 1e-6 } else { 1e-2 }, "{error:e}");
    }
}

#[test]
fn a_singular_matrix_has_no_finite_condition() {
    // B B' of integers with determinant 0, whose last pivot is rounding above zero.
    let three = mat![[106.0, 90.0, -76.0], [90.0, 106.0, -92.0], [-76.0, -92.0, 80.0]];
    // Every node twice, beyond the order whose eigenvalues are all computed.
    let twice = Mat::from_fn(300, 300, |i, j| 0.7_f64.powi((i / 2).abs_diff(j / 2) as i32));
    for m in [&three, &(&three * 1e-9), &(&three * 0.3), &twice] {
        let d = spectrum(m.as_ref());
        assert!(!d.is_positive_definite() && d.condition == f64::INFINITY, "{d:?}");
    }
}

// Endings

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
    assert!(solution.natural_residual > 1e-30 && solution.advice().contains("tolerance"));
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
                assert!(solution.natural_residual <= 1e-10);
            }
        }
    }
}

// Malformed questions

#[test]
fn malformed_problems_are_named() {
    let m = mat![[1.0, 0.0, 2.0], [0.0, 1.0, 2.0]];
    let error = LcpProblem::new(m.as_ref(), &[1.0, 1.0]).unwrap_err();
    assert_eq!(error, LcpError::NotSquare { rows: 2, columns: 3 });
    let m = mat![[1.0, 0.0], [0.0, 1.0]];
    let error = LcpProblem::new(m.as_ref(), &[1.0]).unwrap_err();
    assert_eq!(error, LcpError::LengthMismatch { name: "q", found: 1, expected: 2 });
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = LcpProblem::new(m.as_ref(), &[1.0, bad]).unwrap_err();
        assert!(matches!(error, LcpError::NonFiniteVector { name: "q", index: 1, count: 1, .. }));
        for n in [1, 3, 16, 17, 40, 600] {
            let at = (n / 2, n - 1);
            let sound = |i, j| if i == j { 1.0 } else { 0.0 };
            let m = Mat::from_fn(n, n, |i, j| if (i, j) == at { bad } else { sound(i, j) });
            for (view, at) in [(m.as_ref(), at), (m.transpose(), (at.1, at.0))] {
                // With q < 0 every unknown is above zero, and every column is read.
                let pressed = vec![-1.0; n];
                let problem = LcpProblem::new(view, &pressed).unwrap();
                let error =
                    solve(&problem, &LcpMethodName::Lemke.into(), &LcpOptions::default()).unwrap_err();
                let LcpError::NonFiniteMatrix { row, column, count: 1, .. } = error else {
                    panic!("{error}")
                };
                assert_eq!((row, column), at);
                // With q >= 0 nothing of M is needed, and a large one is not read.
                let apart = vec![1.0; n];
                let problem = LcpProblem::new(view, &apart).unwrap();
                let unread = solve(&problem, &LcpMethodName::Lemke.into(), &LcpOptions::default());
                assert_eq!(unread.is_ok(), n > 64, "{n}");
            }
        }
    }
}

#[test]
fn entries_that_an_answer_needs_are_finite_or_named() {
    let contact = grid_contact(12, 0.8e-3, 10e-3, 0.5e-3);
    let n = contact.q.len();
    let sound = run(&contact.m, &contact.q);
    let touching = sound.active()[3];
    let far = (0..n).find(|&i| contact.q[i] > 0.0).unwrap();
    for method in
        [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::ProjectedCg, LcpMethodName::Auto]
    {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for (row, column) in
                [(far, touching), (touching, touching), (touching, sound.active()[0]), (far, far)]
            {
                let mut m = contact.m.clone();
                m[(row, column)] = bad;
                for view in [m.as_ref(), m.transpose()] {
                    let problem = LcpProblem::new(view, &contact.q).unwrap();
                    match solve(&problem, &method.into(), &LcpOptions::default()) {
                        Err(LcpError::NonFiniteMatrix { row: r, column: c, count: 1, .. }) => {
                            assert!((r, c) == (row, column) || (c, r) == (row, column));
                        }
                        // Turned, it stands in a column that no answer needs.
                        Ok(solution) => {
                            assert!(view[(far, touching)].is_finite() && row == far && column == touching);
                            assert_eq!(solution.active(), sound.active(), "{method}");
                        }
                        Err(error) => panic!("{method}: {error}"),
                    }
                }
            }
        }
        // A column that cannot touch is not read unless a method looks at all of M.
        let mut m = contact.m.clone();
        m[(touching, far)] = f64::NAN;
        let problem = LcpProblem::new(m.as_ref(), &contact.q).unwrap();
        match solve(&problem, &method.into(), &LcpOptions::default()) {
            Ok(solution) => assert_eq!(solution.active(), sound.active(), "{method}"),
            Err(error) => assert!(method == LcpMethodName::ProjectedCg, "{method}: {error}"),
        }
    }
}

#[test]
fn a_look_at_definiteness_that_nobody_asked_for_refuses_no_answer() {
    // Not symmetric, so that blocks cost enough for the look; the entry amiss stands where nothing touches.
    let contact = grid_contact(10, 0.8e-3, 10e-3, 0.5e-3);
    let n = contact.q.len();
    let mut m = Mat::from_fn(n, n, |i, j| contact.m[(i, j)] * (1.0 + 0.001 * (i as f64 / n as f64)));
    let far = (1..n).find(|&i| contact.q[i] > 0.0).unwrap();
    m[(0, far)] = f64::NAN;
    let with = |definiteness| {
        let problem = LcpProblem::new(m.as_ref(), &contact.q).unwrap();
        let options = LcpOptions { definiteness, ..LcpOptions::default() };
        solve(&problem, &LcpMethodName::Auto.into(), &options)
    };
    assert_eq!(with(DefinitenessCheck::Cheap).unwrap().status, LcpStatus::Solved);
    assert_eq!(with(DefinitenessCheck::Never).unwrap().status, LcpStatus::Solved);
    let error = with(DefinitenessCheck::Always).unwrap_err();
    assert!(matches!(error, LcpError::NonFiniteMatrix { row: 0, .. }), "{error}");
}

#[test]
fn matrices_full_of_what_is_not_finite_end_without_panic() {
    let mut noise = Noise(19);
    for case in 0..600 {
        let n = 1 + noise.below(90);
        let share = 1 + noise.below(40);
        let m = Mat::from_fn(n, n, |i, j| match noise.below(share) {
            0 => [f64::NAN, f64::INFINITY, f64::NEG_INFINITY][noise.below(3)],
            _ => noise.value() + if i == j { n as f64 } else { 0.0 },
        });
        let q: Vec<f64> = (0..n).map(|_| noise.value()).collect();
        let method = LcpMethodName::ALL[case % 4];
        let problem = LcpProblem::new(m.as_ref(), &q).unwrap();
        if let Ok(solution) = solve(&problem, &method.into(), &LcpOptions::default()) {
            // Only what the answer does not depend on may be amiss.
            assert_eq!(solution.status, LcpStatus::Solved);
            for j in solution.active() {
                assert!((0..n).all(|i| m[(i, j)].is_finite()));
            }
        }
    }
}

#[test]
fn malformed_options_are_named() {
    let m = mat![[2.0, 1.0], [0.0, 2.0]];
    let problem = LcpProblem::new(m.as_ref(), &[-1.0, -1.0]).unwrap();
    let solve = |method: LcpMethod, options: LcpOptions| solve(&problem, &method, &options).unwrap_err();
    let default = LcpOptions::default;
    let fail = |options: LemkeOptions| {
        let block_pivoting = BlockPivotingOptions { lemke: options.clone(), ..Default::default() };
        let auto = AutoOptions { block_pivoting: block_pivoting.clone(), ..Default::default() };
        let error = solve(LcpMethod::Lemke(options), default());
        for method in [LcpMethod::BlockPivoting(block_pivoting), LcpMethod::Auto(auto)] {
            assert_eq!(solve(method, default()).to_string(), error.to_string());
        }
        error
    };
    let error = fail(LemkeOptions { covering: Some(vec![1.0, 0.0]), ..Default::default() });
    assert_eq!(error, LcpError::CoveringNotPositive { index: 1, value: 0.0 });
    let error = fail(LemkeOptions { covering: Some(vec![1.0]), ..Default::default() });
    assert_eq!(error, LcpError::LengthMismatch { name: "covering", found: 1, expected: 2 });
    for pivot_tol in [0.0, f64::NAN] {
        let error = fail(LemkeOptions { pivot_tol, ..Default::default() });
        assert!(matches!(error, LcpError::OptionOutOfRange { name: "pivot_tol", .. }), "{error}");
    }
    for (guess, position, index) in [(vec![0, 2], 1, 2), (vec![1, 1], 1, 1)] {
        let options = LcpOptions { initial_active: Some(guess), ..default() };
        let error = solve(LcpMethod::default(), options);
        assert_eq!(error, LcpError::InitialActive { position, index, size: 2 });
    }
    let error = solve(LcpMethod::default(), LcpOptions { tolerance: f64::INFINITY, ..default() });
    assert!(matches!(error, LcpError::OptionOutOfRange { name: "tolerance", .. }), "{error}");
    let error = solve(LcpMethodName::ProjectedCg.into(), default());
    assert_eq!(error, LcpError::NotSymmetric { row: 0, column: 1, difference: 0.5 });
}

#[test]
fn gradients_do_not_solve_what_has_no_solution() {
    // w_0 + w_1 = q_0 + q_1 < 0 whatever z is.
    let m = mat![[9.0, -9.0], [-9.0, 9.0]];
    let q = [-0.7856967730984913, -0.030340764541183937];
    for method in LcpMethodName::ALL {
        let solution = run_with(&m, &q, method, &LcpOptions::default());
        assert_ne!(solution.status, LcpStatus::Solved, "{method:?}: {solution:?}");
    }
}

#[test]
fn an_answer_beyond_all_numbers_is_a_breakdown_at_finite_values() {
    for (entry, q) in [(1e-150, -1e200), (1e-300, -1e10), (f64::MIN_POSITIVE, -1.0)] {
        for method in LcpMethodName::ALL {
            let solution = run_with(&mat![[entry]], &[q], method, &LcpOptions::default());
            let representable = (-q / entry).is_finite();
            assert_eq!(solution.status == LcpStatus::Solved, representable, "{method:?}: {solution:?}");
            assert!(solution.z[0].is_finite() && solution.w[0].is_finite());
        }
    }
}

#[test]
fn what_is_zero_to_rounding_is_no_active_unknown() {
    // z = 1 on the first half solves; the others touch without force, so that rounding alone would press them.
    let n = 24;
    for seed in 0..20 {
        let mut noise = Noise(seed);
        let factor = Mat::from_fn(n, n, |_, _| noise.value());
        let m = &factor * factor.transpose() + Mat::<f64>::identity(n, n);
        let q: Vec<f64> = (0..n).map(|i| -(0..n / 2).map(|j| m[(i, j)]).sum::<f64>()).collect();
        for scale in [1.0, 3.0] {
            let scaled = Mat::from_fn(n, n, |i, j| scale * m[(i, j)]);
            for method in LcpMethodName::ALL {
                let solution = run_with(&scaled, &q, method, &LcpOptions::default());
                assert_eq!(solution.status, LcpStatus::Solved, "{method:?} {seed}");
                // Gradients stop at the tolerance, far from rounding.
                if method != LcpMethodName::ProjectedCg {
                    assert_eq!(solution.active(), (0..n / 2).collect::<Vec<_>>(), "{method:?} {seed}");
                }
            }
        }
    }
}

#[test]
fn gradients_within_the_tolerance_are_solved_whatever_stopped_them() {
    // They aim at a tenth of the tolerance; conditions of 1e4 to 1e8 leave them between.
    let n = 12;
    for seed in 0..100 {
        let mut noise = Noise(seed);
        let factor = Mat::from_fn(n, n, |_, j| noise.value() * 10f64.powf(-(j as f64) / 3.0));
        let m = &factor * factor.transpose();
        let q: Vec<f64> = (0..n).map(|_| noise.value() - 0.5).collect();
        let solution = run_with(&m, &q, LcpMethodName::ProjectedCg, &LcpOptions::default());
        let passed = solution.natural_residual <= LcpOptions::default().tolerance;
        assert_eq!(solution.status == LcpStatus::Solved, passed, "{seed}: {solution:?}");
    }
}
