"""How the skin answers a force: the choices for `Skin.response`."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .._check import as_array, as_choice
from .._core import Surface
from .._frozen import Frozen
from ..errors import ResponseError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "Body",
    "Discretization",
    "GaussianCorrected",
    "GivenMatrix",
    "HalfSpace",
    "Layer",
    "PressureBasis",
    "Response",
]


class PressureBasis(StrEnum):
    """How the force of a node is spread: as a hat function, or evenly over its one-ring."""

    LINEAR = "linear"
    ONE_RING = "one_ring"


class Discretization(StrEnum):
    """How the gap of a node is taken: at the vertex, or averaged against the node's pressure."""

    COLLOCATION = "collocation"
    GALERKIN = "galerkin"


_Pressure = PressureBasis | Literal["linear", "one_ring"]
_Discretization = Discretization | Literal["collocation", "galerkin"] | None
# Fields that hold an array, or may.
_ARRAYS = ("thickness", "fixed", "nodes", "compliance")


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class _Response(Frozen):
    """Base of the responses: words are checked, arrays copied, the repr is one line, less the defaults.

    Two of a kind are equal where their fields are, arrays and bones by their content.
    """

    def __post_init__(self) -> None:
        given = vars(self)
        given |= {name: _kept(name, given[name]) for name in _ARRAYS if name in given}
        if "pressure" in given:
            given["pressure"] = as_choice("pressure", given["pressure"], PressureBasis, ResponseError)
        if given.get("discretization") is not None:
            chosen = as_choice("discretization", given["discretization"], Discretization, ResponseError)
            given["discretization"] = chosen
        super().__post_init__()

    def __eq__(self, other: object) -> bool:
        """Return whether it is of the same kind with the same fields."""
        if type(self) is not type(other):
            return NotImplemented
        names = [field.name for field in dataclasses.fields(self)]
        return all(_are_equal(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        """Return a number that equal ones share: of the kind and its words."""
        return hash((type(self), *(value for value in vars(self).values() if isinstance(value, str))))

    def __repr__(self) -> str:
        """Return the arguments on one line, arrays by their size and range."""
        values = ((field, getattr(self, field.name)) for field in dataclasses.fields(self))
        given = (f"{field.name}={_shown(value)}" for field, value in values if value is not field.default)
        return f"{type(self).__name__}({', '.join(given)})"


def _kept(name: str, value: Any) -> Any:
    """Return an array, or rows of numbers, as a copy; all else stays, for whoever refuses it."""
    array = as_array(name, value).copy()
    has_rows = array.ndim > 0 and array.dtype.kind in "biuf"
    if not (has_rows or isinstance(value, np.ndarray)):
        return value
    return array


def _are_equal(one: Any, other: Any) -> bool:
    """Return whether two fields hold the same; surfaces are compared by vertices and faces."""
    if isinstance(one, Surface) and isinstance(other, Surface):
        return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ("vertices", "faces"))
    if one is None or other is None or isinstance(one, Surface) or isinstance(other, Surface):
        return one is other
    return np.array_equal(one, other)


def _shown(value: object) -> str:
    if np.ndim(value) == 0:  # type: ignore[arg-type]
        return repr(str(value) if isinstance(value, StrEnum) else value)
    array = np.asarray(value)
    if array.dtype == np.bool_:
        return f"<{np.count_nonzero(array)} of {array.size}>"
    if array.ndim == 1 and array.size > 0:
        return f"<{array.size} from {array.min():.4g} to {array.max():.4g}>"
    return f"<{' x '.join(map(str, array.shape))}>"


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class HalfSpace(_Response):
    """Elastic half-space: ``u(r) = K / r`` per newton, ``K = (1 - nu) / (2 pi G)``.

    Parameters
    ----------
    pressure : {"linear", "one_ring"}
        Pressure basis. "linear" (hat functions) is accurate and well posed. "one_ring" spreads the force of
        a node evenly over its one-ring, as Xie, Kanai, Date 2011 do; it is numerically singular on regular
        meshes and its pressures oscillate, and is here to reproduce that paper.
    discretization : {"collocation", "galerkin"}, optional
        How the gap of a node is taken; None for "collocation". "collocation": at the vertex; no penetration
        is left at vertices. "galerkin": averaged against the node's pressure; the matrix is symmetric
        positive definite on any surface, slivers and jittered grids too, and force, peak pressure and contact
        area are right on coarser meshes, the last two by recovery between the vertices.

    Notes
    -----
    Take "galerkin" where collocation is found not to be positive definite, or where the figures count and the
    mesh is coarse. Assembly takes 6 to 10 times as long; in large contacts the complementarity problem
    outweighs it. `accuracy` measures the errors of both against Hertz.

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 3.2; Xie, Kanai, Date 2011, eq. 1 and 8.
    """

    pressure: _Pressure = PressureBasis.LINEAR
    discretization: _Discretization = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class GaussianCorrected(_Response):
    """Half-space less a Gaussian, to keep volume.

    ``u(r) = K / r - height exp(-r^2 / 2 width^2)`` for r < cutoff, 0 beyond.

    Parameters
    ----------
    height : float or None
        Height of the Gaussian a (m/N); None for the one that keeps volume (see `balanced`).
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

    height: float | None
    width: float
    cutoff: float
    pressure: _Pressure = PressureBasis.LINEAR

    @classmethod
    def balanced(
        cls, *, width: float, cutoff: float, pressure: _Pressure = PressureBasis.LINEAR
    ) -> GaussianCorrected:
        """Return the one that keeps volume, eq. 5 of the paper: no net volume within the cutoff.

        Parameters
        ----------
        width : float
            Width of the Gaussian c (m).
        cutoff : float
            Distance beyond which the response is zero (m). Well posed from about ``width >= cutoff / 2``.
        pressure : {"linear", "one_ring"}
            Pressure basis, see `HalfSpace`.

        Returns
        -------
        GaussianCorrected
            Its height, ``K L / (c^2 (1 - exp(-L^2 / 2 c^2)))``, follows from the skin that it goes into.
        """
        return cls(height=None, width=width, cutoff=cutoff, pressure=pressure)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Layer(_Response):
    """Elastic layer bonded to rigid bone: ``u(r) = K (1 / r - phi(r / h) / h)``.

    Parameters
    ----------
    thickness : float or (n,) array_like
        Thickness h (m), > 0 and at least 1/1000 of the mesh's mean edge, the same everywhere or one per
        vertex of the surface; a pair of vertices answers as on a layer of the smaller of its two, which keeps
        the matrix well posed.
    pressure : {"linear", "one_ring"}
        Pressure basis, see `HalfSpace`.
    discretization : {"collocation", "galerkin"}, optional
        How the gap of a node is taken, see `HalfSpace`. On flat meshes "galerkin" is always positive
        definite; "collocation" is too, but for large irregular meshes far coarser than an incompressible
        layer is thick.

    Notes
    -----
    For wide flat tissue, as the palm. On a fingertip it is 15 to 50 % too stiff from 0.3 to 2 mm deep, as
    tissue gives way sideways there; where the surface bends within some 20 thicknesses neither form has to be
    positive definite, and the contact says so.

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 5.8.
    """

    thickness: float | ArrayLike
    pressure: _Pressure = PressureBasis.LINEAR
    discretization: _Discretization = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Body(_Response):
    """The body under this skin with its bone, by boundary elements: the true linear answer.

    Its compliance is computed once for a surface (`Skin.prepared`), in seconds; presses then take
    milliseconds. A coarse mesh of the skin takes a fraction of that: what is left of the body there without
    a near kernel, known in closed form on any mesh, is smooth and joins the near kernel on the skin's own
    mesh.

    Parameters
    ----------
    bone : Surface, optional
        Rigid bones inside the skin, each a closed surface.
    fixed : (n,) array_like of bool, optional
        Skin vertices that do not move, such as those of a finger's cut end: those of faces with all three
        corners marked; a vertex marked without such a face stays free. A body needs a bone or fixed vertices.
    memory_limit : int, optional
        Largest memory of the preparation (bytes); what the system has free when left out, where it says so.
    bone_pressure : bool
        Keep what `PreparedSkin.bone_pressure` needs too.
    coarse_edge_length : float or None
        Edge length of the coarse mesh that the body is solved on (m). None: 0.4 to 0.7 of the local tissue
        thickness over the bone or, without one, over the fixed skin close behind, as of a pad on a plate; at
        most half the skin's radius of curvature. Skins that would need over 2,050 vertices,
        such as a whole hand, get longer edges, first away from the nodes. On other skins the mesh stays as
        it is at the outline of the fixed skin and one vertex beside it. 0: the skin's own mesh.
    discretization : {"collocation", "galerkin"}, optional
        How the gap of a node is taken, see `HalfSpace`. "galerkin" averages the near kernel; what is left of
        the body is smooth and stays at the nodes.

    References
    ----------
    Brebbia, Telles, Wrobel 1984, "Boundary Element Techniques"; Pauly, Pai, Guibas 2004.
    """

    bone: Surface | None = None
    fixed: ArrayLike | None = None
    memory_limit: int | None = None
    bone_pressure: bool = False
    coarse_edge_length: float | None = None
    discretization: _Discretization = None


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class GivenMatrix(_Response):
    """A response that was computed or measured before.

    Parameters
    ----------
    nodes : (k,) array_like of int
        Vertices that it is known for; all that touch must be among them, with those beside them that the skin
        bulges at. A contact warns where it reaches their rim, or the compliance cannot belong to them.
    compliance : (k, k) or (k, 3, k, 3) array_like
        Displacement per newton (m/N) in the order of the nodes. (k, k): along the force, as `response_matrix`
        of a kernel by collocation has it; a contact with normals ``n`` takes it times ``n @ n.T``, and its
        gaps at the vertices, which a matrix in Galerkin form does not fit. (k, 3, k, 3): as vectors. One that
        was measured along the nodes' own normals is
        ``m[:, None, :, None] * n[:, :, None, None] * n`` as vectors.

    Raises
    ------
    ResponseError
        Where it is used: if a node is double or no vertex, or the compliance has another shape or is not
        finite.
    """

    nodes: ArrayLike
    compliance: ArrayLike


Response = HalfSpace | GaussianCorrected | Layer | Body | GivenMatrix
"""What `Skin.response` may be: displacement of the surface per unit force (m/N)."""
