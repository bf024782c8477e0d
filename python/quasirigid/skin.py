"""What the skin is made of: material and response."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from . import _core

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from ._core import Skin as CoreSkin
    from .surface import Surface

__all__ = ["GaussianCorrected", "HalfSpace", "Pressure", "Response", "Skin", "response_matrix"]

Pressure = Literal["linear", "one_ring"]


@dataclass(frozen=True)
class HalfSpace:
    """Elastic half-space: ``u(r) = K / r`` per newton, ``K = (1 - nu) / (2 pi G)``.

    Parameters
    ----------
    pressure : {"linear", "one_ring"}
        Pressure basis. "linear" (hat functions) is accurate and well posed. "one_ring" spreads the force of
        a node evenly over its one-ring, as Xie, Kanai, Date 2011 do; it is numerically singular on regular
        meshes and its pressures oscillate, and is here to reproduce that paper.

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 3.2; Xie, Kanai, Date 2011, eq. 1 and 8.
    """

    pressure: Pressure = "linear"


@dataclass(frozen=True)
class GaussianCorrected:
    """Half-space less a Gaussian, to keep volume.

    ``u(r) = K / r - height exp(-r^2 / 2 width^2)`` for r < cutoff, 0 beyond.

    Parameters
    ----------
    height : float
        Height of the Gaussian a (m/N).
    width : float
        Width of the Gaussian c (m).
    cutoff : float
        Distance beyond which the response is zero (m).
    pressure : {"linear", "one_ring"}
        Pressure basis, see `HalfSpace`.

    Notes
    -----
    The constants printed in the paper (0.8 mm/N, 5 mm, balanced at a cutoff of 15 mm) are not well posed on
    a fingertip: from a depth of some tenths of a millimetre the complementarity problem has no solution,
    and the contact ends with status "ray".

    References
    ----------
    Xie, Kanai, Date 2011, eq. 6.
    """

    height: float
    width: float
    cutoff: float
    pressure: Pressure = "linear"


Response = HalfSpace | GaussianCorrected


@dataclass(frozen=True, kw_only=True)
class Skin:
    """Material and response of the skin.

    Parameters
    ----------
    shear_modulus : float
        G (Pa), > 0. About 60 kPa for a fingertip (Xie, Kanai, Date 2011).
    poisson_ratio : float
        nu, in [0, 0.5]; 0.5 is incompressible.
    response : HalfSpace or GaussianCorrected
        Displacement of the surface per unit force.

    Raises
    ------
    ResponseError
        If a constant is out of range.

    Examples
    --------
    >>> import quasirigid as qr
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
    """

    shear_modulus: float
    poisson_ratio: float
    response: Response
    _core: CoreSkin = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_core", self._build())

    def _build(self) -> CoreSkin:
        material = (self.shear_modulus, self.poisson_ratio)
        match self.response:
            case HalfSpace(pressure):
                return _core.Skin.half_space(*material, pressure)
            case GaussianCorrected(height, width, cutoff, pressure):
                return _core.Skin.gaussian_corrected(*material, height, width, cutoff, pressure)
        raise TypeError(f"response is {self.response!r}, expected one of {Response}")


def response_matrix(
    surface: Surface,
    skin: Skin,
    nodes: ArrayLike,
    directions: ArrayLike | None = None,
    tolerance: float = 1e-6,
    num_threads: int | None = None,
) -> NDArray[np.float64]:
    """Displacement of each node per newton at each node.

    Parameters
    ----------
    surface : Surface
        The skin.
    skin : Skin
        Material and response.
    nodes : (k,) array_like of int
        Vertices, each at most once.
    directions : (k, 3) array_like, optional
        Unit directions of force and displacement; None means minus the vertex normal. Kernels that depend
        on the distance alone ignore it.
    tolerance : float
        Relative tolerance of every entry; 0 means all that double precision gives.
    num_threads : int, optional
        Threads; None for all. The matrix is equal to the bit for any number.

    Returns
    -------
    (k, k) float64
        R (m/N): entry (i, j) is the displacement of node i per newton at node j.

    Raises
    ------
    ResponseError
        If a node, the tolerance or the memory needed is out of range.
    """
    return _core.response_matrix(
        surface, skin._core, nodes, directions, tolerance=tolerance, num_threads=num_threads
    )
