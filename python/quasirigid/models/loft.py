"""Closed meshes from a stack of rings, as built-in fingers and round products are, and several joined."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from .._arrays import Floats, Indices
from ..errors import QuasirigidError

# Height of an equilateral triangle over its edge: strips of this height carry near-equilateral triangles.
ROW = 3.0**0.5 / 2.0


# More than any product needs, and a second's work.
MOST_VERTICES = 2_000_000

_CHORDS = 720  # that measure the length of a closed curve


def check_vertex_count(area: float, edge_length: float, refusal: type[QuasirigidError]) -> None:
    """Raise a `refusal` where a mesh of `area` (m²) would have more vertices than can be meant."""
    count = area / (ROW * edge_length**2)
    if not count <= MOST_VERTICES:
        raise refusal(
            f"edge_length is {edge_length} m, which makes some {count:.1e} vertices of {area:.3g} m², "
            f"expected at most {MOST_VERTICES:.0e}: raise it, or check that every length is in m"
        )


def rows_along(length: float, edge_length: float) -> int:
    """Return how many rows (at least 1) of equilateral triangles cover `length` (m)."""
    return max(1, round(length / (ROW * edge_length)))


def ring_size(perimeter: float, edge_length: float) -> int:
    """Return how many vertices (at least 5) a closed curve of `perimeter` (m) has at `edge_length` (m)."""
    return max(5, round(perimeter / edge_length))


def spread_on_curve(curve: Callable[[Floats], Floats], count: int, shifted: bool) -> Floats:
    """Return points at equal arc length on a closed curve.

    Parameters
    ----------
    curve : callable
        Maps angles (k,) in rad to points (k, 3) in m; periodic with 2 pi.
    count : int
        Number of points.
    shifted : bool
        Start half a spacing later, as every other row of a triangular grid does.

    Returns
    -------
    (count, 3) float64
        The points (m), each on the curve itself.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, _CHORDS + 1)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(curve(angles), axis=0), axis=1))])
    stations = (np.arange(count) + (0.5 if shifted else 0.0)) / count * way[-1]
    return curve(np.interp(stations, way, angles))


def perimeter(curve: Callable[[Floats], Floats]) -> float:
    """Return the length (m) of a closed curve that maps angles (k,) in rad to points (k, 3) in m."""
    points = curve(np.linspace(0.0, 2.0 * np.pi, _CHORDS + 1))
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def rings_on(outlines: Iterable[Callable[[Floats], Floats]], edge_length: float) -> list[Floats]:
    """Return rings for `loft` on closed curves, each as in `perimeter`, with edges near `edge_length` (m)."""
    return [
        spread_on_curve(outline, ring_size(perimeter(outline), edge_length), row % 2 == 1)
        for row, outline in enumerate(outlines)
    ]


def loft(rings: list[Floats], first_pole: Floats, last_pole: Floats) -> tuple[Floats, Indices]:
    """Join rings of any sizes, and a pole at either end, to a closed mesh.

    Rings have their points at equal steps, those of every odd ring (counted from 0) half a step further on.
    Between neighbours each edge of either ring gets a triangle whose tip is the vertex of the other ring
    nearest to the edge's middle, so rows of similar rings hold near-equilateral triangles.

    Parameters
    ----------
    rings : list of (k, 3) float64
        Points of each ring (m), counter-clockwise seen from the last pole back to the first.
    first_pole, last_pole : (3,) float64
        The points (m) that close the ends.

    Returns
    -------
    vertices : (n, 3) float64
        First pole, rings in order, last pole (m).
    faces : (m, 3) int64
        Counter-clockwise seen from outside.
    """
    sizes = np.array([len(ring) for ring in rings])
    starts = 1 + np.concatenate([[0], np.cumsum(sizes)])
    vertices = np.concatenate([first_pole[None], *rings, last_pole[None]])
    faces = [_fan(0, int(starts[0]), int(sizes[0]))[:, [0, 2, 1]]]
    for row in range(len(rings) - 1):
        strip_faces = _strip(int(sizes[row]), int(sizes[row + 1]), row % 2)
        # Local numbers run through this ring and on into the next one, as the vertices do.
        faces.append(strip_faces + starts[row])
    faces.append(_fan(len(vertices) - 1, int(starts[-2]), int(sizes[-1])))
    return vertices, np.concatenate(faces)


def joined(meshes: Sequence[tuple[Floats, Indices]]) -> tuple[Floats, Indices]:
    """Return vertices and faces of several meshes as one mesh, one after the other."""
    counts = [len(vertices) for vertices, _ in meshes]
    firsts = np.cumsum([0, *counts[:-1]])
    faces = [own + first for (_, own), first in zip(meshes, firsts, strict=True)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces)


def _fan(pole: int, start: int, size: int) -> Indices:
    around = np.arange(size)
    return np.stack([np.full(size, pole), start + around, start + (around + 1) % size], axis=1)


def _strip(lower: int, upper: int, shift: int) -> Indices:
    """Return triangles between rings of `lower` and `upper` points; `shift`: 1 when the lower one is odd.

    Middles of edges are compared as whole numbers, in units of a 2 * lower * upper-th of the turn, so that
    both rings agree on the order even where two middles coincide.
    """
    turn = 2 * lower * upper
    lower_middles = (2 * np.arange(lower) + 1 + shift) * upper
    upper_middles = (2 * np.arange(upper) + 1 + (1 - shift)) * lower
    unrolled_lower = np.concatenate([lower_middles - turn, lower_middles, lower_middles + turn])
    unrolled_upper = np.concatenate([upper_middles - turn, upper_middles, upper_middles + turn])
    above = np.searchsorted(unrolled_upper, lower_middles, side="left") % upper
    below = np.searchsorted(unrolled_lower, upper_middles, side="right") % lower
    low, up = np.arange(lower), np.arange(upper)
    from_lower = np.stack([low, (low + 1) % lower, lower + above], axis=1)
    from_upper = np.stack([lower + (up + 1) % upper, lower + up, below], axis=1)
    return np.concatenate([from_lower, from_upper])
