"""Weights under which the creases of digits do not turn skin over."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bend import RIGHT_ANGLE, Bend, moved_by, shares_of
from .joints import DIGITS, JOINTS_OF
from .pose import bend_at_rest

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .hand import Hand
    from .rotations import Floats

_MOST_ROUNDS = 60
_PATIENCE = 4  # rounds before one ring of faces more is smoothed
_BORDER = 8  # rings of faces around those over which a joint's share changes


def without_folds(hand: Hand, pivots: Floats) -> tuple[NDArray[np.int64], Floats]:
    """Return joints and weights (n, k) by which no hinge of a digit, bent by a right angle, turns skin over.

    The right angle is one from rest, or from straight where that is more.

    Skin at a distance y from the axis of a joint, on the side that it bends to, turns over where the angle
    grows by more than 1/y along the digit: where a rig's weights change too fast. There they are smoothed
    along the skin, round by round as far as it takes; all others are the rig's.
    """
    shares, moved = shares_of(hand), moved_by(hand.parents)
    turns = RIGHT_ANGLE - np.minimum(bend_at_rest(hand), 0.0)
    for digit in DIGITS:
        for name in JOINTS_OF[digit][2:-1]:
            joint = hand.joint_names.index(name)
            bend = Bend.of(hand, joint, pivots[joint], turns[joint])
            _smooth(hand, shares, moved[joint], bend)
    most = np.count_nonzero(shares, axis=1).max()
    joints = np.argpartition(-shares, most - 1, axis=1)[:, :most]
    return joints, np.take_along_axis(shares, joints, axis=1)


def _smooth(hand: Hand, shares: Floats, moved: NDArray[np.bool_], bend: Bend) -> None:
    """Smooth shares (n, J) in place where faces turn over as the joints `moved` bend as one."""
    faces, points = hand.surface.faces, hand.surface.vertices
    share = shares @ moved
    of_face = share[faces]
    hinge = faces[of_face.max(axis=1) > of_face.min(axis=1)]
    if not _turns_over(bend, points[hinge], share[hinge]).any():
        return
    rows = np.zeros(len(shares), dtype=bool)
    rows[hinge] = True
    _grow(rows, faces, _BORDER)
    part = _Part(faces[rows[faces].all(axis=1)])
    corners = points[part.vertices][part.faces]
    columns = np.flatnonzero(shares[part.vertices].any(axis=0))
    local = shares[np.ix_(part.vertices, columns)]
    for round_ in range(_MOST_ROUNDS):
        over = _turns_over(bend, corners, (local @ moved[columns])[part.faces])
        if not over.any():
            break
        rings = 1 + round_ // _PATIENCE
        near = np.zeros(len(local), dtype=bool)
        near[part.faces[over]] = True
        _grow(near, part.faces, rings + 1)
        part.smooth(local, near, rings)
    shares[np.ix_(part.vertices, columns)] = local


def _turns_over(bend: Bend, corners: Floats, share: Floats) -> NDArray[np.bool_]:
    """Return which faces (k, 3, 3) look the other way after shares (k, 3) of the turn."""
    at_rest = bend.turned(_normals(corners), share.mean(axis=1))
    over: NDArray[np.bool_] = (at_rest * _normals(bend.moved(corners, share))).sum(axis=1) < 0.0
    return over


class _Part:
    """Some faces of a skin, and which of its vertices are neighbours there."""

    def __init__(self, faces: NDArray[np.int64]) -> None:
        self.vertices, local = np.unique(faces, return_inverse=True)
        self.faces = local.reshape(-1, 3)
        sides = np.concatenate([self.faces[:, [0, 1]], self.faces[:, [1, 2]], self.faces[:, [2, 0]]])
        sides = np.concatenate([sides, sides[:, ::-1]]) @ [len(self.vertices), 1]
        self._of, self._neighbours = np.divmod(np.unique(sides), len(self.vertices))
        self._counts = np.bincount(self._of)

    def smooth(self, values: Floats, chosen: NDArray[np.bool_], times: int) -> None:
        """Move values (n, k) of some vertices half of the way to the means of their neighbours'."""
        neighbours = self._neighbours[chosen[self._of]]
        counts = self._counts[chosen]
        firsts = np.cumsum(counts) - counts
        for _ in range(times):
            means = np.add.reduceat(values[neighbours], firsts) / counts[:, None]
            values[chosen] = 0.5 * (values[chosen] + means)


def _grow(chosen: NDArray[np.bool_], faces: NDArray[np.int64], rings: int) -> None:
    """Choose as well the vertices of so many rings of faces around those chosen."""
    for _ in range(rings):
        chosen[faces[chosen[faces].any(axis=1)]] = True


def _normals(corners: Floats) -> Floats:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
