"""Rotations as unit quaternions (x, y, z, w), in rows, and as matrices."""

from __future__ import annotations

import numpy as np

from ..._arrays import Floats


def about(axis: int, angle: Floats) -> Floats:
    """Return the turns (k, 4) by angles (k,) (rad) about a coordinate axis."""
    turn = np.zeros((len(angle), 4))
    turn[:, axis], turn[:, 3] = np.sin(0.5 * angle), np.cos(0.5 * angle)
    return turn


def product(first: Floats, second: Floats) -> Floats:
    """Return the turns (k, 4) by `second` and then by `first`, row by row."""
    a, b = first[:, :3], second[:, :3]
    v, w = first[:, 3:], second[:, 3:]
    return np.hstack([v * b + w * a + np.cross(a, b), v * w - (a * b).sum(axis=1, keepdims=True)])


def from_vectors(vectors: Floats) -> Floats:
    """Return the turns (k, 4) about the axes and by the lengths (rad) of vectors (k, 3)."""
    angle = np.linalg.norm(vectors, axis=1)
    # sin(a/2)/a, 1/2 in the limit.
    factor = 0.5 * np.sinc(0.5 * angle / np.pi)
    return np.column_stack([factor[:, None] * vectors, np.cos(0.5 * angle)])


def to_matrices(turns: Floats) -> Floats:
    """Return the matrices (k, 3, 3) of turns (k, 4)."""
    x, y, z, w = turns.T
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    ).transpose(2, 0, 1)


def nearest_rotations(matrices: Floats) -> tuple[Floats, Floats]:
    """Return the orthogonal matrices (k, 3, 3) nearest to some, and the largest |R'R - I| (k,) of each given.

    That is not finite where an entry is not; the identity stands there for the nearest.
    """
    excess: Floats = np.abs(matrices.transpose(0, 2, 1) @ matrices - np.eye(3)).max(axis=(1, 2))
    left, _, right = np.linalg.svd(np.where(np.isfinite(excess)[:, None, None], matrices, np.eye(3)))
    return left @ right, excess


def between(first: Floats, second: Floats, share: float) -> Floats:
    """Return the turns (k, 4) so far on the shorter way from `first` to `second`."""
    cosine = (first * second).sum(axis=1, keepdims=True)
    second = np.where(cosine < 0.0, -second, second)
    angle = np.arccos(np.clip(np.abs(cosine), 0.0, 1.0))
    # sin(t a)/sin(a), t in the limit.
    weight = [s * np.sinc(s * angle / np.pi) / np.sinc(angle / np.pi) for s in (1.0 - share, share)]
    mixed: Floats = weight[0] * first + weight[1] * second
    mixed /= np.linalg.norm(mixed, axis=1, keepdims=True)
    return mixed
