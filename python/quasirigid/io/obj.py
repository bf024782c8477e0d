"""Wavefront OBJ: points and faces; texture, normals, groups and materials are not read."""

from __future__ import annotations

import numpy as np

from .._arrays import Floats, Indices
from ..errors import MeshFileError
from .check import fans, lines_of, to_float, to_int, weld_equal

_FREE_FORM = {"vp", "cstype", "curv", "curv2", "surf"}


def read_obj(data: bytes, name: str) -> tuple[Floats, Indices]:
    """Return vertices (n, 3), equal ones joined, and faces (m, 3); larger faces become fans."""
    points: list[tuple[float, float, float]] = []
    faces: list[list[int]] = []
    text = data.replace(b"\\\r\n", b"  ").replace(b"\\\n", b" ")
    for number, line in enumerate(lines_of(text), start=1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        here = f"{name}: line {number} ('{line.strip()[:60]}')"
        if words[0] == "v":
            try:
                x, y, z = (to_float(word) for word in words[1:4])
            except ValueError:
                raise MeshFileError(f"{here}: expected 3 coordinates") from None
            points.append((x, y, z))
        elif words[0] == "f":
            if len(words) < 4:
                raise MeshFileError(
                    f"{here}: face {len(faces)} has {len(words) - 1} corners, expected at least 3"
                )
            faces.append([_corner(word, len(points), here) for word in words[1:]])
        elif words[0] in _FREE_FORM:
            raise MeshFileError(f"{here}: free-form curves and surfaces are not read, only points and faces")
    wrong = [corner for face in faces for corner in face if corner >= len(points)]
    if wrong:
        raise MeshFileError(
            f"{name}: a face refers to vertex {wrong[0] + 1}, but the file has {len(points)} vertices"
        )
    vertices = np.array(points, dtype=np.float64).reshape(-1, 3)
    kept, place = weld_equal(vertices)
    return vertices[kept], place[fans(faces, vertices, name)]


def _corner(word: str, known: int, here: str) -> int:
    """Return the number of a vertex, counted from 0: files count from 1, or back from the last one read."""
    try:
        index = to_int(word.split("/")[0])
    except ValueError:
        raise MeshFileError(f"{here}: '{word}' names no vertex") from None
    corner = index - 1 if index > 0 else known + index
    if index == 0 or corner < 0:
        raise MeshFileError(f"{here}: refers to vertex {index}, but {known} vertices were given before it")
    return corner
