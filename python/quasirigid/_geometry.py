"""Sides and normals of triangles, and distances to segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ._arrays import Floats, Indices

__all__ = ["distance_to_segment", "face_normals", "sides_of"]


def sides_of(faces: Indices) -> Indices:
    """Return both ends (3 m, 2) of each side of faces (m, 3), in the order of its face."""
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def face_normals(vertices: Floats, faces: Indices) -> Floats:
    """Return the normals (m, 3) of the faces, as long as twice their area."""
    corners = vertices[faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def distance_to_segment(points: Floats, start: Floats, end: Floats) -> Floats:
    """Return the distance (n,) of points (n, 3) to a segment."""
    along, way = end - start, points - start
    share = np.clip(way @ along / (along @ along), 0.0, 1.0)
    distance: Floats = np.linalg.norm(way - share[:, None] * along, axis=1)
    return distance
