"""Edges and neighbours of a closed triangle mesh, in whole-array operations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..._arrays import Indices

__all__ = ["Edges", "best_of_all", "edges_of", "neighbours", "pairs_of"]


@dataclass(frozen=True)
class Edges:
    """Edges of a closed mesh, each with its two faces; `keys` ascend."""

    ends: Indices  # (k, 2), the smaller number first
    faces: Indices  # (k, 2)
    across: Indices  # (k, 2): the third corner of either face
    forward: NDArray[np.bool_]  # (k,): the first face runs along `ends`
    keys: Indices  # (k,)
    count: int  # of vertices

    def has(self, one: Indices, other: Indices) -> NDArray[np.bool_]:
        """Return whether pairs of vertices are joined by an edge."""
        wanted = np.minimum(one, other) * self.count + np.maximum(one, other)
        place = np.minimum(np.searchsorted(self.keys, wanted), len(self.keys) - 1)
        found: NDArray[np.bool_] = self.keys[place] == wanted
        return found


def edges_of(faces: Indices, count: int) -> Edges:
    """Return the edges of a closed mesh of `count` vertices."""
    starts, ends = faces.T.ravel(), np.roll(faces, -1, axis=1).T.ravel()
    across = np.roll(faces, -2, axis=1).T.ravel()
    keys = np.minimum(starts, ends) * count + np.maximum(starts, ends)
    order = np.sort(np.argsort(keys).reshape(-1, 2), axis=1)
    first = order[:, 0]
    low, high = np.minimum(starts[first], ends[first]), np.maximum(starts[first], ends[first])
    return Edges(
        np.stack([low, high], axis=1),
        order % len(faces),
        across[order],
        starts[first] == low,
        keys[first],
        count,
    )


def neighbours(edges: Edges) -> tuple[Indices, Indices]:
    """Return where each vertex's neighbours begin (n + 1,) and the neighbours in one row."""
    both = np.concatenate([edges.ends, edges.ends[:, ::-1]])
    order = np.argsort(both[:, 0], kind="stable")
    starts = np.searchsorted(both[order, 0], np.arange(edges.count + 1))
    return starts, both[order, 1]


def pairs_of(starts: Indices, items: Indices, vertices: Indices) -> tuple[Indices, Indices]:
    """Return (row of `vertices`, item) for all items of the vertices' lists."""
    sizes = starts[vertices + 1] - starts[vertices]
    rows = np.repeat(np.arange(len(vertices)), sizes)
    offsets = np.arange(len(rows)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    return rows, items[starts[vertices][rows] + offsets]


def best_of_all(places: Indices, ranks: Indices, count: int) -> Indices:
    """Return the least of the ranks (k,) at each of `count` places; `places` is (k, any number)."""
    best = np.full(count, np.iinfo(np.int64).max)
    for column in places.T:
        np.minimum.at(best, column, ranks)
    return best
