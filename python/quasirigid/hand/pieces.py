"""Regions of a mesh that hang together."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._geometry import sides_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


def in_one_piece(faces: NDArray[np.int64], labels: NDArray[np.str_]) -> NDArray[np.str_]:
    """Return labels (n,) of which each holds its largest connected piece alone.

    Another piece takes the label that most of its edges to such largest pieces lead to, and becomes part of
    them; pieces among other pieces alone follow when those have.
    """
    words, label = np.unique(labels, return_inverse=True)
    edges = sides_of(faces)
    while True:
        piece = _pieces(edges, label)
        size = np.bincount(piece, minlength=len(label))
        largest = np.zeros(len(words), dtype=np.int64)
        np.maximum.at(largest, label, size[piece])
        # Of two as large, the one found first.
        first = np.full(len(words), len(label))
        is_largest = size[piece] == largest[label]
        np.minimum.at(first, label[is_largest], piece[is_largest])
        is_loose = piece != first[label]
        leaving = edges[is_loose[edges[:, 0]] & ~is_loose[edges[:, 1]]]
        if not len(leaving):
            break
        pairs, counts = np.unique(
            np.column_stack([piece[leaving[:, 0]], label[leaving[:, 1]]]), axis=0, return_counts=True
        )
        taken = label.copy()
        order = np.lexsort((counts, pairs[:, 0]))
        target = dict(zip(pairs[order, 0].tolist(), pairs[order, 1].tolist(), strict=True))
        for number, wanted in target.items():
            taken[piece == number] = wanted
        label = taken
    return words[label]


def largest_piece(faces: NDArray[np.int64], chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the largest connected piece (n,) of some vertices."""
    piece = np.where(chosen, _pieces(sides_of(faces), chosen.astype(np.int64)), len(chosen))
    largest: NDArray[np.bool_] = chosen & (piece == np.bincount(piece)[: len(chosen)].argmax())
    return largest


def _pieces(edges: NDArray[np.int64], label: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the lowest vertex (n,) that each vertex hangs together with through its own label."""
    inner = edges[label[edges[:, 0]] == label[edges[:, 1]]]
    lowest = np.arange(len(label))
    while True:
        before = lowest.copy()
        least = np.minimum(lowest[inner[:, 0]], lowest[inner[:, 1]])
        for end in (0, 1):
            np.minimum.at(lowest, lowest[inner[:, end]], least)
            np.minimum.at(lowest, inner[:, end], least)
        lowest = lowest[lowest]
        if (lowest == before).all():
            return lowest
