"""Mesh files in, with their unit: PLY, STL and OBJ as arrays, as skin or as product.

The readers are our own and strict. General ones mend in silence: trimesh 5.2 leaves out OBJ faces of two
corners and points that no face uses, puts PLY triangles before quads, takes an ASCII PLY that ends early for
a shorter one, and returns an empty scene for an STL that was cut off.
"""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .._arrays import Floats, Indices
from .._check import as_path
from .._units import LengthUnit, metres_in
from ..errors import MeshFileError, QuasirigidError
from ..obstacle import Obstacle
from ..surface import Surface
from .check import check_values
from .obj import read_obj
from .ply import read_ply
from .stl import read_stl

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["read_mesh", "read_obstacle", "read_surface"]

_READERS = {".ply": read_ply, ".stl": read_stl, ".obj": read_obj}
# Words that files of one kind alone begin with; an STL may be binary and an OBJ has none.
_STARTS = {b"ply\n": ".ply", b"ply\r": ".ply", b"solid ": ".stl"}


def read_mesh(path: str | PathLike[str], *, unit: LengthUnit) -> tuple[Floats, Indices]:
    """Read vertices and faces as they are stored.

    Parameters
    ----------
    path : path
        A file that ends in .ply (ASCII or binary), .stl (ASCII or binary) or .obj.
    unit : {"m", "cm", "mm", "inch"}
        Unit of the coordinates in the file; files do not say it themselves.

    Returns
    -------
    vertices : (n, 3) float64
        Positions (m), in the order of the file. STL and OBJ join points with equal coordinates, as those
        formats need, and nothing else is joined or dropped.
    faces : (m, 3) int64
        In the order of the file; a face of more than three corners becomes a fan from its first corner, or is
        cut ear by ear where that would fold or hold a triangle without area.

    Raises
    ------
    MeshFileError
        The file cannot be read, ends too early, holds a coordinate that is not finite, a face of fewer than
        three corners or one that names a missing vertex; or the unit is not known.

    Examples
    --------
    >>> import quasirigid as qr, tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "triangle.obj"
    >>> _ = path.write_text("v 0 0 0\\nv 20 0 0\\nv 0 10 0\\nf 1 2 3\\n")
    >>> vertices, faces = qr.read_mesh(path, unit="mm")
    >>> vertices[1], faces
    (array([0.02, 0.  , 0.  ]), array([[0, 1, 2]]))
    """
    scale = metres_in(unit, MeshFileError)
    vertices, faces = _read_file(as_path("path", path))
    return (vertices if unit == "m" else vertices * scale), faces


def read_surface(
    path: str | PathLike[str], *, unit: LengthUnit, skin_mask: ArrayLike | None = None
) -> Surface:
    """Read a mesh file as skin.

    Parameters
    ----------
    path : path
        A .ply, .stl or .obj file, as for `read_mesh`.
    unit : {"m", "cm", "mm", "inch"}
        Unit of the coordinates in the file.
    skin_mask : (n,) array_like of bool, optional
        Vertices that may touch; all when left out. The flat cut of a scan is left out by
        ``surface.with_skin_mask(skin_without_caps(surface))``.

    Returns
    -------
    Surface
        The skin, checked.

    Raises
    ------
    MeshFileError
        As for `read_mesh`.
    SurfaceError
        The mesh is no surface; the message names the file, the element and how many there are.
    """
    vertices, faces = read_mesh(path, unit=unit)
    try:
        return Surface(vertices, faces, skin_mask=skin_mask)
    except QuasirigidError as error:
        raise type(error)(f"{path}: {error}") from None


def read_obstacle(path: str | PathLike[str], *, unit: LengthUnit, check_crossings: bool = True) -> Obstacle:
    """Read a mesh file as product.

    Parameters
    ----------
    path : path
        A .ply, .stl or .obj file, as for `read_mesh`.
    unit : {"m", "cm", "mm", "inch"}
        Unit of the coordinates in the file.
    check_crossings : bool
        Look for faces that cross each other, where inside and outside are undefined.

    Returns
    -------
    Obstacle
        The product, checked.

    Raises
    ------
    MeshFileError
        As for `read_mesh`.
    ObstacleError
        The mesh encloses no body; the message names the file, the element and how many there are.
    """
    vertices, faces = read_mesh(path, unit=unit)
    try:
        return Obstacle.mesh(vertices, faces, check_crossings=check_crossings)
    except QuasirigidError as error:
        raise type(error)(f"{path}: {error}") from None


def _read_file(path: Path) -> tuple[Floats, Indices]:
    """Return vertices (n, 3) in the file's own unit and faces (m, 3), checked to be finite and in range."""
    if path.is_dir():
        raise MeshFileError(f"{path}: is a folder, expected a .ply, .stl or .obj file")
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        found = f"the ending is '{path.suffix}'" if path.suffix else "has no ending"
        hint = "; `read_hand` reads hands" if path.suffix.lower() in {".glb", ".gltf"} else ""
        raise MeshFileError(f"{path}: {found}, expected .ply, .stl or .obj{hint}")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MeshFileError(f"{path}: {error.strerror or error}") from None
    for start, ending in _STARTS.items():
        if data.startswith(start) and reader is not _READERS[ending]:
            raise MeshFileError(f"{path}: begins as a {ending} file, but is named {path.suffix}: rename it")
    with np.errstate(invalid="ignore"):  # a signalling nan of single precision warns where it is widened
        vertices, faces = reader(data, str(path))
    check_values(vertices, faces, str(path))
    return vertices, faces
