"""What readers and writers share: lines, checks of the values, fans, and the welding of equal points."""

from __future__ import annotations

import codecs
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import Floats, Indices
from .._check import as_array
from ..errors import MeshFileError

_FLAT = 1e-12  # of a triangle's longest edge: one no higher has no area, as for the core
_FLOAT32_CHANGE = 1e-2  # of an edge: rounding moves its ends against each other by no more


def check_values(vertices: Floats, faces: Indices, name: str) -> None:
    """Raise `MeshFileError` where a coordinate is not finite or a face names a vertex that is not there."""
    if len(vertices) == 0 and len(faces) == 0:
        raise MeshFileError(f"{name}: has neither vertices nor faces: is it a mesh?")
    if len(faces) == 0:
        raise MeshFileError(f"{name}: has {len(vertices)} vertices but no faces, expected triangles")
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
            f"{name}: face {wrong[0]} refers to vertex {vertex}, but there are {len(vertices)} vertices,"
            f" {_how_many(len(wrong), 'faces')}"
        )


def check_float32(vertices: Floats, faces: Indices, name: str, advice: str) -> None:
    """Raise `MeshFileError` with an advice where float32 would turn or stretch an edge by more than 1 %."""
    with np.errstate(over="ignore", invalid="ignore"):
        rounding = vertices.astype(np.float32) - vertices
        after = faces[:, [1, 2, 0]]
        changes = np.linalg.norm(rounding[after] - rounding[faces], axis=2)
        lengths = np.linalg.norm(vertices[after] - vertices[faces], axis=2)
    # Of numbers that float32 does not hold the change is not finite.
    is_kept = np.isfinite(changes) & (changes <= _FLOAT32_CHANGE * lengths)
    wrong = np.flatnonzero(~is_kept.all(axis=1))
    if len(wrong):
        face = wrong[0]
        corner = vertices[faces[face, 0]]
        raise MeshFileError(
            f"{name}: face {face} at {tuple(corner.tolist())}, its shortest edge {lengths[face].min():.3g},"
            f" would lose its shape as float32, {_how_many(len(wrong), 'faces')}: {advice}"
        )


def triangle_rows(faces: Any) -> Indices:
    """Return triangles (m, 3); a ValueError of what has no three whole numbers a row."""
    rows = as_array("faces", faces)
    if rows.ndim != 2 or rows.shape[1] != 3 or rows.dtype.kind not in "iu":
        raise ValueError(f"has faces of {rows.dtype} and shape {rows.shape}, expected whole numbers (m, 3)")
    return rows.astype(np.int64)


def _how_many(count: int, what: str) -> str:
    return "the only one" if count == 1 else f"{count} such {what} in all"


def lines_of(data: bytes) -> list[str]:
    """Return the lines of a text, whatever letters it holds."""
    data = data.removeprefix(codecs.BOM_UTF8)
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


def fans(corners: list[list[int]], points: Floats, name: str) -> Indices:
    """Return faces of three or more corners as triangles from their first corner, in order.

    One that bends inwards, or has a triangle without area there, is cut ear by ear.
    """
    triangles = _fans(corners)
    counts = np.array([len(face) - 2 for face in corners], dtype=np.int64)
    is_known = ((triangles >= 0) & (triangles < len(points))).all(axis=1)
    if (counts <= 1).all() or not is_known.all():
        return triangles
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    is_folded, is_flat = _folded_and_flat(triangles, points, first)
    is_bad = np.logical_or.reduceat(is_folded | is_flat, first) & (counts > 1)
    for face in np.flatnonzero(is_bad):
        own, rows = corners[face], slice(first[face], first[face] + counts[face])
        ears = _ears(points[own])
        if ears is not None:
            triangles[rows] = np.array(own)[ears]
        elif is_folded[rows].any():
            raise MeshFileError(
                f"{name}: face {face} has {len(own)} corners and crosses itself: cut it into triangles"
            )
    return triangles


def _fans(corners: list[list[int]]) -> Indices:
    triangles = [(face[0], second, third) for face in corners for second, third in pairwise(face[1:])]
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _ears(points: Floats) -> Indices | None:
    """Return the triangles of a polygon (n, 3) in its own corners; None where it crosses itself.

    A corner on the line through its neighbours is left out first, as ears would leave triangles without area
    there; it then cuts in two the triangle on that line.
    """
    # Far from the origin, products of coordinates would lose the polygon.
    points = points - points[0]
    normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    # Seen along the largest component, as it turns counter-clockwise.
    axis = int(np.abs(normal).argmax())
    plane = np.roll(points, -1 - axis, axis=1)[:, :2] * [np.sign(normal[axis]), 1.0]

    def turn(a: Floats, b: Floats, c: Floats) -> Floats:
        ab, ac = b - a, c - a
        found: Floats = ab[..., 0] * ac[..., 1] - ab[..., 1] * ac[..., 0]
        return found

    def is_empty(triangle: Indices, rest: list[int]) -> bool:
        a, b, c = plane[triangle]
        others = plane[rest]
        others = others[~(others[:, None] == plane[triangle]).all(axis=2).any(axis=1)]
        sides = ((one, other, -_FLAT * ((other - one) ** 2).sum()) for one, other in ((a, b), (b, c), (c, a)))
        return not np.all([turn(one, other, others) >= least for one, other, least in sides], axis=0).any()

    left, ears, between = list(range(len(points))), [], []
    while len(left) > 3:
        around = np.stack([np.roll(left, 1), left, np.roll(left, -1)], axis=1)
        a, b, c = plane[around].swapaxes(0, 1)
        turns = turn(a, b, c)
        is_level = np.abs(turns) <= _FLAT * ((c - a) ** 2).sum(axis=1)
        is_between = is_level & (((b - a) * (c - b)).sum(axis=1) >= 0.0)
        if is_between.any():
            at = int(is_between.argmax())
            between.append(around[at].tolist())
        else:
            found = (int(k) for k in np.flatnonzero(turns > 0.0) if is_empty(around[k], left))
            at = next(found, -1)
            if at < 0:
                return None
            ears.append(around[at].tolist())
        del left[at]
    if turn(*plane[left]) < 0.0:
        return None
    return _cut_between([*ears, left], between)


def _cut_between(triangles: list[list[int]], between: list[list[int]]) -> Indices:
    """Return triangles with corners put into their edges, the last first: each between two others."""
    for start, middle, end in reversed(between):
        for at, (a, b, c) in enumerate(triangles):
            if (start, end) in ((a, b), (b, c), (c, a)):
                third = a + b + c - start - end
                triangles[at] = [start, middle, third]
                triangles.append([middle, end, third])
                break
    return np.array(triangles, dtype=np.int64)


def _folded_and_flat(
    triangles: Indices, points: Floats, first: Indices
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which triangles face away from the face, and which lack area; face k's begin at `first[k]`."""
    corners = points[triangles]
    a, b, c = corners.swapaxes(0, 1)
    areas = np.cross(b - a, c - a)
    whole = np.add.reduceat(areas, first)
    counts = np.diff(np.append(first, len(triangles)))
    is_folded = (areas * np.repeat(whole, counts, axis=0)).sum(axis=1) < 0.0
    longest = ((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2).max(axis=1)
    return is_folded, np.linalg.norm(areas, axis=1) <= _FLAT * longest


def weld_equal(points: Floats) -> tuple[Indices, Indices]:
    """Return the first (k,) of the points at each place, in their order, and of each point its place (n,)."""
    # Adding 0 turns -0 into 0, which is the same place.
    _, first, which = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return first[order], rank[which.reshape(-1)]
