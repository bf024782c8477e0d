"""Digits on their ways from one pose to another."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..._arrays import Floats
from ..pose import turns_of
from ..regions import digit_of_vertices
from ..rig.joints import DIGIT_OF, DIGITS, REFERENCE_LENGTH
from ..rig.kinematics import motions_of, rigid_motion
from ..rig.rotations import between

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ...obstacle import Obstacle
    from ..hand import Hand
    from ..pose import Pose
    from ..posed import PosedHand

__all__ = ["Closing"]

_TOUCHES = 1e-4  # m, of a hand of REFERENCE_LENGTH: so near a digit has come to the product
_LEAST_STEP = 1e-3  # m, of that hand
_REACH = 2e-2  # m, of that hand: farther away a digit does not look
_OPENING = 2e-3  # m, of that hand: a step of a digit that opens
_LEAD_OUT = 5e-4  # m, of that hand: a digit that opens all the way and comes out by less opens in vain
_SAMPLES = 6  # of a way, to see how fast a digit goes
_SPARE = 1.1  # between them it may be faster


class Closing:
    """A hand between two poses: each digit has gone a share of its own way, from 0 to 1.

    Where the product stands in a digit at the start, that one opens first, if that leads it out: shares from
    0 to -1 lead from the start to the pose "open".

    Attributes
    ----------
    parts : (n,) str
        The digit of each vertex of the skin, ``"palm"`` for the rest.
    digits : (n,) int64
        Its place in DIGITS, and 5.
    vertices : tuple of (k,) int64
        The vertices of each digit.
    speeds : tuple of (k,) float64
        Bound on how far each of these moves per unit of its digit's share (m).
    scale : float
        Length of the hand over REFERENCE_LENGTH.
    reach : float
        How far a digit looks for the product (m).
    mesh_width : float
        What all vertices of a digit are farther from than this lies between none of them either (m).
    """

    def __init__(
        self,
        hand: Hand,
        start: Pose,
        end: Pose,
        rotation: ArrayLike | None,
        translation: ArrayLike | None,
    ) -> None:
        self._hand = hand
        self._placed = rigid_motion(rotation, translation)
        self._open, self._first, self._last = (turns_of(pose, hand) for pose in ("open", start, end))
        self._digit = np.array(
            [DIGITS.index(DIGIT_OF[name]) if name in DIGIT_OF else -1 for name in hand.joint_names]
        )
        self.parts = digit_of_vertices(hand.regions)
        self.digits = np.full(len(self.parts), len(DIGITS))
        for at, digit in enumerate(DIGITS):
            self.digits[self.parts == digit] = at
        self.vertices = tuple(np.flatnonzero(self.digits == at) for at in range(len(DIGITS)))
        self.scale = hand.length / REFERENCE_LENGTH
        self.reach = _REACH * self.scale
        self.mesh_width = self._mesh_width()
        self._posed: tuple[Floats, PosedHand] | None = None
        self.speeds = self._bounds()

    def pose(self, shares: Floats) -> Floats:
        """Return the turns (J, 4) where each of the five digits has gone its share."""
        # The last entry is for joints of no digit, which stay.
        share = np.append(shares, 0.0)[self._digit]
        closing = share[:, None] >= 0.0
        return between(self._first, np.where(closing, self._last, self._open), np.abs(share[:, None]))

    def posed(self, shares: Floats) -> PosedHand:
        """Return the hand there."""
        if self._posed is None or not np.array_equal(self._posed[0], shares):
            self._posed = (shares.copy(), self._hand.posed(self.pose(shares), rotation=self._placed))
        return self._posed[1]

    def places(self, shares: Floats) -> Floats:
        """Return where the vertices (n, 3) (m) of the hand are there."""
        hand, turns = self._hand, turns_of(self.pose(shares), self._hand)
        motions, _ = motions_of(hand.rest, hand._pivots, hand.parents, turns, self._placed)
        return hand._influence.moved(hand.surface, motions)

    def look(
        self, shares: Floats, obstacle: Obstacle, digits: NDArray[np.bool_], *, least: float
    ) -> tuple[Floats, Floats]:
        """Return how near some digits are to the product, and how far they may go on.

        Parameters
        ----------
        shares : (5,) float64
            Where the digits are.
        obstacle : Obstacle
            The product.
        digits : (5,) bool
            Which digits.
        least : float
            So much a vertex may go on at once, however near the product's surface is (m).

        Returns
        -------
        distances : (5,) float64
            Least signed distance of a digit's vertices to the product (m), at the most `reach`.
        steps : (5,) float64
            By how much a share may grow or fall, at the most 1: no vertex moves by more than the product's
            surface is away, or `least`.
        """
        found = self._found(shares, obstacle, digits)
        distances = np.array([one.min(initial=self.reach) for one in found])
        # Shares per step, for skin that does not move.
        pace = [
            (speeds / np.clip(np.abs(away), least, self.reach)).max(initial=1.0) if len(away) else 1.0
            for speeds, away in zip(self.speeds, found, strict=True)
        ]
        return distances, 1.0 / np.array(pace)

    def first_touch(self, obstacle: Obstacle, moving: NDArray[np.bool_]) -> Floats:
        """Return the shares (5,) at which the moving digits come to the product, 1 where they do not.

        No vertex goes on by more than the product is away: it cannot step over it.
        """
        moving = moving & [bool(one.any()) for one in self.speeds]
        shares = self._opened(obstacle, moving)
        while moving.any():
            distances, steps = self.look(shares, obstacle, moving, least=_LEAST_STEP * self.scale)
            moving = moving & (distances > _TOUCHES * self.scale)
            shares = np.where(moving, np.minimum(shares + steps, 1.0), shares)
            moving = moving & (shares < 1.0)
        return shares

    def _opened(self, obstacle: Obstacle, moving: NDArray[np.bool_]) -> Floats:
        """Return the shares (5,) from -1 to 0, the largest found at which no digit that moves is met.

        Of a digit that is about as deep in it when it is open as at first, 0: its base is met.
        """
        shares, deepest = np.zeros(len(DIGITS)), np.full(len(DIGITS), np.nan)
        while moving.any():
            found = self._found(shares, obstacle, moving)
            depths = -np.array([one.min(initial=self.reach) for one in found])
            deepest = np.where(np.isnan(deepest), depths, deepest)
            in_vain = moving & (shares == -1.0) & (depths > deepest - _LEAD_OUT * self.scale)
            shares[in_vain] = 0.0
            moving = moving & (shares > -1.0) & (depths >= 0.0) & ~in_vain
            for at in np.flatnonzero(moving):
                # No vertex is out before it has moved by its depth.
                ways = np.divide(
                    -found[at], self.speeds[at], where=self.speeds[at] > 0.0, out=np.zeros(len(found[at]))
                )
                step = max(ways.max(), _OPENING * self.scale / self.speeds[at].max())
                shares[at] = max(shares[at] - step, -1.0)
        return shares

    def _found(self, shares: Floats, obstacle: Obstacle, digits: NDArray[np.bool_]) -> list[Floats]:
        """Return the signed distances (m) of the vertices of some digits, none of the others."""
        places = self.places(shares)
        vertices = [one if looked else one[:0] for one, looked in zip(self.vertices, digits, strict=True)]
        found = obstacle.signed_distance(places[np.concatenate(vertices)], self.reach)[0]
        return np.split(found, np.cumsum([len(one) for one in vertices])[:-1])

    def _mesh_width(self) -> float:
        """Return how far a point of a digit's triangle can be from its corners (m)."""
        vertices, faces = self._hand.surface.vertices, self._hand.surface.faces
        edges = vertices[faces] - vertices[np.roll(faces, -1, axis=1)]
        is_digit = self.digits[faces].min(axis=1) < len(DIGITS)
        # Of all triangles with such edges, the middle of the equilateral one.
        return float(np.linalg.norm(edges[is_digit], axis=2).max(initial=0.0) / np.sqrt(3.0))

    def _bounds(self) -> tuple[Floats, ...]:
        """Return how far each digit's vertices move at the most per unit of its share (m)."""
        shares = np.arange(-_SAMPLES, _SAMPLES + 1) / _SAMPLES
        places = [self.places(np.full(len(DIGITS), share)) for share in shares]
        ways = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=0) * _SAMPLES
        return tuple(_SPARE * ways[vertices] for vertices in self.vertices)
