"""A small z-buffer in NumPy: which triangle each pixel of a parallel view shows, and where on it.

Pictures must come out on a bare machine with nothing but pip. VTK's wheel ends in a segmentation fault where
no OpenGL library is installed, so the drawing is done here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .._arrays import Floats, Indices

CHUNK = 4_000_000  # pairs of triangle and pixel examined together


@dataclass(frozen=True, kw_only=True)
class Frame:
    """What the covered pixels show.

    Attributes
    ----------
    pixel : (k,) int64
        Their numbers, row by row from the top.
    face : (k,) int64
        The triangle in front.
    weights : (k, 3) float64
        Barycentric coordinates on it.
    """

    pixel: Indices
    face: Indices
    weights: Floats

    def interpolate(self, faces: Indices, values: Floats) -> Floats:
        """Return per-vertex values (n,) or (n, j) at each covered pixel, (k,) or (k, j)."""
        corners = faces[self.face]
        picture: Floats = np.einsum("kc,kc...->k...", self.weights, values[corners])
        return picture


def rasterise(
    projected: Floats, faces: Indices, window: tuple[float, float, float, float], width: int, height: int
) -> Frame:
    """Draw triangles that face the viewer.

    Parameters
    ----------
    projected : (n, 3) float64
        Vertices as `View.project` returns them.
    faces : (m, 3) int64
        Counter-clockwise seen from outside; those turned away are left out.
    window : (left, right, bottom, top)
        Part of the picture plane to show, in the unit of `projected`.
    width, height : int
        Size in pixels.

    Returns
    -------
    Frame
        The covered pixels.
    """
    left, right, bottom, top = window
    # Pixel coordinates: pixel (row, column) has its middle at (column, row); rows count downwards.
    x = (projected[:, 0] - left) / (right - left) * width - 0.5
    y = (top - projected[:, 1]) / (top - bottom) * height - 0.5
    ax, bx, cx = (x[faces[:, corner]] for corner in range(3))
    ay, by, cy = (y[faces[:, corner]] for corner in range(3))
    # Twice the signed area; rows count downwards, so a triangle seen from outside has a negative one.
    doubled = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    first_column = np.clip(np.ceil(np.minimum(np.minimum(ax, bx), cx)), 0, width).astype(np.int64)
    last_column = np.clip(np.floor(np.maximum(np.maximum(ax, bx), cx)), -1, width - 1).astype(np.int64)
    first_row = np.clip(np.ceil(np.minimum(np.minimum(ay, by), cy)), 0, height).astype(np.int64)
    last_row = np.clip(np.floor(np.maximum(np.maximum(ay, by), cy)), -1, height - 1).astype(np.int64)
    columns = np.maximum(last_column - first_column + 1, 0)
    counts = np.where(doubled < 0.0, columns * np.maximum(last_row - first_row + 1, 0), 0)

    # Barycentric coordinates of the second and third corner are linear over the picture: their values
    # at the first pixel of the box around the triangle, and their growth by a column and by a row.
    divisor = np.where(doubled < 0.0, doubled, -1.0)
    by_column = np.stack([cy - ay, ay - by]) / divisor
    by_row = np.stack([ax - cx, bx - ax]) / divisor
    at_first = by_column * (first_column - ax) + by_row * (first_row - ay)

    seen = np.full(height * width, -1, dtype=np.int64)
    weights = np.zeros((height * width, 3))
    nearest = np.full(height * width, -np.inf)
    depths = projected[:, 2][faces].T
    drawn = np.flatnonzero(counts)
    batches = np.cumsum(counts[drawn]) // CHUNK
    for batch in np.unique(batches):
        part = drawn[batches == batch]
        times = counts[part]
        place = np.arange(times.sum()) - np.repeat(np.cumsum(times) - times, times)
        down, right_by = np.divmod(place, np.repeat(columns[part], times))
        second, third = (
            np.repeat(at_first[k, part], times)
            + np.repeat(by_column[k, part], times) * right_by
            + np.repeat(by_row[k, part], times) * down
            for k in range(2)
        )
        inside = np.flatnonzero((second >= -1e-9) & (third >= -1e-9) & (second + third <= 1.0 + 1e-9))
        face = np.repeat(part, times)[inside]
        second, third = second[inside], third[inside]
        pixel = (first_row[face] + down[inside]) * width + first_column[face] + right_by[inside]
        share = np.stack([1.0 - second - third, second, third])
        height_here = (depths[:, face] * share).sum(axis=0)
        front = np.flatnonzero(height_here > nearest[pixel])
        # Of several triangles on one pixel the last one written stays, so write the nearest last.
        front = front[np.argsort(height_here[front], kind="stable")]
        pixel = pixel[front]
        seen[pixel], weights[pixel], nearest[pixel] = face[front], share[:, front].T, height_here[front]
    covered = np.flatnonzero(seen >= 0)
    return Frame(pixel=covered, face=seen[covered], weights=weights[covered])
