"""Closed meshes of implicit bodies from a grid: one vertex a crossed cell, one quadrangle a crossed edge.

These are the surface nets of Gibson 1998 ("Constrained elastic surface nets", MICCAI), with one flat cut.
They are closed and oriented, and manifold where no cell is crossed by two sheets: where a grid that grazes a
saddle sees two, the value nearest to 0 changes its sign.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..._arrays import Floats, Indices

__all__ = ["Distance", "contour"]

_Kind = TypeVar("_Kind", bound=np.generic)
Distance = Callable[[Floats], Floats]
COARSE = 4  # cells of the fine grid per cell of the grid that finds where the surface is


def contour(
    distance: Distance, low: Floats, high: Floats, step: float, cut: float
) -> tuple[Floats, Indices, NDArray[np.bool_]]:
    """Return the surface of a body within a box, its cut at y = `cut` included.

    Parameters
    ----------
    distance : callable
        Maps points (n, 3) in m to an approximate distance (n,) in m, negative inside.
    low, high : (3,) float64
        Corners of the box (m); the body must end inside it, but for the cut.
    step : float
        Edge of the grid's cells (m).
    cut : float
        Where the body ends towards -y (m).

    Returns
    -------
    vertices : (n, 3) float64
        Points (m) near the surface.
    faces : (m, 3) int64
        Counter-clockwise seen from outside.
    on_cut : (m,) bool
        Faces of the flat cut.
    """
    # The first layer lies behind the cut, the second half a cell before it.
    origin = np.array([low[0], cut - 0.5 * step, low[2]])
    shape = COARSE * np.ceil((high - origin) / (COARSE * step)).astype(np.int64) + 1
    values = _sample(distance, origin, shape, step)
    values[:, 0] = 1.0
    _part_sheets(values)
    inside = values < 0.0
    cells = shape - 1
    numbers = np.full(cells, -1)
    crossed = _crossed(inside)
    numbers[tuple(crossed.T)] = np.arange(len(crossed))
    vertices = origin + step * (crossed + _middles(values, crossed))
    vertices[crossed[:, 1] == 0, 1] = cut
    quads, on_cut = [], []
    for axis in range(3):
        found, turned = _quads(inside, numbers, axis)
        quads += [found[:, ::-1][turned], found[~turned]]
        flat = np.zeros(len(found), dtype=bool)
        if axis == 1:
            # The body lies before the first layer, so these edges lead inwards.
            flat = (crossed[found, 1] == 0).all(axis=1)
        on_cut += [flat[turned], flat[~turned]]
    return vertices, *_halved(vertices, np.concatenate(quads), np.concatenate(on_cut))


def _sample(distance: Distance, origin: Floats, shape: Indices, step: float) -> Floats:
    """Return the distance over the step at the grid's points; far from the surface its sign alone."""
    blocks = (shape - 1) // COARSE
    corners = origin + COARSE * step * np.argwhere(np.ones(blocks + 1, dtype=bool))
    coarse = distance(corners).reshape(blocks + 1)
    # Within a cell no point is farther from its nearest corner than 0.87 of its edge.
    near = np.zeros(blocks, dtype=bool)
    for corner in np.ndindex(2, 2, 2):
        near |= np.abs(_corner(coarse, corner)) < 1.2 * COARSE * step
    spread = np.ones((COARSE,) * 3)
    values = np.pad(np.kron(np.sign(coarse[:-1, :-1, :-1]), spread), ((0, 1),) * 3, mode="edge")
    fine = np.argwhere(np.pad(np.kron(near, spread) > 0.0, ((0, 1),) * 3, mode="edge"))
    values[tuple(fine.T)] = distance(origin + step * fine) / step
    return values


def _corner(values: NDArray[_Kind], corner: tuple[int, ...]) -> NDArray[_Kind]:
    """Return, for every cell, the value at one of its corners."""
    return values[
        tuple(slice(place, size - 1 + place) for place, size in zip(corner, values.shape, strict=True))
    ]


def _part_sheets(values: Floats) -> None:
    """Change, in place, the values nearest to 0 of cells whose corners alternate."""
    for _ in range(12):
        inside = values < 0.0
        nodes = []
        for axis in range(3):
            across = np.eye(3, dtype=np.int64)[[place for place in range(3) if place != axis]]
            face = np.array([(0, 0, 0), across[0], across[0] + across[1], across[1]])
            size = np.array(values.shape) - across.sum(axis=0)
            views = [
                inside[tuple(slice(c, c + n) for c, n in zip(corner, size, strict=True))] for corner in face
            ]
            found = np.argwhere((views[0] == views[2]) & (views[1] == views[3]) & (views[0] != views[1]))
            nodes.append((found[:, None] + face).reshape(-1, 4, 3))
        cube = np.array(list(np.ndindex(2, 2, 2)))
        views = [_corner(inside, tuple(corner)) for corner in cube]
        count = np.sum(views, axis=0, dtype=np.int8)
        found = np.zeros(count.shape, dtype=bool)
        for one in range(4):
            found |= (views[one] == views[7 - one]) & (count == np.where(views[one], 2, 6))
        whole = np.argwhere(found)
        lists = [*nodes, (whole[:, None] + cube).reshape(-1, 8, 3)]
        if not any(len(group) for group in lists):
            return
        for group in lists:
            sizes = np.abs(values[tuple(np.moveaxis(group, 2, 0))])
            least = group[np.arange(len(group)), sizes.argmin(axis=1)] if len(group) else group[:, 0]
            flipped = np.unique(least, axis=0)
            at = tuple(flipped.T)
            values[at] = np.where(values[at] < 0.0, 1e-3, -1e-3)


def _crossed(inside: NDArray[np.bool_]) -> Indices:
    """Return the cells (n, 3) with corners on both sides."""
    count = np.zeros(np.array(inside.shape) - 1, dtype=np.int8)
    for corner in np.ndindex(2, 2, 2):
        count += _corner(inside, corner)
    return np.argwhere((count > 0) & (count < 8))


def _middles(values: Floats, cells: Indices) -> Floats:
    """Return the mean place (n, 3), in cells, of where the edges of cells cross the surface."""
    total, count = np.zeros((len(cells), 3)), np.zeros(len(cells))
    for axis in range(3):
        for one in np.ndindex(2, 2, 2):
            if one[axis] == 1:
                continue
            other = tuple(1 if place == axis else value for place, value in enumerate(one))
            start, end = values[tuple((cells + one).T)], values[tuple((cells + other).T)]
            cut = (start < 0.0) != (end < 0.0)
            share = start[cut] / (start[cut] - end[cut])
            total[cut] += one
            total[cut, axis] += share
            count[cut] += 1.0
    middles: Floats = total / count[:, None]
    return middles


def _quads(inside: NDArray[np.bool_], numbers: Indices, axis: int) -> tuple[Indices, NDArray[np.bool_]]:
    """Return the cells (m, 4) around each crossed edge along an axis, and where the edge leads inwards."""
    size = inside.shape
    start = tuple(
        slice(0, size[place] - 1) if place == axis else slice(1, size[place] - 1) for place in range(3)
    )
    end = tuple(slice(1, size[place]) if place == axis else slice(1, size[place] - 1) for place in range(3))
    lead_out, lead_in = inside[start] & ~inside[end], ~inside[start] & inside[end]
    edges = np.argwhere(lead_out | lead_in)
    turned = lead_in[tuple(edges.T)]
    # Across the axis nodes are counted from the second: cells of that number and the next touch the edge.
    across = [(axis + 1) % 3, (axis + 2) % 3]
    corners = []
    for first, second in ((0, 0), (1, 0), (1, 1), (0, 1)):
        cell = edges.copy()
        cell[:, across[0]] += first
        cell[:, across[1]] += second
        corners.append(numbers[tuple(cell.T)])
    return np.stack(corners, axis=1), turned


def _halved(vertices: Floats, quads: Indices, tags: NDArray[np.bool_]) -> tuple[Indices, NDArray[np.bool_]]:
    """Return two triangles a quadrangle, cut along its shorter diagonal."""
    places = vertices[quads]
    other = np.linalg.norm(places[:, 0] - places[:, 2], axis=1) > np.linalg.norm(
        places[:, 1] - places[:, 3], axis=1
    )
    quads = np.where(other[:, None], np.roll(quads, -1, axis=1), quads)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), np.concatenate([tags, tags])
