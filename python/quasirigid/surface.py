"""The skin: a validated triangle mesh, and repair of raw vertices and faces."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from . import _core
from ._check import as_float
from ._core import Surface as Surface
from ._frozen import Frozen
from .scene import as_surface

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Repair", "Surface", "repair", "skin_without_caps"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Repair(Frozen):
    """A repaired raw mesh and what was changed.

    Attributes
    ----------
    vertices : (n, 3) float64
        Vertices kept (m).
    faces : (m, 3) int64
        Faces kept.
    vertex_map : (n_before,) int64
        New number of each old vertex, -1 for a dropped one.
    report : mapping of str to int
        Number of changes of each kind: "welded_vertices"; "collapsed_faces", dropped as two of their corners
        are one; "zero_area_faces"; "duplicate_faces", dropped as another has the same corners;
        "unused_vertices", dropped; "flipped_faces", turned to agree with their neighbours or outwards; and
        "turned_components", closed parts of these that were turned as a whole.
    """

    vertices: NDArray[np.float64] = field(repr=False)
    faces: NDArray[np.int64] = field(repr=False)
    vertex_map: NDArray[np.int64] = field(repr=False)
    report: Mapping[str, int]


def repair(vertices: ArrayLike, faces: ArrayLike, *, weld_tolerance: float) -> Repair:
    """Weld, drop what is unused, degenerate or double, and turn faces the same way.

    Nothing else in the package repairs a mesh: elsewhere one with a defect is refused.

    Parameters
    ----------
    vertices : (n, 3) array_like
        Positions (m).
    faces : (m, 3) array_like of int
        Corners of each triangle.
    weld_tolerance : float
        Vertices at most this far apart (m, >= 0) become one; 0 welds bit-equal points.

    Returns
    -------
    Repair
        The mesh, the map from old to new vertices, and a count of every change.

    Raises
    ------
    SurfaceError
        Where no repair is possible: not finite, index out of range, not orientable.

    Examples
    --------
    >>> import quasirigid as qr
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> fixed = qr.repair(corners, [[0, 1, 2], [3, 4, 5]], weld_tolerance=0.0)
    >>> len(fixed.vertices), fixed.vertex_map.tolist()
    (4, [0, 1, 2, 1, 3, 2])
    """
    weld_tolerance = as_float("weld_tolerance", weld_tolerance)
    kept, corners, vertex_map, report = _core.repair(vertices, faces, weld_tolerance=weld_tolerance)
    return Repair(vertices=kept, faces=corners, vertex_map=vertex_map, report=report)


def skin_without_caps(surface: Surface) -> NDArray[np.bool_]:
    """Return the vertices that are skin: all but those of flat cut faces, rims included.

    Parameters
    ----------
    surface : Surface
        A finger or hand whose cut end is capped flat.

    Returns
    -------
    (n,) bool
        A `skin_mask`. True: skin; False: large flat faces behind a sharp rim.
    """
    return _core.skin_without_caps(as_surface("surface", surface))
