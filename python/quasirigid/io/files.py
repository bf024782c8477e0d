"""Strict readers of PLY, STL and OBJ: everything that a file says about its triangles, or a named error.

Own readers, for the general ones mend in silence: trimesh 5.2 leaves out OBJ faces of two corners and points
that no face uses, puts PLY triangles before quads, takes an ASCII PLY that ends early for a shorter one, and
gives an empty scene for an STL that was cut off.
"""

from __future__ import annotations

from pathlib import Path

from ..errors import MeshFileError
from .check import Floats, Indices, check_values
from .obj import read_obj
from .ply import read_ply
from .stl import read_stl

__all__ = ["read_file"]

_READERS = {".ply": read_ply, ".stl": read_stl, ".obj": read_obj}


def read_file(path: Path) -> tuple[Floats, Indices]:
    """Vertices (n, 3) in the file's own unit and faces (m, 3), checked to be finite and in range."""
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise MeshFileError(f"{path}: the ending is '{path.suffix}', expected .ply, .stl or .obj")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise MeshFileError(f"{path}: {error.strerror or error}") from None
    vertices, faces = reader(data, str(path))
    check_values(vertices, faces, str(path))
    return vertices, faces
