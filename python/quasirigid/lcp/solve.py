"""Solving the linear complementarity problem ``w = M z + q, w >= 0, z >= 0, w'z = 0``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import _core
from .._check import as_boolean, as_choice, short
from .error import LcpError
from .options import DEFAULTS, LcpMethod, LcpOptions, options_to_core
from .solution import LcpStatus, solution_from_core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .options import LcpMethodName
    from .solution import LcpSolution


_DEFAULT_OPTIONS = options_to_core(LcpOptions())

# Options that only some methods know: Lemke's, with which "auto" and block pivoting may end.
_KNOWN_BY = {
    "crash": ("lemke",),
    "covering": ("lemke", "auto", "block_pivoting"),
    "pivot_tol": ("lemke", "auto", "block_pivoting"),
}


def _core_options(options: LcpOptions | None, method: LcpMethod) -> _core.LcpOptions:
    """Return the core's options; refuse one that the method does not know, set to other than its default."""
    if options is None:
        return _DEFAULT_OPTIONS
    if not isinstance(options, LcpOptions):
        raise TypeError(f"options is {short(options)}, expected an LcpOptions")
    for name, methods in _KNOWN_BY.items():
        value = getattr(options, name)
        is_default = value is None if name == "covering" else value == DEFAULTS[name]
        if method not in methods and not is_default:
            known = ", ".join(methods)
            raise LcpError(f"option `{name}` is not known by method {str(method)!r}, only by {known}")
    return options_to_core(options)


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
        and is for large contacts; "auto" chooses and says in `LcpSolution.attempts` what it did.
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

    Notes
    -----
    Rows count in one unit: residuals are shares of max(-q). A row whose M and q are 1e-12 of the others' is
    below their rounding, and its unknown may be anything; multiply such rows first, which changes no answer.

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
    method = as_choice("method", method, LcpMethod, LcpError)
    throw = as_boolean("throw", throw)
    solution = solution_from_core(_core.solve_lcp(M, q, method, _core_options(options, method)))
    if throw and solution.status is not LcpStatus.SOLVED:
        error = LcpError(f"the complementarity problem ended with status {solution.advice}")
        error.solution = solution
        raise error
    return solution
