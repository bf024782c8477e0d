//! Hard cases of the literature.

use quasirigid::lcp::{LcpMethodName, LcpOptions, LcpStatus};

use crate::problems::{Noise, circulant, exponential_examples, graded_p_matrix};
use crate::{assert_solves, run_with};

#[test]
fn exponential_examples_end_solved_by_every_method() {
    for n in [1, 2, 5, 10, 15, 20] {
        for (_, m, q) in exponential_examples(n) {
            for method in [LcpMethodName::Lemke, LcpMethodName::BlockPivoting, LcpMethodName::Auto] {
                let solution = run_with(&m, &q, method, &LcpOptions::default());
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
                assert_eq!(solution.status, LcpStatus::Solved, "{}", solution.advice());
            }
        }
    }
}
