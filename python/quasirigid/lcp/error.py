"""The error of a complementarity problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import QuasirigidError

if TYPE_CHECKING:
    from .solution import LcpSolution


class LcpError(QuasirigidError, ValueError, RuntimeError):
    """A complementarity problem was malformed, or did not end solved.

    Attributes
    ----------
    solution : LcpSolution or None
        What the solver returned, where the problem was well posed and the ending was not "solved".
    """

    solution: LcpSolution | None = None
