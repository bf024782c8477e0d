"""Where the joints are, once they have turned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..._arrays import Floats
from ..._check import as_vector, reals_or_empty, short
from ...errors import HandError
from .rotations import to_matrices

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_ROTATION_TOLERANCE = 1e-9


def motions_of(
    rest: Floats, pivots: Floats, parents: NDArray[np.int64], turns: Floats, placed: Floats
) -> tuple[Floats, Floats]:
    """Return the motion of each joint (J, 4, 4) from rest, and its frame (J, 4, 4) (m).

    Parameters
    ----------
    rest : (J, 4, 4) float64
        Frames at rest (m).
    pivots : (J, 3) float64
        The points about which they turn there (m).
    parents : (J,) int64
        -1 for the root.
    turns : (J, 4) float64
        Turn of each joint in its frame at rest.
    placed : (4, 4) float64
        Motion of the whole hand.
    """
    about = rest.copy()
    about[:, :3, 3] = pivots
    turned = np.tile(np.eye(4), (len(rest), 1, 1))
    turned[:, :3, :3] = to_matrices(turns)
    # The motion that a joint alone would make, from rest.
    own = about @ turned @ inverse_motions(about)
    own[(turns[:, :3] == 0.0).all(axis=1)] = np.eye(4)
    motions = np.empty_like(own)
    done = np.zeros(len(rest), dtype=bool)

    def finish(joint: int) -> Floats:
        if not done[joint]:
            before = finish(int(parents[joint])) if parents[joint] >= 0 else placed
            motions[joint], done[joint] = before @ own[joint], True
        motion: Floats = motions[joint]
        return motion

    for joint in range(len(rest)):
        finish(joint)
    return motions, motions @ rest


def inverse_motions(motions: Floats) -> Floats:
    """Return the inverse of rigid motions (k, 4, 4)."""
    inverse = np.tile(np.eye(4), (len(motions), 1, 1))
    inverse[:, :3, :3] = motions[:, :3, :3].transpose(0, 2, 1)
    inverse[:, :3, 3] = -np.einsum("kij,kj->ki", inverse[:, :3, :3], motions[:, :3, 3])
    return inverse


def rigid_motion(rotation: ArrayLike | None, translation: ArrayLike | None) -> Floats:
    """Return the motion (4, 4) of a rotation (3, 3) and a translation (3,) (m), or of a motion (4, 4).

    Raises
    ------
    TypeError
        If both a motion and a translation are given.
    HandError
        If what is given is no rotation or no translation.
    """
    motion = np.eye(4)
    if rotation is not None:
        matrix = reals_or_empty(rotation)
        if matrix.shape == (4, 4) and (matrix[3] == [0.0, 0.0, 0.0, 1.0]).all():
            if translation is not None:
                raise TypeError(
                    "`rotation` has shape (4, 4) and holds a translation: leave out `translation`"
                )
            motion[:3, 3], matrix = as_vector("rotation[:3, 3]", matrix[:3, 3], HandError), matrix[:3, :3]
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
            raise HandError(
                f"rotation is {short(rotation)}, expected a (3, 3) rotation matrix or a (4, 4) rigid motion,"
                " of finite numbers"
            )
        deviation = np.abs(matrix.T @ matrix - np.eye(3)).max()
        if deviation > _ROTATION_TOLERANCE:
            raise HandError(
                f"rotation must be orthonormal to {_ROTATION_TOLERANCE:g}, but |R'R - I| reaches"
                f" {deviation:.3g}"
            )
        determinant = np.linalg.det(matrix)
        if determinant < 0.0:
            raise HandError(f"rotation is a reflection (determinant {determinant:.3g})")
        motion[:3, :3] = matrix
    if translation is not None:
        motion[:3, 3] = as_vector("translation", translation, HandError)
    return motion


def mirrored_frames(frames: Floats) -> Floats:
    """Return the frames (k, 4, 4) of the mirror image in the plane x = 0.

    The axis of flexion changes sense once more, so that flexion stays a negative turn about it.
    """
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    return mirror @ frames @ mirror
