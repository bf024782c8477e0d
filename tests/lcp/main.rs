//! The linear complementarity solvers through the public API.

mod contact;
mod crash;
mod definiteness;
mod endings;
mod known_answers;
mod literature;
#[path = "../common/lcp_problems.rs"]
mod problems;
mod refusals;
mod twins;

use faer::Mat;
use quasirigid::lcp::{
    LcpMethod, LcpMethodName, LcpOptions, LcpProblem, LcpSolution, LcpStatus, LemkeOptions, solve,
};

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
