"""Skin that follows the bend of one joint in shares."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .._arrays import Floats

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .hand import Hand

RIGHT_ANGLE = 0.5 * math.pi


class Bend(NamedTuple):
    """A turn by an angle (rad) about an axis (3,) through a pivot (3,) (m)."""

    pivot: Floats
    axis: Floats
    angle: float

    @classmethod
    def of(cls, hand: Hand, joint: int, pivot: Floats, angle: float = RIGHT_ANGLE) -> Bend:
        """Return the flexion of a joint of a hand at rest."""
        return cls(pivot, -hand.rest[joint, :3, 0], angle)

    def moved(self, points: Floats, share: Floats) -> Floats:
        """Return where points (..., 3) go that take shares (...) of the turn."""
        return self.pivot + self.turned(points - self.pivot, share)

    def turned(self, vectors: Floats, share: Floats) -> Floats:
        """Return vectors (..., 3) after shares (...) of the turn, blended as dual quaternions."""
        angle = self.angle_of(share)[..., None]
        along = (vectors @ self.axis)[..., None] * self.axis
        turned: Floats = (
            along + np.cos(angle) * (vectors - along) + np.sin(angle) * np.cross(self.axis, vectors)
        )
        return turned

    def angle_of(self, share: Floats) -> Floats:
        """Return the angles (...) (rad) of shares (...) of the turn, blended as dual quaternions."""
        half = 0.5 * self.angle
        angle: Floats = 2.0 * np.arctan2(share * math.sin(half), 1.0 - share + share * math.cos(half))
        return angle

    def share_of(self, angle: Floats) -> Floats:
        """Return the shares (...) of the turn that angles (...) (rad) are."""
        done, left = np.sin(0.5 * angle), np.sin(0.5 * (self.angle - angle))
        share: Floats = done / (done + left)
        return share


def moved_by(parents: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which joints (J, J) each joint moves: itself and all that hang on it."""
    moved: NDArray[np.bool_] = np.eye(len(parents), dtype=bool)
    for joint in range(len(parents)):
        above = parents[joint]
        while above >= 0:
            moved[above, joint] = True
            above = parents[above]
    return moved


def by_joint(joints: NDArray[np.int64], weights: Floats, count: int) -> Floats:
    """Return weights (n, k) of some joints (n, k) as those (n, count) of all."""
    table = np.zeros((len(joints), count))
    np.add.at(table, (np.arange(len(joints))[:, None], joints), weights)
    return table


def shares_of(hand: Hand) -> Floats:
    """Return how much (n, J) each joint moves each vertex; sums are 1."""
    shares = by_joint(hand.joints, hand.weights, len(hand.joint_names))
    shares /= shares.sum(axis=1, keepdims=True)
    return shares
