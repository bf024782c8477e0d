"""The linear complementarity problem ``w = M z + q, w >= 0, z >= 0, w'z = 0``."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from . import _core
from .errors import LcpError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Certificate",
    "LcpAttempt",
    "LcpMethod",
    "LcpOptions",
    "LcpRay",
    "LcpSolution",
    "LcpStatus",
    "solve_lcp",
]

LcpMethod = Literal["lemke", "block_pivoting", "projected_cg", "auto"]


class LcpStatus(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


_DEFAULTS: dict[str, Any] = _core.LcpOptions.defaults()


@dataclass(frozen=True, kw_only=True)
class LcpOptions:
    """How a complementarity problem is solved.

    Attributes
    ----------
    max_pivots : int or None
        Pivot budget of each method that runs; None for a multiple of the size.
    pivot_tol : float
        Rates of change below this share of the largest never pivot (dimensionless).
    tolerance : float
        Largest natural residual of an answer that is called solved (dimensionless).
    initial_active : sequence of int or None
        Guess of the unknowns with z > 0.
    covering : (n,) array_like or None
        Covering vector of Lemke's method, all > 0; None for ones.
    """

    max_pivots: int | None = _DEFAULTS["max_pivots"]
    pivot_tol: float = _DEFAULTS["pivot_tol"]
    tolerance: float = _DEFAULTS["tolerance"]
    initial_active: Sequence[int] | NDArray[np.int64] | None = None
    covering: ArrayLike | None = None

    def _to_core(self) -> _core.LcpOptions:
        guess = None if self.initial_active is None else [int(index) for index in self.initial_active]
        return _core.LcpOptions(
            max_pivots=self.max_pivots,
            pivot_tol=self.pivot_tol,
            tolerance=self.tolerance,
            initial_active=guess,
            covering=self.covering,
        )


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """Measures of an answer against the M and q given; none changes when M or q is scaled.

    Attributes
    ----------
    natural_residual : float
        ``max |min(M_ii z_i, w_i)| / max(-q)``.
    complementarity : float
        ``sum |z_i w_i|`` over ``delta max(delta / mean diagonal, sum z)`` with ``delta = max(-q)``.
    infeasibility : float
        ``max(-w_i, 0) / max(-q)``.
    definiteness : str
        "positive_definite", "p_matrix", "not_positive_definite" or "unknown".
    is_unique : bool
        Whether the solution is known to be the only one.
    """

    natural_residual: float
    complementarity: float
    infeasibility: float
    definiteness: str
    is_unique: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpRay:
    """Direction of the unbounded path on which Lemke's method ended: ``w = M z + d z0``.

    Attributes
    ----------
    z, w : (n,) float64
        Direction of z and w, both >= 0.
    z0 : float
        Direction of the covering variable.
    residual : float
        Largest violation of the ray's equations and signs, relative to its size.
    curvature : float
        ``z'Mz`` relative to the sum of its terms' magnitudes.
    conclusion : str
        "infeasible" (no solution exists), "not_copositive" or "inconclusive".
    """

    z: NDArray[np.float64]
    w: NDArray[np.float64]
    z0: float
    residual: float
    curvature: float
    conclusion: str


class LcpAttempt(NamedTuple):
    """One method's run within a solve."""

    method: str
    status: LcpStatus
    pivots: int
    warm: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpSolution:
    """What a solve found; z and w are an answer only where the status is "solved".

    Attributes
    ----------
    status : LcpStatus
        How it ended.
    z : (n,) float64
        Unknowns, never negative.
    w : (n,) float64
        ``M z + q``, computed anew from the M and q given.
    active : (a,) int64
        Unknowns with z > 0, ascending.
    pivots : int
        Basis exchanges (iterations, for projected_cg) of every run together.
    natural_residual, complementarity : float
        As in `certificate`.
    method : str
        The method that gave this ending.
    advice : str
        What happened, why that usually is, and what to try.
    certificate : Certificate
        Measures of the answer.
    ray : LcpRay or None
        Where Lemke's path left for, when it did.
    attempts : tuple of LcpAttempt
        Every run, in order.
    """

    status: LcpStatus
    z: NDArray[np.float64] = field(repr=False)
    w: NDArray[np.float64] = field(repr=False)
    active: NDArray[np.int64] = field(repr=False)
    pivots: int
    natural_residual: float
    complementarity: float
    method: str
    advice: str = field(repr=False)
    certificate: Certificate = field(repr=False)
    ray: LcpRay | None = field(repr=False)
    attempts: tuple[LcpAttempt, ...] = field(repr=False)

    @classmethod
    def _from_core(cls, solution: _core.LcpSolution) -> LcpSolution:
        fields = solution.fields()
        fields["status"] = LcpStatus(fields["status"])
        ray = solution.ray()
        attempts = (
            LcpAttempt(method, LcpStatus(status), pivots, warm)
            for method, status, pivots, warm in solution.attempts()
        )
        return cls(
            **fields,
            certificate=Certificate(**solution.certificate()),
            ray=None if ray is None else LcpRay(**ray),
            attempts=tuple(attempts),
        )


def solve_lcp(
    M: ArrayLike,
    q: ArrayLike,
    *,
    method: LcpMethod = "lemke",
    options: LcpOptions | None = None,
    throw: bool = True,
) -> LcpSolution:
    """Solve ``w = M z + q, w >= 0, z >= 0, w'z = 0``.

    Parameters
    ----------
    M : (n, n) array_like
        Any real matrix: nonsymmetric, indefinite and singular ones are welcome. Column-major (Fortran)
        order is the fastest; float64 in either order is not copied.
    q : (n,) array_like
        Any real vector.
    method : {"lemke", "block_pivoting", "projected_cg", "auto"}
        "lemke" takes any M; "block_pivoting" is fast for P-matrices; "projected_cg" needs a symmetric M
        and is for large problems; "auto" chooses and says in `LcpSolution.attempts` what it did.
    options : LcpOptions, optional
        How it is solved.
    throw : bool
        Raise on an ending other than "solved"; with False, read `LcpSolution.status`.

    Returns
    -------
    LcpSolution
        z, w, and a certificate computed from the M and q given.

    Raises
    ------
    LcpError
        For a malformed problem, or a bad ending (the error carries `solution`).

    References
    ----------
    Lemke 1965, Management Science 11; Cottle, Pang, Stone 1992, "The Linear Complementarity Problem".

    Examples
    --------
    >>> import quasirigid as qr
    >>> solution = qr.solve_lcp([[2, 1], [1, 2]], [-5, -6])
    >>> solution.status.value, solution.z.round(6).tolist()
    ('solved', [1.333333, 2.333333])
    """
    core_options = (options or LcpOptions())._to_core()
    solution = LcpSolution._from_core(_core.solve_lcp(M, q, method=method, options=core_options))
    if throw and solution.status is not LcpStatus.SOLVED:
        error = LcpError(f"the complementarity problem ended with status {solution.advice}")
        error.solution = solution
        raise error
    return solution
