"""The complementarity solver by itself."""

from __future__ import annotations

import pickle
import re
from dataclasses import FrozenInstanceError
from typing import Any, Literal

import numpy as np
import pytest
import quasirigid as qr
import shapes


def random_problem(size: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positive definite M and a q built from a chosen z."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size))
    matrix = root @ root.T + rng.normal(size=(size, size)) * 0.1 + size * np.eye(size)
    z = np.where(rng.random(size) < 0.5, rng.random(size), 0.0)
    w = np.where(z == 0.0, rng.random(size), 0.0)
    return matrix, w - matrix @ z, z


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("size", [1, 2, 3, 40])
def test_a_chosen_solution_is_found_in_either_memory_order(order: str, size: int) -> None:
    matrix, q, z = random_problem(size, size)
    solution = qr.solve_lcp(np.array(matrix, order=order), q)  # type: ignore[call-overload]
    assert solution.status is qr.LcpStatus.SOLVED
    np.testing.assert_allclose(solution.z, z, atol=1e-12)
    np.testing.assert_allclose(solution.w, matrix @ solution.z + q, atol=1e-11)
    assert solution.natural_residual <= 1e-10
    assert solution.certificate.natural_residual == solution.natural_residual


def test_a_strided_or_integer_matrix_is_read_all_the_same() -> None:
    matrix = np.zeros((4, 4))
    matrix[::2, ::2] = [[2, 1], [1, 2]]
    for view in (matrix[::2, ::2], [[2, 1], [1, 2]]):
        np.testing.assert_allclose(qr.solve_lcp(view, [-5, -6]).z, [4 / 3, 7 / 3])


def misaligned(values: np.ndarray) -> np.ndarray:
    """The same numbers one byte beside where float64 belongs."""
    room = np.zeros(values.nbytes + 1, np.uint8)
    view = room[1:].view(values.dtype).reshape(values.shape)
    view[...] = values
    assert not view.flags.aligned
    return view


def test_what_lies_beside_the_machine_s_words_is_copied() -> None:
    matrix, q, z = random_problem(9, 4)
    for given in (misaligned(matrix), misaligned(matrix.T.copy()).T):
        np.testing.assert_allclose(qr.solve_lcp(given, misaligned(q)).z, z, atol=1e-12)
    with pytest.raises(ValueError, match=r"`M` has shape"):
        qr.solve_lcp(misaligned(q), misaligned(q))
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    surface = qr.Surface(misaligned(corners), misaligned(np.array([[0, 1, 2]])))
    np.testing.assert_array_equal(surface.vertices, corners)


@pytest.mark.parametrize(
    ("option", "value", "error", "message"),
    [
        ("initial_active", np.array([True, False]), TypeError, r"initial_active\[0\] is .*True"),
        ("initial_active", [False, True], TypeError, r"initial_active\[0\] is False, expected an integer"),
        ("initial_active", [0, 0.9], TypeError, r"initial_active\[1\] is 0\.9, expected an integer"),
        ("initial_active", [1, -1], qr.LcpError, r"initial_active\[1\] is -1"),
        ("initial_active", 1, TypeError, "initial_active is 1, expected a sequence"),
        ("initial_active", [2], qr.LcpError, r"initial_active\[0\] is 2, expected distinct unknowns below 2"),
        ("max_pivots", -1, qr.LcpError, "max_pivots is -1"),
        ("max_pivots", 2**64, qr.LcpError, "max_pivots is 18446744073709551616"),
        ("max_pivots", 1.5, TypeError, r"max_pivots is 1\.5"),
        ("max_pivots", True, TypeError, "max_pivots is True"),
    ],
)
def test_counts_out_of_range_are_named(
    option: str, value: object, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        qr.solve_lcp([[2, 1], [1, 2]], [-5, -6], options=qr.LcpOptions(**{option: value}))  # type: ignore[arg-type]


def test_a_guess_may_be_any_sequence_of_integers() -> None:
    for guess in ([0, 1], (1, 0), np.array([0, 1], np.uint8), range(2), np.flatnonzero([True, True])):
        options = qr.LcpOptions(initial_active=guess, max_pivots=np.int64(50))  # type: ignore[arg-type]
        assert qr.solve_lcp([[2, 1], [1, 2]], [-5, -6], options=options).attempts[0].warm


def test_options_of_the_same_arrays_are_equal_and_hash() -> None:
    one, other, third = (
        qr.LcpOptions(initial_active=guess, covering=covering)
        for guess, covering in (
            (np.array([1, 2]), np.array([1.0, 0.5, 2.0])),
            ([1, 2], [1.0, 0.5, 2.0]),
            ((1, 2), [1.0, 0.5, 3.0]),
        )
    )
    assert one == other != third
    assert len({one, other, third}) == 2


def test_a_singular_matrix_is_not_said_to_have_one_solution() -> None:
    matrix = [[106, 90, -76], [90, 106, -92], [-76, -92, 80]]
    options = qr.LcpOptions(definiteness="always")
    solution = qr.solve_lcp(matrix, [-210, -98, 76], options=options)
    assert solution.certificate.definiteness == "unknown"
    assert not solution.certificate.is_unique
    assert not qr.definiteness(matrix).positive_definite


def test_an_infeasible_problem_ends_on_a_ray_that_proves_it() -> None:
    with pytest.raises(qr.LcpError, match="no solution") as caught:
        qr.solve_lcp([[-1.0]], [-1.0])
    solution = caught.value.solution
    assert solution is not None
    assert solution.status is qr.LcpStatus.RAY
    assert solution.ray is not None
    assert solution.ray.conclusion == "infeasible"
    assert solution.advice.endswith(": no method solves it: look at M and q again")
    # The columns add to 0 and rounding above it: about (2.25e15, 2.25e15) solves it.
    almost = qr.solve_lcp([[1, -1], [-1, 1 + 4 * 2.0**-52]], [-1, -1], throw=False)
    assert almost.ray is not None
    assert almost.ray.conclusion == "infeasible_to_rounding"


def test_malformed_problems_are_named() -> None:
    with pytest.raises(qr.LcpError, match="must be square"):
        qr.solve_lcp(np.ones((2, 3)), [1, 2])
    with pytest.raises(qr.LcpError, match="q has 1 entries"):
        qr.solve_lcp(np.eye(2), [1])
    with pytest.raises(qr.LcpError, match=r"M\[0, 1\] is NaN"):
        qr.solve_lcp([[1, np.nan], [0, 1]], [1, 2])
    with pytest.raises(ValueError, match=r"`M` has shape \(2,\)"):
        qr.solve_lcp([1, 2], [1, 2])


def test_the_empty_problem_is_solved() -> None:
    assert qr.solve_lcp(np.empty((0, 0)), []).status == "solved"


def pressed_grid(side: int, depth: float = 1e-3) -> tuple[np.ndarray, np.ndarray]:
    """A symmetric positive definite response of a grid, 1/r off the diagonal, and a parabolic gap."""
    x, y = (a.ravel() - (side - 1) / 2 for a in np.meshgrid(np.arange(side), np.arange(side)))
    distance = np.hypot(x[:, None] - x, y[:, None] - y)
    return 1.0 / np.maximum(distance, 0.28), (x * x + y * y) / 25.0 * 1e-3 - depth


def test_every_option_of_the_core_has_its_twin() -> None:
    defaults = qr.LcpOptions()
    assert (defaults.definiteness, defaults.crash) == ("cheap", True)
    matrix, q = pressed_grid(10)
    always = qr.solve_lcp(matrix, q, options=qr.LcpOptions(definiteness="always"))
    assert always.certificate.definiteness == "positive_definite"
    assert always.certificate.is_unique
    never = qr.solve_lcp(matrix, q, options=qr.LcpOptions(definiteness="never"))
    assert never.certificate.definiteness == "unknown"
    promised = qr.solve_lcp(matrix, q, options=qr.LcpOptions(known_p_matrix=True))
    assert promised.certificate.definiteness == "p_matrix"
    assert promised.certificate.is_unique


@pytest.mark.parametrize("value", ["sometimes", None, 3, ["lemke"], True])
def test_what_is_no_word_of_an_option_is_named(value: Any) -> None:
    found = rf"is {re.escape(repr(value))}, expected one of"
    with pytest.raises(qr.LcpError, match=rf'^definiteness {found} "cheap", "always", "never"$'):
        qr.solve_lcp([[1]], [-1], options=qr.LcpOptions(definiteness=value))
    for options in (None, qr.LcpOptions(), qr.LcpOptions(pivot_tol=1e-9)):
        with pytest.raises(qr.LcpError, match=rf'^method {found} "lemke", "block_pivoting"'):
            qr.solve_lcp([[1]], [-1], method=value, options=options)
    ball = qr.Surface(*shapes.ball(8e-3, 1))
    plate = qr.Obstacle.half_space([0, 0, -1], [0, 0, 1])
    skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    with pytest.raises(qr.LcpError, match=rf'^method {found} "lemke", "block_pivoting"'):
        qr.press(ball, plate, skin, [0, 0, 1], depth=1e-4, options=qr.ContactOptions(method=value))


def test_a_crash_basis_is_recorded_and_can_be_left_out() -> None:
    matrix, q = pressed_grid(12)
    crashed = qr.solve_lcp(matrix, q)
    plain = qr.solve_lcp(matrix, q, options=qr.LcpOptions(crash=False))
    assert [attempt.crash for attempt in crashed.attempts] == [True]
    assert [attempt.crash for attempt in plain.attempts] == [False]
    assert crashed.method == plain.method == "lemke"
    assert crashed.pivots >= len(crashed.active)
    np.testing.assert_array_equal(crashed.active, plain.active)
    np.testing.assert_allclose(crashed.z, plain.z, atol=1e-14)
    assert crashed.candidates < len(q)


@pytest.mark.parametrize("method", ["lemke", "block_pivoting", "projected_cg", "auto"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_what_an_answer_needs_is_finite_or_named(method: qr.LcpMethod, order: Literal["C", "F"]) -> None:
    matrix, q = pressed_grid(12)
    sound = qr.solve_lcp(matrix, q)
    row, column = 0, int(sound.active[2])
    bad = np.array(matrix, order=order)
    bad[row, column] = np.nan
    with pytest.raises(qr.LcpError, match=rf"M\[{row}, {column}\] is NaN; 1 entries"):
        qr.solve_lcp(bad, q, method=method)
    if method != "projected_cg":
        np.testing.assert_array_equal(qr.solve_lcp(bad.T, q, method=method).active, sound.active)
    q[5] = np.inf
    with pytest.raises(qr.LcpError, match=r"q\[5\] is inf"):
        qr.solve_lcp(matrix, q, method=method)


def test_results_are_frozen_and_can_be_stored() -> None:
    solution = qr.solve_lcp([[2, 1], [1, 2]], [-5, -6])
    with pytest.raises(FrozenInstanceError):
        solution.pivots = 0  # type: ignore[misc]
    again = pickle.loads(pickle.dumps(solution))
    assert (again.status, again.attempts) == (solution.status, solution.attempts)
    assert again.certificate == solution.certificate
    assert repr(solution).startswith("LcpSolution(solved by lemke: 2 of 2 unknowns above 0, ")


@pytest.mark.parametrize(
    ("method", "option"),
    [
        ("projected_cg", {"crash": False}),
        ("projected_cg", {"covering": [1.0, 2.0]}),
        ("projected_cg", {"pivot_tol": 1e-9}),
        ("block_pivoting", {"crash": False}),
        ("auto", {"crash": False}),
    ],
)
def test_an_option_that_the_method_does_not_know_is_named_with_the_method(
    method: str, option: dict[str, Any]
) -> None:
    M, q = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])
    (name,) = option
    with pytest.raises(qr.LcpError, match=f"option `{name}` is not known by method '{method}'"):
        qr.solve_lcp(M, q, method=method, options=qr.LcpOptions(**option))
    assert qr.solve_lcp(M, q, method="lemke", options=qr.LcpOptions(**option)).status == "solved"


@pytest.mark.parametrize("method", list(qr.LcpMethod))
def test_twice_the_matrix_and_the_vector_give_the_same_answer_to_the_bit(method: qr.LcpMethod) -> None:
    random = np.random.default_rng(8)
    problems = [
        # Next to singular: what is left of z is rounding.
        (
            np.array([[0.6130697109402233, 0.4870389835552794], [0.4870389835552794, 0.3869516597448032]]),
            np.array([-0.40426959268751356, -0.3211625823152621]),
        ),
        (np.full((2, 2), 4.0), np.array([-0.7281367290764543, -0.7615617841772263])),
    ]
    for size in range(2, 10):
        root = random.normal(size=(size, size))
        problems.append((root @ root.T, random.normal(size=size)))
    for m, q in problems:
        once, twice = (qr.solve_lcp(c * m, c * q, method=method, throw=False) for c in (1.0, 2.0))
        assert once.status == twice.status
        np.testing.assert_array_equal(once.z, twice.z)
