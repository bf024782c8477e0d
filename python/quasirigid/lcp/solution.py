"""What a solve of a complementarity problem returns."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from .._from_core import from_core
from .._frozen import Frozen
from .options import LcpMethod

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .. import _core

_T = TypeVar("_T")


class LcpStatus(StrEnum):
    """How a solve ended."""

    SOLVED = "solved"
    RAY = "ray"
    PIVOT_LIMIT = "pivot_limit"
    BREAKDOWN = "breakdown"
    INTERRUPTED = "interrupted"


class LcpDefiniteness(StrEnum):
    """What a solve has shown of the rows that can leave zero; the first two leave one solution."""

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


@dataclass(frozen=True, kw_only=True)
class Certificate:
    """Measures of an answer against the M and q given; none changes when M or q is scaled.

    Attributes
    ----------
    natural_residual : float
        ``max |min(M_ii z_i, w_i)| / max(-q)``; where ``M_ii z_i`` is the smaller, ``max |M_ji| z_i`` over j
        stands for it.
    complementarity : float
        ``sum |z_i w_i|`` over ``delta max(delta / mean diagonal, sum z)`` with ``delta = max(-q)``.
    infeasibility : float
        ``max(-w_i, 0) / max(-q)``.
    definiteness : LcpDefiniteness
        "positive_definite", "p_matrix", "not_positive_definite" or "unknown": of the rows that can leave
        zero with this q. Another q may have more of them; `quasirigid.definiteness` looks at all of a matrix.
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
    """One method's run within a solve.

    Attributes
    ----------
    method : LcpMethod
        What ran.
    status : LcpStatus
        How it ended.
    pivots : int
        How many it took.
    warm : bool
        Whether it began from your guess.
    crash : bool
        Whether it looked for a crash basis.
    """

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
        Unknowns, never negative; what is zero to rounding is zero. All zero where z or w would not be finite.
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
        ray=core.ray and from_core(LcpRay, core.ray, conclusion=RayConclusion(core.ray.conclusion)),
        attempts=tuple([_attempt_from_core(attempt) for attempt in core.attempts]),
        candidates=core.candidates,
    )


def _attempt_from_core(core: tuple[str, str, int, bool, bool]) -> LcpAttempt:
    method, status, pivots, warm, crash = core
    return LcpAttempt(_METHOD[method], _STATUS[status], pivots, warm, crash)
