//! Random complementarity problems: what is called solved is solved, and every method that solves a problem with one
//! solution finds it. `PROPTEST_CASES` says how many (`make fuzz`).

use faer::Mat;
use proptest::prelude::*;
use quasirigid::lcp::{LcpMethod, LcpMethodName, LcpOptions, LcpProblem, LcpSolution, LcpStatus, solve};

/// Largest natural residual of an answer that is called solved.
const LARGEST_RESIDUAL: f64 = 1e-8;

fn run(m: &Mat<f64>, q: &[f64], method: LcpMethodName) -> Option<LcpSolution> {
    let problem = LcpProblem::new(m.as_ref(), q).ok()?;
    solve(&problem, &LcpMethod::from(method), &LcpOptions::default()).ok()
}

/// Sum and its rounding by compensated products (Dekker 1971, Knuth 1969).
fn exact_dot(row: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut tail) = (0.0_f64, 0.0_f64);
    for (a, b) in row {
        let product = a * b;
        let error = a.mul_add(b, -product);
        let next = sum + product;
        let back = next - sum;
        tail += (sum - (next - back)) + (product - back) + error;
        sum = next;
    }
    sum + tail
}

/// `max |min(M_ii z_i, w_i)| / max(-q)`, computed apart from the crate.
fn natural_residual(m: &Mat<f64>, q: &[f64], z: &[f64]) -> f64 {
    let delta = q.iter().fold(0.0_f64, |delta, q| delta.max(-q));
    let row = |i: usize| {
        let largest = (0..q.len()).map(|j| m[(i, j)].abs()).fold(0.0, f64::max);
        let scale = if m[(i, i)] > 0.0 { m[(i, i)] } else { largest };
        let w = exact_dot((0..q.len()).map(|j| (m[(i, j)], z[j])).chain([(q[i], 1.0)]));
        (scale * z[i]).min(w).abs()
    };
    let worst = (0..q.len()).map(row).fold(0.0, f64::max);
    if delta > 0.0 { worst / delta } else { z.iter().copied().fold(0.0, f64::max) }
}

fn check(m: &Mat<f64>, q: &[f64], solution: &LcpSolution) -> Result<(), TestCaseError> {
    prop_assert!(solution.z.iter().all(|&z| z >= 0.0 && z.is_finite()));
    prop_assert!(solution.status != LcpStatus::Interrupted);
    if solution.status == LcpStatus::Solved {
        let found = natural_residual(m, q, &solution.z);
        prop_assert!(found <= LARGEST_RESIDUAL, "{found:e} by {:?}", solution.method);
    }
    Ok(())
}

fn square(n: usize, entry: impl Strategy<Value = f64>) -> impl Strategy<Value = (Mat<f64>, Vec<f64>)> {
    prop::collection::vec(entry, n * (n + 1))
        .prop_map(move |entries| (Mat::from_fn(n, n, |i, j| entries[i * n + j]), entries[n * n..].to_vec()))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn small_whole_numbers_with_their_ties(
        (m, q) in (1..9_usize).prop_flat_map(|n| square(n, (-3..4_i32).prop_map(f64::from))),
    ) {
        for method in LcpMethodName::ALL {
            if let Some(solution) = run(&m, &q, method) {
                check(&m, &q, &solution)?;
            }
        }
    }

    #[test]
    fn real_numbers_of_all_sizes(
        (m, q) in (1..12_usize).prop_flat_map(|n| {
            square(n, (-1.0..1.0_f64, -12..13_i32).prop_map(|(value, power)| value * 10f64.powi(power)))
        }),
    ) {
        for method in LcpMethodName::ALL {
            if let Some(solution) = run(&m, &q, method) {
                check(&m, &q, &solution)?;
            }
        }
    }

    #[test]
    fn definite_matrices_are_solved_by_every_method_alike(
        (rows, q) in (1..40_usize).prop_flat_map(|n| square(n, -1.0..1.0_f64)),
        power in -9..10_i32,
    ) {
        let n = q.len();
        let shifted = &rows * rows.transpose() + Mat::<f64>::identity(n, n);
        let m = Mat::from_fn(n, n, |i, j| shifted[(i, j)] * 10f64.powi(power));
        let expected = run(&m, &q, LcpMethodName::Lemke).expect("a sound problem");
        for method in LcpMethodName::ALL {
            let solution = run(&m, &q, method).expect("a sound problem");
            prop_assert_eq!(solution.status, LcpStatus::Solved);
            check(&m, &q, &solution)?;
            // The condition is below 40² / 3 + 1, and so is what an error of the residual costs.
            let largest = expected.z.iter().copied().fold(0.0, f64::max);
            for (one, other) in solution.z.iter().zip(&expected.z) {
                prop_assert!((one - other).abs() <= 1e-6 * largest, "{:?}: {} is not {}", method, one, other);
            }
        }
    }
}
