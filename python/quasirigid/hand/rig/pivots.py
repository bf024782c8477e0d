"""The points about which the joints of digits turn."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..._geometry import sides_of
from ..bend import Bend, moved_by
from ..regions import digit_of_vertices
from .joints import DIGITS, JOINTS_OF

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from ..._arrays import Floats
    from ..hand import Hand

_SECANTS = 3  # the gain of volume is linear in the depth but for some per cent
_FARTHEST = 0.5  # of the length of its bone: how far a pivot may lie from the joint


def pivots_of(hand: Hand, shares: Floats) -> Floats:
    """Return the points (J, 3) (m) about which the joints of a hand turn at rest.

    shares : (n, J) float64
        How much each joint moves each vertex.

    The joints themselves, but that rigs have those of digits at any depth below the back, where a bend gains
    or loses volume: those turn at the depth at which a bend by a right angle keeps that of the digit.
    """
    pivots = hand.rest[:, :3, 3].copy()
    moved, digits = moved_by(hand.parents), digit_of_vertices(hand.regions)
    for digit in DIGITS:
        joints = [hand.joint_names.index(name) for name in JOINTS_OF[digit][1:]]
        skin = _Digit(hand, digits == digit)
        for joint, following in pairwise(joints):
            bone = np.linalg.norm(pivots[following] - pivots[joint])
            pivots[joint] = skin.pivot(joint, shares @ moved[joint], _FARTHEST * float(bone))
    return pivots


class _Digit:
    """The skin of a digit, closed at its root by a fan."""

    def __init__(self, hand: Hand, own: NDArray[np.bool_]) -> None:
        faces = hand.surface.faces[own[hand.surface.faces].all(axis=1)]
        self._hand = hand
        self._vertices, local = np.unique(faces, return_inverse=True)
        self._faces = local.reshape(-1, 3)
        sides = sides_of(self._faces)
        forth, back = (sides @ order for order in ([len(own), 1], [1, len(own)]))
        self._rim = np.unique(sides[~np.isin(forth, back)])
        self._at_rest = hand.surface.vertices[self._vertices]

    def pivot(self, joint: int, share: Floats, farthest: float) -> Floats:
        """Return the point (3,) (m), above or below a joint, about which it bends without gain of volume.

        share : (n,) float64
            How much of its turn each vertex of the hand takes.
        farthest : float
            From the joint (m).
        """
        place, dorsal = self._hand.rest[joint, :3, 3], self._hand.rest[joint, :3, 2]
        if len(self._rim) == 0:
            return place
        own, before = share[self._vertices], self._volume(self._at_rest)

        def gain(raised: float) -> float:
            bend = Bend.of(self._hand, joint, place + raised * dorsal)
            return self._volume(bend.moved(self._at_rest, own)) - before

        return place + _zero_of(gain, farthest) * dorsal

    def _volume(self, points: Floats) -> float:
        # The fan's own cones have no height above its middle.
        corners = (points - points[self._rim].mean(axis=0))[self._faces]
        return float(np.linalg.det(corners).sum() / 6.0)


def _zero_of(gain: Callable[[float], float], farthest: float) -> float:
    """Return where a function that is almost linear vanishes, from -farthest to farthest, by secants."""
    last, at = 0.0, 0.1 * farthest
    before = gain(last)
    for _ in range(_SECANTS):
        now = gain(at)
        if now == before:
            return last
        step = now * (at - last) / (now - before)
        last, at, before = at, min(max(at - step, -farthest), farthest), now
    return at
