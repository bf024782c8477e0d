//! Problems whose answers are known by hand.

use faer::{Mat, mat};
use quasirigid::lcp::{LcpMethodName, LcpOptions, LcpStatus, RayConclusion};

use crate::{assert_solves, run, run_with};

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
        if method == LcpMethodName::Auto {
            assert!(solution.attempts.len() > 1, "a ray to rounding is no end for auto");
        }
        // Without u the columns add to zero exactly, and there is none.
        let none = run_with(&mat![[1.0, -1.0], [-1.0, 1.0]], &[-1.0, -1.0], method, &LcpOptions::default());
        assert_eq!(none.ray.expect("a ray").conclusion, RayConclusion::Infeasible);
    }
}

#[test]
fn a_tiny_diagonal_hides_no_unknown_that_carries_other_rows() {
    let (pair, turned) = (mat![[1e-12, -1.0], [1.0, 1e-15]], mat![[1e-15, 1.0], [-1.0, 1.0]]);
    let three = mat![[0.0, 0.0, 2.0], [2.0, 1.03e-11, -2.0], [1.0, 1.0, 1.3e-14]];
    for method in [LcpMethodName::BlockPivoting, LcpMethodName::Lemke, LcpMethodName::Auto] {
        for (m, q, z) in [
            (&pair, &[1.0, -3.0][..], &[3.0, 1.0][..]),
            (&turned, &[-1.0, 1e-3], &[1.001, 1.0]),
            (&three, &[3.0, 1.0, -3.0], &[0.0, 3.0, 0.5]),
        ] {
            let solution = run_with(m, q, method, &LcpOptions::default());
            assert_eq!(solution.status, LcpStatus::Solved, "{method} {m:?}: {}", solution.advice());
            for (found, z) in solution.z.iter().zip(z) {
                assert!((found - z).abs() < 1e-10, "{method} {m:?}: {:?}", solution.z);
            }
        }
    }
    // Both rows hold at (2, -1); without what is below zero w is (1, 1).
    let pair = mat![[1e-12, 1.0], [1.0, 1.0]];
    let options =
        LcpOptions { initial_active: Some(vec![0, 1]), max_pivots: Some(0), ..LcpOptions::default() };
    let solution = run_with(&pair, &[1.0, -1.0], LcpMethodName::BlockPivoting, &options);
    assert_ne!(solution.status, LcpStatus::Solved, "{:?}", solution.z);
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
