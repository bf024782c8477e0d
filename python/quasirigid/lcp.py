"""The linear complementarity problem ``w = M z + q, w >= 0, z >= 0, w'z = 0``."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

from . import _core
from ._check import as_integer_or_none, as_integers
from ._frozen import Frozen
from .errors import QuasirigidError

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Certificate",
    "LcpAttempt",
    "LcpDefiniteness",
    "LcpError",
    "LcpMethod",
    "LcpOptions",
    "LcpRay",
    "LcpSolution",
    "LcpStatus",
    "RayConclusion",
    "solve_lcp",
]

_T = TypeVar("_T")
LcpMethodName = Literal["lemke", "block_pivoting", "projected_cg", "auto"]


class LcpMethod(StrEnum):
    """Solver of a complementarity problem."""

    LEMKE = "lemke"
    BLOCK_PIVOTING = "block_pivoting"
    PROJECTED_CG = "projected_cg"
    AUTO = "auto"


class LcpStatus(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


class LcpDefiniteness(StrEnum):
    """What a solve has shown of its matrix; the first two leave one solution."""

    POSITIVE_DEFINITE = "positive_definite"
    P_MATRIX = "p_matrix"
    NOT_POSITIVE_DEFINITE = "not_positive_definite"
    UNKNOWN = "unknown"


class RayConclusion(StrEnum):
    """What an unbounded path proves: no solution, none that is not huge, no copositive matrix, or nothing."""

    INFEASIBLE = "infeasible"
    INFEASIBLE_TO_ROUNDING = "infeasible_to_rounding"
    NOT_COPOSITIVE = "not_copositive"
    INCONCLUSIVE = "inconclusive"


_DEFAULTS: dict[str, Any] = _core.LcpOptions.defaults()


@dataclass(frozen=True, kw_only=True)
class LcpOptions:
    """How a complementarity problem is solved.

    An option that the chosen method does not know, set to other than its default, is an error.

    Attributes
    ----------
    max_pivots : int or None
        Pivot budget of each run, a crash and the path after it being two; None for a multiple of the size.
    pivot_tol : float
        Rates of change below this share of the largest never pivot (dimensionless).
    tolerance : float
        Largest natural residual of an answer that is called solved (dimensionless).
    initial_active : sequence of int or None
        Guess of the unknowns with z > 0, by their indices (of a mask: ``numpy.flatnonzero(mask)``).
    covering : (n,) array_like or None
        Covering vector of Lemke's method, all > 0; None for ones.
    definiteness : {"cheap", "always", "never"}
        Whether the certificate looks for positive definiteness, which makes a solution the only one;
        "cheap": where that costs no more than the solve did. A matrix that is singular to rounding stays
        "unknown".
    crash : bool
        Let Lemke's method begin from a crash basis: block exchanges guess the active set as long as nothing
        shows that M is no P-matrix; where they stall, the path begins from nothing. Every exchange counts as
        a pivot. Only where neither `initial_active` nor `covering` is given, and for more than 16 unknowns
        that may touch.
    known_p_matrix : bool
        Promise that every principal minor of M is positive, so that there is one solution; it is taken at
        your word and stands in the certificate. "auto" then begins with block pivoting at any size; the one
        solution is the same, to rounding.
    """

    max_pivots: int | None = _DEFAULTS["max_pivots"]
    pivot_tol: float = _DEFAULTS["pivot_tol"]
    tolerance: float = _DEFAULTS["tolerance"]
    initial_active: Sequence[int] | NDArray[np.int64] | None = None
    covering: ArrayLike | None = None
    definiteness: Literal["cheap", "always", "never"] = _DEFAULTS["definiteness"]
    crash: bool = _DEFAULTS["crash"]
    known_p_matrix: bool = False

    def _to_core(self) -> _core.LcpOptions:
        guess = None if self.initial_active is None else as_integers("initial_active", self.initial_active)
        return _core.LcpOptions(
            max_pivots=as_integer_or_none("max_pivots", self.max_pivots),
            pivot_tol=self.pivot_tol,
            tolerance=self.tolerance,
            initial_active=guess,
            covering=self.covering,
            definiteness=self.definiteness,
            crash=self.crash,
            known_p_matrix=self.known_p_matrix,
        )


_DEFAULT_OPTIONS = LcpOptions()._to_core()

# Options that only some methods know: Lemke's, with which "auto" and block pivoting may end.
_KNOWN_BY = {
    "crash": ("lemke", "auto"),
    "covering": ("lemke", "auto"),
    "pivot_tol": ("lemke", "auto", "block_pivoting"),
}


def _core_options(options: LcpOptions | None, method: str) -> _core.LcpOptions:
    """Return the core's options; refuse one that the method does not know, set to other than its default."""
    if options is None:
        return _DEFAULT_OPTIONS
    for name, methods in _KNOWN_BY.items():
        value = getattr(options, name)
        is_default = value is None if name == "covering" else value == _DEFAULTS[name]
        if method in _METHOD and method not in methods and not is_default:
            known = ", ".join(methods)
            raise LcpError(f"option `{name}` is not known by method {str(method)!r}, only by {known}")
    return options._to_core()


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
    definiteness : LcpDefiniteness
        "positive_definite", "p_matrix", "not_positive_definite" or "unknown".
    is_unique : bool
        Whether the solution is known to be the only one.
    """

    natural_residual: float
    complementarity: float
    infeasibility: float
    definiteness: LcpDefiniteness
    is_unique: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpRay(Frozen):
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
    conclusion : RayConclusion
        "infeasible" (no solution exists), "infeasible_to_rounding" (one would have to be huge),
        "not_copositive" or "inconclusive".
    """

    z: NDArray[np.float64] = field(repr=False)
    w: NDArray[np.float64] = field(repr=False)
    z0: float
    residual: float
    curvature: float
    conclusion: RayConclusion


class LcpAttempt(NamedTuple):
    """One method's run within a solve: from your guess (`warm`), or looking for a crash basis (`crash`)."""

    method: LcpMethod
    status: LcpStatus
    pivots: int
    warm: bool
    crash: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class LcpSolution(Frozen):
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
        Basis exchanges (iterations, for projected_cg) of every run together, those of a crash basis included.
    natural_residual, complementarity : float
        As in `certificate`.
    method : LcpMethod
        The method that gave this ending.
    advice : str
        What happened, why that usually is, and what to try.
    certificate : Certificate
        Measures of the answer.
    ray : LcpRay or None
        Where Lemke's path left for, when it did.
    attempts : tuple of LcpAttempt
        Every run, in order.
    candidates : int
        Number of unknowns that the method looked at; the others stay at zero.
    """

    status: LcpStatus
    z: NDArray[np.float64]
    w: NDArray[np.float64]
    active: NDArray[np.int64]
    pivots: int
    natural_residual: float
    complementarity: float
    method: LcpMethod
    advice: str
    certificate: Certificate
    ray: LcpRay | None
    attempts: tuple[LcpAttempt, ...]
    candidates: int

    def __repr__(self) -> str:
        """Return ending, method, counts and residual on one line."""
        return (
            f"LcpSolution({self.status} by {self.method}: "
            f"{len(self.active)} of {len(self.z)} unknowns above 0, "
            f"{self.pivots} pivots, natural residual {self.natural_residual:.1e})"
        )


class LcpError(QuasirigidError, ValueError, RuntimeError):
    """A complementarity problem was malformed, or did not end solved.

    Attributes
    ----------
    solution : LcpSolution or None
        What the solver returned, where the problem was well posed and the ending was not "solved".
    """

    solution: LcpSolution | None = None


_STATUS = {str(status): status for status in LcpStatus}
_METHOD = {str(method): method for method in LcpMethod}
_DEFINITENESS = {str(definiteness): definiteness for definiteness in LcpDefiniteness}


def _built(cls: type[_T], **fields: Any) -> _T:
    """Return a frozen dataclass of all its fields; its own `__init__` takes longer than a small solve."""
    built = object.__new__(cls)
    object.__setattr__(built, "__dict__", fields)
    return built


def solution_from_core(core: _core.LcpSolution) -> LcpSolution:
    """Return the facade's solution."""
    natural_residual, complementarity = core.natural_residual, core.complementarity
    return _built(
        LcpSolution,
        status=_STATUS[core.status],
        z=core.z,
        w=core.w,
        active=core.active,
        pivots=core.pivots,
        natural_residual=natural_residual,
        complementarity=complementarity,
        method=_METHOD[core.method],
        advice=core.advice,
        certificate=_built(
            Certificate,
            natural_residual=natural_residual,
            complementarity=complementarity,
            infeasibility=core.infeasibility,
            definiteness=_DEFINITENESS[core.definiteness],
            is_unique=core.is_unique,
        ),
        ray=None if core.ray is None else _ray_from_core(core.ray),
        attempts=tuple([_attempt_from_core(attempt) for attempt in core.attempts]),
        candidates=core.candidates,
    )


def _attempt_from_core(core: tuple[str, str, int, bool, bool]) -> LcpAttempt:
    method, status, pivots, warm, crash = core
    return LcpAttempt(_METHOD[method], _STATUS[status], pivots, warm, crash)


def _ray_from_core(core: _core.LcpRay) -> LcpRay:
    return LcpRay(
        z=core.z,
        w=core.w,
        z0=core.z0,
        residual=core.residual,
        curvature=core.curvature,
        conclusion=RayConclusion(core.conclusion),
    )


def solve_lcp(
    M: ArrayLike,
    q: ArrayLike,
    *,
    method: LcpMethod | LcpMethodName = "lemke",
    options: LcpOptions | None = None,
    throw: bool = True,
) -> LcpSolution:
    """Solve ``w = M z + q, w >= 0, z >= 0, w'z = 0``.

    Parameters
    ----------
    M : (n, n) array_like
        Any real matrix: nonsymmetric, indefinite and singular ones are welcome. float64 in C or Fortran
        order is read in place; what a solve reads of it must be finite.
    q : (n,) array_like
        Any real vector.
    method : {"lemke", "block_pivoting", "projected_cg", "auto"}
        "lemke" takes any M, and begins from a crash basis (Dirkse, Ferris) where
        `LcpOptions.crash` allows; "block_pivoting" is fast for P-matrices; "projected_cg" needs a symmetric M
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
    solution = solution_from_core(_core.solve_lcp(M, q, method, _core_options(options, method)))
    if throw and solution.status is not LcpStatus.SOLVED:
        error = LcpError(f"the complementarity problem ended with status {solution.advice}")
        error.solution = solution
        raise error
    return solution
