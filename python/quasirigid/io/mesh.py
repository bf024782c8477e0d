"""Vertices and faces of mesh objects of other libraries, recognised by their attributes; none is imported."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .._check import as_array, as_reals
from .._units import LengthUnit, metres_in
from ..errors import QuasirigidError, SurfaceError
from .check import triangle_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["mesh_arrays"]

# Cells of meshio without area, which say nothing about a surface.
_WITHOUT_AREA = ("vertex", "line", "line3")


def mesh_arrays(
    mesh: Any, *, unit: LengthUnit = "m", refusal: type[QuasirigidError] = SurfaceError
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return vertices and faces of a mesh object.

    Parameters
    ----------
    mesh : object
        Anything with `vertices` and `faces` or `triangles` (trimesh, open3d), with `points` and a list
        `cells` of blocks with `type` and `data` (meshio), or with `points` and `faces` (pyvista's PolyData).
    unit : {"m", "cm", "mm", "inch"}
        Unit of its coordinates.
    refusal : exception class
        What is raised.

    Returns
    -------
    vertices : (n, 3) float64
        Positions (m), in its order; a copy, as the faces are.
    faces : (m, 3) int64
        Triangles, in its order.

    Raises
    ------
    TypeError
        If it is no such object; the message names its type and what it has.
    SurfaceError
        Or `refusal`, if it has faces that are no triangles, or the unit is not known.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> from quasirigid.io import mesh_arrays
    >>> corner = SimpleNamespace(vertices=[[0, 0, 0], [20, 0, 0], [0, 10, 0]], faces=[[0, 1, 2]])
    >>> vertices, faces = mesh_arrays(corner, unit="mm")
    >>> vertices[1], faces
    (array([0.02, 0.  , 0.  ]), array([[0, 1, 2]]))
    """
    scale = metres_in(unit, refusal)
    try:
        points, faces = _attributes(mesh)
        vertices = as_reals("vertices", points)
    except ValueError as error:
        raise refusal(f"{type(mesh).__name__} {error}") from None
    return vertices * scale, faces


def _attributes(mesh: Any) -> tuple[Any, NDArray[np.int64]]:
    has = {name for name in ("vertices", "faces", "triangles", "points", "cells") if hasattr(mesh, name)}
    if {"vertices", "faces"} <= has:
        return mesh.vertices, triangle_rows(mesh.faces)
    if {"vertices", "triangles"} <= has:
        return mesh.vertices, triangle_rows(mesh.triangles)
    if {"points", "cells"} <= has and all(hasattr(block, "type") for block in mesh.cells):
        return mesh.points, _blocks(mesh.cells)
    if {"points", "faces"} <= has:
        return mesh.points, _counted(mesh)
    found = f"{' and '.join(sorted(has))} alone" if has else "neither vertices nor points"
    raise TypeError(
        f"{type(mesh).__name__} has {found}, expected vertices and faces (as trimesh), points and blocks of"
        " cells (as meshio) or points and faces (as PolyData of pyvista)"
    )


def _blocks(cells: Any) -> NDArray[np.int64]:
    for block in cells:
        if block.type != "triangle" and block.type not in _WITHOUT_AREA:
            raise ValueError(f"has {len(block.data)} cells of type '{block.type}', expected triangles alone")
    triangles = [triangle_rows(block.data) for block in cells if block.type == "triangle"]
    if not triangles:
        raise ValueError("has no cells of type 'triangle'")
    return np.concatenate(triangles)


def _counted(mesh: Any) -> NDArray[np.int64]:
    """Return the faces of a flat array in which the number of corners stands before each face."""
    if getattr(mesh, "n_strips", 0):
        raise ValueError(f"has {mesh.n_strips} triangle strips, expected triangles: call `triangulate()`")
    flat = as_array("faces", mesh.faces)
    if flat.ndim != 1:
        return triangle_rows(flat)
    # Every fourth number, which is right up to the first face that is no triangle.
    corners = flat[::4]
    wrong = np.flatnonzero(corners != 3)
    if len(wrong):
        number = int(wrong[0])
        raise ValueError(
            f"has a face {number} with {corners[number]} corners, expected triangles: call `triangulate()`"
        )
    return triangle_rows(flat.reshape(-1, 4)[:, 1:])
