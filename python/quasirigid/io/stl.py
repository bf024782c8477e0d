"""STL, ASCII and binary. The format lists loose triangles, so equal points are joined."""

from __future__ import annotations

import numpy as np

from .._arrays import Floats, Indices
from ..errors import MeshFileError
from .check import lines_of, to_float, weld_equal

_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(data: bytes, name: str) -> tuple[Floats, Indices]:
    """Return vertices (n, 3), equal ones joined, and faces (m, 3), as in the file; normals are not read."""
    promised = int(np.frombuffer(data, "<u4", 1, 80)[0]) if len(data) >= 84 else -1
    # Binary files may start with "solid" too, so the length decides.
    if promised >= 0 and len(data) == 84 + _ROW.itemsize * promised:
        corners = np.frombuffer(data, _ROW, promised, 84)["corners"].astype(np.float64)
    elif data.lstrip()[:5].lower() == b"solid" and b"\0" not in data[:512]:
        corners = _ascii(data, name)
    elif promised < 0:
        raise MeshFileError(f"{name}: is {len(data)} bytes long, too short for an STL file")
    else:
        raise MeshFileError(
            f"{name}: is {len(data)} bytes long, but its header promises {promised} triangles,"
            f" {84 + _ROW.itemsize * promised} bytes"
        )
    points = corners.reshape(-1, 3)
    kept, number = weld_equal(points)
    return points[kept], number.reshape(-1, 3)


def _ascii(data: bytes, name: str) -> Floats:
    expected = ("facet", "outer", "vertex", "vertex", "vertex", "endloop", "endfacet")
    corners: list[tuple[float, float, float]] = []
    step = 0
    open_solid = False
    number = 0
    for number, line in enumerate(lines_of(data), start=1):
        words = line.split()
        if not words:
            continue
        word = words[0].lower()
        if step == 0 and word in ("solid", "endsolid") and open_solid == (word == "endsolid"):
            open_solid = word == "solid"
            continue
        if not open_solid or word != expected[step]:
            wanted = expected[step] if open_solid else "solid"
            raise MeshFileError(f"{name}: line {number} is '{line.strip()[:60]}', expected '{wanted}'")
        if word == "vertex":
            try:
                x, y, z = (to_float(value) for value in words[1:])
            except ValueError:
                raise MeshFileError(
                    f"{name}: line {number} is '{line.strip()[:60]}', expected 3 numbers"
                ) from None
            corners.append((x, y, z))
        step = (step + 1) % len(expected)
    if open_solid:
        raise MeshFileError(
            f"{name}: ends after line {number} without 'endsolid' ({len(corners) // 3} triangles)"
        )
    return np.array(corners, dtype=np.float64).reshape(-1, 3, 3)


def stl_bytes(points: Floats, faces: Indices, unit: str) -> bytes:
    """Return a binary STL, normals left 0, with the unit in its header."""
    triangles = np.zeros(len(faces), dtype=_ROW)
    triangles["corners"] = points[faces]
    return f"units: {unit}".encode().ljust(80) + len(faces).to_bytes(4, "little") + triangles.tobytes()
