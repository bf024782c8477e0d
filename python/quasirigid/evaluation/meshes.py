"""Meshes and products of the reference problems."""

from __future__ import annotations

import numpy as np

from .._arrays import Floats, Indices
from ..obstacle import Obstacle
from ..surface import Surface

__all__ = ["ball", "cone", "lattice", "lattice_faces"]


def lattice_faces(columns: int, rows: int) -> Indices:
    """Return two triangles a cell of a lattice of ``columns x rows`` cells, all cut by the same diagonal."""
    index = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]))
    return np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def lattice(columns: int, rows: int, edges: Floats) -> tuple[Floats, Indices]:
    """Return places (n, 2) in m and faces of parallelograms about the origin, of those sides (2, 2) in m."""
    i, j = np.meshgrid(np.arange(columns + 1) - columns / 2, np.arange(rows + 1) - rows / 2, indexing="ij")
    places: Floats = i.reshape(-1, 1) * edges[0] + j.reshape(-1, 1) * edges[1]
    return places, lattice_faces(columns, rows)


def ball(radius: float, subdivisions: int, draw: float = 1.0) -> Surface:
    """Return an icosphere about the origin (radius in m), `draw` times finer at its lowest point."""
    g = (1 + 5**0.5) / 2
    corners: list[tuple[float, float, float]] = []
    corners += [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    corners += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    points = [np.array(corner) / np.linalg.norm(corner) for corner in corners]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2)]
    faces += [(10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5)]
    faces += [(2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles: dict[tuple[int, int], int] = {}
        finer = []
        for a, b, c in faces:
            for one, other in ((a, b), (b, c), (c, a)):
                edge = (min(one, other), max(one, other))
                if edge not in middles:
                    middles[edge] = len(points)
                    middle = points[one] + points[other]
                    points.append(middle / np.linalg.norm(middle))
            ab, bc, ca = (middles[(min(end), max(end))] for end in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    x, y, z = np.array(points).T
    polar = 2 * np.arctan(np.tan(0.5 * np.arctan2(np.hypot(x, y), -z)) / draw)
    around = np.arctan2(y, x)
    drawn = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), -np.cos(polar)], 1)
    return Surface(radius * drawn, np.array(faces))


def cone(radius: float, height: float, sides: int) -> Obstacle:
    """Return a pyramid of many sides, its point at the origin and its base (radius in m) at z = `height`."""
    around = np.arange(sides) / sides * 2 * np.pi
    rim = np.column_stack([radius * np.cos(around), radius * np.sin(around), np.full(sides, height)])
    vertices = np.vstack([[0.0, 0.0, 0.0], [0.0, 0.0, height], rim])
    here, after = 2 + np.arange(sides), 2 + np.roll(np.arange(sides), -1)
    mantle = np.stack([np.zeros(sides, dtype=np.int64), after, here], 1)
    base = np.stack([np.ones(sides, dtype=np.int64), here, after], 1)
    return Obstacle.mesh(vertices, np.concatenate([mantle, base]), check_crossings=False)
