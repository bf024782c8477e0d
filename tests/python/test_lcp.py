"""The complementarity solver by itself."""

from __future__ import annotations

import numpy as np
import pytest
import quasirigid as qr


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


def test_an_infeasible_problem_ends_on_a_ray_that_proves_it() -> None:
    with pytest.raises(qr.LcpError, match="no solution") as caught:
        qr.solve_lcp([[-1.0]], [-1.0])
    solution = caught.value.solution
    assert solution is not None
    assert solution.status is qr.LcpStatus.RAY
    assert solution.ray is not None
    assert solution.ray.conclusion == "infeasible"


def test_malformed_problems_are_named() -> None:
    with pytest.raises(qr.LcpError, match="must be square"):
        qr.solve_lcp(np.ones((2, 3)), [1, 2])
    with pytest.raises(qr.LcpError, match="q has 1 entries"):
        qr.solve_lcp(np.eye(2), [1])
    with pytest.raises(qr.LcpError, match=r"M\[0, 1\] is NaN"):
        qr.solve_lcp([[1, np.nan], [0, 1]], [1, 2])
    with pytest.raises(ValueError, match=r"`M` has shape \[2\]"):
        qr.solve_lcp([1, 2], [1, 2])


def test_the_empty_problem_is_solved() -> None:
    assert qr.solve_lcp(np.empty((0, 0)), []).status == "solved"
