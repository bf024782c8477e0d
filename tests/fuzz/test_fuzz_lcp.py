"""Complementarity problems of every kind: what is called solved is solved, and all else ends by its name."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import quasirigid as qr
from fuzz_profile import EXAMPLES
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

Floats = NDArray[np.float64]
METHODS = ["lemke", "block_pivoting", "projected_cg", "auto"]
KINDS = [
    "any", "integers", "definite", "nearly singular", "semidefinite", "skew", "p_matrix", "murty", "fathi",
    "contact", "graded", "tied", "sparse", "vast",
]  # fmt: skip
LARGEST_RESIDUAL = 1e-8


def matrix(kind: str, n: int, random: np.random.Generator) -> Floats:
    rows = random.normal(size=(n, n))
    upper = np.triu(np.full((n, n), 2.0), 1)
    match kind:
        case "integers":
            return random.integers(-2, 3, (n, n)).astype(float)
        case "definite":
            return rows @ rows.T + np.eye(n)
        case "nearly singular":
            rows *= 10.0 ** -np.linspace(0, random.uniform(0, 8), n)
            return rows @ rows.T
        case "semidefinite":
            few = random.integers(-2, 3, (n, max(1, n // 2))).astype(float)
            return few @ few.T
        case "skew":
            return rows - rows.T + random.integers(0, 2) * np.diag(random.integers(0, 2, n))
        case "p_matrix":
            return np.triu(5 * rows, 1) + np.diag(random.uniform(0.1, 2, n))
        case "murty":
            return np.eye(n) + upper
        case "fathi":
            return (np.eye(n) + upper).T @ (np.eye(n) + upper)
        case "contact":
            places = random.uniform(size=(n, 2))
            distance = np.linalg.norm(places[:, None] - places[None], axis=2)
            return 1.0 / (distance + 0.5 / np.sqrt(n))
        case "graded":
            scale = 10.0 ** random.uniform(-6, 6, n)
            return (rows @ rows.T + np.eye(n)) * scale[:, None] * scale
        case "sparse":
            return np.where(random.uniform(size=(n, n)) < 0.2, rows, 0.0) + np.eye(n)
        case "vast":
            return rows * 10.0 ** random.integers(-150, 150, (n, n))
        case _:
            return rows


def problem(kind: str, n: int, seed: int) -> tuple[Floats, Floats]:
    """Return M and q; a tie has an answer with z = w = 0 in many rows."""
    random = np.random.default_rng(seed)
    m = matrix("definite" if kind == "tied" else kind, n, random)
    match random.integers(0, 3) if kind != "tied" else 2:
        case 0:
            q = random.normal(size=n) - random.uniform(0, 1)
        case 1:
            q = random.integers(-3, 2, n).astype(float)
        case _:
            z = np.where(random.uniform(size=n) < 0.5, random.integers(0, 3, n), 0)
            w = np.where(z > 0, 0.0, random.integers(0, 2, n))
            q = w - m @ z
    scale = 10.0 ** random.integers(-12, 13, 2)
    return m * scale[0], q * scale[1]


def natural_residual(m: Floats, q: Floats, z: Floats) -> float:
    """Return max |min(M_ii z_i, w_i)| / max(-q), in extended precision or, where that is short, exactly."""
    delta = float(np.max(-q, initial=0.0))
    if delta == 0.0:
        return float(np.abs(z).max(initial=0.0))
    scale = np.where(np.diag(m) > 0, np.diag(m), np.abs(m).max(axis=1))
    wide = np.longdouble
    w = m.astype(wide) @ z.astype(wide) + q.astype(wide)
    rounding = len(q) * np.finfo(wide).eps * float((np.abs(m).astype(wide) @ z.astype(wide)).max())
    if rounding > 1e-3 * LARGEST_RESIDUAL * delta:
        used = np.flatnonzero(z)
        rows = [sum((Fraction(row[j]) * Fraction(z[j]) for j in used), Fraction(0)) for row in m]
        exact = [
            abs(min(Fraction(s) * Fraction(zi), r + Fraction(qi)))
            for s, zi, r, qi in zip(scale, z, rows, q, strict=True)
        ]
        return float(max(exact) / Fraction(delta))
    return float(np.abs(np.minimum(scale.astype(wide) * z, w)).max() / delta)


def check(m: Floats, q: Floats, solution: qr.LcpSolution) -> None:
    assert np.isfinite(solution.z).all()
    assert (solution.z >= 0).all()
    assert not np.isnan(solution.w).any()
    assert solution.status in ("solved", "ray", "pivot_limit", "breakdown")
    assert solution.advice
    if solution.status == "solved":
        assert natural_residual(m, q, solution.z) <= LARGEST_RESIDUAL


@given(
    kind=st.sampled_from(KINDS),
    n=st.integers(1, 60),
    seed=st.integers(0, 2**32 - 1),
    method=st.sampled_from(METHODS),
    crash=st.booleans(),
)
@settings(max_examples=8 * EXAMPLES)
def test_what_is_called_solved_is_solved(kind: str, n: int, seed: int, method: str, crash: bool) -> None:
    m, q = problem(kind, n, seed)
    options = qr.LcpOptions(crash=crash) if method == "lemke" else None
    try:
        solution = qr.solve_lcp(m, q, method=method, options=options, throw=False)
    except qr.LcpError as error:
        assert method == "projected_cg" and "symmetric" in str(error)
        return
    check(m, q, solution)
    again = qr.solve_lcp(m, q, method=method, options=options, throw=False)
    assert again.status == solution.status
    np.testing.assert_array_equal(again.z, solution.z)


@given(
    n=st.integers(1, 12),
    seed=st.integers(0, 2**32 - 1),
    method=st.sampled_from(METHODS),
    guess=st.lists(st.integers(0, 11), unique=True),
    tolerance=st.sampled_from([1e-14, 1e-10, 1e-6, 1e-2]),
    pivots=st.sampled_from([None, 0, 1, 5, 1000]),
)
def test_options_change_no_ending_to_a_false_one(
    n: int, seed: int, method: str, guess: list[int], tolerance: float, pivots: int | None
) -> None:
    m, q = problem("definite", n, seed)
    active = [i for i in guess if i < n]
    options = qr.LcpOptions(initial_active=active, tolerance=tolerance, max_pivots=pivots)
    solution = qr.solve_lcp(m, q, method=method, options=options, throw=False)
    assert (solution.z >= 0).all()
    if solution.status == "solved":
        assert natural_residual(m, q, solution.z) <= 1.001 * tolerance


entry = st.floats(width=64) | st.integers(-2, 2).map(float)


@given(
    st.integers(0, 6).flatmap(
        lambda n: st.tuples(
            st.lists(st.lists(entry, min_size=n, max_size=n), min_size=n, max_size=n),
            st.lists(entry, min_size=n, max_size=n),
        )
    ),
    st.sampled_from(METHODS),
)
@settings(max_examples=4 * EXAMPLES)
def test_any_numbers_end_by_name(given_problem: tuple[list[list[float]], list[float]], method: str) -> None:
    m = np.array(given_problem[0]).reshape(len(given_problem[1]), len(given_problem[1]))
    q = np.array(given_problem[1])
    try:
        solution = qr.solve_lcp(m, q, method=method, throw=False)
    except qr.LcpError:
        return
    assert np.isfinite(solution.z).all()
    assert (solution.z >= 0).all()
    # What a solve does not read need not be finite.
    if solution.status == "solved" and np.isfinite(m).all():
        assert natural_residual(m, q, solution.z) <= LARGEST_RESIDUAL
