"""Where a way from inside the skin leaves it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..surface import Surface
    from .rotations import Floats


def way_out(surface: Surface, point: Floats, direction: Floats) -> float:
    """Return how far it is from a point along a unit direction to the skin (m); 0 where there is none.

    Triangles as by Moeller, Trumbore 1997, J. Graphics Tools 2(1), 21-28.
    """
    # Triangles far from the line are left out.
    away = surface.vertices - point
    beside = np.linalg.norm(away - np.outer(away @ direction, direction), axis=1)
    near = beside[surface.faces].min(axis=1) < 3.0 * surface.mean_edge_length
    corners = surface.vertices[surface.faces[near]]
    edges = corners[:, 1:] - corners[:, :1]
    across = np.cross(direction, edges[:, 1])
    size = (edges[:, 0] * across).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        start = point - corners[:, 0]
        first = (start * across).sum(axis=1) / size
        around = np.cross(start, edges[:, 0])
        second = around @ direction / size
        way = (edges[:, 1] * around).sum(axis=1) / size
        hit = (first >= 0.0) & (second >= 0.0) & (first + second <= 1.0) & (way > 0.0)
    return float(way[hit].min()) if hit.any() else 0.0
