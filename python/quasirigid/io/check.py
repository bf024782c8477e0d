"""What the readers share: lines, checks of the values, fans, and the welding of equal points."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..errors import MeshFileError

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


def check_values(vertices: Floats, faces: Indices, name: str) -> None:
    """Raise `MeshFileError` where a coordinate is not finite or a face names a vertex that is not there."""
    if len(faces) == 0:
        raise MeshFileError(f"{name}: has {len(vertices)} vertices but no faces")
    wrong = np.flatnonzero(~np.isfinite(vertices).all(axis=1))
    if len(wrong):
        x, y, z = vertices[wrong[0]]
        raise MeshFileError(
            f"{name}: vertex {wrong[0]} is at ({x}, {y}, {z}), {_how_many(len(wrong), 'vertices')}"
        )
    wrong = np.flatnonzero(((faces < 0) | (faces >= len(vertices))).any(axis=1))
    if len(wrong):
        corners = faces[wrong[0]]
        vertex = corners[(corners < 0) | (corners >= len(vertices))][0]
        raise MeshFileError(
            f"{name}: face {wrong[0]} refers to vertex {vertex}, but the file has {len(vertices)} vertices,"
            f" {_how_many(len(wrong), 'faces')}"
        )


def _how_many(count: int, what: str) -> str:
    return "the only one" if count == 1 else f"{count} such {what} in all"


def lines_of(data: bytes) -> list[str]:
    """Return the lines of a text, whatever letters it holds."""
    # Bytes end a line at \n, \r and \r\n alone: decoded first, bytes of many a letter would too.
    return [line.decode("utf-8", "backslashreplace") for line in data.splitlines()]


def to_float(word: str) -> float:
    """Return a number as mesh files write it; Python's own `1_000` is none."""
    if "_" in word:
        raise ValueError(word)
    return float(word)


def to_int(word: str) -> int:
    """Return a whole number that 64 bits hold."""
    if "_" in word or not -(2**63) <= int(word) < 2**63:
        raise ValueError(word)
    return int(word)


def fans(corners: list[list[int]]) -> Indices:
    """Return faces of three or more corners as triangles from their first corner, in order."""
    triangles = [(face[0], second, third) for face in corners for second, third in pairwise(face[1:])]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def weld_equal(points: Floats, faces: Indices) -> tuple[Floats, Indices]:
    """Join points whose three coordinates are equal, keeping the order in which they first appear."""
    # Adding 0 turns -0 into 0, which is the same place.
    _, first, which = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[which.reshape(-1)][faces]
