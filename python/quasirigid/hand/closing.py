"""Digits on their ways from one pose to another."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .joints import DIGIT_OF, DIGITS
from .pose import turns_of
from .regions import digit_of_vertices
from .rotations import Floats, between

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..obstacle import Obstacle
    from .hand import Hand
    from .pose import Pose
    from .posed import PosedHand

__all__ = ["Closing"]

_TOUCHES = 1e-4  # m, of a hand of 0.19 m: so near a digit has come to the product
_LEAST_STEP = 1e-3  # m, of that hand
_REACH = 2e-2  # m, of that hand: farther away a digit does not look
_OPENING = 2e-3  # m, of that hand: a step of a digit that opens
_SAMPLES = 6  # of a way, to see how fast a digit goes
_SPARE = 1.1  # between them it may be faster
_HAND_LENGTH = 0.19


class Closing:
    """A hand between two poses: each digit has gone a share of its own way, from 0 to 1.

    Where the product stands in a digit at the start, that one opens first: shares from 0 to -1 lead from the
    start to the pose "open".

    Attributes
    ----------
    parts : (n,) str
        The digit of each vertex of the skin, ``"palm"`` for the rest.
    vertices : tuple of (k,) int64
        The vertices of each digit.
    speeds : (5,) float64
        Bound on how far a digit's skin moves per unit of its share (m).
    scale : float
        Length of the hand over 0.19 m.
    reach : float
        How far a digit looks for the product (m).
    """

    def __init__(
        self, hand: Hand, start: Pose, end: Pose, rotation: ArrayLike | None, translation: ArrayLike
    ) -> None:
        self._hand, self._rotation, self._translation = hand, rotation, translation
        self._open, self._first, self._last = (turns_of(pose, hand) for pose in ("open", start, end))
        self._digit = np.array(
            [DIGITS.index(DIGIT_OF[name]) if name in DIGIT_OF else -1 for name in hand.joint_names]
        )
        self.parts = digit_of_vertices(hand)
        self.vertices = tuple(np.flatnonzero(self.parts == digit) for digit in DIGITS)
        self.scale = hand.length / _HAND_LENGTH
        self.reach = _REACH * self.scale
        self.speeds = self._speeds()

    def pose(self, shares: Floats) -> Floats:
        """Return the turns (J, 4) where each of the five digits has gone its share."""
        # The last entry is for joints of no digit, which stay.
        share = np.append(shares, 0.0)[self._digit]
        closing = share[:, None] >= 0.0
        return between(self._first, np.where(closing, self._last, self._open), np.abs(share[:, None]))

    def posed(self, shares: Floats) -> PosedHand:
        """Return the hand there."""
        return self._hand.posed(self.pose(shares), rotation=self._rotation, translation=self._translation)

    def distances(self, shares: Floats, obstacle: Obstacle, reach: float | None = None) -> Floats:
        """Return the least signed distance (5,) (m) of each digit's vertices to the product.

        Beyond `reach` (m) it is not searched, and `reach` itself.
        """
        vertices = self.posed(shares).surface.vertices
        found = obstacle.signed_distance(vertices[np.concatenate(self.vertices)], reach)[0]
        ends = np.cumsum([len(one) for one in self.vertices])[:-1]
        farthest = np.inf if reach is None else reach
        return np.array([one.min(initial=farthest) for one in np.split(found, ends)])

    def first_touch(self, obstacle: Obstacle, moving: NDArray[np.bool_]) -> Floats:
        """Return the shares (5,) at which the moving digits come to the product, 1 where they do not.

        No digit goes on by more than the product is away: it cannot step over it.
        """
        moving = moving & (self.speeds > 0.0)
        shares = self._opened(obstacle, moving)
        while moving.any():
            distance = self.distances(shares, obstacle, self.reach)
            moving &= distance > _TOUCHES * self.scale
            ways = np.maximum(distance, _LEAST_STEP * self.scale)
            steps = np.divide(ways, self.speeds, out=np.zeros_like(ways), where=moving)
            shares = np.minimum(shares + steps, 1.0)
            moving &= shares < 1.0
        return shares

    def _opened(self, obstacle: Obstacle, moving: NDArray[np.bool_]) -> Floats:
        """Return the shares (5,) from -1 to 0, the largest found at which no digit that moves is met."""
        shares = np.zeros(len(DIGITS))
        while True:
            met = moving & (shares > -1.0) & (self.distances(shares, obstacle, self.scale * _TOUCHES) <= 0.0)
            if not met.any():
                return shares
            steps = np.divide(_OPENING * self.scale, self.speeds, out=np.zeros(len(DIGITS)), where=met)
            shares = np.maximum(shares - steps, -1.0)

    def _speeds(self) -> Floats:
        """Return how far (5,) each digit's skin moves at the most per unit of its share (m)."""
        shares = np.arange(-_SAMPLES, _SAMPLES + 1) / _SAMPLES
        places = [self.posed(np.full(len(DIGITS), share)).surface.vertices for share in shares]
        ways = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=0) * _SAMPLES
        return np.array([_SPARE * ways[vertices].max(initial=0.0) for vertices in self.vertices])
