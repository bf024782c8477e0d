"""A tetrahedron in the formats of mesh files."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import quasirigid as qr

POINTS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
PLY_HEADER = (
    "ply\nformat {order} 1.0\ncomment unit cube corner\nelement vertex {vertices}\nproperty float x\n"
    "property float y\nproperty float z\nelement face {faces}\nproperty list uchar int vertex_indices\n"
    "end_header\n"
)


def ply_text(rows: list[str], vertices: int = 4, faces: int = 4) -> bytes:
    return (
        PLY_HEADER.format(order="ascii", vertices=vertices, faces=faces) + "\n".join(rows) + "\n"
    ).encode()


def good_ply_rows() -> list[str]:
    return [f"{x} {y} {z}" for x, y, z in POINTS] + [f"3 {a} {b} {c}" for a, b, c in FACES]


def stl_text(faces: list[tuple[int, int, int]]) -> str:
    facets = [
        "  facet normal 0 0 0\n    outer loop\n"
        + "".join("      vertex {} {} {}\n".format(*POINTS[corner]) for corner in face)
        + "    endloop\n  endfacet\n"
        for face in faces
    ]
    return "solid corner of a box\n" + "".join(facets) + "endsolid corner of a box\n"


def stl_bytes(faces: list[tuple[int, int, int]], header: bytes = b"solid or not") -> bytes:
    rows = [
        struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in POINTS[corner]), 0) for face in faces
    ]
    return header.ljust(80, b"\0") + struct.pack("<I", len(faces)) + b"".join(rows)


def obj_text() -> str:
    lines = ["# a corner", "o corner", *(f"v {x} {y} {z}" for x, y, z in POINTS)]
    return "\n".join([*lines, *(f"f {a + 1}/1 {b + 1}//2 {c + 1}/1/2" for a, b, c in FACES)]) + "\n"


def read(folder: Path, name: str, content: bytes | str) -> tuple[np.ndarray, np.ndarray]:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return qr.read_mesh(path, unit="m")
