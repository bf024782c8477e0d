"""Exceptions and warnings. Everything raised on purpose is a `QuasirigidError`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .contact.result import Contact
    from .lcp import LcpSolution


class QuasirigidError(Exception):
    """Base of all exceptions of this package."""


class SurfaceError(QuasirigidError, ValueError):
    """A surface was rejected; the message names the element at fault, its value and how many there are."""


class ObstacleError(QuasirigidError, ValueError):
    """An obstacle was rejected, or could not answer."""


class ResponseError(QuasirigidError, ValueError):
    """A response was rejected, or its matrix could not be built."""


class LcpError(QuasirigidError, ValueError, RuntimeError):
    """A complementarity problem was malformed, or did not end solved.

    Attributes
    ----------
    solution : LcpSolution or None
        What the solver returned, where the problem was well posed and the ending was not "solved".
    """

    solution: LcpSolution | None = None


class ContactError(QuasirigidError, ValueError, RuntimeError):
    """A contact was malformed, or did not end solved.

    Attributes
    ----------
    contact : Contact or None
        What was found, where the question was well posed and the ending was not "solved".
    """

    contact: Contact | None = None


class MeshFileError(QuasirigidError, ValueError):
    """A mesh file could not be read as it stands; the message names the file, the defect and its place."""


class QuasirigidWarning(UserWarning):
    """Something in a question or its answer that the user should know."""


class MissingExtraError(QuasirigidError, ImportError):
    """A part of the package needs a library that is not installed; the message says how to get it."""
