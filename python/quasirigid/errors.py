"""Exceptions and warnings.

A value out of range, and a question without an answer, raise a `QuasirigidError`; each but
`MissingExtraError` is a `ValueError` too. An argument of the wrong kind raises `TypeError`, an array of the
wrong shape a `ValueError`, plain or one of these. `reference` raises plain `ValueError`; a step that a
sequence has not raises `IndexError`. A file that is missing or cannot be read raises the error of what it
should hold (`MeshFileError`, `HandError`, `ResponseError`), one that cannot be written to `OSError`.

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


class SizeWarning(QuasirigidWarning):
    """The size of skin, product or hand, or a product's mass, is unusual; check the unit."""


class DirectionWarning(QuasirigidWarning):
    """A press goes the other way than the product stands."""


class DepthWarning(QuasirigidWarning):
    """A press is deeper than the tissue or the part allows."""


class ModulusWarning(QuasirigidWarning):
    """The shear modulus of the skin is none of soft tissue, or that of a product none of a material."""


class CoarseMeshWarning(QuasirigidWarning):
    """The mesh was taken as it is, and is too coarse for the contact."""


class CutWarning(QuasirigidWarning):
    """A contact reaches where skin is cut, held, masked or not known, or a cut leaves more than was meant."""


class ResponseRangeWarning(QuasirigidWarning):
    """A response is not well posed, does not fit its nodes, or is used beyond what it is right for."""


class MaskWarning(QuasirigidWarning):
    """The skin mask leaves few vertices."""


class PenetrationWarning(QuasirigidWarning):
    """Skin and product overlap after the contact, press across a gap, pull, or went through each other."""


class RefinementWarning(QuasirigidWarning):
    """A refinement, a search or the mesh of a body falls short of the target."""


class MissingExtraError(QuasirigidError, ImportError):
    """A part of the package needs a library that is not installed; the message names the command."""
