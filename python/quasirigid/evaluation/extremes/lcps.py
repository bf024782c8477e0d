"""Complementarity problems, each answer judged by a residual that is computed here."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from ..._arrays import Floats
from ...lcp import LcpMethod, LcpStatus, solve_lcp
from .case import Case, Outcome, holds, near
from .problems import Problem, all_in_contact, infeasible, problems

__all__ = ["lcp_cases", "natural_residual"]

# The largest residual of an answer that may be called solved.
_RESIDUAL = 1e-8
_SOLVED_OR_SAID = (LcpStatus.PIVOT_LIMIT, LcpStatus.BREAKDOWN)
_ROWS = 256


def lcp_cases() -> Iterator[Case]:
    """Make the cases of every problem with every method that is for it."""
    for problem in problems():
        for method in LcpMethod:
            if method is LcpMethod.PROJECTED_CG and not problem.symmetric:
                continue
            judge = partial(_judge, problem, method)
            yield Case(
                group="LCP", name=f"{problem.name}, {method}", judge=judge, quick=method is LcpMethod.LEMKE
            )
    for problem in infeasible():
        for method in (LcpMethod.LEMKE, LcpMethod.AUTO):
            yield Case(
                group="LCP",
                name=f"{problem.name}, {method}",
                judge=partial(_ray, problem, method),
                quick=True,
            )
    direct = (LcpMethod.LEMKE, LcpMethod.BLOCK_PIVOTING)
    for count, methods in ((500, (*direct, LcpMethod.PROJECTED_CG)), (5000, direct)):
        for method in methods:
            judge = partial(_judge_large, count, method)
            name = f"all in contact, n = {count}, {method}"
            yield Case(group="LCP", name=name, judge=judge, quick=count == 500)


def natural_residual(matrix: Floats, vector: Floats, z: Floats) -> float:
    """Return ``max |min(M_ii z_i, w_i)| / max(-q)``, in extended precision where the machine has it.

    A row whose diagonal is not positive is scaled by its largest entry.
    """
    wide = z.astype(np.longdouble)
    worst = np.longdouble(0.0)
    for start in range(0, len(z), _ROWS):
        rows = slice(start, start + _ROWS)
        block = matrix[rows].astype(np.longdouble)
        w = block @ wide + vector[rows]
        diagonal = matrix.diagonal()[rows]
        scale = np.where(diagonal > 0, diagonal, np.abs(matrix[rows]).max(axis=1))
        worst = np.maximum(worst, np.abs(np.minimum(scale * wide[rows], w)).max())
    return float(worst / max(-vector.min(), np.finfo(np.float64).tiny))


def _judge_large(count: int, method: LcpMethod) -> Outcome:
    return _judge(all_in_contact(count), method)


def _judge(problem: Problem, method: LcpMethod) -> Outcome:
    """Solve; an answer must pass the residual here, another ending must not be called solved."""
    solution = solve_lcp(problem.matrix, problem.vector, method=method, throw=False)
    residual = natural_residual(problem.matrix, problem.vector, solution.z)
    if solution.status is not LcpStatus.SOLVED:
        expected = "solved, or pivot limit or breakdown said"
        return holds(expected, str(solution.status), solution.status in _SOLVED_OR_SAID)
    if (solution.z < 0.0).any():
        return holds("z >= 0", f"z = {solution.z.min():.1e}", False)
    return near("natural residual of what is called solved", residual, _RESIDUAL)


def _ray(problem: Problem, method: LcpMethod) -> Outcome:
    """Solve what has no solution: a ray, whose equation is computed anew."""
    solution = solve_lcp(problem.matrix, problem.vector, method=method, throw=False)
    ray = solution.ray
    expected = "a ray that shows that there is no solution"
    if solution.status is not LcpStatus.RAY or ray is None:
        return holds(expected, str(solution.status), False)
    left = ray.w - problem.matrix @ ray.z - ray.z0
    size = max(float(np.abs(ray.w).max()), float(np.abs(problem.matrix).max() * ray.z.max()), abs(ray.z0))
    found = f"{ray.conclusion}, its equation to {np.abs(left).max() / size:.1e}"
    is_shown = str(ray.conclusion).startswith("infeasible")
    return holds(expected, found, is_shown and np.abs(left).max() <= _RESIDUAL * size)
