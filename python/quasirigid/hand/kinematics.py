"""Where the joints are, once they have turned."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .._check import Refusal, as_vector, short
from .joints import DIGITS, JOINTS_OF
from .rays import way_out
from .rotations import Floats, to_matrices

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .hand import Hand

_ROTATION_TOLERANCE = 1e-9
_KNUCKLE = 1.25  # least depth of a knuckle below the back, over that of the next joint


def moved_by(parents: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which joints (J, J) each joint moves: itself and all that hang on it."""
    moved: NDArray[np.bool_] = np.eye(len(parents), dtype=bool)
    for joint in range(len(parents)):
        above = parents[joint]
        while above >= 0:
            moved[above, joint] = True
            above = parents[above]
    return moved


def shares_of(hand: Hand) -> Floats:
    """Return how much (n, J) each joint moves each vertex; sums are 1."""
    shares = np.zeros((len(hand.joints), len(hand.joint_names)))
    np.add.at(shares, (np.arange(len(shares))[:, None], hand.joints), hand.weights)
    shares /= shares.sum(axis=1, keepdims=True)
    return shares


def pivots_of(hand: Hand) -> Floats:
    """Return the points (J, 3) (m) about which the joints of a hand turn at rest.

    The joints themselves, but that rigs have those of digits at any depth below the back. Hinges turn where
    a digit that bends neither gains nor loses volume, at the middle of its section. Knuckles, whose heads
    are thicker and below which lies the palm, turn deeper below the back than the next joint.

    Skin that takes a share w of a small turn moves by w times axis cross (x - pivot), and the volume changes
    by the turn times axis . (∫ w x cross n dA - pivot cross ∫ w n dA).
    """
    pivots = hand.rest[:, :3, 3].copy()
    faces = hand.surface.faces
    corners = hand.surface.vertices[faces]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Integrals of w x over triangles on which w is linear, by its value at each corner, over their area.
    places = (corners.sum(axis=1, keepdims=True) + corners) / 12.0
    shares, moved = shares_of(hand), moved_by(hand.parents)
    for digit in DIGITS:
        for name in reversed(JOINTS_OF[digit][2:-1]):
            joint = hand.joint_names.index(name)
            axis, dorsal = hand.rest[joint, :3, 0], hand.rest[joint, :3, 2]
            share = (shares @ moved[joint])[faces]
            area = share.mean(axis=1) @ normals
            moment = np.cross(np.einsum("fc,fcx->fx", share, places), normals).sum(axis=0)
            gain = axis @ (moment - np.cross(pivots[joint], area))
            per_length = axis @ np.cross(dorsal, area)
            if per_length != 0.0:
                pivots[joint] += gain / per_length * dorsal
        next_depth = way_out(hand.surface, pivots[joint], dorsal)
        knuckle = hand.joint_names.index(JOINTS_OF[digit][1])
        dorsal = hand.rest[knuckle, :3, 2]
        depth = way_out(hand.surface, pivots[knuckle], dorsal)
        pivots[knuckle] -= max(_KNUCKLE * next_depth - depth, 0.0) * dorsal
    return pivots


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


def moved_frames(
    frames: Floats, rotation: ArrayLike | None, translation: ArrayLike, refusal: Refusal
) -> Floats:
    """Return frames (k, 4, 4) after a rotation (3, 3), or a motion (4, 4), and a translation (3,) (m)."""
    motion = np.eye(4)
    if rotation is not None:
        try:
            matrix = np.array(rotation, dtype=np.float64)
        except (TypeError, ValueError):
            matrix = np.empty(0)
        if matrix.shape == (4, 4) and (matrix[3] == [0.0, 0.0, 0.0, 1.0]).all():
            motion[:3, 3], matrix = as_vector("rotation[:3, 3]", matrix[:3, 3], refusal), matrix[:3, :3]
        is_rotation = (
            matrix.shape == (3, 3)
            and np.isfinite(matrix).all()
            and np.abs(matrix.T @ matrix - np.eye(3)).max() <= _ROTATION_TOLERANCE
            and np.linalg.det(matrix) > 0.0
        )
        if not is_rotation:
            raise refusal(
                f"rotation is {short(rotation)}, expected a (3, 3) rotation matrix or a (4, 4) rigid motion"
            )
        motion[:3, :3] = matrix
    motion[:3, 3] += as_vector("translation", translation, refusal)
    return motion @ frames


def mirrored_frames(frames: Floats) -> Floats:
    """Return the frames (k, 4, 4) of the mirror image in the plane x = 0.

    The axis of flexion changes sense once more, so that flexion stays a negative turn about it.
    """
    mirror = np.diag([-1.0, 1.0, 1.0, 1.0])
    return mirror @ frames @ mirror
