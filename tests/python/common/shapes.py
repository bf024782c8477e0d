"""Small meshes with known properties, a plate and a skin, shared by the tests."""

from __future__ import annotations

import numpy as np
import quasirigid as qr
from numpy.typing import NDArray

# For what is said of one mesh, or of matrices on it.
AS_GIVEN = qr.ContactOptions(target_error=None)
SKIN = qr.Skin(shear_modulus=60e3, poisson_ratio=0.5, response=qr.HalfSpace())
PLATE = qr.Obstacle.half_space([0, 0, 0], [0, 0, 1])
TURN = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])

Mesh = tuple[NDArray[np.float64], NDArray[np.int64]]


def tetrahedron() -> Mesh:
    """Corner of the unit cube: volume 1/6."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return corners, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def grid(cells: int, spacing: float) -> Mesh:
    """Flat open square about the origin, normals to +z, diagonals alternating."""
    x = (np.arange(cells + 1) - cells / 2) * spacing
    points = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((cells + 1, cells + 1))], axis=-1)
    index = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    even = (np.add.outer(np.arange(cells), np.arange(cells)) % 2 == 0)[..., None]
    first = np.where(even, np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(even, np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return points.reshape(-1, 3), np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def slab(top: Mesh, thickness: float) -> Mesh:
    """Closed mesh from an open one, seen from +z, down to a plane below it; the top comes first."""
    points, faces = top
    ground = points.copy()
    ground[:, 2] = points[:, 2].min() - thickness
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, number, count = np.unique(np.sort(edges), axis=0, return_inverse=True, return_counts=True)
    a, b = edges[count[number.ravel()] == 1].T
    below = len(points)
    sides = [np.stack([b, a, a + below], -1), np.stack([b, a + below, b + below], -1)]
    return np.concatenate([points, ground]), np.concatenate([faces, faces[:, ::-1] + below, *sides])


def ball(radius: float, subdivisions: int) -> Mesh:
    """Icosphere whose lowest point is near the origin."""
    g = (1 + 5**0.5) / 2
    corners = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g)]
    corners += [(0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    vertices = [np.array(corner) / np.linalg.norm(corner) for corner in corners]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4)]
    faces += [(11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8)]
    faces += [(3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(subdivisions):
        middles: dict[tuple[int, int], int] = {}

        def middle(a: int, b: int, middles: dict[tuple[int, int], int] = middles) -> int:
            edge = (min(a, b), max(a, b))
            if edge not in middles:
                point = vertices[a] + vertices[b]
                vertices.append(point / np.linalg.norm(point))
                middles[edge] = len(vertices) - 1
            return middles[edge]

        finer = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return np.array(vertices) * radius + [0, 0, radius], np.array(faces)
