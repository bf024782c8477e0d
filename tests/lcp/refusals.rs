//! Malformed questions are refused.

use faer::{Mat, mat};
use quasirigid::lcp::{
    DefinitenessCheck, LcpError, LcpMethod, LcpMethodName, LcpOptions, LcpProblem, LcpStatus, LemkeOptions,
    solve,
};

use crate::problems::{Noise, grid_contact};
use crate::{run, run_with};

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
        let error = solve(LcpMethod::Lemke(options.clone()), default());
        for method in [LcpMethod::BlockPivoting, LcpMethod::Auto] {
            assert_eq!(solve(method(options.clone()), default()).to_string(), error.to_string());
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
        let passed = solution.certificate.natural_residual <= LcpOptions::default().tolerance;
        assert_eq!(solution.status == LcpStatus::Solved, passed, "{seed}: {solution:?}");
    }
}
