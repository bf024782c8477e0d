"""Skin of one digit as an implicit surface: sections across a gently bent middle line.

Breadths and depths at the joints follow Greiner 1991 (Hand Anthropometry of U.S. Army Personnel, Natick
TR-92/011), as in `quasirigid.models.finger`; what lies between is drawn.
"""

from __future__ import annotations

import numpy as np

from ..._arrays import Floats
from ..._geometry import distance_to_segment
from ..fingers import TIP_EXPONENT
from .field import superellipse
from .skeleton import Digit

__all__ = ["DigitSkin"]

# Breadth at the last joint (m) of a hand of the reference breadth.
BREADTHS = {"thumb": 21.0e-3, "index": 17.6e-3, "middle": 18.0e-3, "ring": 16.6e-3, "little": 14.8e-3}
# At the tip, the middle of the nail, then joint, mid-bone, joint ... to the base of the first bone drawn:
# half breadth, half depth and place of the middle towards the back, in breadths at the last joint.
FINGER = np.array(
    [
        (0.440, 0.310, 0.020),
        (0.475, 0.350, -0.055),
        (0.500, 0.400, -0.020),
        (0.492, 0.415, -0.055),
        (0.560, 0.475, -0.025),
        (0.545, 0.490, -0.085),
        (0.550, 0.535, -0.120),
    ]
)
THUMB = np.array(
    [
        (0.440, 0.290, 0.020),
        (0.490, 0.325, -0.050),
        (0.500, 0.385, -0.010),
        (0.475, 0.400, -0.050),
        (0.530, 0.480, -0.060),
        (0.560, 0.560, -0.140),
        (0.540, 0.580, -0.120),
    ]
)
THICKEST = 0.8  # no skin is farther from the bones than this, in breadths
NEAR = 0.75  # from there on another body's join does not reach here, in breadths


class DigitSkin:
    """Approximate distance to the skin of a digit and the place along it."""

    def __init__(self, digit: Digit, across: float) -> None:
        self.name = digit.name
        start = 0 if digit.name == "thumb" else 1
        self.origin, self.axes = digit.joints[start], digit.frames[start]
        local = (digit.joints[start:] - self.origin) @ self.axes
        self.breadth = across * BREADTHS[digit.name]
        bones = np.linalg.norm(np.diff(local, axis=0), axis=1)
        self.joints = np.concatenate([[0.0], np.cumsum(bones)])  # places along the digit (m)
        self.end = digit.joints[-1]
        self.length = self.joints[-1] + digit.pulp
        self.round = 0.62 * self.breadth
        self._line(local)
        self._profile()

    def _line(self, local: Floats) -> None:
        """Tabulate the middle line, its corners rounded: place along the first bone -> height, slope, way."""
        step = 0.5e-3
        y = np.arange(-0.06, local[-1, 1] + 0.06, step)
        slopes = np.diff(local[:, 2]) / np.diff(local[:, 1])
        bone = np.clip(np.searchsorted(local[:, 1], y, side="right") - 1, 0, len(slopes) - 1)
        slope = _smoothed(slopes[bone], round(5e-3 / step))
        height = np.cumsum(slope) * step
        height -= np.interp(0.0, y, height)
        way = np.cumsum(np.sqrt(1.0 + slope**2)) * step
        way -= np.interp(0.0, y, way)
        self.line = _Table(y[0], step, np.stack([height, slope, way], axis=1))

    def _profile(self) -> None:
        ends = self.joints
        last = 0.5 * (ends[-2] + ends[-1])
        middles = 0.5 * (ends[:-2] + ends[1:-1])
        places = [self.length, last]
        for joint in range(len(ends) - 2, -1, -1):
            places += [ends[joint]] if joint == 0 else [ends[joint], middles[joint - 1]]
        table = (THUMB if self.name == "thumb" else FINGER) * self.breadth
        step = 0.5e-3
        s = np.arange(-0.06, self.length + 0.06, step)
        columns = [np.interp(s, places[::-1], column[::-1]) for column in table.T]
        smooth = [_smoothed(column, round(3.5e-3 / step)) for column in columns]
        self.profile = _Table(s[0], step, np.stack(smooth, axis=1))

    def local(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the place across, along the middle line and above it (m) of points (n, 3)."""
        x, y, z = ((points - self.origin) @ self.axes).T
        height, slope, _ = self.line.at(y)
        # One step towards the foot of the point on the line.
        foot = y + (z - height) * slope / (1.0 + slope**2)
        height, slope, way = self.line.at(foot)
        scale = np.sqrt(1.0 + slope**2)
        rise, run = z - height, y - foot
        return x, way + (run + rise * slope) / scale, (rise - run * slope) / scale

    def distance(self, points: Floats) -> Floats:
        """Return the distance (n,) in m to the skin, nearly, negative inside; far away a lower bound."""
        distance = distance_to_segment(points, self.origin, self.end) - THICKEST * self.breadth
        near = np.flatnonzero(distance < NEAR * self.breadth)
        distance[near] = self._near(points[near])
        return distance

    def _near(self, points: Floats) -> Floats:
        x, s, z = self.local(points)
        half_breadth, half_depth, middle = self.profile.at(s)
        # Flatter on the nail's side, rounder on the pad's.
        near_tip = np.exp(-(((self.length - 0.009 - s) / 0.011) ** 2))
        nail = half_depth * (0.06 + 0.17 * near_tip)
        z = z - middle - nail * (np.minimum((x / half_breadth) ** 2, 1.5) - 0.5)
        beyond = np.maximum(s - (self.length - self.round), 0.0)
        behind = np.maximum(-s, 0.0)
        ends = beyond / self.round + behind / (0.6 * self.breadth)
        return superellipse(
            (x / half_breadth, z / half_depth, ends), (half_breadth, half_depth, self.round), TIP_EXPONENT
        )


class _Table:
    """Columns at even steps, read between them in straight lines and held beyond the ends."""

    def __init__(self, first: float, step: float, values: Floats) -> None:
        self.first, self.step, self.values = first, step, values

    def at(self, places: Floats) -> Floats:
        """Return the columns (k, n) at places (n,)."""
        place = np.clip((places - self.first) / self.step, 0.0, len(self.values) - 1.001)
        below = place.astype(np.int64)
        share = (place - below)[:, None]
        found: Floats = (1.0 - share) * self.values[below] + share * self.values[below + 1]
        return found.T


def _smoothed(values: Floats, width: int) -> Floats:
    """Return values averaged by a bell of standard deviation `width` entries, ends held."""
    offsets = np.arange(-3 * width, 3 * width + 1)
    bell = np.exp(-0.5 * (offsets / width) ** 2)
    padded = np.pad(values, 3 * width, mode="edge")
    return np.convolve(padded, bell / bell.sum(), mode="valid")
