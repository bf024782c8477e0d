"""A response as a matrix: its entries, the volume that it moves, its definiteness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _core
from ._check import as_float, as_index, as_integer_or_none
from ._from_core import from_core
from .errors import ResponseError
from .scene import as_obstacle, as_surface
from .skin.elastic import core_skin
from .skin.prepared import PreparedSkin
from .skin.skins import CombinedSkin, Skin

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from .obstacle import Obstacle
    from .skin.elastic import ElasticSkin
    from .surface import Surface

__all__ = ["Definiteness", "NetVolume", "definiteness", "initial_gaps", "net_volume", "response_matrix"]


def response_matrix(
    surface: Surface,
    skin: ElasticSkin,
    nodes: ArrayLike,
    *,
    directions: ArrayLike | None = None,
    tolerance: float = 1e-6,
    num_threads: int | None = None,
) -> NDArray[np.float64]:
    """Return the displacement of each node per newton at each node.

    Parameters
    ----------
    surface : Surface
        The skin.
    skin : Skin, PreparedSkin or CombinedSkin
        Material and response.
    nodes : (k,) array_like of int
        Vertices, each at most once.
    directions : (k, 3) array_like, optional
        Unit directions of force and displacement; None means minus the vertex normal. Kernels and given
        matrices ignore it: they move the skin along the force, so that a contact with normals ``n`` takes
        their R times ``n @ n.T``.
    tolerance : float
        Error of every entry relative to the half-space's, some K/r; a layer's entries fade faster, so of
        these it is a larger share far away. 0 means all that double precision gives; in Galerkin form some
        1e-8, 1e-4 at angles below 3 degrees, and 1e-3 between faces that nearly touch and share no vertex.
    num_threads : int, optional
        Threads; None for all. The matrix is equal to the bit for any number.

    Returns
    -------
    (k, k) float64
        R (m/N): entry (i, j) is the displacement of node i per newton at node j; in Galerkin form, its
        average against the pressure of node i. The gaps that belong to it are those of `initial_gaps`.

    Raises
    ------
    ResponseError
        If a node, the tolerance or the memory needed is out of range, or a direction has not length 1.
    """
    num_threads = as_integer_or_none("num_threads", num_threads, ResponseError, least=1)
    return _core.response_matrix(
        as_surface("surface", surface),
        core_skin(skin, surface, num_threads),
        nodes,
        directions=directions,
        tolerance=as_float("tolerance", tolerance),
        num_threads=num_threads,
    )


def initial_gaps(
    surface: Surface,
    skin: ElasticSkin,
    nodes: ArrayLike,
    distance: Obstacle | Callable[[NDArray[np.float64]], ArrayLike],
) -> NDArray[np.float64]:
    """Return the initial gaps that match `response_matrix`, for use as ``q`` in `solve_lcp`.

    In collocation at the vertices; in Galerkin form averaged against the pressure of each node, from the
    vertices and the middles of the edges around it. Gaps of the vertices alone would cost the latter more
    force than all else: a round obstacle's are h^2/6R too large on edges of length h.

    Parameters
    ----------
    surface : Surface
        The skin.
    skin : Skin, PreparedSkin or CombinedSkin
        Material and response.
    nodes : (k,) array_like of int
        Vertices, each at most once.
    distance : Obstacle or callable
        The obstacle, or a function from points (p, 3) to their gaps (p,), in m, negative inside.

    Returns
    -------
    (k,) float64
        Gaps (m).

    Raises
    ------
    ResponseError
        If the skin was made for another surface, a node is out of range, or the function does not return one
        finite number per point.

    Examples
    --------
    >>> import numpy as np
    >>> import quasirigid as qr
    >>> finger = qr.models.fingertip(edge_length=2e-3)
    >>> response = qr.HalfSpace(discretization="galerkin")
    >>> skin = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=response)
    >>> ball = qr.Obstacle.sphere(finger.vertices[0] + [0, 0, 1.0], 1.0005)
    >>> q = qr.initial_gaps(finger, skin, np.arange(20), ball)
    >>> R = qr.response_matrix(finger, skin, np.arange(20))
    >>> qr.solve_lcp(R, q).status
    <LcpStatus.SOLVED: 'solved'>
    """
    as_surface("surface", surface)
    measured = distance if callable(distance) else _distance_to(as_obstacle("distance", distance))
    return _core.initial_gaps(surface, core_skin(skin, surface), nodes, measured)


def _distance_to(obstacle: Obstacle) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    return lambda points: obstacle.signed_distance(points)[0]


class NetVolume(NamedTuple):
    """Volume under the displacement of a unit force.

    Attributes
    ----------
    net : float
        Dents less bulges (m³/N).
    gross : float
        Both added up (m³/N).
    """

    net: float
    gross: float


def net_volume(surface: Surface, skin: Skin, node: int) -> NetVolume:
    """Return the volume that the mesh moves per newton at a vertex, ``sum S_i R_ij`` over all its vertices.

    R is in Galerkin form where the kernel has one (half-space, layer): the sum is then the integral of the
    displacement, whatever the triangles. The paper's condition (its eq. 4) asks for a net volume of 0.

    Parameters
    ----------
    surface : Surface
        The skin's mesh.
    skin : Skin
        A kernel: half-space, Gaussian-corrected or layer.
    node : int
        The loaded vertex.

    Returns
    -------
    NetVolume
        Net and gross volume (m³/N).

    Raises
    ------
    ResponseError
        If the node is out of range or the response is no kernel.
    """
    vertex = as_index("node", node, len(as_surface("surface", surface).vertices), ResponseError)
    return NetVolume(*_require_kernel(skin).net_volume(surface, vertex))


def _require_kernel(skin: Skin) -> _core.Skin:
    need = "net_volume needs one; for a body read Contact.volume_change"
    if isinstance(skin, PreparedSkin):
        raise ResponseError(f"a PreparedSkin is no kernel: {need}; its `skin` may be one")
    if isinstance(skin, CombinedSkin):
        raise ResponseError(f"a CombinedSkin is no kernel: {need}; its `background` is one")
    if not isinstance(skin, Skin):
        raise TypeError(f"skin is a {type(skin).__name__}, expected a Skin: {need}")
    if skin._kernel is None:
        raise ResponseError(f"the response {type(skin.response).__name__} is no kernel: {need}")
    return skin._kernel


@dataclass(frozen=True, kw_only=True)
class Definiteness:
    """What is known of the symmetric part of a response matrix.

    Attributes
    ----------
    positive_definite : bool
        Whether it is positive definite beyond rounding: the contact problem then has one solution, and Lemke
        finds it. False also where it is singular to rounding.
    smallest, largest : float
        Its extreme eigenvalues (m/N).
    condition : float
        largest / smallest; inf unless positive definite.
    estimated : bool
        Whether the eigenvalues are Lanczos estimates (large matrices).
    """

    positive_definite: bool
    smallest: float
    largest: float
    condition: float
    estimated: bool


def definiteness(matrix: ArrayLike) -> Definiteness:
    """Examine the symmetric part ``(R + R') / 2`` of a response matrix.

    Parameters
    ----------
    matrix : (k, k) array_like
        R (m/N).

    Returns
    -------
    Definiteness
        Definiteness, extreme eigenvalues and condition number.

    Raises
    ------
    ResponseError
        If it is not square, or an entry is not finite.

    Examples
    --------
    >>> import quasirigid as qr
    >>> qr.definiteness([[2.0, 1.0], [0.0, 2.0]]).positive_definite
    True
    """
    return from_core(Definiteness, _core.definiteness(matrix))
