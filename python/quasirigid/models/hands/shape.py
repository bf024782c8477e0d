"""Skin of the whole hand as one implicit surface: palm, pads, knuckles, webs and digits smoothly joined.

Breadths and thicknesses are drawn for a hand 85 mm broad, palm about 28 mm thick at its heads.
"""

from __future__ import annotations

import numpy as np

from ..._arrays import Floats
from .digits import DigitSkin
from .field import ellipsoid, sheet, smooth_union, superellipse
from .skeleton import REFERENCE_BREADTH, REFERENCE_LENGTH, Digit, Skeleton

__all__ = ["HandShape"]

WRIST_CUT = 18.0e-3  # behind the wrist joint, of the reference hand (m)
# Palm without its pads, by place along the hand: middle across, half breadth, middle towards the back, half
# thickness, sag of the edges below the middle (m).
TRUNK = np.array(
    [
        (-40.0e-3, 0.0e-3, 28.5e-3, -0.5e-3, 19.5e-3, 0.0e-3),
        (-10.0e-3, 0.0e-3, 28.0e-3, -0.5e-3, 18.5e-3, 0.0e-3),
        (20.0e-3, 1.5e-3, 31.5e-3, -1.5e-3, 17.5e-3, 1.0e-3),
        (45.0e-3, 4.0e-3, 35.0e-3, -2.0e-3, 15.5e-3, 3.5e-3),
        (70.0e-3, 6.5e-3, 39.0e-3, -2.5e-3, 14.0e-3, 5.0e-3),
        (92.0e-3, 8.0e-3, 41.5e-3, -3.5e-3, 13.5e-3, 5.0e-3),
        (120.0e-3, 8.5e-3, 41.0e-3, -6.0e-3, 10.5e-3, 4.0e-3),
    ]
)
# How far the rim of the palm falls back, by place across (m).
RIM = np.array(
    [
        (-60e-3, 22e-3),
        (-33e-3, 7e-3),
        (-11e-3, 0e-3),
        (9e-3, 3e-3),
        (28e-3, 13e-3),
        (46e-3, 24e-3),
        (70e-3, 44e-3),
    ]
)
RIM_END = 116.0e-3
RIM_ROUND = 15.0e-3


class HandShape:
    """Approximate distance to the skin of a right hand."""

    def __init__(self, skeleton: Skeleton, hand_length: float, hand_breadth: float) -> None:
        self.along, self.across = hand_length / REFERENCE_LENGTH, hand_breadth / REFERENCE_BREADTH
        self.scale = np.array([self.across, self.along, self.across])
        self.digits = tuple(DigitSkin(digit, self.across) for digit in skeleton.digits)
        self.cut = -WRIST_CUT * self.along
        self.skeleton = skeleton
        thumb = skeleton.digits[0]
        self._pads(thumb, skeleton.digits[1])

    def _pads(self, thumb: Digit, index: Digit) -> None:
        b = self.across
        base, knuckle = thumb.joints[:2]
        inwards = np.array([0.45, 0.0, -0.9])
        frame = thumb.frames[0]
        middle = base + 0.50 * (knuckle - base) + 5.0e-3 * b * inwards
        self.bodies = [
            (middle, frame, np.array([15.0e-3 * b, 30.0e-3 * self.along, 15.0e-3 * b]), 16e-3),
            (
                self.scale * (24.5e-3, 43.0e-3, -11.0e-3),
                np.eye(3),
                self.scale * (14.5e-3, 36.0e-3, 13.0e-3),
                16e-3,
            ),
        ]
        for digit, inner in zip(self.skeleton.digits[1:], (1.5e-3, 0.0, -0.5e-3, -3.0e-3), strict=True):
            place = digit.joints[1] + digit.frames[1] @ (np.array([inner, -5.0e-3, 2.5e-3]) * b)
            self.bodies.append((place, digit.frames[1], np.array([6.0e-3, 17.0e-3, 8.5e-3]) * b, 8e-3))
        root = 0.7 * base + 0.3 * index.joints[0]
        self.web = np.stack(
            [
                root,
                base + 0.80 * (knuckle - base),
                index.joints[0] + 0.72 * (index.joints[1] - index.joints[0]),
            ]
        )
        self.web[2] += np.array([1.0e-3, 0.0, -4.0e-3]) * b
        self.web_thickness = 6.0e-3 * b

    def trunk(self, points: Floats) -> Floats:
        """Return the distance (m) to palm and wrist without pads."""
        x, y, z = (points / self.scale).T
        stations = TRUNK[:, 0]
        middle, half, height, thickness, sag = (_curve(y, stations, column) for column in TRUNK[:, 1:].T)
        offset = (x - middle) / half
        z = z - height + sag * (np.minimum(offset**2, 1.5) - 0.35)
        end = np.maximum(y + _curve(x, RIM[:, 0], RIM[:, 1]) - (RIM_END - RIM_ROUND), 0.0) / RIM_ROUND
        unit = superellipse((offset, z / thickness, end), (half, thickness, RIM_ROUND), 2.4)
        distance: Floats = unit * min(self.across, self.along)
        return distance

    def distance(self, points: Floats) -> Floats:
        """Return the distance (n,) in m to the skin, nearly, negative inside; the wrist goes on behind it."""
        b = self.across
        thumb, *fingers = (digit.distance(points) for digit in self.digits)
        hand = self.trunk(points)
        for middle, axes, radii, blend in self.bodies:
            hand = smooth_union(hand, ellipsoid(points, middle, axes, radii), blend * b)
        hand = smooth_union(hand, sheet(points, self.web, self.web_thickness), 12e-3 * b)
        hand = smooth_union(hand, thumb, 10e-3 * b)
        four = fingers[0]
        for finger in fingers[1:]:
            four = smooth_union(four, finger, 3.5e-3 * b)
        whole: Floats = smooth_union(hand, four, 7e-3 * b)
        return whole


def _curve(places: Floats, stations: Floats, values: Floats) -> Floats:
    """Return a smooth curve through values at stations, level at neither end (Catmull and Rom 1974)."""
    slopes = np.gradient(values, stations)
    piece = np.clip(np.searchsorted(stations, places, side="right") - 1, 0, len(stations) - 2)
    width = stations[piece + 1] - stations[piece]
    t = np.clip((places - stations[piece]) / width, 0.0, 1.0)
    rest = 1.0 - t
    curve: Floats = (
        rest**2 * (1.0 + 2.0 * t) * values[piece]
        + t**2 * (1.0 + 2.0 * rest) * values[piece + 1]
        + t * rest * width * (rest * slopes[piece] - t * slopes[piece + 1])
    )
    return curve
