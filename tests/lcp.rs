//! The linear complementarity solvers through the public API.

#[path = "common/lcp_problems.rs"]
mod problems;

use faer::{Mat, mat};
use problems::{
    Noise, P_MATRICES, RAY_MEANS_INFEASIBLE, circulant, exponential_examples, graded_p_matrix, grid_contact,
    small_problem,
};
use quasirigid::lcp::{
    LcpError, LcpMethod, LcpOptions, LcpProblem, LcpSolution, LcpStatus, RayConclusion, solve,
};

fn run(m: &Mat<f64>, q: &[f64]) -> LcpSolution {
    run_with(m, q, LcpMethod::Lemke, &LcpOptions::default())
}

fn run_with(m: &Mat<f64>, q: &[f64], method: LcpMethod, options: &LcpOptions) -> LcpSolution {
    let problem = LcpProblem::new(m.as_ref(), q).unwrap();
    solve(&problem, method, options).unwrap()
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

fn agree_with_enumeration(method: LcpMethod, cases: usize, seed: u64, largest: usize) {
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
    for method in [LcpMethod::Lemke, LcpMethod::Auto] {
        agree_with_enumeration(method, 4000, 1, 8);
    }
}

#[test]
#[ignore = "takes minutes; the short version always runs"]
fn a_hundred_thousand_small_problems_agree_with_enumeration() {
    for method in [LcpMethod::Lemke, LcpMethod::Auto] {
        agree_with_enumeration(method, 100_000, 2, 10);
    }
}

#[test]
fn block_pivoting_and_lemke_find_the_one_solution_of_a_p_matrix() {
    let mut noise = Noise(5);
    for _ in 0..3000 {
        let (m, q, kind) = small_problem(&mut noise, 9);
        if P_MATRICES.contains(&kind) {
            let pivoting = run_with(&m, &q, LcpMethod::BlockPivoting, &LcpOptions::default());
            assert_solves(&m, &q, &pivoting, 1e-10);
            let lemke = run(&m, &q);
            for (a, b) in lemke.z.iter().zip(&pivoting.z) {
                assert!((a - b).abs() <= 1e-9 * (1.0 + a.abs()), "{kind}: {a} and {b} for {m:?} {q:?}");
            }
        }
    }
}

// Hard cases of the literature

#[test]
fn exponential_examples_end_solved_by_every_method() {
    for n in [1, 2, 5, 10, 15, 20] {
        for (name, m, q) in exponential_examples(n) {
            for method in [LcpMethod::Lemke, LcpMethod::BlockPivoting, LcpMethod::Auto] {
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
    let solution = run_with(&m, &q, LcpMethod::Lemke, &options);
    assert_eq!((solution.status, solution.pivots), (LcpStatus::PivotLimit, 100));
    assert!(solution.advice().contains("max_pivots"));
}

#[test]
fn circulants_on_which_exchanges_can_cycle_end_solved() {
    for n in [3, 5, 7, 9, 31] {
        let (m, q) = circulant(n);
        for method in [LcpMethod::Lemke, LcpMethod::BlockPivoting, LcpMethod::Auto] {
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
            for method in [LcpMethod::Lemke, LcpMethod::Auto] {
                let solution = run_with(&m, &q, method, &LcpOptions::default());
                println!("1e{exponent}, {n}, {method}: {:e}", solution.natural_residual);
                assert_eq!(solution.status, LcpStatus::Solved, "{}", solution.advice());
            }
        }
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

// Endings

#[test]
fn malformed_problems_are_named() {
    let m = mat![[1.0, 0.0], [0.0, f64::NAN]];
    let error = LcpProblem::new(m.as_ref(), &[1.0, 1.0]).unwrap_err();
    assert!(matches!(error, LcpError::NonFiniteMatrix { row: 1, column: 1, count: 1, .. }));
}
