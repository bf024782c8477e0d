"""Exceptions and warnings; everything raised on purpose is a `QuasirigidError`.

`LcpError` and `ContactError` stand beside the results that they carry, in `lcp` and `contact.result`.
"""


class QuasirigidError(Exception):
    """Base of all exceptions of this package."""


class SurfaceError(QuasirigidError, ValueError):
    """A surface was rejected; the message names the element at fault, its value and how many there are."""


class ObstacleError(QuasirigidError, ValueError):
    """An obstacle was rejected, or could not answer."""


class ResponseError(QuasirigidError, ValueError):
    """A response was rejected, or its matrix could not be built."""


class HandError(QuasirigidError, ValueError):
    """A hand, its pose or its file was rejected; the message names the joint, vertex or field at fault."""


class MeshFileError(QuasirigidError, ValueError):
    """A mesh file could not be read as it stands; the message names the file, the defect and its place."""


class QuasirigidWarning(UserWarning):
    """Something in a question or its answer that the user should know."""


class MissingExtraError(QuasirigidError, ImportError):
    """A part of the package needs a library that is not installed; the message names the command."""
