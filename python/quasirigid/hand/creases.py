"""Weights under which the creases of digits do not turn skin over."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .._sides import sides_of
from .bend import RIGHT_ANGLE, Bend, moved_by
from .pose import bend_at_rest
from .regions import digit_of_vertices
from .rig.joints import DIGITS, JOINTS_OF

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from .._arrays import Floats
    from .hand import Hand

_MOST_ROUNDS = 60
_VAIN_ROUNDS = 10  # after which no more faces are won back
_PATIENCE = 4  # rounds before one ring of faces more is smoothed
_SPREAD = 0.01  # of the shares at the corners of a face, below which no bend turns it over
_OTHERS = 0.1  # share of other joints from which skin is left to them
_BORDER = 8  # rings of faces around those over which a joint's share changes


def without_folds(hand: Hand, pivots: Floats, shares: Floats) -> Floats:
    """Return shares (n, J) by which no joint of a digit, bent by a right angle, turns skin over.

    The right angle is one from rest, or from straight where that is more. Joints bend one by one, and the
    knuckles of the fingers together.

    Skin at a distance y from the axis of a joint, on the side that it bends to, turns over where the angle
    grows by more than 1/y along the digit: where a rig's weights change too fast. There what moves with the
    joint is smoothed along the skin, round by round as far as it takes; all other weights are the rig's.
    """
    shares, moved, on = shares.copy(), moved_by(hand.parents), digit_of_vertices(hand.regions)
    turns = RIGHT_ANGLE - np.minimum(bend_at_rest(hand), 0.0)

    def smooth(digits: Sequence[str], links: list[tuple[int, int]]) -> None:
        joints, following = (list(column) for column in zip(*links, strict=True))
        middle = joints[len(joints) // 2]
        bend = Bend.of(hand, middle, pivots[middle], turns[middle])
        # What bends with the next joint, and other digits, go with this one as they did.
        kept = ((shares @ moved[following].T).max(axis=1) > _OTHERS) | ~np.isin(on, [*digits, "palm"])
        before = shares @ moved[joints].T
        _set_totals(shares, moved[joints], joints, hand.parents, before, _smoothed(hand, before, bend, kept))

    chains = {
        digit: list(pairwise(hand.joint_names.index(name) for name in JOINTS_OF[digit][1:]))
        for digit in DIGITS
    }
    for _ in range(2):
        smooth(DIGITS[1:], [chains[digit][0] for digit in DIGITS[1:]])
        for digit, chain in chains.items():
            for link in chain:
                smooth([digit], [link])
    return shares


def _set_totals(
    shares: Floats,
    moved: NDArray[np.bool_],
    joints: list[int],
    parents: NDArray[np.int64],
    before: Floats,
    after: Floats,
) -> None:
    """Change shares (n, J) in place such that those moved (k, J) by each joint sum to `after` (n, k).

    Where none move with a joint, its own does; where all did, the parent of the first takes the rest.
    """
    rows = np.flatnonzero((after != before).any(axis=1))
    changed, before, after = shares[rows], before[rows], after[rows]
    others = ~moved.any(axis=0)
    rest, left = changed[:, others].sum(axis=1), 1.0 - after.sum(axis=1)
    changed[:, others] *= _over(left, rest)
    changed[:, parents[joints[0]]] += np.where(rest == 0.0, left, 0.0)
    for joint, own, was, now in zip(joints, moved, before.T, after.T, strict=True):
        changed[:, own] *= _over(now, was)
        changed[:, joint] += np.where(was == 0.0, now, 0.0)
    shares[rows] = changed


def _over(new: Floats, old: Floats) -> Floats:
    """Return factors (n, 1) from old to new; 0 where there is nothing."""
    return (np.where(old == 0.0, 0.0, new) / np.where(old == 0.0, 1.0, old))[:, None]


def _smoothed(hand: Hand, shares: Floats, bend: Bend, kept: NDArray[np.bool_]) -> Floats:
    """Return shares (n, k) of a bend, smoothed where faces turn over by their sums; those kept (n,) stay."""
    faces, points = hand.surface.faces, hand.surface.vertices
    first, second, third = (total := shares.sum(axis=1))[faces.T]
    spread = np.maximum(np.maximum(first, second), third) - np.minimum(np.minimum(first, second), third)
    hinge = faces[spread > _SPREAD]
    if not _turns_over(bend, points[hinge], total[hinge]).any():
        return shares
    rows = np.zeros(len(shares), dtype=bool)
    rows[hinge] = True
    _grow(rows, faces, _BORDER)
    part = _Part(faces[rows[faces].all(axis=1)])
    corners, local = points[part.vertices][part.faces], shares[part.vertices]
    over = np.zeros(len(corners), dtype=bool)
    changed, fewest, since = np.arange(len(corners)), len(corners) + 1, 0
    for round_ in range(_MOST_ROUNDS):
        over[changed] = _turns_over(bend, corners[changed], local.sum(axis=1)[part.faces[changed]])
        count = int(np.count_nonzero(over))
        fewest, since = (count, 0) if count < fewest else (fewest, since + 1)
        if count == 0 or since == _VAIN_ROUNDS:
            break
        rings = 1 + round_ // _PATIENCE
        near = np.zeros(len(local), dtype=bool)
        near[part.faces[over]] = True
        _grow(near, part.faces, rings + 1)
        near &= ~kept[part.vertices]
        part.smooth(local, near, rings)
        changed = np.flatnonzero(_touching(near, part.faces))
    smoothed = shares.copy()
    smoothed[part.vertices] = local
    return smoothed


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
        sides = sides_of(self.faces)
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
        chosen[faces[_touching(chosen, faces)]] = True


def _touching(chosen: NDArray[np.bool_], faces: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which faces (m, 3) have some corner among those chosen (n,)."""
    first, second, third = faces.T
    touching: NDArray[np.bool_] = chosen[first] | chosen[second] | chosen[third]
    return touching


def _normals(corners: Floats) -> Floats:
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
