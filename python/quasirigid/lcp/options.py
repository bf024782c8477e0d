"""How a complementarity problem is solved."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .. import _core
from .._check import as_boolean, as_choice, as_float, as_integer_or_none, as_integers
from .error import LcpError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

LcpMethodName = Literal["lemke", "block_pivoting", "projected_cg", "auto"]


class LcpMethod(StrEnum):
    """Solver of a complementarity problem."""

    LEMKE = "lemke"
    BLOCK_PIVOTING = "block_pivoting"
    PROJECTED_CG = "projected_cg"
    AUTO = "auto"


class _Examination(StrEnum):
    """When the certificate looks for positive definiteness."""

    CHEAP = "cheap"
    ALWAYS = "always"
    NEVER = "never"


DEFAULTS: dict[str, Any] = _core.LcpOptions.defaults()


@dataclass(frozen=True, kw_only=True)
class LcpOptions:
    """How a complementarity problem is solved.

    Values are checked where they are used. An option that the chosen method does not know, set to other than
    its default, is an error.

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
        Whether the certificate looks for positive definiteness of the rows that can leave zero, which makes a
        solution the only one; "cheap": where that costs no more than the solve did. What is singular to
        rounding stays "unknown".
    crash : bool
        Let Lemke's method begin from a crash basis: block exchanges guess the active set as long as nothing
        shows that M is no P-matrix, or from `initial_active`, whatever M is; where they stall, the path
        begins from that guess or from nothing. Every exchange counts as a pivot. Only where no `covering` is
        given, and for more than 16 unknowns that may touch.
    known_p_matrix : bool
        Promise that every principal minor of M is positive, so that there is one solution; it is taken at
        your word and stands in the certificate. "auto" then begins with block pivoting at any size; the one
        solution is the same, to rounding.
    """

    max_pivots: int | None = DEFAULTS["max_pivots"]
    pivot_tol: float = DEFAULTS["pivot_tol"]
    tolerance: float = DEFAULTS["tolerance"]
    initial_active: Sequence[int] | NDArray[np.int64] | None = None
    covering: ArrayLike | None = None
    definiteness: Literal["cheap", "always", "never"] = DEFAULTS["definiteness"]
    crash: bool = DEFAULTS["crash"]
    known_p_matrix: bool = False

    def __post_init__(self) -> None:
        """Keep arrays and lists as tuples, which compare and hash."""
        for name in ("initial_active", "covering"):
            given = getattr(self, name)
            listed = given.tolist() if isinstance(given, np.ndarray) else given
            if isinstance(listed, list):
                object.__setattr__(self, name, tuple(listed))


def options_to_core(options: LcpOptions) -> _core.LcpOptions:
    """Return the core's options; refuse by name what is of another kind."""
    given = options.initial_active
    guess = None if given is None else as_integers("initial_active", given, LcpError)
    return _core.LcpOptions(
        max_pivots=as_integer_or_none("max_pivots", options.max_pivots, LcpError),
        pivot_tol=as_float("pivot_tol", options.pivot_tol),
        tolerance=as_float("tolerance", options.tolerance),
        initial_active=guess,
        covering=options.covering,
        definiteness=as_choice("definiteness", options.definiteness, _Examination, LcpError),
        crash=as_boolean("crash", options.crash),
        known_p_matrix=as_boolean("known_p_matrix", options.known_p_matrix),
    )
