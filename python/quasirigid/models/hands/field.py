"""Pieces that implicit surfaces are made of: approximate distances (m), negative inside, smooth joins."""

from __future__ import annotations

import numpy as np

from ..._arrays import Floats
from ..._geometry import distance_to_segment

__all__ = ["ellipsoid", "sheet", "smooth_union", "superellipse"]


def smooth_union(one: Floats, other: Floats, blend: float) -> Floats:
    """Return the union of two bodies, its groove filled where they differ by less than `blend` (m)."""
    overlap = np.maximum(blend - np.abs(one - other), 0.0)
    return np.minimum(one, other) - overlap**2 / (4.0 * blend)


def superellipse(parts: tuple[Floats, ...], radii: tuple[Floats | float, ...], exponent: float) -> Floats:
    """Return the distance (m), to first order, to where the `parts` (place over radius) have the norm 1."""
    sizes = [np.abs(part) for part in parts]
    level = sum(size**exponent for size in sizes) ** (1.0 / exponent)
    level = np.maximum(level, 1e-9)
    squares = [
        ((size / level) ** (exponent - 1.0) / radius) ** 2 for size, radius in zip(sizes, radii, strict=True)
    ]
    distance: Floats = (level - 1.0) / np.sqrt(sum(squares))
    return distance


def ellipsoid(points: Floats, middle: Floats, axes: Floats, radii: Floats) -> Floats:
    """Return the distance (m), to first order, to an ellipsoid with its axes in the columns of `axes`."""
    x, y, z = (axes / radii).T @ (points - middle).T
    level = np.sqrt(x**2 + y**2 + z**2)
    steepness = np.sqrt((x / radii[0]) ** 2 + (y / radii[1]) ** 2 + (z / radii[2]) ** 2)
    distance: Floats = level * (level - 1.0) / np.maximum(steepness, 1e-9)
    return distance


def sheet(points: Floats, corners: Floats, thickness: float) -> Floats:
    """Return the distance (m) to a triangle (3, 3) thickened by `thickness` on all sides."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    inside = np.ones(len(points), dtype=bool)
    nearest = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        nearest = np.minimum(nearest, distance_to_segment(points, start, end))
        inside &= (points - start) @ np.cross(normal, end - start) >= 0.0
    return np.where(inside, np.abs((points - a) @ normal), nearest) - thickness
