"""What an elastic product is made of, to the core and from it."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import _core
from .._check import as_array, as_reals
from ..errors import ResponseError, ResponseRangeWarning
from .core import ElasticConstants, build_kernel
from .response import Body, GaussianCorrected, GivenMatrix, HalfSpace, Layer, PressureBasis, Response

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Material", "product_skin"]


class Material(NamedTuple):
    """What an elastic product is made of, as `Obstacle.with_material` took it.

    Attributes
    ----------
    shear_modulus : float
        G (Pa).
    poisson_ratio : float
        nu.
    response : HalfSpace, GaussianCorrected, Layer or GivenMatrix
        Displacement of the surface per unit force.
    """

    shear_modulus: float
    poisson_ratio: float
    response: HalfSpace | GaussianCorrected | Layer | GivenMatrix


def product_skin(
    constants: ElasticConstants, response: Response | None, is_new: bool
) -> tuple[_core.Skin, tuple[NDArray[Any], NDArray[np.float64]] | None]:
    """Return the kernel of a product's response, and nodes and compliance of a given matrix.

    A new one warns of a kernel that is not well posed.

    Raises
    ------
    ResponseError
        If a constant is out of range, or no product has such a response; a TypeError if it is no response.
    """
    response = HalfSpace() if response is None else response
    kernel = build_kernel(constants, response)
    if kernel is not None:
        _check_kernel(response)
        why = kernel.ill_posedness()
        if is_new and why is not None:
            warnings.warn(why, ResponseRangeWarning, stacklevel=2)
        return kernel, None
    if isinstance(response, Body):
        raise ResponseError(
            "no such response of a product: a Body is solved under its own skin; take a kernel, or the "
            "product's compliance as GivenMatrix"
        )
    assert isinstance(response, GivenMatrix)
    nodes = as_array("nodes", response.nodes)
    compliance = as_reals("compliance", response.compliance)
    if compliance.ndim != 2:
        raise ResponseError(
            f"no such response of a product: compliance has shape {compliance.shape}, expected (k, k), along "
            "the force"
        )
    kernel = build_kernel(constants, HalfSpace())
    assert kernel is not None
    return kernel, (nodes, compliance)


def _check_kernel(response: Any) -> None:
    """Refuse what a product takes over from the skin, and a thickness for each vertex."""
    given = getattr(response, "discretization", None) is not None
    if given or response.pressure is not PressureBasis.LINEAR:
        raise ResponseError(
            "no such response of a product: it has the pressure and the discretization of the skin that it "
            f"meets; leave them out of {response!r}"
        )
    if isinstance(response, Layer) and np.ndim(response.thickness) > 0:
        raise ResponseError(
            "no such response of a product: a layer of the product has one thickness everywhere"
        )
