//! Problems as contact poses them.

use faer::{Mat, mat};
use quasirigid::lcp::{
    Definiteness, DefinitenessCheck, LcpMethodName, LcpOptions, LcpProblem, LcpStatus, RayConclusion, solve,
};

use crate::problems::grid_contact;
use crate::{assert_solves, run, run_with};

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
    assert!(deep.advice().contains("not copositive"));
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
