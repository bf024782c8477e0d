"""Which joints carry the skin of the built-in hand: smooth weights from places along its digits.

Along a digit the weights pass from bone to bone within about half a breadth of the joint. The palm goes with
the metacarpals near to it, the heel of the hand with the wrist. Phalanges carry the skin of their own digit
alone, but for the webs, which neighbours share.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..._arrays import Floats, Indices
from ..._geometry import distance_to_segment
from ...hand.rig.joints import WEBXR_25
from .shape import HandShape

__all__ = ["MOST", "weights_of"]

MOST = 6  # joints a vertex: where the metacarpals begin, all five and the wrist
# Where two bones share the skin, from the knuckle to the last joint, in breadths of the digit.
BLENDS = (1.30, 0.95, 0.75)
WRIST = (0.0, 34.0e-3)  # between these the metacarpals take over from the wrist (m)
BELONGS = (2.0e-3, 8.0e-3)  # skin farther from a digit than this is the palm's (m)
FADE = 8.0e-3  # at a web, by as much must a digit be nearer than the next to carry the skin alone (m)
WEB = 8.0e-3  # beyond the bottom of a web, the way in which neighbours cease to share (m)
REACH = 3.0e-3  # over which one finger's metacarpal yields to the next (m)
BALL = 30.0e-3  # by as much must skin be nearer to the thumb's metacarpal to be its alone (m)


def weights_of(points: Floats, shape: HandShape) -> tuple[Indices, Floats]:
    """Return joints (n, 6) and weights (n, 6) of skin points (n, 3) in m of a right hand."""
    weights = np.zeros((len(points), len(WEBXR_25)))
    distances = np.stack([digit.distance(points) for digit in shape.digits], axis=1)
    alongs = np.stack([digit.local(points)[1] for digit in shape.digits], axis=1)
    order = np.argsort(distances, axis=1, kind="stable")[:, :2]
    least, second = np.take_along_axis(distances, order, axis=1).T
    beyond = np.take_along_axis(alongs, order, axis=1).mean(axis=1) - _webs(shape)[order[:, 0], order[:, 1]]
    apart = _step(second - least, 0.0, FADE * shape.across)
    apart = np.maximum(apart, _step(beyond, 0.0, WEB * shape.across))
    left = np.ones(len(points))
    for number, (skin, digit) in enumerate(zip(shape.digits, shape.skeleton.digits, strict=True)):
        # Half way between two digits either has one half.
        for rank, part in ((0, 0.5 + 0.5 * apart), (1, 0.5 - 0.5 * apart)):
            own = np.flatnonzero((order[:, rank] == number) & (part > 0.0))
            near = 1.0 - _step(distances[own, number], *(bound * shape.across for bound in BELONGS))
            carried = part[own] * near
            knuckle = 1 if skin.name == "thumb" else 0
            for place, (joint, blend) in enumerate(zip(skin.joints[knuckle:-1], BLENDS, strict=False)):
                reach = 0.5 * blend * skin.breadth
                turn = carried * _step(alongs[own, number], joint - reach, joint + reach)
                if place > 0:
                    weights[own, digit.first + place] -= turn
                weights[own, digit.first + place + 1] += turn
                left[own] -= turn if place == 0 else 0.0
                carried = turn
    wrist = 1.0 - _step(points[:, 1], *(bound * shape.along for bound in WRIST))
    weights[:, 0] = left * wrist
    for digit, share in zip(shape.skeleton.digits, _shares(points, shape).T, strict=True):
        weights[:, digit.first] = left * (1.0 - wrist) * share
    return _most(weights)


def _webs(shape: HandShape) -> Floats:
    """Return how far along two digits (5, 5), in their mean, the bottom of the web between them lies (m)."""
    webs = np.zeros((len(shape.digits), len(shape.digits)))
    steps = np.linspace(0.0, 0.05 * shape.along, 101)
    for one, (digit, following) in enumerate(pairwise(shape.skeleton.digits)):
        start = 0.5 * (digit.joints[1] + following.joints[1])
        line = start + steps[:, None] * (digit.frames[1, :, 1] + following.frames[1, :, 1]) / 2.0
        bottom = line[np.argmax(shape.distance(line) > 0.0)][None]
        alongs = [skin.local(bottom)[1][0] for skin in shape.digits[one : one + 2]]
        webs[one, one + 1] = webs[one + 1, one] = np.mean(alongs)
    return webs


def _shares(points: Floats, shape: HandShape) -> Floats:
    """Return the metacarpals' shares (n, 5), those of the nearest largest."""
    distances = [distance_to_segment(points, *digit.joints[:2]) for digit in shape.skeleton.digits]
    thumb, fingers = distances[0], np.stack(distances[1:], axis=1)
    nearest = fingers.min(axis=1)
    shares: Floats = np.exp(-(fingers - nearest[:, None]) / (REACH * shape.across))
    shares /= shares.sum(axis=1, keepdims=True)
    ball = _step(nearest - thumb, -BALL * shape.across, BALL * shape.across)[:, None]
    return np.concatenate([ball, (1.0 - ball) * shares], axis=1)


def _step(values: Floats, low: float, high: float) -> Floats:
    """Return 0 below `low`, 1 above `high`, and a smooth rise between."""
    t = np.clip((values - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _most(weights: Floats) -> tuple[Indices, Floats]:
    """Return the joints of the largest weights, the largest first, and those weights made to sum to 1."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :MOST]
    largest = np.take_along_axis(weights, joints, axis=1)
    largest[largest < 1e-4] = 0.0
    joints[largest == 0.0] = 0
    return joints, largest / largest.sum(axis=1, keepdims=True)
