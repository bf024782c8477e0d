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


class SizeWarning(QuasirigidWarning):
    """A skin or product has a size that no hand or product has: it is in another unit."""


class DepthWarning(QuasirigidWarning):
    """A press is deeper than the tissue, or the part, can give."""


class ModulusWarning(QuasirigidWarning):
    """The shear modulus is none of tissue."""


class CoarseMeshWarning(QuasirigidWarning):
    """The mesh was taken as it is, and is too coarse for the contact."""


class CutWarning(QuasirigidWarning):
    """A contact reaches where the skin is cut, held or masked, or a cut leaves more than was meant."""


class ResponseRangeWarning(QuasirigidWarning):
    """A response is not well posed, or is used beyond what it is right for."""


class MaskWarning(QuasirigidWarning):
    """Few vertices may touch."""


class PenetrationWarning(QuasirigidWarning):
    """Skin and product still overlap, or are pulled, or went through each other."""


class RefinementWarning(QuasirigidWarning):
    """A refinement, a search or the mesh of a body falls short of the target."""


class MissingExtraError(QuasirigidError, ImportError):
    """A part of the package needs a library that is not installed; the message names the command."""
