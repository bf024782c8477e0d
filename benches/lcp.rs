//! LCP solvers on a sphere pressed into a square grid of an elastic half-space (0.8 mm, G = 60 kPa, ν = 0.5).

#[path = "../tests/common/lcp_problems.rs"]
mod problems;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use problems::{GridContact, grid_contact};
use quasirigid::lcp::{LcpMethodName, LcpOptions, LcpProblem, LcpStatus, solve};

/// Nodes along a side; N = 225, 900, 2500, 5041.
const SIDES: [usize; 4] = [15, 30, 50, 71];

fn bench(criterion: &mut Criterion, name: &str, contact: &GridContact) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10);
    let n = contact.q.len();
    for method in LcpMethodName::ALL {
        group.bench_with_input(BenchmarkId::new(method.as_str(), n), contact, |bencher, contact| {
            bencher.iter(|| {
                let problem = LcpProblem::new(contact.m.as_ref(), &contact.q).expect("a valid problem");
                let solution =
                    solve(&problem, &method.into(), &LcpOptions::default()).expect("valid options");
                assert_eq!(solution.status, LcpStatus::Solved);
                solution.certificate.natural_residual
            });
        });
    }
    group.finish();
}

/// R = 10 mm at three depths: 25, 52 and 96 contact nodes.
fn fingertip(criterion: &mut Criterion) {
    for side in SIDES {
        for (name, depth) in [("0.5 mm", 0.5e-3), ("1.12 mm", 1.12e-3), ("2 mm", 2e-3)] {
            bench(criterion, &format!("sphere 10 mm, {name}"), &grid_contact(side, 0.8e-3, 10e-3, depth));
        }
    }
}

/// R = 200 mm at 0.5 mm: about 500 contact nodes.
fn palm(criterion: &mut Criterion) {
    for side in [30, 50] {
        bench(criterion, "sphere 200 mm, 0.5 mm", &grid_contact(side, 0.8e-3, 200e-3, 0.5e-3));
    }
}

criterion_group!(benches, fingertip, palm);
criterion_main!(benches);
