"""How the skin answers a force: the choices for `Skin.response`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..surface import Surface

__all__ = ["Body", "Gap", "GaussianCorrected", "GivenMatrix", "HalfSpace", "Layer", "Pressure", "Response"]

Pressure = Literal["linear", "one_ring"]
Gap = Literal["node", "weighted"]


@dataclass(frozen=True)
class HalfSpace:
    """Elastic half-space: ``u(r) = K / r`` per newton, ``K = (1 - nu) / (2 pi G)``.

    Parameters
    ----------
    pressure : {"linear", "one_ring"}
        Pressure basis. "linear" (hat functions) is accurate and well posed. "one_ring" spreads the force of
        a node evenly over its one-ring, as Xie, Kanai, Date 2011 do; it is numerically singular on regular
        meshes and its pressures oscillate, and is here to reproduce that paper.
    gap : {"node", "weighted"}
        How the gap of a node is measured. "node": at the vertex (collocation); no penetration is left at
        vertices. "weighted": averaged against hats (Galerkin); the matrix is symmetric positive definite on
        any surface, slivers and jittered grids too, and force, peak pressure and contact area are right on
        coarser meshes, the last two by recovery between the vertices. Take "weighted" where "node" is found
        not to be positive definite, or where these figures count and the mesh is coarse.

    Notes
    -----
    A sphere pressed into flat skin, Hertz's parabola, with 4, 8 and 16 square cells per contact radius; the
    errors are root mean squares over places of the sphere on the mesh (docs/validation.md):

    ========================================  ======================  ======================
    error, or what                            "node"                  "weighted"
    ========================================  ======================  ======================
    force                                     0.70, 0.19, 0.05 %      0.16, 0.03, 0.00 %
    peak pressure                             0.48, 0.13, 0.03 %      0.50, 0.02, 0.00 %
    contact area                              4.6, 1.8, 0.7 %         1.1, 0.4, 0.1 %
    penetration left at vertices, of depth    0                       1.1, 0.5, 0.3 %
    condition of R                            23, 48, 96              81, 168, 341
    smallest over largest eigenvalue          0.044, 0.021, 0.010     0.012, 0.006, 0.003
    time of a contact                         1                       21, 13, 3
    ========================================  ======================  ======================

    With vertices moved by up to a quarter of a cell the errors are much the same. Assembly takes
    25 to 40 times as long; in large contacts the complementarity problem, which takes the same time in both,
    outweighs it.

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 3.2; Xie, Kanai, Date 2011, eq. 1 and 8.
    """

    pressure: Pressure = "linear"
    gap: Gap = "node"


@dataclass(frozen=True)
class GaussianCorrected:
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
    pressure: Pressure = "linear"

    @classmethod
    def balanced(cls, width: float, cutoff: float, pressure: Pressure = "linear") -> GaussianCorrected:
        """Take the height that keeps volume, eq. 5 of the paper: no net volume within the cutoff.

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
            Its height, ``K L / (c^2 (1 - exp(-L^2 / 2 c^2)))``, follows from the skin that it is given to.
        """
        return cls(None, width, cutoff, pressure)


@dataclass(frozen=True, eq=False)
class Layer:
    """Elastic layer bonded to rigid bone: ``u(r) = K (1 / r - phi(r / h) / h)``.

    Parameters
    ----------
    thickness : float or (n,) array_like
        Thickness h (m), the same everywhere or one per vertex of the surface; a pair of vertices answers as
        on a layer of the smaller of its two, which keeps the matrix well posed.
    pressure : {"linear", "one_ring"}
        Pressure basis, see `HalfSpace`.
    gap : {"node", "weighted"}
        How the gap of a node is measured, see `HalfSpace`. On flat meshes "weighted" is always positive
        definite; "node" is too, but for large irregular meshes far coarser than an incompressible layer is
        thick.

    Notes
    -----
    For wide flat tissue, as the palm. On a fingertip it is too stiff, by up to twice the true force; where
    the surface bends within some 20 thicknesses neither form has to be positive definite, and the contact
    says so.

    References
    ----------
    Johnson 1985, "Contact Mechanics", section 5.8.
    """

    thickness: float | ArrayLike
    pressure: Pressure = "linear"
    gap: Gap = "node"


@dataclass(frozen=True, kw_only=True, eq=False)
class Body:
    """The body under this skin with its bone, by boundary elements: the true linear answer.

    Its compliance is computed once for a surface (`Skin.prepared`), in seconds; presses then take
    milliseconds.

    Parameters
    ----------
    bone : Surface, optional
        Rigid bones inside the skin, each a closed surface.
    fixed : (n,) array_like of bool, optional
        Skin vertices that do not move, such as those of a finger's cut end. A body needs a bone or fixed
        vertices.
    memory_limit : int, optional
        Largest memory of the preparation (bytes); what the system has free when left out, where it says so.
    bone_pressure : bool
        Keep what tells the pressure on the bone too (`PreparedSkin.bone_pressure`).

    Notes
    -----
    Forces and gaps are those of linear elasticity. The drawn skin keeps its volume beyond that: the second
    order that the displacement misses is taken up by the free skin, some micrometres, and `Contact.left_out`
    says how much.

    References
    ----------
    Brebbia, Telles, Wrobel 1984, "Boundary Element Techniques"; Pauly, Pai, Guibas 2004.
    """

    bone: Surface | None = None
    fixed: ArrayLike | None = None
    memory_limit: int | None = None
    bone_pressure: bool = False


@dataclass(frozen=True, eq=False)
class GivenMatrix:
    """A response that was computed or measured elsewhere.

    Parameters
    ----------
    nodes : (k,) array_like of int
        Vertices that it is known for; all that touch must be among them.
    compliance : (k, k) or (k, 3, k, 3) array_like
        Displacement per newton (m/N) in the order of the nodes: along the obstacle's normals, or as vectors.
    """

    nodes: ArrayLike
    compliance: ArrayLike


Response = HalfSpace | GaussianCorrected | Layer | Body | GivenMatrix
