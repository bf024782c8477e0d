"""Weights under which the creases of digits do not turn skin over."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .bend import RIGHT_ANGLE, Bend, moved_by
from .pose import bend_at_rest
from .rig.joints import DIGITS, JOINTS_OF

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .._arrays import Floats
    from .hand import Hand

_SLACK = 0.2  # of the growth that turns skin over: pivots are found anew after, and meshes are coarse
_ACROSS = 4.0  # times as much growth may there be across a bend, where none turns skin over
_OPPOSITE = np.linspace(0.0, 1.0, 5)  # places on the side opposite to a corner
_SPREAD = 0.01  # of the angle (rad) in a face, below which no bend turns it over
_SETTLED = 1e-5  # change of an angle (rad) that is none
_TINY = np.finfo(np.float64).tiny


def without_folds(hand: Hand, pivots: Floats, shares: Floats) -> Floats:
    """Return shares (n, J) by which no joint of a digit, bent by a right angle, turns skin over.

    The right angle is one from rest, or from straight where that is more. Joints bend one by one, and the
    knuckles of the fingers together.

    Skin at a distance y from the axis of a joint, on the side that it bends to, turns over where the angle
    grows by more than 1/y along the digit: where a rig's weights change too fast. There what moves with the
    joint grows as slowly as it must, as far before the rig's as behind it; all other weights are the rig's.
    """
    shares, moved = shares.copy(), moved_by(hand.parents)
    turns = RIGHT_ANGLE - np.minimum(bend_at_rest(hand), 0.0)
    chains = [[hand.joint_names.index(name) for name in JOINTS_OF[digit][1:-1]] for digit in DIGITS]
    for joints in ([chain[0] for chain in chains[1:]], *([joint] for chain in chains for joint in chain)):
        middle = joints[len(joints) // 2]
        slopes = _Slopes(hand, Bend.of(hand, middle, pivots[middle], turns[middle]))
        before = shares @ moved[joints].T
        _set_totals(shares, moved[joints], joints, hand.parents, before, slopes.limited(before))
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


class _Slopes:
    """How fast the angle of a bend may grow along the skin of a hand.

    A direction v along skin at an arm r from the axis a becomes v + (grad angle . v) a x r, turned. The skin
    turns over where the angle grows along t, the part of r x a in the skin, by more than 1 / |t|.
    """

    def __init__(self, hand: Hand, bend: Bend) -> None:
        self._bend, self._points, self._faces = bend, hand.surface.vertices, hand.surface.faces
        self._corners = np.ascontiguousarray(self._faces.T)
        self._most = np.empty((len(self._faces), 3, len(_OPPOSITE)))
        self._known = np.zeros(len(self._faces), dtype=bool)

    def limited(self, shares: Floats) -> Floats:
        """Return shares (n, k) of the bend whose angles, and that of their sum, grow slowly enough."""
        limited = np.stack([self._limited(share) for share in shares.T], axis=1)
        if shares.shape[1] > 1:
            total = limited.sum(axis=1)
            limited *= _over(self._limited(np.minimum(total, 1.0)), total)
        return limited

    def _limited(self, share: Floats) -> Floats:
        """Return the mean of the least share (n,) above and the greatest below that grow slowly enough.

        The bound is convex: a mean keeps it too. Where the share itself does, all of them are the same.
        """
        angle = self._bend.angle_of(share)
        mean = 0.5 * (self._above(angle, 1.0) - self._above(-angle, -1.0))
        return np.where(mean == angle, share, self._bend.share_of(mean))

    def _above(self, angle: Floats, way: float) -> Floats:
        """Return the least angle (n,) (rad) above that grows slowly enough along the bend (1) or back (-1).

        From a large one it falls as distances grow along the skin: an eikonal equation, solved by rounds.
        """
        angle = angle.copy()
        faces = np.flatnonzero(np.ptp(angle[self._corners], axis=0) > _SPREAD)
        while len(faces) > 0:
            values = angle[self._faces[faces]]
            first, second = (np.roll(values, -step, axis=1)[..., None] for step in (1, 2))
            most = way * self._most_of(faces)
            least = np.where(most > 0.0, first + _OPPOSITE * (second - first) - most, -np.inf).max(axis=2)
            before = angle.copy()
            np.maximum.at(angle, self._faces[faces], least)
            moved = (angle > before + _SETTLED)[self._corners]
            faces = np.flatnonzero(moved[0] | moved[1] | moved[2])
        return angle

    def _most_of(self, faces: NDArray[np.int64]) -> Floats:
        """Return by how much (k, 3, 5) (rad) the angle may grow from corners of faces to places opposite.

        Negative where the place lies behind the corner: by so much from there to the corner.
        """
        new = faces[~self._known[faces]]
        corner = self._points[self._faces[new]]
        first, second = (np.roll(corner, -step, axis=1) for step in (1, 2))
        span = (first - corner)[:, :, None] + _OPPOSITE[:, None] * (second - first)[:, :, None]
        normal = np.cross(span[:, 0, 0], second[:, 0] - corner[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), _TINY)[:, None]
        arm = np.cross(corner.mean(axis=1) - self._bend.pivot, self._bend.axis)
        arm -= (arm * normal).sum(axis=1)[:, None] * normal
        length = np.maximum(np.linalg.norm(arm, axis=1), _TINY)[:, None, None]
        along = np.einsum("fcpx,fx->fcp", span, arm) / length
        across = np.maximum((span * span).sum(axis=-1) - along * along, 0.0)
        size = np.sqrt(along * along + _ACROSS * _ACROSS * across)
        self._most[new], self._known[new] = np.copysign((1.0 - _SLACK) * size / length, along), True
        most: Floats = self._most[faces]
        return most
